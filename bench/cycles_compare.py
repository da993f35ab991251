#!/usr/bin/env python3
"""Talbot against Cycles on one glTF scene, in turn in one run: samples per second, and error per sample.

Neither needs a reference: two renders a and b of different seeds have independent errors, so mean (a - b)^2 / (2 (r^2 + 0.01))
with r = (a + b) / 2 estimates relMSE of one of them (r in the denominator is itself noisy, alike for both programs).
Usage: cycles_compare.py TALBOT SCENE.gltf [--spp N] [--threads N] [--bounces N] [--rounds N] [--json FILE]
Exit code 77: Blender is not installed, nothing was compared.
"""
import argparse
import json
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

import numpy as np


def read_pfm(path):
    with open(path, "rb") as file:
        assert file.readline().strip() == b"PF"
        width, height = map(int, file.readline().split())
        little = float(file.readline()) < 0
        data = np.fromfile(file, "<f4" if little else ">f4", width * height * 3)
    return data.reshape(height, width, 3)[::-1].astype(float)


def relmse(a, b):
    r = (a + b) / 2
    return float(np.mean((a - b) ** 2 / (2 * (r * r + 0.01))))


def talbot(args, folder, seed):
    image, report = folder / f"talbot{seed}.pfm", folder / "report.json"
    subprocess.run([args.talbot, args.scene, "--frames", str(args.spp), "--threads", str(args.threads), "--max-depth",
                    str(args.bounces + 1), "--seed", str(seed), "--output", image, "--report", report, "--quiet"], check=True)
    return json.loads(report.read_text())["samples_per_second"], read_pfm(image)


def cycles(args, folder, seed):
    image = folder / f"cycles{seed}.pfm"
    script = pathlib.Path(__file__).with_name("cycles_scene.py")
    done = subprocess.run(["blender", "-b", "--factory-startup", "-P", script, "--", args.scene, str(args.spp), str(args.threads),
                           str(args.bounces), image, str(seed)], check=True, capture_output=True, text=True)
    figures = json.loads(re.search(r"^\{.*\}$", done.stdout, re.M).group(0))
    return figures["samples_per_second"], read_pfm(image), figures["cycles"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("talbot")
    parser.add_argument("scene")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--bounces", type=int, default=8)
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--quick", action="store_true", help="4 samples a pixel")
    parser.add_argument("--json")
    args = parser.parse_args()
    if args.quick:
        args.spp = 4
    if not shutil.which("blender"):
        print("SKIPPED: Blender is not installed (apt-get install blender), NOTHING WAS COMPARED")
        return 77
    rates = {"talbot": [], "cycles": []}
    images = {"talbot": [], "cycles": []}
    version = ""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for seed in range(max(2, args.rounds)):
            rate, image = talbot(args, folder, seed)
            rates["talbot"].append(rate)
            images["talbot"].append(image)
            rate, image, version = cycles(args, folder, seed)
            rates["cycles"].append(rate)
            images["cycles"].append(image)
    errors = {name: relmse(*pair[:2]) for name, pair in images.items()}
    means = {name: float(np.mean(pair)) for name, pair in images.items()}
    figures = {"scene": args.scene, "spp": args.spp, "threads": args.threads, "bounces": args.bounces, "cycles": version,
               "samples_per_second": rates, "rate_ratio": statistics.median(rates["talbot"]) / statistics.median(rates["cycles"]),
               "relmse": errors, "relmse_ratio": errors["talbot"] / errors["cycles"], "mean": means}
    print("| program | Msamples/s | relMSE at {} spp | mean |\n|---|---|---|---|".format(args.spp))
    for name in ("talbot", "cycles"):
        print("| {} | {} | {:.5f} | {:.5f} |".format(name, " ".join(f"{r / 1e6:.2f}" for r in rates[name]), errors[name],
                                                       means[name]))
    print(f"rate ratio {figures['rate_ratio']:.2f}, error ratio {figures['relmse_ratio']:.2f}")
    if args.json:
        pathlib.Path(args.json).write_text(json.dumps(figures, indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
