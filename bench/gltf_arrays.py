"""The parts of a glTF file that other renderers' scenes are made of: placed triangles as arrays, materials, the camera. Standard
library and numpy; .gltf with separate buffers, float and integer accessors."""
import json
import pathlib

import numpy as np

KINDS = {5120: np.int8, 5121: np.uint8, 5122: np.int16, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


def matrix_of(node):
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
    m = np.eye(4)
    m[:3, :3] = turn * np.array(node.get("scale", [1, 1, 1]), float)
    m[:3, 3] = node.get("translation", [0, 0, 0])
    return m


class Gltf:
    def __init__(self, path):
        self.path = pathlib.Path(path)
        self.doc = json.loads(self.path.read_text())
        self.buffers = [(self.path.parent / b["uri"]).read_bytes() for b in self.doc["buffers"]]
        self.scene = self.doc["scenes"][self.doc.get("scene", 0)]
        self.environment = self.scene.get("extras", {}).get("environment", {}).get("color", [0, 0, 0])

    def accessor(self, index):
        a = self.doc["accessors"][index]
        view = self.doc["bufferViews"][a["bufferView"]]
        kind, width = KINDS[a["componentType"]], WIDTHS[a["type"]]
        start = view.get("byteOffset", 0) + a.get("byteOffset", 0)
        packed = width * np.dtype(kind).itemsize
        stride = view.get("byteStride", packed)
        data = np.frombuffer(self.buffers[view["buffer"]], np.uint8, (a["count"] - 1) * stride + packed, start)
        rows = np.lib.stride_tricks.as_strided(data, (a["count"], packed), (stride, 1))
        return np.ascontiguousarray(rows).view(kind).reshape(a["count"], width)

    def nodes(self):
        """All nodes of the scene with their world matrices."""
        stack = [(index, np.eye(4)) for index in self.scene["nodes"]]
        while stack:
            index, above = stack.pop()
            node = self.doc["nodes"][index]
            world = above @ matrix_of(node)
            yield node, world
            stack.extend((child, world) for child in node.get("children", []))

    def primitives(self):
        """(name, material, arrays) of every placed primitive, in world space."""
        for node, world in self.nodes():
            if "mesh" not in node:
                continue
            for k, primitive in enumerate(self.doc["meshes"][node["mesh"]]["primitives"]):
                attributes = primitive["attributes"]
                positions = self.accessor(attributes["POSITION"]).astype(float) @ world[:3, :3].T + world[:3, 3]
                faces = self.accessor(primitive["indices"]).reshape(-1, 3).astype(np.uint32)
                if np.linalg.det(world[:3, :3]) < 0:
                    faces = faces[:, ::-1]
                arrays = {"positions": positions, "faces": faces}
                if "NORMAL" in attributes:
                    normals = self.accessor(attributes["NORMAL"]).astype(float) @ np.linalg.inv(world[:3, :3])
                    arrays["normals"] = normals / np.linalg.norm(normals, axis=1, keepdims=True)
                if "TEXCOORD_0" in attributes:
                    arrays["uv"] = self.accessor(attributes["TEXCOORD_0"]).astype(float)
                name = f"{node.get('name', 'node')}_{k}"
                yield name, self.doc["materials"][primitive["material"]], arrays

    def camera(self):
        """(vertical field of view in radians, world matrix) of the first perspective camera."""
        for node, world in self.nodes():
            if "camera" in node:
                return self.doc["cameras"][node["camera"]]["perspective"]["yfov"], world
        raise SystemExit(f"{self.path}: has no camera")

    def lights(self):
        """(light, world matrix) of every placed punctual light."""
        lights = self.doc.get("extensions", {}).get("KHR_lights_punctual", {}).get("lights", [])
        for node, world in self.nodes():
            placed = node.get("extensions", {}).get("KHR_lights_punctual")
            if placed:
                yield lights[placed["light"]], world

    def size(self, scale):
        width, height = self.doc["cameras"][0].get("extras", {}).get("resolution", [512, 512])
        return max(1, round(width * scale)), max(1, round(height * scale))

    def image_file(self, texture):
        return self.path.parent / self.doc["images"][self.doc["textures"][texture]["source"]]["uri"]
