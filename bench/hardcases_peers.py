#!/usr/bin/env python3
"""Image cases of `talbot hardcases` through other renderers: Talbot, Cycles (Debian's blender) and Mitsuba 3 (pip install mitsuba).

One scene of diffuse surfaces is scaled, moved and mirrored, camera and lamp included, which should change nothing; each renderer is
held against its own picture of the scene as it is, with the same seed, and against its own noise (another seed). So no renderer is
asked to agree with another. The transform stands where files have it: in the nodes' translation and scale, in double. Small scenes
(hardcases_peers_scenes.py) ask for thin gaps, the edge of the shadow on a coarse mesh, and huge and distant spheres, against a
picture by the same renderer that has no such difficulty.
Usage: hardcases_peers.py TALBOT SCENE.gltf [--size N] [--spp N] [--bounces N] [--threads N] [--quick] [--json FILE]
Renderers that are not installed are named and left out.
"""
import argparse
import copy
import importlib.util
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import numpy as np

import hardcases_peers_scenes as scenes
from cycles_compare import read_pfm
from gltf_arrays import matrix_of

# Name, scale, shift in metres along (1, -1, 1).
CASES = [
    ("scaled by 2^-20", 2.0 ** -20, 0), ("scaled by 2^20", 2.0 ** 20, 0), ("scaled by 1e-3", 1e-3, 0), ("scaled by 1e-5", 1e-5, 0),
    ("scaled by 1e5", 1e5, 0), ("moved by 100 m", 1, 1e2), ("moved by 1 km", 1, 1e3), ("moved by 100 km", 1, 1e5),
    ("moved by 1e7 m", 1, 1e7),
]
QUICK = ("scaled by 2^-20", "moved by 1 km")
MIRRORED = "mirrored"  # other random numbers: only the mean can be the same


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
        self.smooth = False  # whether vertex normals count

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

    def mirrored(self):
        """Across x = 0; the camera looks along z, so that its picture is mirrored, too."""
        doc = self.placed(1, 0)
        for node in doc["nodes"]:
            node["translation"][0] *= -1
            if "camera" not in node:
                node["scale"][0] *= -1
        return doc

    def write(self, folder, doc):
        for buffer in doc.get("buffers", []):
            target = folder / buffer["uri"]
            if not target.exists():
                shutil.copy(self.path.parent / buffer["uri"], target)
        file = folder / "placed.gltf"
        file.write_text(json.dumps(doc))
        return file


class Talbot:
    name = "Talbot"
    spheres = True

    def __init__(self, args):
        self.args = args
        words = subprocess.run([args.talbot, "--version"], capture_output=True, text=True).stdout.split()
        self.version = next((w for w in words if w[0].isdigit()), "")

    def render(self, scene, folder, doc, seed):
        file = scene.write(folder, doc)
        image = folder / "talbot.pfm"
        subprocess.run([self.args.talbot, file, "--frames", str(self.args.spp), "--threads", str(self.args.threads), "--seed",
                        str(seed), "--max-depth", str(self.args.bounces + 1), "--output", image, "--quiet"], check=True)
        return read_pfm(image)


class Cycles:
    name = "Cycles"
    spheres = False  # but as point clouds, which no file brings

    def __init__(self, args):
        self.args = args
        if not shutil.which("blender"):
            raise ImportError("blender is not installed (apt-get install blender)")
        self.version = ""

    def render(self, scene, folder, doc, seed):
        file = scene.write(folder, doc)
        image = folder / "cycles.pfm"
        script = pathlib.Path(__file__).with_name("cycles_scene.py")
        done = subprocess.run(["blender", "-b", "--factory-startup", "-P", script, "--", file, str(self.args.spp),
                               str(self.args.threads), str(self.args.bounces), image, str(seed)], check=True, capture_output=True,
                              text=True)
        self.version = json.loads(re.search(r"^\{.*\}$", done.stdout, re.M).group(0))["cycles"]
        return read_pfm(image)


