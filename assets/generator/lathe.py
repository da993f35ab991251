"""Surfaces of revolution and tubes, with smooth normals from the profile.

A profile is a list of (r, y, nr, ny): walked so that its left-to-right normal (dy, -dr) points outwards, that
is up along an outer wall, over the rim, and down along the inner one. Two entries at one place make a crease.
"""

from math import acos, cos, hypot, pi, sin, sqrt, tan

from .geometry import Mesh, add, cross, dot, length, normalized, scaled, sub

SLOPE_STEP = 1e-5  # metres, for the slope of a lobe's depth


def fillet(corners, steps=4):
    """Profile of a polyline of (r, y, rounding radius) with every inner corner replaced by an arc."""
    profile = []
    count = len(corners)
    starts = []
    for i, (r, y, radius) in enumerate(corners):
        if i in (0, count - 1) or radius == 0.0:
            starts.append(((r, y), (r, y), None))
            continue
        back, ahead = _unit(corners[i], corners[i - 1]), _unit(corners[i], corners[i + 1])
        half = acos(max(-1.0, min(1.0, back[0] * ahead[0] + back[1] * ahead[1]))) / 2
        cut = radius / tan(half)
        starts.append(((r + back[0] * cut, y + back[1] * cut), (r + ahead[0] * cut, y + ahead[1] * cut), radius))
    for i in range(count - 1):
        begin, end = starts[i][1], starts[i + 1][0]
        normal = _normal(_unit(corners[i], corners[i + 1]))
        profile += [(*begin, *normal), (*end, *normal)]
        if i + 2 < count and starts[i + 1][2] is not None:
            following = _normal(_unit(corners[i + 1], corners[i + 2]))
            profile += _arc(end, starts[i + 1][1], normal, following, starts[i + 1][2], steps)
    return profile


def _arc(begin, end, normal0, normal1, radius, steps):
    """The inner points of the arc between two tangent points."""
    turn = normal0[0] * normal1[1] - normal0[1] * normal1[0]
    sign = 1.0 if turn > 0 else -1.0
    centre = (begin[0] - sign * radius * normal0[0], begin[1] - sign * radius * normal0[1])
    angle = acos(max(-1.0, min(1.0, normal0[0] * normal1[0] + normal0[1] * normal1[1]))) * sign
    points = []
    for k in range(1, steps):
        c, s = cos(angle * k / steps), sin(angle * k / steps)
        n = (normal0[0] * c - normal0[1] * s, normal0[0] * s + normal0[1] * c)
        points.append((centre[0] + sign * radius * n[0], centre[1] + sign * radius * n[1], *n))
    return points


def arc(centre, radius, begin, end, steps):
    """Profile of a circular arc about (r, y) from angle `begin` to `end` in radians, 0 pointing outwards, pi/2 up."""
    profile = []
    for k in range(steps + 1):
        angle = begin + (end - begin) * k / steps
        r = centre[0] + radius * cos(angle)
        profile.append((r if r > radius / 1000 else 0.0, centre[1] + radius * sin(angle), cos(angle), sin(angle)))
    return profile


def spline(points, samples, start=None, end=None):
    """Profile of the Catmull-Rom curve through (r, y) points; `start`, `end` are optional end directions."""
    padded = [points[0]] + list(points) + [points[-1]]
    tangents = [((padded[i + 2][0] - padded[i][0]) / 2, (padded[i + 2][1] - padded[i][1]) / 2)
                for i in range(len(points))]
    for index, direction, other in ((0, start, 1), (-1, end, -2)):
        size = sqrt(sum((a - b) ** 2 for a, b in zip(points[index], points[other])))
        unit = tangents[index] if direction is None else (direction[0] * size, direction[1] * size)
        tangents[index] = (unit[0] * 2, unit[1] * 2) if direction is None else unit
    profile = []
    for i in range(len(points) - 1):
        last = i == len(points) - 2
        for k in range(samples + (1 if last else 0)):
            t = k / samples
            place = _hermite(points[i], points[i + 1], tangents[i], tangents[i + 1], t)
            slope = _hermite_slope(points[i], points[i + 1], tangents[i], tangents[i + 1], t)
            size = sqrt(slope[0] ** 2 + slope[1] ** 2)
            profile.append((max(place[0], 0.0), place[1], slope[1] / size, -slope[0] / size))
    return profile


def _hermite(p0, p1, m0, m1, t):
    a, b = 2 * t ** 3 - 3 * t ** 2 + 1, t ** 3 - 2 * t ** 2 + t
    c, d = 3 * t ** 2 - 2 * t ** 3, t ** 3 - t ** 2
    return tuple(a * p0[i] + b * m0[i] + c * p1[i] + d * m1[i] for i in range(2))


