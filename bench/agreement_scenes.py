"""Writes small glTF scenes for comparisons with other renderers: balls on a matte floor, one subject a scene. Standard library
and numpy."""
import json
import pathlib

import numpy as np

RESOLUTION = [96, 64]
MATTE = {"KHR_materials_specular": {"specularFactor": 0}}


def material(color=(1, 1, 1), metallic=0, roughness=1, **extensions):
    return {"pbrMetallicRoughness": {"baseColorFactor": [*color, 1], "metallicFactor": metallic, "roughnessFactor": roughness},
            "extensions": {f"KHR_materials_{name}": value for name, value in extensions.items()}}


def matte(color):
    return {**material(color), "extensions": MATTE, "doubleSided": True}


def lamp(color, strength):
    return {**material((0, 0, 0)), "emissiveFactor": list(color),
            "extensions": {**MATTE, "KHR_materials_emissive_strength": {"emissiveStrength": strength}}}


class SceneWriter:
    def __init__(self, environment=(0, 0, 0)):
        self.bytes, self.views, self.accessors = b"", [], []
        self.meshes, self.nodes, self.materials, self.lights = [], [], [], []
        self.environment = list(environment)

    def array(self, data, kind, component):
        data = np.ascontiguousarray(data, np.float32 if component == 5126 else np.uint32)
        self.views.append({"buffer": 0, "byteOffset": len(self.bytes), "byteLength": data.nbytes})
        self.bytes += data.tobytes()
        accessor = {"bufferView": len(self.views) - 1, "componentType": component, "count": len(data), "type": kind}
        if kind == "VEC3":
            accessor["min"], accessor["max"] = data.min(0).tolist(), data.max(0).tolist()
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def mesh(self, arrays, kind_of_material):
        self.materials.append({"name": f"material {len(self.materials)}", **kind_of_material})
        attributes = {name: self.array(arrays[name], kind, 5126) for name, kind in
                      (("POSITION", "VEC3"), ("NORMAL", "VEC3"), ("TEXCOORD_0", "VEC2"), ("TANGENT", "VEC4")) if name in arrays}
        self.meshes.append({"primitives": [{"attributes": attributes, "indices": self.array(arrays["faces"].ravel(), "SCALAR", 5125),
                                            "material": len(self.materials) - 1}]})
        self.nodes.append({"mesh": len(self.meshes) - 1, "name": f"mesh {len(self.meshes) - 1}"})

    def ball(self, center, radius, kind_of_material, around=128, down=64):
        phi, theta = np.meshgrid(np.linspace(0, 2 * np.pi, around + 1), np.linspace(0, np.pi, down + 1))
        phi, theta = phi.ravel(), theta.ravel()
        n = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), -np.sin(theta) * np.sin(phi)], 1)
        east = np.stack([-np.sin(phi), 0 * phi, -np.cos(phi), 1 + 0 * phi], 1)
        i, j = (v.ravel() for v in np.meshgrid(np.arange(around), np.arange(down)))
        a, b = j * (around + 1) + i, (j + 1) * (around + 1) + i
        faces = np.concatenate([np.stack([a, b, b + 1], 1)[j < down - 1], np.stack([a, b + 1, a + 1], 1)[j > 0]])
        self.mesh({"POSITION": np.array(center) + radius * n, "NORMAL": n, "TANGENT": east,
                   "TEXCOORD_0": np.stack([phi / (2 * np.pi), theta / np.pi], 1), "faces": faces}, kind_of_material)

    def quad(self, corner, u, v, kind_of_material):
        """Facing u x v."""
        corner, u, v = np.array(corner, float), np.array(u, float), np.array(v, float)
        n = np.cross(u, v)
        self.mesh({"POSITION": np.array([corner, corner + u, corner + u + v, corner + v]), "NORMAL": np.tile(n / np.linalg.norm(n), (4, 1)),
                   "faces": np.array([[0, 1, 2], [0, 2, 3]])}, kind_of_material)

    def light(self, kind, position, color, intensity, down=False, **more):
        """Shining along -Z, or straight down."""
        self.lights.append({"type": kind, "color": list(color), "intensity": intensity, **more})
        turn = [-np.sqrt(0.5), 0, 0, np.sqrt(0.5)] if down else [0, 0, 0, 1]
        self.nodes.append({"translation": list(position), "rotation": turn,
                           "extensions": {"KHR_lights_punctual": {"light": len(self.lights) - 1}}})

    def studio(self, balls, lamp_strength=12):
        """A floor, a wall, a lamp and balls in a row."""
        self.quad([-8, 0, 8], [16, 0, 0], [0, 0, -11], matte((0.5, 0.45, 0.4)))
        self.quad([-8, 0, -3], [16, 0, 0], [0, 8, 0], matte((0.4, 0.45, 0.5)))
        if lamp_strength:
            self.quad([-2, 4, 2.5], [0, 0, -2], [4, 0, 0], lamp((1, 0.95, 0.85), lamp_strength))
        for k, kind_of_material in enumerate(balls):
            self.ball([1.5 * (k - (len(balls) - 1) / 2), 0.65, 0], 0.65, kind_of_material)

    def write(self, file):
        tilt = -0.16
        camera = {"camera": 0, "translation": [0, 1.5, 5.2], "rotation": [np.sin(tilt / 2), 0, 0, np.cos(tilt / 2)]}
        used = sorted({name for m in self.materials for name in m["extensions"]} | ({"KHR_lights_punctual"} if self.lights else set()))
        doc = {"asset": {"version": "2.0"}, "scene": 0, "nodes": self.nodes + [camera], "meshes": self.meshes, "materials": self.materials,
               "scenes": [{"nodes": list(range(len(self.nodes) + 1)), "extras": {"environment": {"color": self.environment}}}],
               "cameras": [{"type": "perspective", "perspective": {"yfov": 0.6, "znear": 0.01, "aspectRatio": RESOLUTION[0] / RESOLUTION[1]},
                            "extras": {"resolution": RESOLUTION}}],
               "accessors": self.accessors, "bufferViews": self.views, "extensionsUsed": used,
               "buffers": [{"uri": f"{pathlib.Path(file).stem}.bin", "byteLength": len(self.bytes)}]}
        if self.lights:
            doc["extensions"] = {"KHR_lights_punctual": {"lights": self.lights}}
        pathlib.Path(file).with_suffix(".bin").write_bytes(self.bytes)
        pathlib.Path(file).write_text(json.dumps(doc))