class Mitsuba:
    name = "Mitsuba 3"
    spheres = True

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

    def bsdf(self, material):
        color = {"type": "rgb", "value": material["pbrMetallicRoughness"]["baseColorFactor"][:3]}
        return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": color}}

    def shape(self, scene, node, primitive, folder, name):
        mi = self.mi
        attributes = primitive["attributes"]
        positions = self.accessor(scene, attributes["POSITION"])
        faces = self.accessor(scene, primitive["indices"]).reshape(-1, 3).astype(np.uint32)
        smooth = scene.smooth and "NORMAL" in attributes
        mesh = mi.Mesh(name, len(positions), len(faces), has_vertex_normals=smooth)
        params = mi.traverse(mesh)
        params["vertex_positions"] = positions.ravel()
        params["faces"] = faces.ravel()
        if smooth:
            params["vertex_normals"] = self.accessor(scene, attributes["NORMAL"]).ravel()
        params.update()
        mesh.write_ply(str(folder / f"{name}.ply"))
        material = scene.doc["materials"][primitive["material"]]
        place = mi.ScalarTransform4f().translate(node["translation"]).scale(node["scale"])
        shape = {"type": "ply", "filename": str(folder / f"{name}.ply"), "face_normals": not smooth, "to_world": place,
                 "bsdf": self.bsdf(material)}
        if any(material.get("emissiveFactor", [0, 0, 0])):
            strength = material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"]
            radiance = [c * strength for c in material["emissiveFactor"]]
            shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": radiance}}
        return shape

    def sensor(self, doc, node):
        size, lens = doc["cameras"][0]["extras"]["resolution"][0], doc["cameras"][0]["perspective"]
        to_world = matrix_of(node) @ np.diag([-1.0, 1, -1, 1])  # it looks along +z, its x points left
        return {"type": "perspective", "fov": float(np.degrees(lens["yfov"])), "fov_axis": "y", "near_clip": lens["znear"],
                "far_clip": lens["zfar"], "to_world": self.mi.ScalarTransform4f(to_world),
                "film": {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}, "pixel_format": "rgb",
                         "component_format": "float32"},
                "sampler": {"type": "independent"}}

    def render(self, scene, folder, doc, seed):
        mi = self.mi
        out = {"type": "scene", "integrator": {"type": "path", "max_depth": self.args.bounces + 1, "rr_depth": 10000}}
        for number, node in enumerate(doc["nodes"]):
            extensions = node.get("extensions", {})
            if "camera" in node:
                out["sensor"] = self.sensor(doc, node)
            if "mesh" in node:
                for k, primitive in enumerate(doc["meshes"][node["mesh"]]["primitives"]):
                    name = f"shape_{number}_{k}"
                    out[name] = self.shape(scene, node, primitive, folder, name)
            if "KHR_lights_punctual" in extensions:
                light = doc["extensions"]["KHR_lights_punctual"]["lights"][extensions["KHR_lights_punctual"]["light"]]
                along = -matrix_of(node)[:3, 2]
                out[f"light_{number}"] = {"type": "directional", "direction": along.tolist(),
                                          "irradiance": {"type": "rgb", "value": light["intensity"]}}
            if scenes.SURFACE in extensions:
                surface = extensions[scenes.SURFACE]
                radius = doc["extensions"][scenes.SHAPES]["shapes"][surface["shape"]]["sphere"]["radius"]
                out[f"sphere_{number}"] = {"type": "sphere", "center": node["translation"], "radius": radius,
                                           "bsdf": self.bsdf(doc["materials"][surface["material"]])}
        return np.array(mi.render(mi.load_dict(out), spp=self.args.spp, seed=seed), float)


def attempt(rows, renderer, name, figures):
    """Adds what figures() gives, or why the renderer has none."""
    row = {"case": name, "renderer": renderer.name}
    try:
        row.update(figures())
    except (subprocess.CalledProcessError, RuntimeError) as error:
        row["failed"] = str(error).splitlines()[0]
    rows.append(row)


def measure(renderer, scene, cases, folder):
    base = renderer.render(scene, folder, scene.placed(1, 0), 0)
    noise = relmse(renderer.render(scene, folder, scene.placed(1, 0), 1), base) / 2
    rows = []

    def against(doc, flip):
        image = renderer.render(scene, folder, doc, 0)
        if flip:
            image = image[:, ::-1]
        return {"relmse": relmse(image, base), "noise_relmse": noise, "mean_ratio": float(np.nanmean(image) / np.mean(base)),
                "same": bool(np.array_equal(image, base)), "black_pixels": int(np.sum(np.all(image == 0, axis=2))),
                "not_finite": int(np.sum(~np.isfinite(image)))}

    for name, scale, shift in cases:
        attempt(rows, renderer, name, lambda: against(scene.placed(scale, shift), False))
    attempt(rows, renderer, MIRRORED, lambda: against(scene.mirrored(), True))
    return rows


