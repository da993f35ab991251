#!/usr/bin/env python3
"""Compares Talbot's Cornell box with Mitsuba 3's (scalar_rgb), block by block.

Both render the same glTF geometry, light and camera with several seeds; the means of 8x8 blocks are compared by a z-test with
the variance between seeds. Usage: mitsuba_cornell.py TALBOT SCENE.gltf [--size N] [--spp N] [--seeds N] [--depth N] [--json FILE]
Exit code 0: they agree; 1: they do not; 77: Mitsuba is not installed (pip install mitsuba), nothing was compared.
"""
import argparse
import json
import math
import pathlib
import subprocess
import sys
import tempfile

try:
    import mitsuba as mi
    import numpy as np
except ImportError as error:
    print(f"SKIPPED: {error}; install with: pip install mitsuba numpy")
    sys.exit(77)

BLOCK = 8
Z_LIMIT = 4.5
MEAN_LIMIT = 0.003


class Gltf:
    """The few parts of glTF that the scene uses: meshes of triangles, translated nodes, Lambert and emissive materials."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        self.doc = json.loads(self.path.read_text())
        self.buffers = [(self.path.parent / b["uri"]).read_bytes() for b in self.doc["buffers"]]

    def accessor(self, index):
        a = self.doc["accessors"][index]
        view = self.doc["bufferViews"][a["bufferView"]]
        kind = {5126: np.float32, 5125: np.uint32, 5123: np.uint16}[a["componentType"]]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[a["type"]]
        start = view.get("byteOffset", 0) + a.get("byteOffset", 0)
        data = np.frombuffer(self.buffers[view["buffer"]], kind, a["count"] * width, start)
        return data.reshape(a["count"], width)


def mitsuba_scene(gltf, size, depth):
    scene = {"type": "scene", "integrator": {"type": "path", "max_depth": depth + 1, "rr_depth": 10000, "hide_emitters": False}}
    for node in gltf.doc["nodes"]:
        if "camera" in node:
            camera = gltf.doc["cameras"][node["camera"]]["perspective"]
            eye = np.array(node.get("translation", [0, 0, 0]), float)
            x, y, z, w = node.get("rotation", [0, 0, 0, 1])
            forward = -np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
            scene["sensor"] = {
                "type": "perspective", "fov": math.degrees(camera["yfov"]), "fov_axis": "y",
                "to_world": mi.ScalarTransform4f().look_at(eye.tolist(), (eye + forward).tolist(), [0, 1, 0]),
                "film": {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}, "pixel_format": "rgb",
                         "component_format": "float32"},
                "sampler": {"type": "independent"}}
        if "mesh" not in node:
            continue
        for k, primitive in enumerate(gltf.doc["meshes"][node["mesh"]]["primitives"]):
            positions = gltf.accessor(primitive["attributes"]["POSITION"]) + np.array(node.get("translation", [0, 0, 0]), np.float32)
            faces = gltf.accessor(primitive["indices"]).reshape(-1, 3).astype(np.uint32)
            material = gltf.doc["materials"][primitive["material"]]
            color = material["pbrMetallicRoughness"]["baseColorFactor"][:3]
            bsdf = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": color}}}
            with tempfile.NamedTemporaryFile(suffix=".ply", delete=False) as file:
                name = file.name
            mesh = mi.Mesh("mesh", len(positions), len(faces))
            params = mi.traverse(mesh)
            params["vertex_positions"] = positions.ravel()
            params["faces"] = faces.ravel()
            params.update()
            mesh.write_ply(name)
            shape = {"type": "ply", "filename": name, "face_normals": True, "bsdf": bsdf}
            if any(material.get("emissiveFactor", [0, 0, 0])):
                strength = material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"]
                radiance = [c * strength for c in material["emissiveFactor"]]
                shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": radiance}}
            scene[f"{node['name'].replace(' ', '_')}_{k}"] = shape
    return mi.load_dict(scene)


def read_pfm(path):
    with open(path, "rb") as file:
        assert file.readline().strip() == b"PF"
        width, height = map(int, file.readline().split())
        scale = float(file.readline())
        data = np.frombuffer(file.read(), "<f4" if scale < 0 else ">f4").reshape(height, width, 3)
    return data[::-1].astype(np.float64)


def blocks(image):
    h, w, _ = image.shape
    return image.reshape(h // BLOCK, BLOCK, w // BLOCK, BLOCK, 3).mean((1, 3, 4))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("talbot")
    parser.add_argument("scene")
    parser.add_argument("--size", type=int, default=128)
    parser.add_argument("--spp", type=int, default=256)
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--depth", type=int, default=8)
    parser.add_argument("--json")
    args = parser.parse_args()
    mi.set_variant("scalar_rgb")
    scene = mitsuba_scene(Gltf(args.scene), args.size, args.depth)
    theirs, ours = [], []
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(args.seeds):
            theirs.append(blocks(np.array(mi.render(scene, spp=args.spp, seed=seed), np.float64)))
            out = f"{folder}/{seed}.pfm"
            subprocess.run([args.talbot, args.scene, "--frames", str(args.spp), "--size", f"{args.size}x{args.size}", "--seed",
                            str(seed), "--max-depth", str(args.depth), "--output", out], check=True)
            ours.append(blocks(read_pfm(out)))
    theirs, ours = np.array(theirs), np.array(ours)
    n = args.seeds
    difference = ours.mean(0) - theirs.mean(0)
    # Few seeds give a poor variance per block, so it is pooled over blocks of like brightness: var = c mean^2 + d.
    variance = (ours.var(0, ddof=1) + theirs.var(0, ddof=1)) / n
    brightness = theirs.mean(0)
    design = np.stack([brightness.ravel() ** 2, brightness.ravel()], 1)
    fit, *_ = np.linalg.lstsq(design, variance.ravel(), rcond=None)
    pooled = np.maximum(np.maximum(design @ fit, 0).reshape(variance.shape), variance)
    lit = brightness > 1e-3 * brightness.max()
    z = np.where(lit, difference / np.sqrt(np.maximum(pooled, 1e-30)), 0)
    ratio = ours.mean() / theirs.mean()
    result = {"mitsuba": mi.__version__, "size": args.size, "spp": args.spp, "seeds": n, "blocks": int(z.size),
              "max_abs_z": float(np.abs(z).max()), "rms_z": float(np.sqrt((z[lit] ** 2).mean())), "mean_ratio": float(ratio)}
    print(json.dumps(result, indent=2))
    if args.json:
        pathlib.Path(args.json).write_text(json.dumps(result, indent=2))
    good = np.abs(z).max() <= Z_LIMIT and abs(ratio - 1) <= MEAN_LIMIT
    print("AGREE" if good else "DISAGREE")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
