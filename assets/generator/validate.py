"""Checks of a written scene, from its bytes: structure, ranges, normals, winding, closed volumes, light directions.

Independent of the code that wrote it; every failure names file and element.
"""

import json
import struct
from math import isfinite, sqrt

from .geometry import add, cross, dot, length, scaled, sub

WIDTH = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
CODE = {5126: "f", 5123: "H", 5125: "I"}


class InvalidScene(Exception):
    """A written file breaks a rule; the message says which file, which element and what."""


class Checker:
    """The opened file; `check(condition, element, what)` raises with the names."""

    def __init__(self, path):
        self.path = path
        content = path.read_bytes()
        self.binary = b""
        if path.suffix == ".glb":
            magic, version, total = struct.unpack_from("<III", content)
            self.check((magic, version, total) == (0x46546C67, 2, len(content)), "header", "is wrong")
            size = struct.unpack_from("<I", content, 12)[0]
            self.json = json.loads(content[20:20 + size])
            self.binary = content[28 + size:]
        else:
            self.json = json.loads(content)
            for buffer in self.json.get("buffers", []):
                self.binary = (path.parent / buffer["uri"]).read_bytes()
        for buffer in self.json.get("buffers", []):
            self.check(buffer["byteLength"] == len(self.binary), "buffer", "length differs from the file")

    def check(self, condition, element, what):
        if not condition:
            raise InvalidScene(f"{self.path.name}: {element}: {what}")

    def accessor(self, index):
        """The rows of an accessor, after checking range, alignment, finiteness and bounds."""
        name = f"accessor {index}"
        entry = self.json["accessors"][index]
        view = self.json["bufferViews"][entry["bufferView"]]
        code, width = CODE[entry["componentType"]], WIDTH[entry["type"]]
        count = entry["count"] * width
        self.check(view["byteOffset"] % 4 == 0, name, "is not aligned")
        self.check(count * struct.calcsize(code) == view["byteLength"], name, "does not fill its view")
        self.check(view["byteOffset"] + view["byteLength"] <= len(self.binary), name, "runs past the buffer")
        flat = struct.unpack_from(f"<{count}{code}", self.binary, view["byteOffset"])
        self.check(all(isfinite(v) for v in flat), name, "holds a number that is not finite")
        for key, extreme in (("min", min), ("max", max)):
            if key in entry:
                self.check(entry[key] == [extreme(flat[i::width]) for i in range(width)], name, f"{key} is wrong")
        return [flat[i:i + width] for i in range(0, count, width)]


def _rotate(q, v):
    axis = q[:3]
    inner = add(cross(axis, v), scaled(v, q[3]))
    return add(v, scaled(cross(axis, inner), 2.0))


def _check_closed(checker, name, positions, triangles):
    """Every edge is used once in each direction, and the enclosed volume is positive."""
    welded = {}
    ids = [welded.setdefault(p, len(welded)) for p in positions]
    edges = {}
    volume = 0.0
    for triangle in triangles:
        for a, b in zip(triangle, triangle[1:] + triangle[:1]):
            key = (ids[a], ids[b])
            checker.check(key not in edges, name, "an edge is used twice in one direction")
            edges[key] = True
        a, b, c = (positions[i] for i in triangle)
        volume += dot(a, cross(b, c))
    checker.check(all((b, a) in edges for a, b in edges), name, "is not closed")
    checker.check(volume > 0, name, "is inside out")


def _check_primitive(checker, name, primitive):
    material = checker.json["materials"][primitive["material"]]
    attributes = primitive["attributes"]
    positions, normals = checker.accessor(attributes["POSITION"]), checker.accessor(attributes["NORMAL"])
    checker.check("min" in checker.json["accessors"][attributes["POSITION"]], name, "has no bounds")
    flat = [row[0] for row in checker.accessor(primitive["indices"])]
    checker.check(len(flat) % 3 == 0 and max(flat) < len(positions), name, "has a wrong index")
    checker.check(set(flat) == set(range(len(positions))), name, "has a vertex without a triangle")
    checker.check(all(abs(length(n) - 1) < 1e-5 for n in normals), name, "has a normal that is not of unit length")
    triangles = [tuple(flat[i:i + 3]) for i in range(0, len(flat), 3)]
    for a, b, c in triangles:
        face = cross(sub(positions[b], positions[a]), sub(positions[c], positions[a]))
        checker.check(length(face) > 0, name, f"triangle {a} {b} {c} has no area")
        for i in (a, b, c):
            checker.check(dot(face, normals[i]) > 0, name, f"triangle {a} {b} {c} winds against its normals")
    counts = {checker.json["accessors"][i]["count"] for i in attributes.values()}
    checker.check(len(counts) == 1, name, "has attributes of different lengths")
    if "normalTexture" in material:
        for n, t in zip(normals, checker.accessor(attributes["TANGENT"])):
            checker.check(abs(length(t[:3]) - 1) < 1e-5 and abs(dot(n, t[:3])) < 1e-5 and abs(t[3]) == 1, name,
                          "has a tangent that is not orthogonal, unit and signed")
    if "normalTexture" in material or "baseColorTexture" in material["pbrMetallicRoughness"]:
        checker.check(len(checker.accessor(attributes["TEXCOORD_0"])) == len(positions), name, "has no coordinates")
    closed = primitive.get("extras", {}).get("closed", False)
    solid = "KHR_materials_volume" in material.get("extensions", {})
    checker.check(closed or not solid, name, "is a volume but not closed")
    if closed:
        _check_closed(checker, name, positions, triangles)
    return len(triangles)


