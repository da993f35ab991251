"""A glTF 2.0 document under construction, written as .gltf + .bin (+ .png) or as one .glb.

Colours are linear; emission is given as radiance. The extras and the sphere extension are those of ../README.md.
"""

import json
import struct
from math import sqrt

from .geometry import cross, normalized, sphere, sub

FLOAT, UNSIGNED_SHORT, UNSIGNED_INT = 5126, 5123, 5125
ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER = 34962, 34963
IMPLICIT_SHAPES, IMPLICIT_SURFACE = "KHR_implicit_shapes", "TALBOT_implicit_surface"


def rounded(values, digits=9):
    """Shortens numbers, so that the text does not depend on the last bit of a library function."""
    if isinstance(values, (list, tuple)):
        return [rounded(v, digits) for v in values]
    return round(float(values), digits) + 0.0


def look_rotation(eye, target):
    """Quaternion (x, y, z, w) that turns -Z towards the target and keeps +Y up."""
    back = normalized(sub(eye, target))
    right = normalized(cross((0.0, 1.0, 0.0), back))
    up = cross(back, right)
    m = (right, up, back)  # columns of the rotation matrix
    trace = m[0][0] + m[1][1] + m[2][2]
    if trace > 0:
        s = 2 * sqrt(1 + trace)
        q = ((m[1][2] - m[2][1]) / s, (m[2][0] - m[0][2]) / s, (m[0][1] - m[1][0]) / s, s / 4)
    else:
        i = max(range(3), key=lambda k: m[k][k])
        j, k = (i + 1) % 3, (i + 2) % 3
        s = 2 * sqrt(1 + m[i][i] - m[j][j] - m[k][k])
        q = [0.0] * 4
        q[i], q[j], q[k] = s / 4, (m[j][i] + m[i][j]) / s, (m[k][i] + m[i][k]) / s
        q[3] = (m[j][k] - m[k][j]) / s
    size = sqrt(sum(v * v for v in q))
    return [v / size for v in q]


