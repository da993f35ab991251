"""The Cornell box at a hundredth of its published numbers, read as metres: a room of 5.56 x 5.488 x 5.592 m.

Block corners and camera are those of the Cornell University page of 1998; the slanted walls are made straight.
"""

from math import atan

from .geometry import Mesh, prism, quad

LIGHT_TARGET = (2.78, 1.0, 2.8)
WIDTH, HEIGHT, DEPTH = 5.56, 5.488, 5.592
LIGHT = (2.13, 3.43, 2.27, 3.32)  # x0, x1, z0, z1 of the opening in the ceiling that the light fills
TALL = ((4.23, 2.47), (2.65, 2.96), (3.14, 4.56), (4.72, 4.06))
SHORT = ((1.30, 0.65), (0.82, 2.25), (2.40, 2.72), (2.90, 1.14))


def _ceiling():
    """Four strips around the light, so that no two surfaces lie in one place."""
    x0, x1, z0, z1 = LIGHT
    mesh = Mesh()
    for left, right, near, far in ((0, WIDTH, 0, z0), (0, WIDTH, z1, DEPTH), (0, x0, z0, z1), (x1, WIDTH, z0, z1)):
        mesh.append(quad((left, HEIGHT, near), (right - left, 0, 0), (0, 0, far - near)))
    return mesh


def _counter_clockwise(corners):
    """Corners (x, z) in the order that `prism` wants: x towards -z has positive area."""
    area = sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(corners, corners[1:] + corners[:1]))
    return corners if area < 0 else corners[::-1]


def build(document):
    white = document.material("white", (0.73, 0.73, 0.73), lambert=True, two_sided=True)
    red = document.material("red", (0.63, 0.065, 0.05), lambert=True, two_sided=True)
    green = document.material("green", (0.14, 0.45, 0.091), lambert=True, two_sided=True)
    light = document.material("light", (0.0, 0.0, 0.0), lambert=True, emission=(17.0, 12.0, 4.0))
    shell = quad((0, 0, DEPTH), (WIDTH, 0, 0), (0, 0, -DEPTH))
    shell.append(quad((WIDTH, 0, DEPTH), (-WIDTH, 0, 0), (0, HEIGHT, 0)))
    shell.append(_ceiling())
    x0, x1, z0, z1 = LIGHT
    document.node("shell", document.mesh("shell", (shell, white)))
    document.node("red wall", document.mesh("red wall", (
        quad((WIDTH, 0, 0), (0, 0, DEPTH), (0, HEIGHT, 0)), red)))
    document.node("green wall", document.mesh("green wall", (
        quad((0, 0, DEPTH), (0, 0, -DEPTH), (0, HEIGHT, 0)), green)))
    lamp = quad((x0, HEIGHT, z0), (x1 - x0, 0, 0), (0, 0, z1 - z0))
    document.node("light", document.mesh("light", (lamp, light)))
    document.node("tall block", document.mesh("tall block", (prism(_counter_clockwise(TALL), 3.3), white)))
    document.node("short block", document.mesh("short block", (prism(_counter_clockwise(SHORT), 1.65), white)))
    # 35 mm lens over a 25 mm film.
    document.camera("camera", (2.78, 2.73, -8.0), (2.78, 2.73, 0.0), 2 * atan(12.5 / 35), (512, 512))
