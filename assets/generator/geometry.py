"""Vectors as tuples, and triangle meshes with normals, texture coordinates and tangents.

Metres, right-handed, +Y up; faces wind counter-clockwise seen from outside; v of a texture points down.
"""

from math import cos, pi, sin, sqrt


def add(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scaled(a, s):
    return (a[0] * s, a[1] * s, a[2] * s)


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def length(a):
    return sqrt(dot(a, a))


def normalized(a):
    size = length(a)
    return (a[0] / size, a[1] / size, a[2] / size)


def turn_y(angle):
    """Quaternion (x, y, z, w) of a turn about +Y."""
    return (0.0, sin(angle / 2), 0.0, cos(angle / 2))


def turn_z(angle):
    """Quaternion of a turn about +Z."""
    return (0.0, 0.0, sin(angle / 2), cos(angle / 2))


def after(a, b):
    """Quaternion product: the turn b, then the turn a."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz)


class Mesh:
    """Vertices in parallel lists and index triples. `closed` promises a watertight outward-facing surface."""

    def __init__(self, closed=False):
        self.positions = []
        self.normals = []
        self.uvs = []
        self.tangents = []
        self.triangles = []
        self.closed = closed

    def vertex(self, position, normal, uv=(0.0, 0.0)):
        self.positions.append(position)
        self.normals.append(normal)
        self.uvs.append(uv)
        return len(self.positions) - 1

    def append(self, other, offset=(0.0, 0.0, 0.0)):
        """Adds the triangles of another mesh, moved by `offset`; tangents are not carried over."""
        base = len(self.positions)
        self.positions += [add(p, offset) for p in other.positions]
        self.normals += other.normals
        self.uvs += other.uvs
        self.triangles += [(a + base, b + base, c + base) for a, b, c in other.triangles]
        return self

    def compacted(self):
        """Drops the vertices that no triangle uses (the seam's end at a pole)."""
        used = sorted({i for t in self.triangles for i in t})
        moved = {old: new for new, old in enumerate(used)}
        self.positions = [self.positions[i] for i in used]
        self.normals = [self.normals[i] for i in used]
        self.uvs = [self.uvs[i] for i in used]
        self.triangles = [tuple(moved[i] for i in t) for t in self.triangles]
        return self

    def with_tangents(self):
        """Fills the tangents: along +u, orthogonal to the normal, w so that cross(n, t) w runs along -v."""
        along_u = [(0.0, 0.0, 0.0)] * len(self.positions)
        against_v = [(0.0, 0.0, 0.0)] * len(self.positions)
        for a, b, c in self.triangles:
            edge1 = sub(self.positions[b], self.positions[a])
            edge2 = sub(self.positions[c], self.positions[a])
            u1, v1 = self.uvs[b][0] - self.uvs[a][0], self.uvs[b][1] - self.uvs[a][1]
            u2, v2 = self.uvs[c][0] - self.uvs[a][0], self.uvs[c][1] - self.uvs[a][1]
            sign = 1.0 if u1 * v2 - u2 * v1 > 0 else -1.0
            du = scaled(sub(scaled(edge1, v2), scaled(edge2, v1)), sign)
            dv = scaled(sub(scaled(edge1, u2), scaled(edge2, u1)), sign)
            for i in (a, b, c):
                along_u[i] = add(along_u[i], du)
                against_v[i] = add(against_v[i], dv)
        self.tangents = []
        for normal, u, v in zip(self.normals, along_u, against_v):
            tangent = normalized(sub(u, scaled(normal, dot(u, normal))))
            self.tangents.append((*tangent, 1.0 if dot(cross(normal, tangent), v) > 0 else -1.0))
        return self


def quad(corner, edge_u, edge_v, uv_scale=(1.0, 1.0), uv_offset=(0.0, 0.0)):
    """A parallelogram whose normal is cross(edge_u, edge_v); edge_v is the upright direction of the texture."""
    mesh = Mesh()
    normal = normalized(cross(edge_u, edge_v))
    for s, t in ((0, 0), (1, 0), (1, 1), (0, 1)):
        position = add(corner, add(scaled(edge_u, s), scaled(edge_v, t)))
        mesh.vertex(position, normal, (uv_offset[0] + s * uv_scale[0], uv_offset[1] + (1 - t) * uv_scale[1]))
    mesh.triangles += [(0, 1, 2), (0, 2, 3)]
    return mesh


def panel(centre, target, width, height):
    """A rectangle around `centre` that faces `target`, its lower edge level."""
    facing = normalized(sub(target, centre))
    right = normalized(cross((0.0, 1.0, 0.0), facing))
    up = cross(facing, right)
    corner = sub(sub(centre, scaled(right, width / 2)), scaled(up, height / 2))
    return quad(corner, scaled(right, width), scaled(up, height))


def box(size, centre=(0.0, 0.0, 0.0)):
    """A closed box with flat normals and the whole texture upright on every face."""
    mesh = Mesh(closed=True)
    hx, hy, hz = (s / 2 for s in size)
    faces = (((-hx, -hy, hz), (2 * hx, 0, 0), (0, 2 * hy, 0)), ((hx, -hy, -hz), (-2 * hx, 0, 0), (0, 2 * hy, 0)),
             ((hx, -hy, hz), (0, 0, -2 * hz), (0, 2 * hy, 0)), ((-hx, -hy, -hz), (0, 0, 2 * hz), (0, 2 * hy, 0)),
             ((-hx, hy, hz), (2 * hx, 0, 0), (0, 0, -2 * hz)), ((-hx, -hy, -hz), (2 * hx, 0, 0), (0, 0, 2 * hz)))
    for corner, edge_u, edge_v in faces:
        mesh.append(quad(add(corner, centre), edge_u, edge_v))
    return mesh


def prism(footprint, height):
    """A closed upright prism over y = 0; `footprint` lists (x, z) corners counter-clockwise seen from above."""
    mesh = Mesh(closed=True)
    count = len(footprint)
    for i, (x, z) in enumerate(footprint):
        nx, nz = footprint[(i + 1) % count]
        mesh.append(quad((x, 0.0, z), (nx - x, 0.0, nz - z), (0.0, height, 0.0)))
    for y, normal in ((height, (0.0, 1.0, 0.0)), (0.0, (0.0, -1.0, 0.0))):
        base = len(mesh.positions)
        for x, z in footprint:
            mesh.vertex((x, y, z), normal)
        fan = [(base, base + i, base + i + 1) for i in range(1, count - 1)]
        mesh.triangles += fan if y else [(a, c, b) for a, b, c in fan]
    return mesh


def sphere(radius, columns, rows):
    """A closed latitude-longitude sphere with smooth normals, poles on the Y axis."""
    mesh = Mesh(closed=True)
    angles = [2 * pi * (j % columns) / columns for j in range(columns + 1)]
    ring = [(cos(angle), sin(angle)) for angle in angles]
    for i in range(rows + 1):
        y, r = cos(pi * i / rows), sin(pi * i / rows) if 0 < i < rows else 0.0
        for j, (c, s) in enumerate(ring):
            # A pole has one vertex for each triangle, with u in the middle of it.
            u = j / columns if 0 < i < rows else (j + 0.5) / columns
            mesh.vertex(scaled((r * c, y, -r * s), radius), normalized((r * c, y, -r * s)), (u, i / rows))
    for i in range(rows):
        for j in range(columns):
            a, b = i * (columns + 1) + j, (i + 1) * (columns + 1) + j
            if i > 0:
                mesh.triangles.append((a, b, a + 1))
            if i < rows - 1:
                mesh.triangles.append((a + 1, b, b + 1))
    return mesh.compacted()


def faceted(points, triangles):
    """A closed mesh with one flat normal for each triangle."""
    mesh = Mesh(closed=True)
    for triangle in triangles:
        a, b, c = (points[i] for i in triangle)
        normal = normalized(cross(sub(b, a), sub(c, a)))
        base = [mesh.vertex(p, normal) for p in (a, b, c)]
        mesh.triangles.append(tuple(base))
    return mesh