def _hermite_slope(p0, p1, m0, m1, t):
    a, b, d = 6 * t * t - 6 * t, 3 * t * t - 4 * t + 1, 3 * t * t - 2 * t
    return tuple(a * (p0[i] - p1[i]) + b * m0[i] + d * m1[i] for i in range(2))


def _unit(a, b):
    size = sqrt((b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2)
    return ((b[0] - a[0]) / size, (b[1] - a[1]) / size)


def _normal(direction):
    return (direction[1], -direction[0])


def lathe(profile, segments, closed=False, lobes=None):
    """Turns a profile around the Y axis; u runs around, v up along the profile's length.

    `lobes` = (count, depth) swells the radius by the share depth(y) times cos(count angle); depth is 0 at the axis.
    """
    mesh = Mesh(closed=closed)
    # The last ring of vertices reuses the angles of the first, so the seam is watertight to the bit.
    angles = [2 * pi * (j % segments) / segments for j in range(segments + 1)]
    ring = [(cos(angle), sin(angle)) for angle in angles]
    count, depth = lobes or (0, lambda y: 0.0)
    waves = [(cos(count * angle), sin(count * angle)) for angle in angles]
    lengths = [0.0]
    for a, b in zip(profile, profile[1:]):
        lengths.append(lengths[-1] + hypot(a[0] - b[0], a[1] - b[1]))
    for (r, y, nr, ny), distance in zip(profile, lengths):
        # Along the profile dr = -ny, dy = nr; the radius R = r (1 + depth cos) has these slopes along it and around.
        swell, steepness = depth(y), (depth(y + SLOPE_STEP) - depth(y - SLOPE_STEP)) / (2 * SLOPE_STEP)
        for j, ((c, s), (wave, wave_slope)) in enumerate(zip(ring, waves)):
            u = (j + (0.5 if r == 0.0 else 0.0)) / segments
            factor = 1.0 + swell * wave
            out, up = nr, ny * factor - r * steepness * wave * nr
            around = swell * count * wave_slope * nr / factor
            normal = (0.0, 1.0 if ny > 0 else -1.0, 0.0)
            if r > 0.0:
                normal = normalized((out * c - around * s, up, -out * s - around * c))
            mesh.vertex((r * factor * c, y, -r * factor * s), normal, (u, 1.0 - distance / lengths[-1]))
    for i, (a, b) in enumerate(zip(profile, profile[1:])):
        if lengths[i + 1] - lengths[i] == 0.0:
            continue
        for j in range(segments):
            low, high = i * (segments + 1) + j, (i + 1) * (segments + 1) + j
            if a[0] > 0.0:
                mesh.triangles.append((low, low + 1, high))
            if b[0] > 0.0:
                mesh.triangles.append((low + 1, high + 1, high))
    return mesh.compacted()


def tube(points, radii, segments):
    """A closed tube with flat ends along a polyline, with one radius for each point."""
    mesh = Mesh(closed=True)
    count = len(points)
    forward = [normalized(sub(points[min(i + 1, count - 1)], points[max(i - 1, 0)])) for i in range(count)]
    side = normalized(cross(forward[0], (0.0, 0.0, 1.0) if abs(forward[0][2]) < 0.9 else (0.0, 1.0, 0.0)))
    rings = []
    for point, axis, radius in zip(points, forward, radii):
        side = normalized(sub(side, scaled(axis, dot(side, axis))))
        other = cross(axis, side)
        rings.append([add(point, add(scaled(side, radius * cos(2 * pi * j / segments)),
                                     scaled(other, radius * sin(2 * pi * j / segments)))) for j in range(segments)])
    travelled = [0.0]
    for a, b in zip(points, points[1:]):
        travelled.append(travelled[-1] + length(sub(b, a)))
    for i in range(count):
        for j in range(segments + 1):
            around = sub(rings[i][(j + 1) % segments], rings[i][(j - 1) % segments])
            along = sub(rings[min(i + 1, count - 1)][j % segments], rings[max(i - 1, 0)][j % segments])
            mesh.vertex(rings[i][j % segments], normalized(cross(around, along)),
                        (j / segments, 1.0 - travelled[i] / travelled[-1]))
    for i in range(count - 1):
        for j in range(segments):
            a, b = i * (segments + 1) + j, (i + 1) * (segments + 1) + j
            mesh.triangles += [(a, a + 1, b), (a + 1, b + 1, b)]
    for i, sign in ((0, -1.0), (count - 1, 1.0)):
        normal = scaled(forward[i], sign)
        centre = mesh.vertex(points[i], normal, (0.5, 0.5))
        base = [mesh.vertex(p, normal, (0.5, 0.5)) for p in rings[i]]
        for j in range(segments):
            a, b = base[j], base[(j + 1) % segments]
            mesh.triangles.append((centre, a, b) if sign > 0 else (centre, b, a))
    return mesh
