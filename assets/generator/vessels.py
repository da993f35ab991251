"""The turned and swept objects of the still life, each about its own upright axis with the foot at y = 0; metres."""

from math import atan2, cos, hypot, pi, sin

from .geometry import Mesh
from .lathe import arc, fillet, lathe, spline, tube
from .textures import smoothstep

SEGMENTS = 96


def _lip(outer, inner, steps=5):
    """The half circle over a rim, from the last point of the outer wall to the first of the inner one."""
    centre = ((outer[0] + inner[0]) / 2, (outer[1] + inner[1]) / 2)
    begin = atan2(outer[1] - centre[1], outer[0] - centre[0])
    return arc(centre, hypot(outer[0] - centre[0], outer[1] - centre[1]), begin, begin + pi, steps)


def bottle():
    """A wine bottle of 0.3 m with a raised bottom and 2.7 mm walls, hollow: a closed body of glass."""
    return lathe(fillet([
        (0.0, 0.022, 0.0), (0.012, 0.019, 0.012), (0.026, 0.0, 0.005), (0.0365, 0.0, 0.005), (0.0365, 0.208, 0.034),
        (0.0146, 0.230, 0.022), (0.0136, 0.283, 0.001), (0.0158, 0.2845, 0.001), (0.0158, 0.296, 0.0016),
        (0.0142, 0.299, 0.0012), (0.0100, 0.299, 0.0012), (0.0104, 0.230, 0.022), (0.0338, 0.2066, 0.032),
        (0.0338, 0.0075, 0.006), (0.026, 0.0065, 0.004), (0.0125, 0.0255, 0.008), (0.0, 0.0275, 0.0)]),
        SEGMENTS, closed=True)


def cork():
    """Sits in the neck of the bottle, clear of its wall."""
    profile = fillet([(0.0, 0.27, 0.0), (0.0094, 0.27, 0.0008), (0.0096, 0.308, 0.0012), (0.0, 0.308, 0.0)], 3)
    return lathe(profile, 48, closed=True)


def goblet():
    """A tulip glass of 0.185 m with walls of about 1.3 mm: a closed body of glass."""
    foot = fillet([(0.0, 0.0012, 0.0), (0.014, 0.0012, 0.002), (0.020, 0.0, 0.003), (0.0335, 0.0, 0.0008),
                   (0.0335, 0.0022, 0.0009), (0.011, 0.0064, 0.016), (0.0041, 0.022, 0.03),
                   (0.0039, 0.078, 0.0)])
    bowl = [(0.0039, 0.078), (0.0075, 0.0865), (0.0225, 0.098), (0.0372, 0.122), (0.0402, 0.146),
            (0.0345, 0.1845)]
    inner = [(0.0332, 0.1845), (0.0387, 0.146), (0.0357, 0.1232), (0.0205, 0.1005), (0.0, 0.0925)]
    return lathe(foot + spline(bowl, 7, start=(0, 1)) + _lip(bowl[-1], inner[0])
                 + spline(inner, 7, end=(-1, 0)), SEGMENTS, closed=True)


def _gadroons(y):
    """Depth of the vase's lobes at a height: none at the stem, most at the belly, fading out at the shoulder."""
    return 0.022 * smoothstep(0.033, 0.055, y) * (1.0 - smoothstep(0.108, 0.140, y))


def vase():
    """A baluster vase of 0.24 m with a gadrooned belly, for polished metal."""
    foot = fillet([(0.0, 0.004, 0.0), (0.03, 0.004, 0.002), (0.033, 0.0, 0.0015), (0.039, 0.0, 0.0015),
                   (0.039, 0.006, 0.002), (0.0345, 0.009, 0.002), (0.0335, 0.0125, 0.001), (0.021, 0.02, 0.008),
                   (0.0195, 0.03, 0.0)])
    body = [(0.0195, 0.03), (0.0225, 0.037), (0.047, 0.075), (0.0605, 0.118), (0.0525, 0.160), (0.0275, 0.188),
            (0.0215, 0.208), (0.0275, 0.228), (0.0375, 0.2395)]
    inner = [(0.0355, 0.2405), (0.0255, 0.2285), (0.0195, 0.208), (0.026, 0.187), (0.050, 0.159),
             (0.057, 0.118), (0.044, 0.077), (0.0, 0.042)]
    mesh = lathe(foot, SEGMENTS)
    mesh.append(lathe(spline(body, 7, start=(0, 1)), 198, lobes=(22, _gadroons)))
    return mesh.append(lathe(_lip(body[-1], inner[0]) + spline(inner, 3, end=(-1, 0)), SEGMENTS))


