#!/usr/bin/env python3
"""Compares converged images of Talbot and Mitsuba 3, block by block.

A scene is rendered as it is, by Mitsuba with the plugin of gltf_bsdf.py, which follows glTF's texts; normal maps are left out.
With :VARIANT its materials are replaced, for both programs, by ones that Mitsuba's own models define alike: see VARIANTS. Several
seeds of each program give the means of 8x8 blocks and their noise. A scene agrees where 95 % of its blocks differ by less
than 1 % (sum over the channels of the differences over the sum of the values), or by no more than noise explains (z below 4.5),
and the mean by less than 0.3 %.
Usage: mitsuba_agreement.py TALBOT [SCENE.gltf[:VARIANT]...] [--scenes DIR] [--studio] [--environment FILE] [--native] [--size N]
[--spp N] [--seeds N] [--noise PCT] [--most N] [--events N] [--variant NAME] [--images DIR] [--json FILE] [--quick]. --studio adds
scenes of its own, one a material; --environment lights the last scene of all once more; --noise renders more seeds, up to --most,
until the differences of 95 % of the blocks are known to that (one standard error). Exit code 0: all agree; 1: one does not; 77: Mitsuba is not
installed (pip install mitsuba), nothing was compared.
"""
import copy
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

from cycles_compare import read_pfm
from gltf_arrays import Gltf
from scene_arguments import scene_parser, scenes_in

BLOCK = 8
Z_LIMIT = 4.5
RELATIVE_LIMIT = 0.01
SHARE_LIMIT = 0.95
MEAN_LIMIT = 0.003
ENOUGH_SEEDS = 8  # from here on a block's own variance is known well enough


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


def as_it_is(material):
    return {k: v for k, v in material.items() if k != "normalTexture"}


def write_variant(scene, variant, folder):
    """The scene with its materials replaced, beside its buffers and images."""
    gltf = Gltf(scene)
    doc = copy.deepcopy(gltf.doc)
    doc["materials"] = [VARIANTS.get(variant, as_it_is)(m) for m in doc["materials"]]
    used = sorted({name for m in doc["materials"] for name in m.get("extensions", {})} | set(doc.get("extensions", {})))
    doc["extensionsUsed"] = used
    for entry in doc["buffers"] + doc.get("images", []):
        source = gltf.path.parent / entry["uri"]
        (folder / source.name).write_bytes(source.read_bytes())
        entry["uri"] = source.name
    file = folder / (f"{gltf.path.stem}-{variant}.gltf" if variant else gltf.path.name)
    file.write_text(json.dumps(doc))
    return file