# A figure of two pictures by one renderer.
def leaked(image, open_lamp):
    return float(np.nanmean(image) / np.mean(open_lamp))


def rms_in_disc(image, fine):
    """Within nine tenths of the ball's radius, where a coarse outline plays no part; over the mean there."""
    n = image.shape[0]
    y, x = np.mgrid[0:n, 0:n]
    half = 1 / (math.sqrt(8 ** 2 - 1) * math.tan(0.15))  # of the ball, in half pictures
    disc = np.hypot(2 * (x + 0.5) / n - 1, 2 * (y + 0.5) / n - 1) < 0.9 * half
    return float(np.sqrt(np.mean((image[disc] - fine[disc]) ** 2)) / np.mean(fine[disc]))


def rms(image, reference):
    return float(np.sqrt(np.nanmean((image - reference) ** 2)) / np.mean(reference))


# Name, scene, the same without the difficulty, figure, whether it needs analytic spheres.
PROBES = [(f"lamp behind a black sheet {gap:g} m away: light that comes through", lambda size, gap=gap: scenes.covered_lamp(size, gap),
           lambda size: scenes.covered_lamp(size, None), leaked, False) for gap in (1e-3, 1e-4, 1e-5, 1e-6)]
PROBES += [(f"ball of 8 x 16 faces, sun {90 - e} degrees from the zenith: RMS against 128 x 256",
            lambda size, e=e: scenes.lit_ball(size, 8, e), lambda size, e=e: scenes.lit_ball(size, 128, e), rms_in_disc, False)
           for e in (30, 5)]
PROBES += [(f"ground, a sphere of radius {r:g} m: RMS against a plane", lambda size, r=r: scenes.ground(size, r),
            lambda size: scenes.ground(size, None), rms, True) for r in (1e5, 1e6, 1e7)]
PROBES += [(f"sphere {d:g} radii away: RMS against 1e3", lambda size, d=d: scenes.distant_ball(size, d),
            lambda size: scenes.distant_ball(size, 1e3), rms, True) for d in (1e5, 1e7)]


def probe(renderer, size, probes, folder):
    rows, plain = [], {}

    def picture(make, name):
        file = make(size).write(folder / f"{name}.gltf")
        scene = Scene(file, size)
        scene.smooth = True
        return renderer.render(scene, folder, scene.doc, 0)

    for number, (name, hard, easy, figure, needs_spheres) in enumerate(probes):
        if needs_spheres and not renderer.spheres:
            continue

        def figures():
            key = json.dumps(easy(size).doc)
            if key not in plain:
                plain[key] = picture(easy, f"easy_{number}")
            return {"figure": figure(picture(hard, f"hard_{number}"), plain[key])}

        attempt(rows, renderer, name, figures)
    return rows


def cell(row):
    if row is None:
        return "-"
    if "failed" in row:
        return "failed"
    if "figure" in row:
        return "0" if row["figure"] == 0 else f"{100 * row['figure']:.3g} %"
    if row["case"] == MIRRORED:
        return f"mean {100 * (row['mean_ratio'] - 1):+.1f} %"
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
    probes = PROBES[1::4] if args.quick else PROBES
    renderers, rows = [], []
    for kind in (Talbot, Cycles, Mitsuba):
        try:
            renderers.append(kind(args))
        except ImportError as error:
            print(f"left out: {kind.name}: {error}", file=sys.stderr)
    with tempfile.TemporaryDirectory() as folder:
        for renderer in renderers:
            rows += measure(renderer, scene, cases, pathlib.Path(folder))
            rows += probe(renderer, args.size, probes, pathlib.Path(folder))
    print("| case | " + " | ".join(f"{r.name} {r.version}".strip() for r in renderers) + " |")
    print("|---|" + "---|" * len(renderers))
    for name in [c[0] for c in cases] + [MIRRORED] + [p[0] for p in probes]:
        by = {row["renderer"]: row for row in rows if row["case"] == name}
        print(f"| {name} | " + " | ".join(cell(by.get(r.name)) for r in renderers) + " |")
    if args.json:
        record = {"scene": args.scene, "size": args.size, "spp": args.spp, "bounces": args.bounces,
                  "versions": {r.name: r.version for r in renderers}, "rows": rows}
        pathlib.Path(args.json).write_text(json.dumps(record, indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
