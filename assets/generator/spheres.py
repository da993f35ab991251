"""A field of spheres in the manner of Shirley 2016, "Ray Tracing in One Weekend": all exact spheres, one sky.

Placed by our own random numbers, without overlaps, each resting on the ground sphere.
"""

from math import pi, sqrt
from random import Random

LIGHT_TARGET = None
GROUND_RADIUS = 1000.0
SMALL_RADIUS = 0.2
COUNT = 400
CLEARANCE = 0.0001  # keeps the spheres of glass from cutting into the ground


def fuzz_roughness(fuzz):
    """glTF roughness with the same RMS spread as a mirror direction moved by `fuzz` inside the unit ball.

    The transverse RMS of a uniform ball is sqrt(2/5); a facet slope turns the reflection by twice its angle.
    """
    return sqrt(fuzz * sqrt(0.4) / 2)


def _resting(x, z, radius):
    """Centre of a sphere that touches the ground sphere, whose top is the origin."""
    reach = GROUND_RADIUS + radius + CLEARANCE
    return (x, sqrt(reach * reach - x * x - z * z) - GROUND_RADIUS, z)


def _palette(document, random):
    """Materials by kind: 40 diffuse colours, 12 metals, one glass."""
    def colour(low, high):
        return [low + (high - low) * random.random() for _ in range(3)]

    diffuse = []
    for i in range(40):
        albedo = [a * b for a, b in zip(colour(0.1, 1.0), colour(0.1, 1.0))]
        diffuse.append(document.material(f"diffuse {i}", albedo, lambert=True))
    metal = []
    for i in range(12):
        color, fuzz = colour(0.5, 1.0), 0.5 * random.random()
        metal.append(document.material(f"metal {i}", color, metallic=1.0, roughness=fuzz_roughness(fuzz)))
    return diffuse, metal


def build(document):
    random = Random(19)
    diffuse, metal = _palette(document, random)
    # Volume distances are measured along the ray; the thickness only says that the body is solid.
    glass = document.material("glass", (1.0, 1.0, 1.0), roughness=0.0, ior=1.5, transmission=1.0, thickness=2.0)
    ground = document.material("ground", (0.5, 0.5, 0.5), lambert=True)
    brown = document.material("brown", (0.4, 0.2, 0.1), lambert=True)
    mirror = document.material("bronze mirror", (0.82, 0.62, 0.42), metallic=1.0, roughness=0.0)
    document.sphere("ground", (0.0, -GROUND_RADIUS, 0.0), GROUND_RADIUS, ground)
    big = (("brown", -4.0, brown), ("glass", 0.0, glass), ("mirror", 4.0, mirror))
    placed = []
    for name, x, material in big:
        centre = _resting(x, 0.0, 1.0)
        placed.append((centre, 1.0))
        document.sphere(name, centre, 1.0, material)
    while len(placed) < COUNT + len(big):
        centre = _resting(22 * random.random() - 11, 22 * random.random() - 11, SMALL_RADIUS)
        if any(sum((a - b) ** 2 for a, b in zip(centre, other)) < (1.1 * (SMALL_RADIUS + radius)) ** 2
               for other, radius in placed):
            continue
        placed.append((centre, SMALL_RADIUS))
        choice = random.random()
        if choice < 0.75:
            kind, material = "diffuse", diffuse[int(random.random() * len(diffuse))]
        elif choice < 0.92:
            kind, material = "metal", metal[int(random.random() * len(metal))]
        else:
            kind, material = "glass", glass
        document.sphere(f"{kind} ball {len(placed) - len(big)}", centre, SMALL_RADIUS, material)
    document.environment(color=(0.75, 0.86, 1.0))
    document.camera("camera", (13.0, 2.0, 3.0), (0.0, 0.0, 0.0), 20 * pi / 180, (960, 540), lens=(0.05, 10.0))
    document.camera("overview", (0.0, 9.0, 16.0), (0.0, 0.0, 0.0), 40 * pi / 180, (960, 540))
