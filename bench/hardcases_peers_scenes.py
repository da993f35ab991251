"""Scenes of hardcases_peers.py beyond the one that it is given: small glTF files whose right picture is known from a picture of the
same renderer. Nodes have translation, rotation and scale alone, materials are Lambert's, lights are quads or one sun."""
import json
import math

import numpy as np

SHAPES, SURFACE = "KHR_implicit_shapes", "TALBOT_implicit_surface"


class Builder:
    def __init__(self, size):
        self.doc = {"asset": {"version": "2.0"}, "scene": 0, "nodes": [], "meshes": [], "materials": [], "accessors": [],
                    "bufferViews": [], "cameras": [], "extensionsUsed": ["KHR_materials_specular"]}
        self.data = bytearray()
        self.size = size

    def use(self, extension):
        if extension not in self.doc["extensionsUsed"]:
            self.doc["extensionsUsed"].append(extension)

    def diffuse(self, grey, emission=0):
        material = {"doubleSided": emission == 0, "extensions": {"KHR_materials_specular": {"specularFactor": 0}},
                    "pbrMetallicRoughness": {"baseColorFactor": [grey, grey, grey, 1], "metallicFactor": 0, "roughnessFactor": 1}}
        if emission:
            self.use("KHR_materials_emissive_strength")
            material["emissiveFactor"] = [1, 1, 1]
            material["extensions"]["KHR_materials_emissive_strength"] = {"emissiveStrength": emission}
        self.doc["materials"].append(material)
        return len(self.doc["materials"]) - 1

    def accessor(self, values, kind, component, bounds=False):
        self.doc["bufferViews"].append({"buffer": 0, "byteOffset": len(self.data), "byteLength": values.nbytes})
        accessor = {"bufferView": len(self.doc["bufferViews"]) - 1, "componentType": component, "count": len(values), "type": kind}
        if bounds:
            accessor["min"], accessor["max"] = values.min(0).tolist(), values.max(0).tolist()
        self.data += values.tobytes()
        self.doc["accessors"].append(accessor)
        return len(self.doc["accessors"]) - 1

    def mesh(self, points, faces, material, normals=None, at=(0, 0, 0)):
        attributes = {"POSITION": self.accessor(np.asarray(points, np.float32), "VEC3", 5126, True)}
        if normals is not None:
            attributes["NORMAL"] = self.accessor(np.asarray(normals, np.float32), "VEC3", 5126)
        indices = self.accessor(np.asarray(faces, np.uint32).reshape(-1), "SCALAR", 5125)
        self.doc["meshes"].append({"primitives": [{"attributes": attributes, "indices": indices, "material": material}]})
        self.doc["nodes"].append({"mesh": len(self.doc["meshes"]) - 1, "translation": list(at), "scale": [1, 1, 1]})

    def level(self, side, material, at=(0, 0, 0), up=True):
        """A horizontal square; the height stands in the node, in double."""
        h = side / 2
        self.mesh([[-h, 0, -h], [h, 0, -h], [h, 0, h], [-h, 0, h]], [[0, 2, 1], [0, 3, 2]] if up else [[0, 1, 2], [0, 2, 3]], material,
                  at=at)

    def ball(self, stacks, slices, material):
        """A unit sphere of triangles with the sphere's normals."""
        theta = np.linspace(0, math.pi, stacks + 1)[:, None]
        phi = np.linspace(0, 2 * math.pi, slices + 1)[None, :]
        points = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta) + 0 * phi, -np.sin(theta) * np.sin(phi)], 2).reshape(-1, 3)
        faces = []
        for j in range(stacks):
            for i in range(slices):
                a, b = j * (slices + 1) + i, (j + 1) * (slices + 1) + i
                faces += ([[a, b, a + 1]] if j > 0 else []) + ([[a + 1, b, b + 1]] if j + 1 < stacks else [])
        self.mesh(points, faces, material, normals=points)

    def sphere(self, radius, material, at):
        """An analytic one."""
        self.use(SHAPES)
        self.use(SURFACE)
        shapes = self.doc.setdefault("extensions", {}).setdefault(SHAPES, {"shapes": []})["shapes"]
        shapes.append({"type": "sphere", "sphere": {"radius": radius}})
        self.doc["nodes"].append({"translation": list(at),
                                  "extensions": {SURFACE: {"shape": len(shapes) - 1, "material": material}}})

    def sun(self, direction):
        """Light travels along `direction`. Blender takes 683 lux for a watt, and leaves out chance by chance what is dim."""
        self.use("KHR_lights_punctual")
        d = np.array(direction, float) / np.linalg.norm(direction)
        axis, w = np.cross([0, 0, -1], d), 1 - d[2]  # the rotation that takes -z there
        q = np.append(axis, w) / math.hypot(np.linalg.norm(axis), w)
        lights = self.doc.setdefault("extensions", {}).setdefault("KHR_lights_punctual", {"lights": []})["lights"]
        lights.append({"type": "directional", "intensity": 2049})
        self.doc["nodes"].append({"rotation": q.tolist(), "extensions": {"KHR_lights_punctual": {"light": len(lights) - 1}}})

    def camera(self, eye, pitch, yfov, near=0.01, far=1e3):
        """Looks along -z, turned by `pitch` radians up."""
        self.doc["cameras"].append({"type": "perspective", "extras": {"resolution": [self.size, self.size]},
                                    "perspective": {"aspectRatio": 1, "yfov": yfov, "znear": near, "zfar": far}})
        self.doc["nodes"].append({"camera": 0, "translation": list(eye), "rotation": [math.sin(pitch / 2), 0, 0, math.cos(pitch / 2)]})

    def write(self, file):
        self.doc["scenes"] = [{"nodes": list(range(len(self.doc["nodes"])))}]
        if self.data:
            name = file.with_suffix(".bin").name
            file.with_suffix(".bin").write_bytes(self.data)
            self.doc["buffers"] = [{"uri": name, "byteLength": len(self.data)}]
        else:
            for key in ("meshes", "accessors", "bufferViews"):
                del self.doc[key]
        file.write_text(json.dumps(self.doc))
        return file