def blocks(image):
    h, w = image.shape[0] // BLOCK * BLOCK, image.shape[1] // BLOCK * BLOCK
    return image[:h, :w].reshape(h // BLOCK, BLOCK, w // BLOCK, BLOCK, 3).mean((1, 3))


def write_images(folder, name, ours, theirs):
    """Both images and their difference, red where Talbot is brighter, blue where it is darker, full at 5 %."""
    scale = 0.8 / max(np.percentile(theirs, 98), 1e-9)
    relative = smooth((ours - theirs).mean(2)) / np.maximum(smooth(theirs.mean(2)), 1e-3 / scale) / 0.05
    signed = 1 - np.stack([np.clip(-relative, 0, 1), np.clip(np.abs(relative), 0, 1), np.clip(relative, 0, 1)], -1)
    shown = np.concatenate([np.clip(ours * scale, 0, 1), np.clip(theirs * scale, 0, 1), signed ** 2.2], 1)
    shown = np.repeat(np.repeat(shown, 4, 0), 4, 1).astype(np.float32)
    mi.util.write_bitmap(str(pathlib.Path(folder) / f"{name}.png"), mi.Bitmap(shown), write_async=False)


def smooth(image):
    """Means of 4x4 neighbourhoods, spread over them."""
    h, w = (n // 4 * 4 for n in image.shape)
    return np.repeat(np.repeat(image[:h, :w].reshape(h // 4, 4, w // 4, 4).mean((1, 3)), 4, 0), 4, 1)


def image_size(args, gltf):
    """About args.size pixels wide: whole blocks, and exactly the shape of the scene's picture."""
    width, height = gltf.size(1)
    common = math.gcd(width, height)
    unit = BLOCK * width // common, BLOCK * height // common
    times = max(1, round(args.size / unit[0]))
    return times * unit[0], times * unit[1]


def compare(args, file, folder, oracle, environment):
    from mitsuba_scene import mitsuba_scene
    gltf = Gltf(file)
    width, height = image_size(args, gltf)
    scene = mitsuba_scene(gltf, width, height, args.events, oracle, environment, "multijitter")
    command = [args.talbot, file, "--frames", str(args.spp), "--size", f"{width}x{height}", "--max-depth", str(args.events), "--quiet"]
    command += ["--environment", environment] if environment else []
    ours, theirs = [], []
    while True:
        seed = len(ours)
        theirs.append(np.array(mi.render(scene, spp=args.spp, seed=seed), np.float64))
        out = folder / "image.pfm"
        subprocess.run(command + ["--seed", str(seed), "--output", out], check=True)
        ours.append(read_pfm(out))
        if len(ours) < args.seeds:
            continue
        result = judge(ours, theirs)
        if args.noise is None or result["noise_percent_95"] <= args.noise or len(ours) >= args.most:
            break
    if args.images:
        write_images(args.images, file.stem + ("-environment" if environment else ""), np.mean(ours, 0), np.mean(theirs, 0))
    return {"size": [width, height], "spp": args.spp, **result}


def judge(ours, theirs):
    """Agreement of some seeds' images of both programs."""
    seeds = len(ours)
    theirs, ours = (np.array([blocks(image) for image in images]) for images in (theirs, ours))
    brightness, difference = theirs.mean(0).mean(-1), ours.mean(0) - theirs.mean(0)
    # Few seeds give a poor variance per block, so it is pooled over blocks of like brightness: var = c mean^2 + d mean.
    variance = (ours.mean(-1).var(0, ddof=1) + theirs.mean(-1).var(0, ddof=1)) / seeds
    design = np.stack([brightness.ravel() ** 2, brightness.ravel()], 1)
    fit, *_ = np.linalg.lstsq(design, variance.ravel(), rcond=None)
    pooled = variance if seeds >= ENOUGH_SEEDS else np.maximum(np.maximum(design @ fit, 0).reshape(variance.shape), variance)
    lit = brightness > 1e-3 * brightness.max()
    relative = np.abs(difference).mean(-1)[lit] / brightness[lit]
    z = difference.mean(-1)[lit] / np.sqrt(np.maximum(pooled[lit], 1e-30))
    noise = np.sqrt(pooled[lit]) / brightness[lit]
    ratio = float(ours.mean() / theirs.mean())
    ratio_noise = float(np.sqrt(sum(a.mean((1, 2, 3)).var(ddof=1) / seeds for a in (ours, theirs))) / theirs.mean())
    explained = float(((relative < RELATIVE_LIMIT) | (np.abs(z) < Z_LIMIT)).mean())
    far = np.where(lit, np.abs(difference).mean(-1) / np.maximum(brightness, 1e-30), 0)
    worst = sorted(((float(far[y, x]), x, y) for y, x in np.argwhere(far > RELATIVE_LIMIT).tolist()), reverse=True)[:12]
    return {"seeds": seeds, "blocks": int(z.size),
            "within_1_percent": float((relative < RELATIVE_LIMIT).mean()), "within_1_percent_or_noise": explained,
            "noise_percent": float(100 * np.median(noise)), "noise_percent_95": float(100 * np.percentile(noise, 95)),
            "median_difference_percent": float(100 * np.median(relative)),
            "rms_z": float(np.sqrt((z ** 2).mean())), "max_abs_z": float(np.abs(z).max()), "mean_ratio": ratio,
            "mean_ratio_noise": ratio_noise, "worst_blocks": [[x, y, round(100 * d, 2)] for d, x, y in worst],
            "agrees": explained >= SHARE_LIMIT and abs(ratio - 1) <= MEAN_LIMIT + 3 * ratio_noise}


def jobs_of(args, folder):
    """(scene, variant, environment)"""
    jobs = [(scene.partition(":")[0], scene.partition(":")[2], None) for scene in args.scene]
    for file in scenes_in(args.scenes) if args.scenes else []:
        jobs.append((file, "", None))
        if args.native:
            shiny = any(not is_lambert(m) and not is_lamp(m) for m in Gltf(file).doc["materials"])
            jobs += [(file, variant, None) for variant in (VARIANTS if shiny else ["lambert"])]
    if args.studio:
        from agreement_scenes import write_scenes
        jobs += [(str(file), "", None) for file in write_scenes(folder)]
    if args.environment:
        jobs.append((jobs[-1][0], "", args.environment))
    return jobs


def main():
    parser = scene_parser(__doc__, "few samples of small images")
    parser.add_argument("--studio", action="store_true", help="scenes of its own, one a material")
    parser.add_argument("--native", action="store_true", help="the folder's scenes also in all VARIANTS that change them")
    parser.add_argument("--environment", help="an HDR image: the last scene once more")
    parser.add_argument("--size", type=int, default=96, help="pixels of a row")
    parser.add_argument("--spp", type=int, default=512)
    parser.add_argument("--seeds", type=int, default=6)
    parser.add_argument("--noise", type=float, help="per cent: more seeds until a block's difference is known to that")
    parser.add_argument("--most", type=int, default=48, help="seeds with --noise")
    parser.add_argument("--events", type=int, default=8, help="scattering events of a path")
    parser.add_argument("--variant", default="llvm_ad_rgb", help="of Mitsuba")
    parser.add_argument("--images", help="a folder for both images and their difference, of each scene")
    args = parser.parse_args()
    if args.quick:
        args.size, args.spp, args.seeds = 48, 64, 3
    mi.set_variant(args.variant)
    results = {}
    print("| scene | within 1 % | or noise | median difference | noise of a block | rms z | mean ratio | |\n|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name, tempfile.TemporaryDirectory() as own:
        for scene, variant, environment in jobs_of(args, own):
            file = write_variant(scene, variant, pathlib.Path(name))
            key = file.stem + (f" in {pathlib.Path(environment).stem}" if environment else "")
            r = results[key] = compare(args, file, pathlib.Path(name), not variant, environment)
            print(f"| {key} | {100 * r['within_1_percent']:.1f} % | {100 * r['within_1_percent_or_noise']:.1f} % | "
                  f"{r['median_difference_percent']:.2f} % | {r['noise_percent']:.2f} % | {r['rms_z']:.2f} | "
                  f"{r['mean_ratio']:.4f} +- {r['mean_ratio_noise']:.4f} | {'agrees' if r['agrees'] else 'DISAGREES'} |", flush=True)
            if args.json:
                pathlib.Path(args.json).write_text(json.dumps({"mitsuba": mi.__version__, "scenes": results}, indent=1))
    return 0 if results and all(r["agrees"] for r in results.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