def write_scenes(folder):
    """The scenes' files."""
    def glass(roughness, color, distance):
        return material(roughness=roughness, transmission={"transmissionFactor": 1}, ior={"ior": 1.5},
                        volume={"thicknessFactor": 1.3, "attenuationColor": color, "attenuationDistance": distance})

    def coat(factor, roughness):
        return {"clearcoatFactor": factor, "clearcoatRoughnessFactor": roughness}

    def film(factor, ior, thickness):
        return {"iridescenceFactor": factor, "iridescenceIor": ior, "iridescenceThicknessMaximum": thickness}

    rows = {
        "coat": [material((0.7, 0.1, 0.05), 0, 0.6, clearcoat=coat(1, 0.1)), material((0.9, 0.6, 0.3), 1, 0.5, clearcoat=coat(1, 0.4)),
                 material((0.1, 0.2, 0.6), 0.5, 0.3, clearcoat=coat(0.5, 0.2))],
        "sheen": [material((0.3, 0.05, 0.1), 0, 0.8, sheen={"sheenColorFactor": [1, 0.6, 0.7], "sheenRoughnessFactor": 0.3}),
                  material((0.05, 0.1, 0.3), 0, 1, sheen={"sheenColorFactor": [0.4, 0.7, 1], "sheenRoughnessFactor": 0.6}),
                  material((0.4, 0.4, 0.4), 0, 0.5, sheen={"sheenColorFactor": [0.9, 0.9, 0.9], "sheenRoughnessFactor": 1})],
        "iridescence": [material((0.9, 0.9, 0.9), 1, 0.2, iridescence=film(1, 1.3, 400)),
                        material((0.05, 0.05, 0.05), 0, 0.25, iridescence=film(1, 1.8, 300)),
                        material((0.6, 0.3, 0.1), 1, 0.4, iridescence=film(0.6, 1.4, 650))],
        "rough-glass": [glass(0.1, [0.9, 0.4, 0.2], 1), glass(0.2, [0.3, 0.8, 0.5], 2), glass(0.3, [0.5, 0.6, 0.9], 0.8)],
        "anisotropy": [material((0.9, 0.7, 0.5), 1, 0.3, anisotropy={"anisotropyStrength": 0.5}),
                       material((0.8, 0.8, 0.8), 1, 0.2, anisotropy={"anisotropyStrength": 0.8, "anisotropyRotation": 1.5707963}),
                       material((0.2, 0.4, 0.6), 0, 0.4, anisotropy={"anisotropyStrength": 0.7, "anisotropyRotation": 0.6})],
        "specular": [material((0.5, 0.1, 0.1), 0, 0.3, specular={"specularFactor": 0.5}),
                     material((0.1, 0.4, 0.1), 0, 0.4, specular={"specularColorFactor": [1, 0.5, 0.2]}, ior={"ior": 2}),
                     material((0.2, 0.2, 0.5), 0, 0.6, ior={"ior": 1.2})],
    }
    files = []
    for name, balls in rows.items():
        writer = SceneWriter((0.3, 0.32, 0.35))
        writer.studio(balls)
        files.append(pathlib.Path(folder) / f"{name}.gltf")
        writer.write(files[-1])

    plain = [material((0.8, 0.2, 0.1), 0, 0.4), material((0.9, 0.8, 0.6), 1, 0.35), matte((0.7, 0.7, 0.7))]
    writer = SceneWriter()
    writer.studio(plain, 0)
    random = np.random.default_rng(5)
    for k in range(40):
        color = 0.3 + 0.7 * random.random(3)
        if k % 2:
            writer.light("point", [8 * random.random() - 4, 2 + random.random(), 4 * random.random() - 2], color, 0.8)
        else:
            x, y, z = 8 * random.random() - 4, 2 + random.random(), 4 * random.random() - 2
            writer.quad([x, y, z], [0.2, 0, 0], [0, 0, 0.2], lamp(color, 12))
    writer.light("directional", [0, 0, 0], (0.4, 0.5, 1), 0.5)
    writer.light("spot", [0, 4, 0], (1, 0.6, 0.3), 6, down=True,
                 spot={"innerConeAngle": np.radians(24.9), "outerConeAngle": np.radians(25)})
    files.append(pathlib.Path(folder) / "lamps.gltf")
    writer.write(files[-1])
    return files