def covered_lamp(size, gap):
    """A floor below a lamp, which a black sheet covers from `gap` metres below; without one where that is None."""
    b = Builder(size)
    b.level(4, b.diffuse(0.8))
    b.level(1, b.diffuse(0, 10), (0, 2, 0), up=False)
    if gap is not None:
        b.level(1.2, b.diffuse(0), (0, 2 - gap, 0))
    b.camera((0, 1, 5), -0.2, 0.7)
    return b


def lit_ball(size, stacks, elevation):
    """A ball of triangles under a sun that stands `elevation` degrees above its horizon, seen from the side."""
    b = Builder(size)
    b.ball(stacks, 2 * stacks, b.diffuse(0.8))
    e = math.radians(elevation)
    b.sun((-math.cos(e), -math.sin(e), -0.3))
    b.camera((0, 0, 8), 0, 0.3)
    return b


def ground(size, radius):
    """The ground under a sun from a man's height: a plane, or a sphere of that radius."""
    b = Builder(size)
    grey = b.diffuse(0.5)
    if radius is None:
        b.level(400, grey)
    else:
        b.sphere(radius, grey, (0, -radius, 0))
    b.sun((-0.6, -0.35, -0.2))
    b.camera((0, 1.7, 0), -0.5, 0.6)
    return b


def distant_ball(size, distance):
    """A sphere of radius 1 under a sun, filling the view from that many radii away."""
    b = Builder(size)
    b.sphere(1, b.diffuse(0.5), (0, 0, 0))
    b.sun((-0.6, -0.5, -0.4))
    b.camera((0, 0, distance), 0, 2 * math.atan(1.2 / distance), 0.1 * distance, 10 * distance)
    return b
