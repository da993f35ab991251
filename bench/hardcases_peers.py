#!/usr/bin/env python3
"""Image cases of `talbot hardcases` through other renderers: Talbot, Cycles (Debian's blender) and Mitsuba 3 (pip install mitsuba).

One scene of diffuse surfaces is scaled and moved, camera and lamp included, which should change nothing; each renderer is held
against its own picture of the scene as it is, with the same seed, and against its own noise (another seed). So no renderer is
asked to agree with another. The transform stands where files have it: in the nodes' translation and scale, in double.
Usage: hardcases_peers.py TALBOT SCENE.gltf [--size N] [--spp N] [--bounces N] [--threads N] [--quick] [--json FILE]
Renderers that are not installed are named and left out.
"""
import argparse
import copy
import importlib.util
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import numpy as np

from cycles_compare import read_pfm

# Name, scale, shift in metres along (1, -1, 1).
CASES = [
    ("scaled by 2^-20", 2.0 ** -20, 0), ("scaled by 2^20", 2.0 ** 20, 0), ("scaled by 1e-3", 1e-3, 0), ("scaled by 1e-5", 1e-5, 0),
    ("scaled by 1e5", 1e5, 0), ("moved by 100 m", 1, 1e2), ("moved by 1 km", 1, 1e3), ("moved by 100 km", 1, 1e5),
    ("moved by 1e7 m", 1, 1e7),
]
QUICK = ("scaled by 2^-20", "moved by 1 km")


def relmse(image, reference):
    bad = ~(np.isfinite(image) & np.isfinite(reference))
    error = (image - reference) ** 2 / (reference ** 2 + 0.01)
    return float(np.mean(np.where(bad, 1.0, error)))


class Scene:
    """The glTF file with its nodes scaled and moved; nodes of the source have no matrix and no parent."""

    def __init__(self, path, size):
        self.path = pathlib.Path(path)
        self.doc = json.loads(self.path.read_text())
        self.doc["cameras"][0].setdefault("extras", {})["resolution"] = [size, size]

    def placed(self, scale, shift):
        doc = copy.deepcopy(self.doc)
        by = np.array([1.0, -1.0, 1.0]) * shift
        for node in doc["nodes"]:
            at = np.array(node.get("translation", [0, 0, 0]), float)
            node["translation"] = (scale * at + by).tolist()
            if "camera" not in node:
                node["scale"] = [scale * s for s in node.get("scale", [1, 1, 1])]
        lens = doc["cameras"][0]["perspective"]
        lens["znear"] *= scale
        lens["zfar"] = 1e3 * scale
        return doc

    def write(self, folder, scale, shift):
        for buffer in self.doc["buffers"]:
            target = folder / buffer["uri"]
            if not target.exists():
                shutil.copy(self.path.parent / buffer["uri"], target)
        file = folder / "placed.gltf"
        file.write_text(json.dumps(self.placed(scale, shift)))
        return file


class Talbot:
    name = "Talbot"

    def __init__(self, args):
        self.args = args
        words = subprocess.run([args.talbot, "--version"], capture_output=True, text=True).stdout.split()
        self.version = next((w for w in words if w[0].isdigit()), "")

    def render(self, scene, folder, scale, shift, seed):
        file = scene.write(folder, scale, shift)
        image = folder / "talbot.pfm"
        subprocess.run([self.args.talbot, file, "--frames", str(self.args.spp), "--threads", str(self.args.threads), "--seed",
                        str(seed), "--max-depth", str(self.args.bounces + 1), "--output", image, "--quiet"], check=True)
        return read_pfm(image)


class Cycles:
    name = "Cycles"

    def __init__(self, args):
        self.args = args
        if not shutil.which("blender"):
            raise ImportError("blender is not installed (apt-get install blender)")
        self.version = ""

    def render(self, scene, folder, scale, shift, seed):
        file = scene.write(folder, scale, shift)
        image = folder / "cycles.pfm"
        script = pathlib.Path(__file__).with_name("cycles_scene.py")
        done = subprocess.run(["blender", "-b", "--factory-startup", "-P", script, "--", file, str(self.args.spp),
                               str(self.args.threads), str(self.args.bounces), image, str(seed)], check=True, capture_output=True,
                              text=True)
        self.version = json.loads(re.search(r"^\{.*\}$", done.stdout, re.M).group(0))["cycles"]
        return read_pfm(image)


