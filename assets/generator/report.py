"""The scene of Heath 2019, "Advanced Technologies Report - Raytracer", by its published numbers.

Camera at the origin; window at z = -10 over x -2.5..2.833, y -1..2; six spheres; a sky from white to red along x.
"""

from math import atan, sqrt

from .geometry import scaled

LIGHT_TARGET = None
DIFFUSE_LOSS, METAL_LOSS = 0.9, 0.8  # what a bounce keeps there, on top of the colour
GROUND_FUZZ = 0.1
WINDOW_DISTANCE, WINDOW_HEIGHT, WINDOW_CENTRE = 10.0, 3.0, (0.1665, 0.5)


def normal_fuzz_roughness(fuzz):
    """glTF roughness whose facets have the RMS slope of a normal moved by `fuzz` in the unit ball: sqrt(2/5) fuzz."""
    return sqrt(fuzz * sqrt(0.4))


def diffuse(document, name, color):
    return document.material(name, scaled(color, DIFFUSE_LOSS), lambert=True)


def metal(document, name, color, roughness):
    return document.material(name, scaled(color, METAL_LOSS), metallic=1.0, roughness=roughness)


def camera(document):
    """The off-centre window as an ordinary camera with a shifted lens."""
    yfov = 2 * atan(WINDOW_HEIGHT / 2 / WINDOW_DISTANCE)
    document.camera("report", (0.0, 0.0, 0.0), (0.0, 0.0, -1.0), yfov, (960, 540),
                    shift=[centre / WINDOW_HEIGHT for centre in WINDOW_CENTRE])


def build(document):
    document.sphere("red ball", (0.0, 0.0, -5.0), 0.5, diffuse(document, "red", (1.0, 0.2, 0.2)))
    document.sphere("yellow ball", (1.0, 0.0, -7.0), 2.2, diffuse(document, "yellow", (1.0, 1.0, 0.0)))
    document.sphere("mirror ball", (1.0, 0.5, -5.0), 0.75, metal(document, "mirror", (1.0, 1.0, 1.0), 0.0))
    document.sphere("green ball", (-1.0, 0.0, -4.0), 0.3, diffuse(document, "green", (0.0, 1.0, 0.0)))
    document.sphere("blue ball", (-0.5, 0.0, -4.0), 0.3, diffuse(document, "blue", (0.0, 0.3, 0.8)))
    document.sphere("ground", (0.0, -19.2, -10.0), 20.0,
                    metal(document, "ground", (1.0, 1.0, 1.0), normal_fuzz_roughness(GROUND_FUZZ)))
    document.environment(gradient=((1.0, 0.0, 0.0), (1.0, 1.0, 1.0), (1.0, 0.0, 0.0)))
    camera(document)