def bowl():
    """A shallow footed bowl, 0.23 m across."""
    foot = fillet([(0.0, 0.006, 0.0), (0.036, 0.006, 0.002), (0.038, 0.0, 0.001), (0.0425, 0.0, 0.0015),
                   (0.044, 0.009, 0.002), (0.046, 0.0098, 0.0)])
    outer = [(0.046, 0.0098), (0.080, 0.0255), (0.104, 0.048), (0.1155, 0.0745)]
    inner = [(0.1115, 0.0755), (0.100, 0.0500), (0.077, 0.0295), (0.040, 0.0155), (0.0, 0.0125)]
    return lathe(foot + spline(outer, 8) + _lip(outer[-1], inner[0]) + spline(inner, 7, end=(-1, 0)), SEGMENTS)


def tray():
    """A round tray with a low lip, 0.34 m across; u runs around, v along the radius."""
    return lathe(fillet([(0.0, 0.0, 0.0), (0.160, 0.0, 0.002), (0.1705, 0.0125, 0.002), (0.1705, 0.0150, 0.0012),
                         (0.1675, 0.0150, 0.0012), (0.1585, 0.0025, 0.004), (0.0, 0.0025, 0.0)]), SEGMENTS + 32)


def fruit(radius, columns=60, rows=32):
    """An orange: slightly flat, with a dimple at each pole."""
    profile = []
    for i in range(rows + 1):
        angle = -pi / 2 + pi * i / rows
        dimple = 0.07 * max(0.0, abs(sin(angle)) - 0.94) / 0.06
        r, y = cos(angle) * (1.0 - dimple) if 0 < i < rows else 0.0, 0.93 * sin(angle) * (1.0 - 1.6 * dimple)
        profile.append((radius * r, radius * (y + 0.83)))
    return lathe(spline(profile, 1, start=(1, 0), end=(-1, 0)), columns, closed=True)


def lemon(columns=56):
    """A lemon of 0.08 m along y, with a nipple at one end."""
    points = [(0.0, 0.0), (0.005, 0.0015), (0.0115, 0.006), (0.0215, 0.017), (0.0268, 0.036), (0.0225, 0.054),
              (0.0125, 0.0665), (0.0066, 0.0715), (0.0048, 0.0755), (0.0, 0.079)]
    return lathe(spline(points, 5, start=(1, 0), end=(-1, 0)), columns, closed=True)


def _chess_foot(radius):
    """The moulded base that the chess pieces share, for a base radius in metres; ends at height 0.62 radius."""
    corners = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.08), (1.0, 0.26, 0.12), (0.86, 0.34, 0.05), (0.86, 0.42, 0.05),
               (0.66, 0.52, 0.08), (0.60, 0.62, 0.0))
    return fillet([tuple(v * radius for v in corner) for corner in corners], 3)


def pawn():
    """A chess pawn of 0.052 m."""
    stem = [(0.0084, 0.0087), (0.0066, 0.0135), (0.0049, 0.0215), (0.0044, 0.0295)]
    collar = fillet([(0.0044, 0.0295, 0.0), (0.0048, 0.0302, 0.0004), (0.0092, 0.0312, 0.0007),
                     (0.0088, 0.0334, 0.0007), (0.0052, 0.0345, 0.0)], 3)
    head = arc((0.0, 0.0427), 0.0093, -0.97, pi / 2, 12)
    return lathe(_chess_foot(0.014) + spline(stem, 5) + collar + head, 48)