class Mitsuba:
    name = "Mitsuba 3"

    def __init__(self, args):
        self.args = args
        if importlib.util.find_spec("mitsuba") is None:
            raise ImportError("mitsuba is not installed (pip install mitsuba)")
        import mitsuba
        self.mi = mitsuba
        self.mi.set_variant("scalar_rgb")
        self.version = f"{mitsuba.__version__} scalar_rgb"

    def accessor(self, scene, index):
        accessor = scene.doc["accessors"][index]
        view = scene.doc["bufferViews"][accessor["bufferView"]]
        data = (scene.path.parent / scene.doc["buffers"][view["buffer"]]["uri"]).read_bytes()
        kind = {5126: np.float32, 5125: np.uint32, 5123: np.uint16}[accessor["componentType"]]
        width = {"SCALAR": 1, "VEC3": 3}[accessor["type"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        return np.frombuffer(data, kind, accessor["count"] * width, start).reshape(accessor["count"], width)

    def shape(self, scene, node, primitive, folder, name):
        mi = self.mi
        positions = self.accessor(scene, primitive["attributes"]["POSITION"])
        faces = self.accessor(scene, primitive["indices"]).reshape(-1, 3).astype(np.uint32)
        mesh = mi.Mesh(name, len(positions), len(faces))
        params = mi.traverse(mesh)
        params["vertex_positions"] = positions.ravel()
        params["faces"] = faces.ravel()
        params.update()
        mesh.write_ply(str(folder / f"{name}.ply"))
        material = scene.doc["materials"][primitive["material"]]
        color = material["pbrMetallicRoughness"]["baseColorFactor"][:3]
        place = mi.ScalarTransform4f().translate(node["translation"]).scale(node["scale"])
        shape = {"type": "ply", "filename": str(folder / f"{name}.ply"), "face_normals": True, "to_world": place,
                 "bsdf": {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": color}}}}
        if any(material.get("emissiveFactor", [0, 0, 0])):
            strength = material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"]
            radiance = [c * strength for c in material["emissiveFactor"]]
            shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": radiance}}
        return shape

    def render(self, scene, folder, scale, shift, seed):
        mi = self.mi
        doc = scene.placed(scale, shift)
        size = doc["cameras"][0]["extras"]["resolution"][0]
        lens = doc["cameras"][0]["perspective"]
        out = {"type": "scene", "integrator": {"type": "path", "max_depth": self.args.bounces + 1, "rr_depth": 10000}}
        for number, node in enumerate(doc["nodes"]):
            if "camera" in node:
                x, y, z, w = node.get("rotation", [0, 0, 0, 1])
                forward = -np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
                # A target far enough that it does not round to the eye.
                reach = max(scale, abs(shift) * 1e-3)
                eye = np.array(node["translation"])
                out["sensor"] = {
                    "type": "perspective", "fov": float(np.degrees(lens["yfov"])), "fov_axis": "y", "near_clip": lens["znear"],
                    "far_clip": lens["zfar"],
                    "to_world": mi.ScalarTransform4f().look_at(eye.tolist(), (eye + reach * forward).tolist(), [0, 1, 0]),
                    "film": {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"},
                             "pixel_format": "rgb", "component_format": "float32"},
                    "sampler": {"type": "independent"}}
            if "mesh" in node:
                for k, primitive in enumerate(doc["meshes"][node["mesh"]]["primitives"]):
                    name = f"shape_{number}_{k}"
                    out[name] = self.shape(scene, node, primitive, folder, name)
        return np.array(mi.render(mi.load_dict(out), spp=self.args.spp, seed=seed), float)


def measure(renderer, scene, cases, folder):
    base = renderer.render(scene, folder, 1, 0, 0)
    other = renderer.render(scene, folder, 1, 0, 1)
    noise = relmse(other, base) / 2
    rows = []
    for name, scale, shift in cases:
        try:
            image = renderer.render(scene, folder, scale, shift, 0)
        except (subprocess.CalledProcessError, RuntimeError) as error:
            rows.append({"case": name, "renderer": renderer.name, "failed": str(error).splitlines()[0]})
            continue
        rows.append({"case": name, "renderer": renderer.name, "relmse": relmse(image, base), "noise_relmse": noise,
                     "mean_ratio": float(np.nanmean(image) / np.mean(base)), "same": bool(np.array_equal(image, base)), "black_pixels": int(np.sum(np.all(image == 0, axis=2))),
                     "not_finite": int(np.sum(~np.isfinite(image)))})
    return rows


def cell(row):
    if row is None:
        return "-"
    if "failed" in row:
        return "failed"
    if row["same"]:
        return "same bytes"
    text = f"{row['relmse']:.1e}"
    if row["noise_relmse"] > 0 and row["relmse"] > 1e-6:
        text += f" ({row['relmse'] / row['noise_relmse']:.1g} x noise"
        if abs(row["mean_ratio"] - 1) > 0.005:
            text += f", mean {100 * (row['mean_ratio'] - 1):+.0f} %"
        text += ")"
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("talbot")
    parser.add_argument("scene")
    parser.add_argument("--size", type=int, default=64)
    parser.add_argument("--spp", type=int, default=16)
    parser.add_argument("--bounces", type=int, default=8)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--json")
    args = parser.parse_args()
    scene = Scene(args.scene, args.size)
    cases = [c for c in CASES if not args.quick or c[0] in QUICK]
    renderers, rows = [], []
    for kind in (Talbot, Cycles, Mitsuba):
        try:
            renderers.append(kind(args))
        except ImportError as error:
            print(f"left out: {kind.name}: {error}", file=sys.stderr)
    with tempfile.TemporaryDirectory() as folder:
        for renderer in renderers:
            rows += measure(renderer, scene, cases, pathlib.Path(folder))
    print("| case | " + " | ".join(f"{r.name} {r.version}".strip() for r in renderers) + " |")
    print("|---|" + "---|" * len(renderers))
    for name, _, _ in cases:
        by = {row["renderer"]: row for row in rows if row["case"] == name}
        print(f"| {name} | " + " | ".join(cell(by.get(r.name)) for r in renderers) + " |")
    if args.json:
        record = {"scene": args.scene, "size": args.size, "spp": args.spp, "bounces": args.bounces,
                  "versions": {r.name: r.version for r in renderers}, "rows": rows}
        pathlib.Path(args.json).write_text(json.dumps(record, indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
