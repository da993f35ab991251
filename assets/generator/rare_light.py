"""A grey room with a panel in the ceiling and a small lamp inside a glass ball: a sixth of the light, which light sampling
never reaches through the glass and one path in a thousand finds. For the error estimate and its trust light.
"""

from math import atan

from .geometry import Mesh, quad

LIGHT_TARGET = (0.0, 1.0, 0.0)
HALF, HEIGHT, PANEL = 2.0, 3.0, 0.5
BALL, BALL_RADIUS, LAMP_RADIUS = (0.7, 0.9, -0.4), 0.35, 0.03


def _ceiling():
    """Four strips around the panel, so that no two surfaces lie in one place."""
    mesh = Mesh()
    for x0, x1, z0, z1 in ((-HALF, HALF, -HALF, -PANEL), (-HALF, HALF, PANEL, HALF), (-HALF, -PANEL, -PANEL, PANEL),
                           (PANEL, HALF, -PANEL, PANEL)):
        mesh.append(quad((x0, HEIGHT, z0), (x1 - x0, 0, 0), (0, 0, z1 - z0)))
    return mesh


def build(document):
    grey = document.material("grey", (0.6, 0.6, 0.6), lambert=True, two_sided=True)
    ochre = document.material("ochre", (0.7, 0.5, 0.2), lambert=True, two_sided=True)
    glass = document.material("glass", (1.0, 1.0, 1.0), roughness=0.0, ior=1.5, transmission=1.0, thickness=0.7)
    panel = document.material("panel", (0.0, 0.0, 0.0), lambert=True, emission=(3.0, 3.0, 3.0))
    lamp = document.material("lamp", (0.0, 0.0, 0.0), lambert=True, emission=(60.0, 50.0, 35.0))
    side = 2 * HALF
    shell = quad((-HALF, 0, HALF), (side, 0, 0), (0, 0, -side))
    shell.append(quad((-HALF, 0, -HALF), (side, 0, 0), (0, HEIGHT, 0)))
    shell.append(quad((HALF, 0, HALF), (-side, 0, 0), (0, HEIGHT, 0)))
    shell.append(_ceiling())
    document.node("shell", document.mesh("shell", (shell, grey)))
    walls = quad((-HALF, 0, HALF), (0, 0, -side), (0, HEIGHT, 0))
    walls.append(quad((HALF, 0, -HALF), (0, 0, side), (0, HEIGHT, 0)))
    document.node("walls", document.mesh("walls", (walls, ochre)))
    document.node("panel", document.mesh("panel", (
        quad((-PANEL, HEIGHT, -PANEL), (2 * PANEL, 0, 0), (0, 0, 2 * PANEL)), panel)))
    document.sphere("ball", BALL, BALL_RADIUS, glass)
    document.sphere("lamp", BALL, LAMP_RADIUS, lamp)
    document.camera("camera", (0.0, 1.5, 1.9), (0.0, 1.3, 0.0), 2 * atan(0.8), (640, 480))
