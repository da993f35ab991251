"""Periodic gradient noise (Perlin 1985, with the quintic fade of Perlin 2002), evaluated a whole row at a time."""

from math import cos, pi, sin
from random import Random


class Noise:
    """One octave over the unit square with a whole number of cells each way; values lie in about -0.7..0.7."""

    def __init__(self, seed, cells_x, cells_y, width, height):
        random = Random(seed)
        self.cells_x, self.cells_y, self.height = cells_x, cells_y, height
        self.gradients = [[(cos(a), sin(a)) for a in (2 * pi * random.random() for _ in range(cells_x))]
                          for _ in range(cells_y)]
        self.columns = [[] for _ in range(cells_x)]  # (place in the cell, fade) of the texels of each cell
        for x in range(width):
            place = (x + 0.5) * cells_x / width
            cell = int(place)
            self.columns[cell].append((place - cell, _fade(place - cell)))

    def row(self, y):
        place = (y + 0.5) * self.cells_y / self.height
        cell = int(place)
        fraction = place - cell
        blend = _fade(fraction)
        upper, lower = self.gradients[cell], self.gradients[(cell + 1) % self.cells_y]
        # For a fixed y each corner contributes slope * (distance in x) + level.
        slopes = [a[0] + (b[0] - a[0]) * blend for a, b in zip(upper, lower)]
        levels = [a[1] * fraction * (1 - blend) + b[1] * (fraction - 1) * blend for a, b in zip(upper, lower)]
        result = []
        for cell, texels in enumerate(self.columns):
            slope, level = slopes[cell], levels[cell]
            after = (cell + 1) % self.cells_x
            # From the left corner's plane to the right one's, whose distance counts from the cell's far side.
            rise, step = slopes[after] - slope, levels[after] - slopes[after] - level
            result += [slope * x + level + (rise * x + step) * fade for x, fade in texels]
        return result


def _fade(t):
    return t * t * t * (t * (t * 6 - 15) + 10)


class Fbm:
    """Octaves of noise, each of twice the frequency and `gain` times the height."""

    def __init__(self, seed, cells_x, cells_y, width, height, octaves, gain=0.5):
        self.octaves = [(gain ** k, Noise(seed * 64 + k, cells_x << k, cells_y << k, width, height))
                        for k in range(octaves)]

    def row(self, y):
        rows = [[weight * v for v in noise.row(y)] for weight, noise in self.octaves]
        return [sum(values) for values in zip(*rows)]
