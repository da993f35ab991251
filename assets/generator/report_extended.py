"""What the report of 2019 wanted and did not reach: right cubes, a glass heart, textures, lights that cast shadows.

On the ground ball of `report`, under a dim copy of its sky; a lamp quad, a small sphere lamp and a spot light.
"""

from math import cos, pi, sin, sqrt

from . import report, textures
from .geometry import box, faceted, panel, scaled, sphere, turn_y

LIGHT_TARGET = (0.0, 0.8, -6.0)
GROUND_RADIUS = 20.0


def _heart_radius(direction):
    """Distance from the centre to (x^2 + 9/4 z^2 + y^2 - 1)^3 = (x^2 + 9/80 z^2) y^3 (Taubin 1994)."""
    x, y, z = direction
    a, b = x * x + 2.25 * z * z + y * y, (x * x + 0.1125 * z * z) * y ** 3
    low, high = 0.0, 2.0
    for _ in range(60):
        middle = (low + high) / 2
        inside = (a * middle * middle - 1) ** 3 - b * middle ** 5 < 0
        low, high = (middle, high) if inside else (low, middle)
    return low


def heart(size, columns=18, rows=11):
    """A cut-glass heart: rings about y from the notch to the tip, every second one turned by half a facet."""
    points = [scaled((0.0, _heart_radius((0.0, 1.0, 0.0)), 0.0), size)]
    for i in range(1, rows):
        polar = pi * i / rows
        for j in range(columns):
            angle = 2 * pi * (j + 0.5 * (i % 2)) / columns
            direction = (sin(polar) * cos(angle), cos(polar), -sin(polar) * sin(angle))
            points.append(scaled(direction, size * _heart_radius(direction)))
    points.append(scaled((0.0, -_heart_radius((0.0, -1.0, 0.0)), 0.0), size))
    triangles = []
    for j in range(columns):
        after = (j + 1) % columns
        triangles.append((0, 1 + j, 1 + after))
        last = 1 + (rows - 2) * columns
        triangles.append((last + after, last + j, len(points) - 1))
        for i in range(rows - 2):
            a, b = 1 + i * columns, 1 + (i + 1) * columns
            if i % 2 == 0:  # this ring is the turned one
                triangles += [(a + j, b + after, a + after), (a + j, b + j, b + after)]
            else:
                triangles += [(a + j, b + j, a + after), (a + after, b + j, b + after)]
    return faceted(points, triangles)


def _on_ground(x, z, lift):
    """A place `lift` above the ground ball, measured along its radius."""
    reach = GROUND_RADIUS + lift
    return (x, -19.2 + sqrt(reach * reach - x * x - (z + 10) ** 2), z)


def _build_lights(document):
    lamp = document.material("lamp", (0.0, 0.0, 0.0), lambert=True, emission=(26.0, 23.0, 18.0))
    globe = document.material("globe", (0.0, 0.0, 0.0), lambert=True, emission=(12.0, 6.0, 2.3))
    # A square panel up on the left, tilted towards the middle of the scene.
    document.node("lamp", document.mesh("lamp", (panel((-2.6, 4.2, -4.2), LIGHT_TARGET, 1.2, 1.2), lamp)))
    document.sphere("globe", _on_ground(2.35, -6.6, 0.25), 0.25, globe)
    document.spot("spot", (2.6, 4.5, -3.5), (0.0, 0.9, -6.2), (0.85, 0.92, 1.0), 90.0, 8 * pi / 180, 14 * pi / 180)


def build(document):
    size = 256
    brick_base, brick_rough, brick_normal = textures.bricks(size, 4, 8, 5)
    check_base, check_rough = textures.tiles(size, 8, 9)
    brick = document.material("brick", roughness=1.0, textures={
        "base": document.texture("brick base", brick_base),
        "roughness": document.texture("brick roughness", brick_rough),
        "normal": document.texture("brick normal", brick_normal)})
    check = document.material("check", roughness=1.0, textures={
        "base": document.texture("check base", check_base),
        "roughness": document.texture("check roughness", check_rough)})
    rosy = document.material("rosy glass", roughness=0.0, ior=1.5, transmission=1.0, thickness=0.8,
                             attenuation=((0.95, 0.35, 0.42), 0.6))
    red = report.diffuse(document, "red", (1.0, 0.2, 0.2))
    blue = report.diffuse(document, "blue", (0.0, 0.3, 0.8))
    mirror = report.metal(document, "mirror", (1.0, 1.0, 1.0), 0.0)
    ground = document.material("ground", (0.62, 0.6, 0.58), lambert=True)
    document.sphere("ground", (0.0, -19.2, -10.0), GROUND_RADIUS, ground)
    solids = (("brick cube", box((0.9, 0.9, 0.9)), brick, _on_ground(-1.45, -6.4, 0.44), 0.5),
              ("red cube", box((0.5, 0.5, 0.5)), red, _on_ground(-0.55, -5.2, 0.24), -0.3),
              ("mirror cube", box((1.1, 1.1, 1.1)), mirror, _on_ground(1.2, -7.4, 0.54), 0.75),
              ("check ball", sphere(0.45, 64, 32), check, _on_ground(1.15, -5.7, 0.45), 0.6),
              ("heart", heart(0.62), rosy, _on_ground(0.12, -6.0, 0.635), 0.35))
    for name, mesh, material, place, heading in solids:
        document.node(name, document.mesh(name, (mesh, material)), place, turn_y(heading))
    document.sphere("blue ball", _on_ground(-1.35, -5.1, 0.22), 0.22, blue)
    _build_lights(document)
    document.environment(gradient=((1.0, 0.0, 0.0), (0.16, 0.16, 0.16), (0.16, 0.0, 0.0)))
    document.camera("camera", (-0.3, 2.0, 0.4), (0.05, 0.7, -6.0), 30 * pi / 180, (960, 540))
    report.camera(document)