def queen():
    """A chess queen of 0.1 m with a plain coronet."""
    stem = [(0.0114, 0.0118), (0.0092, 0.0195), (0.0067, 0.035), (0.0062, 0.054)]
    collar = fillet([(0.0062, 0.054, 0.0), (0.0064, 0.0556, 0.0005), (0.0122, 0.0566, 0.0007),
                     (0.0124, 0.0592, 0.0008), (0.0088, 0.0606, 0.0008), (0.0105, 0.0622, 0.0006),
                     (0.0103, 0.0640, 0.0006), (0.0066, 0.0660, 0.001), (0.0064, 0.068, 0.0)], 3)
    crown = [(0.0064, 0.068), (0.0073, 0.0745), (0.0099, 0.0845), (0.0122, 0.0895)]
    top = fillet([(0.0122, 0.0895, 0.0), (0.0116, 0.0912, 0.0005), (0.0092, 0.0898, 0.0008),
                  (0.0042, 0.0935, 0.002), (0.0018, 0.0942, 0.0)], 3)
    ball = arc((0.0, 0.0972), 0.0034, -1.0, pi / 2, 8)
    return lathe(_chess_foot(0.0185) + spline(stem, 6) + collar + spline(crown, 5) + top + ball, 64)


def _bezier(a, b, c, d, steps):
    points = []
    for k in range(steps + 1):
        t = k / steps
        weights = ((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t ** 3)
        points.append(tuple(sum(w * p[i] for w, p in zip(weights, (a, b, c, d))) for i in range(3)))
    return points


def teapot():
    """A round pot with lid, spout (+x) and handle (-x), for porcelain; overlapping closed bodies."""
    foot = fillet([(0.0, 0.004, 0.0), (0.031, 0.004, 0.001), (0.033, 0.0, 0.001), (0.037, 0.0, 0.0012),
                   (0.0375, 0.006, 0.001), (0.0392, 0.0075, 0.0)])
    body = [(0.0392, 0.0075), (0.060, 0.0285), (0.0685, 0.052), (0.0635, 0.076), (0.0470, 0.0945),
            (0.0405, 0.0985)]
    lid = fillet([(0.0405, 0.0985, 0.0), (0.0412, 0.1015, 0.0008), (0.0398, 0.1025, 0.0006),
                  (0.0395, 0.1005, 0.0003), (0.0385, 0.1008, 0.0)], 3)
    dome = [(0.0385, 0.1008), (0.030, 0.1095), (0.016, 0.1155), (0.0062, 0.1185), (0.0048, 0.1225)]
    knob = arc((0.0, 0.1300), 0.0088, -0.99, pi / 2, 14)
    mesh = Mesh()
    mesh.append(lathe(foot + spline(body, 8) + lid + spline(dome, 5) + knob, SEGMENTS))
    path = _bezier((0.050, 0.036, 0.0), (0.088, 0.036, 0.0), (0.080, 0.086, 0.0), (0.112, 0.101, 0.0), 28)
    mesh.append(tube(path, [0.0165 - 0.0098 * (k / 28) ** 0.7 for k in range(29)], 40))
    path = _bezier((-0.055, 0.083, 0.0), (-0.118, 0.108, 0.0), (-0.122, 0.020, 0.0), (-0.058, 0.030, 0.0), 36)
    mesh.append(tube(path, [0.0062 - 0.0014 * sin(pi * k / 36) for k in range(37)], 32))
    return mesh


def lamp_stand():
    """A brass foot with a slim stem that carries a globe at 0.106 m."""
    return lathe(fillet([(0.0, 0.0, 0.0), (0.055, 0.0, 0.002), (0.055, 0.006, 0.003), (0.040, 0.010, 0.004),
                         (0.012, 0.014, 0.012), (0.0055, 0.030, 0.02), (0.0055, 0.084, 0.006), (0.012, 0.090, 0.002),
                         (0.012, 0.095, 0.002), (0.026, 0.100, 0.003), (0.026, 0.106, 0.001), (0.0, 0.106, 0.0)]), 56)
