#!/usr/bin/env python3
"""Compares converged images of Talbot and Mitsuba 3 (scalar_rgb or llvm_ad_rgb), block by block.

The scenes are glTF files whose materials are replaced, for both programs, by ones that both define alike: see VARIANTS. Several
seeds of each give the means of 8x8 blocks and their variance. A scene agrees where 95 % of its blocks differ by less than 1 %,
or by no more than noise explains (z below 4.5), and the mean by less than 0.3 %.
Usage: mitsuba_agreement.py TALBOT [SCENE.gltf[:VARIANT]...] [--scenes DIR] [--scale S] [--spp N] [--seeds N] [--events N]
[--variant NAME] [--json FILE] [--quick]. Exit code 0: all agree; 1: one does not; 77: Mitsuba is not installed (pip install
mitsuba), nothing was compared.
"""
import argparse
import copy
import json
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

from cycles_compare import read_pfm
from gltf_arrays import Gltf

BLOCK = 8
Z_LIMIT = 4.5
RELATIVE_LIMIT = 0.01
SHARE_LIMIT = 0.95
MEAN_LIMIT = 0.003


def plain(material):
    """What both programs share of a material: emission, colour and its texture."""
    kept = {k: material[k] for k in ("name", "emissiveFactor", "doubleSided") if k in material}
    strength = material.get("extensions", {}).get("KHR_materials_emissive_strength")
    kept["extensions"] = {"KHR_materials_specular": {"specularFactor": 0}}
    if strength:
        kept["extensions"]["KHR_materials_emissive_strength"] = strength
    pbr = material.get("pbrMetallicRoughness", {})
    kept["pbrMetallicRoughness"] = {"metallicFactor": 0, "roughnessFactor": 1,
                                    "baseColorFactor": pbr.get("baseColorFactor", [1, 1, 1, 1])}
    if "baseColorTexture" in pbr:  # Mitsuba's has no factor
        kept["pbrMetallicRoughness"].update(baseColorTexture=pbr["baseColorTexture"], baseColorFactor=[1, 1, 1, 1])
    return kept


def is_lamp(material):
    return any(material.get("emissiveFactor", [0, 0, 0]))


def is_lambert(material):
    return material.get("extensions", {}).get("KHR_materials_specular", {}).get("specularFactor", 1) == 0


def replaced(material, roughness=None, glass=False):
    """A white metal of that roughness, or clear glass; walls and lamps stay Lambert."""
    if is_lamp(material) or is_lambert(material):
        return plain(material)
    if glass:
        return {"name": material.get("name", ""), "doubleSided": False,
                "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0},
                "extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}, "KHR_materials_ior": {"ior": 1.5},
                               "KHR_materials_volume": {"thicknessFactor": 1}}}
    return {"name": material.get("name", ""), "doubleSided": True,
            "pbrMetallicRoughness": {"metallicFactor": 1, "roughnessFactor": roughness}}


# Rough metal stays below 0.3, where the light that Talbot gives back to multiple scattering is below 0.1 %.
VARIANTS = {
    "lambert": plain,
    "mirror": lambda m: replaced(m, roughness=0),
    "metal": lambda m: replaced(m, roughness=0.3),
    "glass": lambda m: replaced(m, glass=True),
}


def write_variant(scene, variant, folder):
    """The scene with its materials replaced, beside its buffers and images."""
    gltf = Gltf(scene)
    doc = copy.deepcopy(gltf.doc)
    doc["materials"] = [VARIANTS[variant](m) for m in doc["materials"]]
    used = sorted({name for m in doc["materials"] for name in m.get("extensions", {})})
    doc["extensionsUsed"] = used
    for entry in doc["buffers"] + doc.get("images", []):
        source = gltf.path.parent / entry["uri"]
        (folder / source.name).write_bytes(source.read_bytes())
        entry["uri"] = source.name
    file = folder / f"{gltf.path.stem}-{variant}.gltf"
    file.write_text(json.dumps(doc))
    return file