def _check_nodes(checker, light_target):
    nodes = checker.json["nodes"]
    parents = [child for node in nodes for child in node.get("children", [])] + checker.json["scenes"][0]["nodes"]
    checker.check(sorted(parents) == list(range(len(nodes))), "nodes", "are not a set of disjoint trees")
    for index, node in enumerate(nodes):
        name = f"node {index} ({node['name']})"
        rotation = node.get("rotation", [0.0, 0.0, 0.0, 1.0])
        checker.check(abs(sqrt(sum(v * v for v in rotation)) - 1) < 1e-6, name, "rotation is not of unit length")
        if "mesh" not in node or light_target is None:
            continue
        for primitive in checker.json["meshes"][node["mesh"]]["primitives"]:
            if "emissiveFactor" not in checker.json["materials"][primitive["material"]] or primitive.get("extras"):
                continue  # dark, or closed and so shining all around
            checker.check(index in checker.json["scenes"][0]["nodes"], name, "is an emitter below another node")
            for place, normal in zip(checker.accessor(primitive["attributes"]["POSITION"]),
                                     checker.accessor(primitive["attributes"]["NORMAL"])):
                size = node.get("scale", (1.0, 1.0, 1.0))
                turned = _rotate(rotation, tuple(p * s for p, s in zip(place, size)))
                world = add(turned, node.get("translation", (0.0, 0.0, 0.0)))
                facing = dot(_rotate(rotation, normal), sub(light_target, world))
                checker.check(facing > 0, name, "emits away from the scene")


def check_scene(path, light_target=None):
    """Checks one .gltf or .glb; `light_target` is a point that every open emitter must face. Returns a summary."""
    checker = Checker(path)
    document = checker.json
    used = set()

    def collect(value):
        if isinstance(value, dict):
            used.update(value.get("extensions", {}))
            value = list(value.values())
        if isinstance(value, list):
            for item in value:
                collect(item)

    collect(document)
    checker.check(sorted(used) == document.get("extensionsUsed", []), "extensionsUsed", "differs from what is used")
    triangles = [0] * len(document.get("meshes", []))
    for index, mesh in enumerate(document.get("meshes", [])):
        for number, primitive in enumerate(mesh["primitives"]):
            name = f"mesh {index} ({mesh['name']}) primitive {number}"
            triangles[index] += _check_primitive(checker, name, primitive)
    _check_nodes(checker, light_target)
    images = document.get("images", [])
    for index, image in enumerate(images):
        if "uri" in image:
            content = (path.parent / image["uri"]).read_bytes()
        else:
            view = document["bufferViews"][image["bufferView"]]
            content = checker.binary[view["byteOffset"]:view["byteOffset"] + view["byteLength"]]
        checker.check(content[:8] == b"\x89PNG\r\n\x1a\n", f"image {index}", "is not a PNG")
    shapes = document.get("extensions", {}).get("KHR_implicit_shapes", {}).get("shapes", [])
    spheres = 0
    for index, node in enumerate(document["nodes"]):
        surface = node.get("extensions", {}).get("TALBOT_implicit_surface")
        if surface is not None:
            spheres += 1
            checker.check(surface["shape"] < len(shapes) and surface["material"] < len(document["materials"]),
                          f"node {index}", "points at a missing shape or material")
    drawn = sum(triangles[node["mesh"]] for node in document["nodes"] if "mesh" in node)
    return {"triangles": drawn, "stored": sum(triangles), "spheres": spheres, "materials": len(document["materials"]),
            "images": len(images), "bytes": path.stat().st_size}
