"""A rumpled napkin: a height field of rounded ridges over a plane, y up, the cloth's middle at the origin; metres."""

from math import exp

from .geometry import Mesh, normalized
from .noise import Fbm
from .textures import clamped, smoothstep

# Ridges of cloth: from (x, z) to (x, z), half-width and height; each rises from its first end and fades at its last.
RIDGES = (((-0.135, 0.060), (0.030, 0.022), 0.0105, 0.013), ((-0.120, -0.095), (-0.020, -0.010), 0.0120, 0.015),
          ((0.135, -0.070), (0.010, -0.045), 0.0095, 0.012), ((0.120, 0.105), (0.055, 0.030), 0.0130, 0.014),
          ((0.140, 0.015), (0.060, 0.005), 0.0085, 0.008), ((-0.040, 0.110), (-0.015, 0.050), 0.0100, 0.009))
CLEARANCE = 0.0012  # between cloth and table


def _height(x, z):
    height = 0.0
    for (x0, z0), (x1, z1), width, top in RIDGES:
        dx, dz = x1 - x0, z1 - z0
        size = dx * dx + dz * dz
        along = clamped(((x - x0) * dx + (z - z0) * dz) / size)
        distance = ((x - x0 - along * dx) ** 2 + (z - z0 - along * dz) ** 2) / (width * width)
        height += top * (1.0 - smoothstep(0.1, 1.0, along)) * exp(-distance)
    return height


def napkin(width, depth, columns, rows, seed):
    """The cloth as a single sheet seen from above, its texture upright towards -z."""
    ripple = Fbm(seed, 5, 5, columns + 1, rows + 1, 2)
    heights = []
    for i in range(rows + 1):
        z = (i / rows - 0.5) * depth
        heights.append([CLEARANCE + 0.0016 * (noise + 0.7) + _height((j / columns - 0.5) * width, z)
                        for j, noise in enumerate(ripple.row(i))])
    mesh = Mesh()
    step_x, step_z = width / columns, depth / rows
    for i in range(rows + 1):
        for j in range(columns + 1):
            left, right = max(j - 1, 0), min(j + 1, columns)
            back, front = max(i - 1, 0), min(i + 1, rows)
            slope_x = (heights[i][right] - heights[i][left]) / ((right - left) * step_x)
            slope_z = (heights[front][j] - heights[back][j]) / ((front - back) * step_z)
            mesh.vertex(((j / columns - 0.5) * width, heights[i][j], (i / rows - 0.5) * depth),
                        normalized((-slope_x, 1.0, -slope_z)), (j / columns, i / rows))
    for i in range(rows):
        for j in range(columns):
            a, b = i * (columns + 1) + j, (i + 1) * (columns + 1) + j
            mesh.triangles += [(a, b, a + 1), (a + 1, b, b + 1)]
    return mesh