def blocks(image):
    h, w = image.shape[0] // BLOCK * BLOCK, image.shape[1] // BLOCK * BLOCK
    return image[:h, :w].reshape(h // BLOCK, BLOCK, w // BLOCK, BLOCK, 3).mean((1, 3, 4))


def compare(args, file, folder):
    from mitsuba_scene import mitsuba_scene
    gltf = Gltf(file)
    width, height = gltf.size(args.scale)
    width, height = max(BLOCK, width // BLOCK * BLOCK), max(BLOCK, height // BLOCK * BLOCK)
    scene = mitsuba_scene(gltf, width, height, args.events)
    theirs, ours = [], []
    for seed in range(args.seeds):
        theirs.append(blocks(np.array(mi.render(scene, spp=args.spp, seed=seed), np.float64)))
        out = folder / "image.pfm"
        subprocess.run([args.talbot, file, "--frames", str(args.spp), "--size", f"{width}x{height}", "--seed", str(seed),
                        "--max-depth", str(args.events), "--output", out, "--quiet"], check=True)
        ours.append(blocks(read_pfm(out)))
    theirs, ours = np.array(theirs), np.array(ours)
    difference = ours.mean(0) - theirs.mean(0)
    brightness = theirs.mean(0)
    # Few seeds give a poor variance per block, so it is pooled over blocks of like brightness: var = c mean^2 + d mean.
    variance = (ours.var(0, ddof=1) + theirs.var(0, ddof=1)) / args.seeds
    design = np.stack([brightness.ravel() ** 2, brightness.ravel()], 1)
    fit, *_ = np.linalg.lstsq(design, variance.ravel(), rcond=None)
    pooled = np.maximum(np.maximum(design @ fit, 0).reshape(variance.shape), variance)
    lit = brightness > 1e-3 * brightness.max()
    relative = np.abs(difference[lit]) / brightness[lit]
    z = difference[lit] / np.sqrt(np.maximum(pooled[lit], 1e-30))
    worst = np.unravel_index(np.argmax(np.where(lit, np.abs(difference) / np.sqrt(np.maximum(pooled, 1e-30)), 0)), lit.shape)
    ratio = float(ours.mean() / theirs.mean())
    close = float((relative < RELATIVE_LIMIT).mean())
    explained = float(((relative < RELATIVE_LIMIT) | (np.abs(z) < Z_LIMIT)).mean())
    return {"size": [width, height], "spp": args.spp, "seeds": args.seeds, "blocks": int(z.size), "within_1_percent": close,
            "within_1_percent_or_noise": explained, "noise_percent": float(100 * np.median(np.sqrt(pooled[lit]) / brightness[lit])),
            "rms_z": float(np.sqrt((z ** 2).mean())), "max_abs_z": float(np.abs(z).max()), "worst_block": [int(worst[1]), int(worst[0])],
            "mean_ratio": ratio, "agrees": explained >= SHARE_LIMIT and abs(ratio - 1) <= MEAN_LIMIT}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("talbot")
    parser.add_argument("scene", nargs="*")
    parser.add_argument("--scenes", help="a folder: its .gltf files with separate buffers, each in all variants that change it")
    parser.add_argument("--scale", type=float, default=0.25)
    parser.add_argument("--spp", type=int, default=256)
    parser.add_argument("--seeds", type=int, default=6)
    parser.add_argument("--events", type=int, default=8, help="scattering events of a path")
    parser.add_argument("--variant", default="scalar_rgb", help="of Mitsuba")
    parser.add_argument("--quick", action="store_true", help="few samples of small images")
    parser.add_argument("--json")
    args = parser.parse_args()
    if args.quick:
        args.scale, args.spp, args.seeds = 0.125, 32, 3
    mi.set_variant(args.variant)
    jobs = [(scene.partition(":")[0], scene.partition(":")[2] or "lambert") for scene in args.scene]
    if args.scenes:
        for file in sorted(pathlib.Path(args.scenes).glob("*.gltf")):
            if "uri\": \"data:" in file.read_text():
                continue
            shiny = any(not is_lambert(m) and not is_lamp(m) for m in Gltf(file).doc["materials"])
            jobs += [(str(file), variant) for variant in (VARIANTS if shiny else ["lambert"])]
    results = {}
    print("| scene | within 1 % | or noise | noise of a block | rms z | max z | mean ratio | |\n|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        for scene, variant in jobs:
            file = write_variant(scene, variant, pathlib.Path(name))
            r = results[file.stem] = compare(args, file, pathlib.Path(name))
            print(f"| {file.stem} | {100 * r['within_1_percent']:.1f} % | {100 * r['within_1_percent_or_noise']:.1f} % | "
                  f"{r['noise_percent']:.2f} % | {r['rms_z']:.2f} | {r['max_abs_z']:.1f} | {r['mean_ratio']:.4f} | "
                  f"{'agrees' if r['agrees'] else 'DISAGREES'} |", flush=True)
            if args.json:
                pathlib.Path(args.json).write_text(json.dumps({"mitsuba": mi.__version__, "scenes": results}, indent=1))
    return 0 if results and all(r["agrees"] for r in results.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
