#!/usr/bin/env python3
"""What each unbiased switch of the estimator is worth: error times seconds of each setting against the default's.

All settings have the same expected image, so the mean of all their renders is the reference, and the variance between seeds the
error: relMSE as everywhere, of one render of --spp samples a pixel. Seconds are CPU seconds of sampling, so that other programs
on the machine matter little; a render of one pass of the same setting takes loading out. Settings take turns, seed by seed.
Work is relMSE x seconds over that of the default: above 1 where the switch loses, by that much more time for the same error.
Usage: estimators.py TALBOT [SCENE.gltf...] [--scenes DIR] [--environment FILE.hdr] [--size-scale S] [--spp N] [--seeds N]
[--json FILE] [--markdown FILE] [--quick]. With --environment the last scene is measured once more under that image.
"""
import json
import os
import pathlib
import sys
import tempfile

import numpy as np

from child_clock import run_timed
from cycles_compare import read_pfm
from gltf_arrays import Gltf
from scene_arguments import scene_parser, scenes_of

SETTINGS = {
    "default": [],
    "--lights power": ["--lights", "power"],
    "--lights uniform": ["--lights", "uniform"],
    "--sampler independent": ["--sampler", "independent"],
    "--sampler stratified": ["--sampler", "stratified"],
    "--sampler halton": ["--sampler", "halton"],
    "--sampler zsobol": ["--sampler", "zsobol"],
    "--no-roulette": ["--no-roulette"],
    "--no-nee": ["--no-nee"],
}
UNDER_AN_IMAGE = {
    "--environment-sampling luminance": ["--environment-sampling", "luminance"],
    "--environment-sampling none": ["--environment-sampling", "none"],
}


def render(args, scene, options, spp, seed, folder):
    """(CPU seconds of the whole process, image)"""
    image = folder / "image.pfm"
    width, height = Gltf(scene).size(args.size_scale)
    # Without --report: its record measures what --max-depth removes, which takes longer than these renders.
    cpu, _ = run_timed([args.talbot, scene, "--frames", str(spp), "--seed", str(seed), "--size", f"{width}x{height}", "--threads",
                    str(args.threads), "--max-depth", "9", "--output", image, "--quiet", *options])
    return cpu, read_pfm(image)


def measure(args, scene, environment, folder):
    settings = {**SETTINGS, **(UNDER_AN_IMAGE if environment else {})}
    under = ["--environment", environment] if environment else []
    # Loading goes out with a short run of the same setting.
    short = {name: min(render(args, scene, under + options, 1, 77 + k, folder)[0] for k in range(2)) for name, options in settings.items()}
    images, seconds = {name: [] for name in settings}, {name: [] for name in settings}
    for seed in range(args.seeds):
        for name, options in settings.items():
            cpu, image = render(args, scene, under + options, args.spp, seed, folder)
            images[name].append(image)
            seconds[name].append((cpu - short[name]) * args.spp / (args.spp - 1))
    # Without light sampling the image is too noisy to add to the reference.
    reference = np.mean([np.mean(stack, 0) for name, stack in images.items() if name != "--no-nee"], 0)
    rows = {}
    for name, stack in images.items():
        variance = np.var(stack, axis=0, ddof=1)
        relmse = float(np.mean(variance / (reference ** 2 + 0.01)))
        ratios = [s / d for s, d in zip(seconds[name], seconds["default"])]
        rows[name] = {"relmse": relmse, "cpu_seconds": float(np.median(seconds[name])), "time_ratio": float(np.median(ratios))}
    for row in rows.values():
        row["error_ratio"] = row["relmse"] / rows["default"]["relmse"]
        row["work"] = row["error_ratio"] * row["time_ratio"]
    return rows


def table(results):
    names = [name for rows in results.values() for name in rows]
    lines = ["| setting | " + " | ".join(results) + " |", "|---" * (len(results) + 1) + "|"]
    for name in dict.fromkeys(names):
        cells = []
        for rows in results.values():
            row = rows.get(name)
            if row is None:
                cells.append("-")
            elif name == "default":
                cells.append(f"{100 * row['relmse'] ** 0.5:.1f} %")
            else:
                cells.append(f"{row['work']:.2f} ({row['error_ratio']:.2f} x {row['time_ratio']:.2f})")
        lines.append(f"| {name if name == 'default' else '`' + name + '`'} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def main():
    parser = scene_parser(__doc__, "small images, two seeds, 8 samples a pixel")
    parser.add_argument("--environment")
    parser.add_argument("--size-scale", type=float, default=0.25)
    parser.add_argument("--spp", type=int, default=32)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--markdown")
    args = parser.parse_args()
    if args.quick:
        args.size_scale, args.spp, args.seeds = 0.1, 8, 2
    scenes = scenes_of(args)
    results = {}
    with tempfile.TemporaryDirectory() as name:
        for scene in scenes:
            results[pathlib.Path(scene).stem] = measure(args, scene, None, pathlib.Path(name))
            if args.json:
                pathlib.Path(args.json).write_text(json.dumps({"load": os.getloadavg(), "scenes": results}, indent=1))
        if args.environment:
            key = f"{pathlib.Path(scenes[-1]).stem} in {pathlib.Path(args.environment).stem}"
            results[key] = measure(args, scenes[-1], args.environment, pathlib.Path(name))
    text = table(results)
    print(text)
    if args.json:
        pathlib.Path(args.json).write_text(json.dumps({"load": os.getloadavg(), "scenes": results}, indent=1))
    if args.markdown:
        pathlib.Path(args.markdown).write_text(text + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