class Document:
    """One scene. Methods that add something return its index; `save` writes the files."""

    def __init__(self, name, binary=False, tessellate=False):
        self.name = name
        self.binary = binary
        self.tessellate = tessellate
        self.buffer = bytearray()
        self.files = {}
        self.used = set()
        self.root = []
        self.lights = []
        self.sphere_meshes = {}
        self.json = {key: [] for key in ("nodes", "cameras", "meshes", "materials", "textures", "images", "samplers",
                                         "accessors", "bufferViews")}
        self.scene_extras = {}
        self.shapes = []

    def material(self, name, color=(1.0, 1.0, 1.0), metallic=0.0, roughness=1.0, lambert=False, emission=None,
                 ior=None, transmission=None, thickness=None, attenuation=None, textures=None, two_sided=False,
                 normal_scale=1.0):
        """A metallic-roughness material; `lambert` removes the dielectric coat, `emission` is a radiance,
        `attenuation` is (colour, distance in metres), `textures` maps base, roughness, normal to textures."""
        pbr = {"baseColorFactor": rounded([*color, 1.0], 6), "metallicFactor": metallic,
               "roughnessFactor": rounded(roughness, 6)}
        extensions = {}
        entry = {"name": name, "pbrMetallicRoughness": pbr}
        textures = textures or {}
        if "base" in textures:
            pbr["baseColorTexture"] = {"index": textures["base"]}
        if "roughness" in textures:
            pbr["metallicRoughnessTexture"] = {"index": textures["roughness"]}
        if "normal" in textures:
            entry["normalTexture"] = {"index": textures["normal"], "scale": normal_scale}
        if lambert:
            extensions["KHR_materials_specular"] = {"specularFactor": 0.0}
        if ior is not None:
            extensions["KHR_materials_ior"] = {"ior": ior}
        if transmission is not None:
            extensions["KHR_materials_transmission"] = {"transmissionFactor": transmission}
        if thickness is not None:
            extensions["KHR_materials_volume"] = {"thicknessFactor": thickness}
            if attenuation is not None:
                extensions["KHR_materials_volume"].update(attenuationColor=rounded(attenuation[0], 6),
                                                          attenuationDistance=attenuation[1])
        if emission is not None:
            strength = max(emission)
            entry["emissiveFactor"] = rounded([v / strength for v in emission])
            extensions["KHR_materials_emissive_strength"] = {"emissiveStrength": strength}
        if two_sided:
            entry["doubleSided"] = True
        if extensions:
            entry["extensions"] = extensions
            self.used.update(extensions)
        return self._push("materials", entry)

    def texture(self, name, png):
        """A repeating, linearly filtered texture of an encoded PNG: in the .glb, or in a file beside the .gltf."""
        if not self.json["samplers"]:
            self.json["samplers"].append({"magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497})
        image = {"name": name, "mimeType": "image/png"}
        if self.binary:
            image["bufferView"] = self._view(png, None)
        else:
            image = {"name": name, "uri": f"{self.name}-{name.replace(' ', '-')}.png"}
            self.files[image["uri"]] = png
        return self._push("textures", {"name": name, "sampler": 0, "source": self._push("images", image)})

    def mesh(self, name, *parts):
        """A mesh of (Mesh, material index) parts."""
        return self._push("meshes", {"name": name, "primitives": [self._primitive(*part) for part in parts]})

    def node(self, name, mesh=None, translation=None, rotation=None, scale=None, children=None, parent=True, **more):
        """A node; with `parent=False` it is left out of the scene's roots, to become someone's child."""
        entry = {"name": name}
        if mesh is not None:
            entry["mesh"] = mesh
        entry.update(more)
        for key, value in (("translation", translation), ("rotation", rotation), ("scale", scale)):
            if value is not None:
                entry[key] = rounded(value)
        if children:
            entry["children"] = children
        index = self._push("nodes", entry)
        if parent:
            self.root.append(index)
        return index

    def sphere(self, name, centre, radius, material):
        """An exact sphere: KHR_implicit_shapes and TALBOT_implicit_surface, or a mesh when tessellating."""
        if self.tessellate:
            key = (radius, material)
            if key not in self.sphere_meshes:
                columns = 64 if radius < 5 else 256 if radius < 100 else 1024
                self.sphere_meshes[key] = self.mesh(name, (sphere(radius, columns, columns // 2), material))
            return self.node(name, mesh=self.sphere_meshes[key], translation=centre)
        self.used.update((IMPLICIT_SHAPES, IMPLICIT_SURFACE))
        shape = {"type": "sphere", "sphere": {"radius": radius}}
        if shape not in self.shapes:
            self.shapes.append(shape)
        surface = {"shape": self.shapes.index(shape), "material": material}
        return self.node(name, translation=centre, extensions={IMPLICIT_SURFACE: surface})

    def spot(self, name, position, target, color, intensity, inner, outer):
        """A KHR_lights_punctual spot; intensity in candela, cone half-angles in radians."""
        self.used.add("KHR_lights_punctual")
        self.lights.append({"name": name, "type": "spot", "color": rounded(color, 6), "intensity": intensity,
                            "spot": {"innerConeAngle": rounded(inner), "outerConeAngle": rounded(outer)}})
        return self.node(name, translation=position, rotation=look_rotation(position, target),
                         extensions={"KHR_lights_punctual": {"light": len(self.lights) - 1}})

    def camera(self, name, eye, target, yfov, resolution, lens=None, shift=None):
        """A perspective camera; `lens` is (aperture radius, focus distance), `shift` in window heights."""
        extras = {"resolution": list(resolution)}
        if lens is not None:
            extras["lens"] = {"apertureRadius": lens[0], "focusDistance": rounded(lens[1], 6)}
        if shift is not None:
            extras["lensShift"] = rounded(shift)
        perspective = {"aspectRatio": rounded(resolution[0] / resolution[1]), "yfov": rounded(yfov), "znear": 0.01}
        index = self._push("cameras", {"name": name, "type": "perspective", "extras": extras,
                                       "perspective": perspective})
        turned = {} if eye[0] == target[0] and eye[1] == target[1] and eye[2] > target[2] else {
            "rotation": look_rotation(eye, target)}
        return self.node(name, camera=index, translation=eye, **turned)

    def environment(self, color=None, gradient=None):
        """Uniform radiance, or (axis, from, to): from at -axis to `to` at +axis, linear in the cosine."""
        self.scene_extras["environment"] = {"color": list(color)} if color is not None else {
            "gradient": {"axis": list(gradient[0]), "from": list(gradient[1]), "to": list(gradient[2])}}

    def save(self, folder):
        """Writes the files into a folder and returns their names."""
        document = {"asset": {"version": "2.0", "generator": "Talbot assets/generate.py", "copyright": "CC0-1.0"},
                    "scene": 0, "scenes": [{"name": self.name, "nodes": self.root}]}
        if self.scene_extras:
            document["scenes"][0]["extras"] = self.scene_extras
        if self.used:
            document["extensionsUsed"] = sorted(self.used)
        extensions = {}
        if self.shapes:
            extensions[IMPLICIT_SHAPES] = {"shapes": self.shapes}
        if self.lights:
            extensions["KHR_lights_punctual"] = {"lights": self.lights}
        if extensions:
            document["extensions"] = extensions
        document.update({key: value for key, value in self.json.items() if value})
        if self.buffer:
            while len(self.buffer) % 4:
                self.buffer.append(0)
            document["buffers"] = [{"byteLength": len(self.buffer)}]
        files = dict(self.files)
        if self.binary:
            files[self.name + ".glb"] = self._glb(document)
        else:
            if self.buffer:
                document["buffers"][0]["uri"] = self.name + ".bin"
                files[self.name + ".bin"] = bytes(self.buffer)
            files[self.name + ".gltf"] = _pretty(document).encode()
        for name, content in files.items():
            (folder / name).write_bytes(content)
        return sorted(files)

    def _glb(self, document):
        text = json.dumps(document, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        body = struct.pack("<II", len(text), 0x4E4F534A) + text
        body += struct.pack("<II", len(self.buffer), 0x004E4942) + bytes(self.buffer)
        return struct.pack("<III", 0x46546C67, 2, 12 + len(body)) + body

    def _push(self, key, entry):
        self.json[key].append(entry)
        return len(self.json[key]) - 1

    def _view(self, content, target):
        while len(self.buffer) % 4:
            self.buffer.append(0)
        view = {"buffer": 0, "byteOffset": len(self.buffer), "byteLength": len(content)}
        if target is not None:
            view["target"] = target
        self.buffer += content
        return self._push("bufferViews", view)

    def _accessor(self, rows, kind, component=FLOAT, target=ARRAY_BUFFER, bounds=False):
        code = {FLOAT: "f", UNSIGNED_SHORT: "H", UNSIGNED_INT: "I"}[component]
        flat = [v for row in rows for v in row]
        if component == FLOAT:
            flat = [round(v, 9) + 0.0 for v in flat]  # + 0.0 turns -0.0 into 0.0
        packed = struct.pack(f"<{len(flat)}{code}", *flat)
        entry = {"bufferView": self._view(packed, target), "componentType": component,
                 "count": len(rows), "type": kind}
        if bounds:
            stored = struct.unpack(f"<{len(flat)}{code}", packed)
            width = len(rows[0])
            entry["min"] = [min(stored[i::width]) for i in range(width)]
            entry["max"] = [max(stored[i::width]) for i in range(width)]
        return self._push("accessors", entry)

    def _primitive(self, mesh, material):
        entry = self.json["materials"][material]
        pbr = entry["pbrMetallicRoughness"]
        attributes = {"POSITION": self._accessor(mesh.positions, "VEC3", bounds=True),
                      "NORMAL": self._accessor(mesh.normals, "VEC3")}
        if "normalTexture" in entry:
            attributes["TANGENT"] = self._accessor((mesh.tangents or mesh.with_tangents().tangents), "VEC4")
        if "normalTexture" in entry or "baseColorTexture" in pbr or "metallicRoughnessTexture" in pbr:
            attributes["TEXCOORD_0"] = self._accessor(mesh.uvs, "VEC2")
        component = UNSIGNED_SHORT if len(mesh.positions) < 65535 else UNSIGNED_INT
        indices = self._accessor([(i,) for t in mesh.triangles for i in t], "SCALAR", component, ELEMENT_ARRAY_BUFFER)
        primitive = {"attributes": attributes, "indices": indices, "material": material}
        if mesh.closed:
            primitive["extras"] = {"closed": True}
        return primitive


def _pretty(document):
    """JSON with one line for each entry of the big arrays: readable, and short differences."""
    lines = []
    for key, value in document.items():
        if isinstance(value, list) and value and isinstance(value[0], dict):
            rows = ",\n".join("    " + json.dumps(row) for row in value)
            lines.append(f"  {json.dumps(key)}: [\n{rows}\n  ]")
        else:
            lines.append(f"  {json.dumps(key)}: {json.dumps(value)}")
    return "{\n" + ",\n".join(lines) + "\n}\n"
