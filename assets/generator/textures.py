"""Procedural textures as PNG bytes: bricks, wood, plaster, peel, brushed metal.

Scalar textures are palette images (one byte a texel); normals come from a periodic height field.
"""

from math import pi, sin, sqrt

from . import png
from .noise import Fbm, Noise


def srgb(linear):
    """8-bit sRGB code of a linear value."""
    linear = min(1.0, max(0.0, linear))
    encoded = 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055
    return int(encoded * 255 + 0.5)


def clamped(value):
    return 0.0 if value < 0.0 else 1.0 if value > 1.0 else value


def smoothstep(low, high, value):
    t = clamped((value - low) / (high - low))
    return t * t * (3 - 2 * t)


def colour_ramp(stops, size=256):
    """Palette of `size` sRGB colours along (position, linear colour) stops."""
    palette = []
    for i in range(size):
        t = i / (size - 1)
        k = next((k for k in range(len(stops) - 2) if t <= stops[k + 1][0]), len(stops) - 2)
        (t0, c0), (t1, c1) = stops[k], stops[k + 1]
        w = clamped((t - t0) / (t1 - t0))
        palette.append(tuple(srgb(a + (b - a) * w) for a, b in zip(c0, c1)))
    return palette


def ramp_png(field, stops, levels=256):
    """A field of 0..1 values through a colour ramp."""
    top = levels - 1
    indices = [[int(clamped(v) * top + 0.5) for v in row] for row in field]
    return png.encode_palette(indices, colour_ramp(stops, levels))


def roughness_png(field, metallic=0, levels=64):
    """A field of roughness as a metallic-roughness texture (G roughness, B metallic)."""
    top = levels - 1
    palette = [(255, int(i * 255 / top + 0.5), metallic) for i in range(levels)]
    return png.encode_palette([[int(clamped(v) * top + 0.5) for v in row] for row in field], palette)


def normal_png(height, relief, step_x=1.0, step_y=1.0):
    """Tangent-space normals (+Y up the image) of a periodic height field; `relief` is height per texel width."""
    rows = []
    count = len(height)
    for y in range(count):
        row, above, below = height[y], height[y - 1], height[(y + 1) % count]
        ahead, behind = row[1:] + row[:1], row[-1:] + row[:-1]
        line = []
        for a, b, c, d in zip(behind, ahead, below, above):
            nx, ny = (a - b) * relief * 0.5 / step_x, (c - d) * relief * 0.5 / step_y
            scale = 127.5 / sqrt(nx * nx + ny * ny + 1.0)
            line += (int(nx * scale + 128.0), int(ny * scale + 128.0), int(scale + 128.0))
        rows.append(line)
    return png.encode_rgb(rows)


def bricks(size, columns, courses, seed):
    """Base colour, roughness and normal of a running bond wall; periodic when `courses` is even."""
    grain = Fbm(seed, 16, 16, size, size, 4)
    edge = Fbm(seed + 1, 12, 12, size, size, 3)
    tones = [Noise(seed + 2 + i, columns, courses, columns, courses) for i in range(2)]
    tone_rows = [[clamped(0.5 + a * 1.1) for a in tones[0].row(y)] for y in range(courses)]
    joint = 0.055  # half the mortar's width in courses
    colour, rough, height = [], [], []
    for y in range(size):
        place = y * courses / size
        course = int(place)
        v = min(place - course, course + 1 - place)
        shift = 0.5 * (course % 2)
        line = ([], [], [])
        for x, (g, e) in enumerate(zip(grain.row(y), edge.row(y))):
            across = x * columns / size + shift
            brick = int(across)
            u = min(across - brick, brick + 1 - across) * courses / columns * 2
            inside = smoothstep(joint - 0.02, joint + 0.05, min(u, v) + 0.05 * e)
            tone = tone_rows[course][brick % columns]
            line[0].append(0.5 + 0.45 * tone + 0.3 * g if inside > 0.5 else 0.15 + 0.25 * (g + 0.3) * (1 - inside))
            line[1].append(0.95 - 0.2 * inside * (0.6 + g))
            line[2].append(inside * (1.0 + 0.25 * tone) + 0.22 * g)
        for field, row in zip((colour, rough, height), line):
            field.append(row)
    stops = ((0.0, (0.30, 0.28, 0.25)), (0.3, (0.52, 0.49, 0.44)), (0.45, (0.16, 0.055, 0.035)),
             (0.7, (0.36, 0.12, 0.07)), (1.0, (0.58, 0.25, 0.14)))
    return ramp_png(colour, stops), roughness_png(rough), normal_png(height, 6.0 * size / 512)


def tiles(size, squares, seed):
    """A two-tone glazed check: base colour and roughness."""
    cloud = Fbm(seed, 4, 4, size, size, 5)
    colour, rough = [], []
    for y in range(size):
        line = []
        for x, n in enumerate(cloud.row(y)):
            dark = (x * squares // size + y * squares // size) % 2
            vein = 1.0 - min(1.0, abs(n) * 6.0)
            line.append(0.12 + 0.2 * vein ** 3 if dark else 0.88 - 0.25 * vein ** 3 + 0.1 * n)
        colour.append(line)
        rough.append([0.12 + 0.15 * v for v in line])
    return ramp_png(colour, ((0.0, (0.01, 0.015, 0.02)), (0.35, (0.16, 0.19, 0.20)), (0.6, (0.42, 0.40, 0.37)),
                             (1.0, (0.86, 0.84, 0.78)))), roughness_png(rough)
