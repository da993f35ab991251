"""Textures of the still life: planks, plaster, citrus peel, turned metal and a speckled glaze."""

from math import pi, sin, sqrt
from random import Random

from .noise import Fbm, Noise
from .textures import clamped, normal_png, ramp_png, roughness_png, smoothstep

WALNUT = ((0.0, (0.012, 0.006, 0.003)), (0.25, (0.055, 0.026, 0.012)), (0.5, (0.125, 0.062, 0.028)),
          (0.75, (0.225, 0.122, 0.058)), (1.0, (0.36, 0.21, 0.105)))


def planks(width, height, count, seed):
    """Boards along u with arched growth rings, fibres, pores and thin gaps: base colour, roughness, normal.

    The grain runs along u, so that texels may be long: for a square tile, width can be half of height.
    """
    random = Random(seed)
    warp = Fbm(seed, 2, 8, width, height, 3)
    fibre = Fbm(seed + 1, 12, 180, width, height, 2, 0.7)
    pores = Noise(seed + 2, 64, 400, width, height)
    clouds = Fbm(seed + 3, 3, 5, width, height, 4)
    boards = [{"heart": random.uniform(-0.4, 1.4), "turn": random.random() * 2 * pi,
               "depth": random.uniform(0.25, 0.9), "tone": random.uniform(-0.13, 0.13),
               "rings": random.uniform(13, 22)} for _ in range(count)]
    waves = [2 * pi * x / width for x in range(width)]
    late_wood = [smoothstep(0.25, 0.92, t / 255) * (1.0 - smoothstep(0.93, 1.0, t / 255)) for t in range(256)]
    colour, rough, relief = [], [], []
    for y in range(height):
        place = y * count / height
        board = boards[int(place)]
        across = place - int(place)
        gap = smoothstep(0.0, 0.014, min(across, 1 - across))
        base = across - board["heart"]
        line = ([], [], [])
        for angle, w, f, p, c in zip(waves, warp.row(y), fibre.row(y), pores.row(y), clouds.row(y)):
            reach = board["depth"] * (1.0 + 0.6 * sin(angle + board["turn"]))
            d = base + 0.16 * w
            phase = (sqrt(d * d + reach * reach) + 0.012 * f) * board["rings"]
            late = late_wood[int(phase % 1.0 * 256)]
            pore = smoothstep(0.22, 0.45, p) * (0.35 + 0.65 * late) if p > 0.22 else 0.0
            tone = 0.70 + board["tone"] + 0.26 * c - 0.24 * late + 0.16 * f - 0.26 * pore
            line[0].append(tone * (0.25 + 0.75 * gap))
            line[1].append(0.30 + 0.10 * c - 0.05 * late + 0.22 * pore + 0.3 * (1 - gap))
            line[2].append(1.5 * gap - 0.30 * pore + 0.10 * f - 0.10 * late)
        for field, row in zip((colour, rough, relief), line):
            field.append(row)
    return ramp_png(colour, WALNUT), roughness_png(rough[::2]), normal_png(relief, 1.1, step_x=height / width)


def plaster(size, seed, stops):
    """A trowelled wall: base colour, and normals of broad sweeps with some grit."""
    sweep = Fbm(seed, 3, 4, size, size, 6, 0.55)
    grit = Fbm(seed + 1, 48, 48, size, size, 2)
    colour, height = [], []
    for y in range(size):
        rows = list(zip(sweep.row(y), grit.row(y)))
        colour.append([0.5 + 0.55 * s + 0.08 * g for s, g in rows])
        height.append([3.0 * abs(s + 0.1) + 0.35 * g for s, g in rows])
    return ramp_png(colour, stops, 64), normal_png(height, 1.6)


def peel(size, seed):
    """Citrus peel: mottled base tone (white, to be tinted) and pitted normals."""
    pits = Noise(seed, size // 8, size // 14, size, size)
    fine = Noise(seed + 1, size // 5, size // 8, size, size)
    mottle = Fbm(seed + 2, 4, 3, size, size, 4)
    colour, height = [], []
    for y in range(size):
        rows = list(zip(pits.row(y), fine.row(y), mottle.row(y)))
        colour.append([0.72 + 0.45 * m - 0.5 * max(0.0, p - 0.12) for p, _, m in rows])
        height.append([-max(0.0, p + 0.05) * 1.6 + 0.3 * f + 0.8 * m for p, f, m in rows])
    return (ramp_png(colour, ((0.0, (0.76, 0.60, 0.42)), (0.5, (0.88, 0.80, 0.68)), (1.0, (1.0, 1.0, 1.0))), 64),
            normal_png(height, 1.5))


def turned_metal(width, height, seed):
    """Fine circular strokes: v across them. Roughness (fully metallic) and normals."""
    strokes = Fbm(seed, 2, height // 4, width, height, 2, 0.8)
    broad = Fbm(seed + 1, 5, 6, width, height, 3)
    rough, relief = [], []
    for y in range(height):
        rows = list(zip(strokes.row(y), broad.row(y)))
        rough.append([0.22 + 0.14 * s + 0.10 * b for s, b in rows])
        relief.append([0.6 * s for s, _ in rows])
    return roughness_png(rough, metallic=255), normal_png(relief, 0.55)


def glaze(width, height, seed):
    """A stoneware glaze that breaks to rust at rims (both ends of v) with iron specks: base colour and roughness."""
    flow = Fbm(seed, 6, 4, width, height, 4)
    specks = Noise(seed + 1, width // 5, height // 5, width, height)
    colour, rough = [], []
    for y in range(height):
        v = y / height
        line, gloss = [], []
        for f, s in zip(flow.row(y), specks.row(y)):
            edge = max(smoothstep(0.028, 0.0, abs(v - 0.45) + 0.02 * f), smoothstep(0.80, 0.92, v + 0.05 * f))
            speck = smoothstep(0.40, 0.52, s)
            body = clamped(0.50 + 0.30 * f) * (1 - edge) * (1 - 0.7 * speck)
            line.append(body if edge < 0.5 else 0.8 + 0.2 * edge - 0.1 * f)
            gloss.append(0.13 + 0.06 * f + 0.35 * max(edge - 0.5, 0.0))
        colour.append(line)
        rough.append(gloss)
    stops = ((0.0, (0.006, 0.012, 0.018)), (0.35, (0.012, 0.055, 0.085)), (0.75, (0.05, 0.20, 0.26)),
             (0.8, (0.10, 0.12, 0.09)), (1.0, (0.20, 0.085, 0.035)))
    return ramp_png(colour, stops), roughness_png(rough)


def linen(size, seed):
    """Woven cloth with a blue border of stripes near both ends of u: base colour."""
    warp, weft = Noise(seed, size // 3, 6, size, size), Noise(seed + 1, 6, size // 3, size, size)
    stripes = ((0.085, 0.135), (0.15, 0.16), (0.175, 0.185))
    places = [(x + 0.5) / size for x in range(size)]
    blue = [any(low <= min(u, 1 - u) <= high for low, high in stripes) for u in places]
    field = [[(0.22 if dark else 0.86) + 0.16 * (a + b) for dark, a, b in zip(blue, warp.row(y), weft.row(y))]
             for y in range(size)]
    return ramp_png(field, ((0.0, (0.035, 0.06, 0.12)), (0.4, (0.09, 0.15, 0.27)), (0.6, (0.52, 0.50, 0.45)),
                            (1.0, (0.80, 0.77, 0.70))), 64)
