#!/usr/bin/env python3
"""What a promised error is worth: Talbot's --target-error and Cycles' noise threshold on the same scenes, each against its own
converged image.

Talbot is told an error in per cent and stops by itself; Cycles is told a noise threshold. Both end somewhere: the true relRMSE
(100 sqrt of the mean of (x - r)^2 / (r^2 + 0.01)) is measured against references of the same program with other seeds, whose own
variance is subtracted. Usage: accuracy_vs_cycles.py TALBOT [SCENE.gltf...] [--targets 10,5] [--thresholds 0.1,0.05] [--scale N]
[--threads N] [--seeds N] [--json FILE] [--quick]. Exit code 77: Blender is not installed, nothing was compared.
"""
import argparse
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np

from cycles_compare import read_pfm

REFERENCE_SEEDS = (1001, 1002)
CAP = 4096  # samples a pixel that neither may exceed


def relmse(image, reference, reference_variance):
    return float(np.mean(((image - reference) ** 2 - reference_variance) / (reference * reference + 0.01)))


def percent(value):
    return 100 * math.sqrt(max(value, 0.0))


def size_of(scene, scale):
    width, height = json.loads(pathlib.Path(scene).read_text())["cameras"][0].get("extras", {}).get("resolution", [512, 512])
    return max(1, round(width * scale)), max(1, round(height * scale))


def reference_of(images):
    mean = sum(images) / len(images)
    variance = sum((i - mean) ** 2 for i in images) / (len(images) - 1) / len(images)
    return mean, variance


class Talbot:
    name = "Talbot"

    def __init__(self, args, scene, folder):
        self.args, self.scene, self.folder = args, scene, folder
        width, height = size_of(scene, args.scale)
        self.words = [args.talbot, scene, "--size", f"{width}x{height}", "--threads", str(args.threads), "--max-depth", "9", "--quiet"]

    def run(self, seed, *end):
        image, report = self.folder / "talbot.pfm", self.folder / "talbot.json"
        subprocess.run([*self.words, "--seed", str(seed), *end, "--output", image, "--report", report], check=True)
        return read_pfm(image), json.loads(report.read_text())

    def reference(self):
        return reference_of([self.run(seed, "--frames", str(self.args.reference))[0] for seed in REFERENCE_SEEDS])

    def promised(self, target, seed):
        image, report = self.run(seed, "--target-error", str(target))
        error = report["error"]
        return image, {"samples": report["passes"], "seconds": report["seconds"]["render"], "stated": error["relrmse_percent"],
                       "lo95": error["lo95"], "hi95": error["hi95"], "trust": error["trust"]}


class Cycles:
    name = "Cycles"

    def __init__(self, args, scene, folder):
        self.args, self.scene, self.folder = args, scene, folder

    def run(self, seed, samples, threshold):
        image = self.folder / "cycles.pfm"
        script = pathlib.Path(__file__).with_name("cycles_threshold.py")
        done = subprocess.run(["blender", "-b", "--factory-startup", "-P", script, "--", self.scene, str(samples), str(threshold),
                               str(self.args.scale), str(self.args.threads), str(seed), image], capture_output=True, text=True)
        if done.returncode != 0 or not image.exists():
            raise SystemExit(f"blender failed on {self.scene}:\n{done.stdout[-1500:]}{done.stderr[-1500:]}")
        return read_pfm(image)

    def reference(self):
        return reference_of([self.run(seed, self.args.reference, 0) for seed in REFERENCE_SEEDS])

    def promised(self, threshold, seed):
        return self.run(seed, CAP, threshold), {}


def measure(program, promises, seeds):
    reference, variance = program.reference()
    rows = []
    for promise in promises:
        for seed in range(1, seeds + 1):
            image, row = program.promised(promise, seed)
            row.update(promise=promise, seed=seed, true=percent(relmse(image, reference, variance)),
                       brightness=100 * float(np.mean(image) / np.mean(reference) - 1))
            rows.append(row)
    return rows


def print_table(results):
    print("| scene | program | promise | true relRMSE | brightness |\n|---|---|---|---|---|")
    for scene, programs in results.items():
        for name, rows in programs.items():
            for promise in sorted({r["promise"] for r in rows}, reverse=True):
                same = [r for r in rows if r["promise"] == promise]
                asked = f"error {promise:g} %" if name == "Talbot" else f"threshold {promise:g}"
                lights = ", " + same[0]["trust"] if name == "Talbot" else ""
                true = " ".join(f"{r['true']:.2f} %" for r in same)
                print(f"| {scene} | {name} | {asked}{lights} | {true} | {sum(r['brightness'] for r in same) / len(same):+.2f} % |")
    print("\n| program | promise | true relRMSE from | to | ratio |\n|---|---|---|---|---|")
    for name in ("Talbot", "Cycles"):
        rows = [r for programs in results.values() for r in programs[name]]
        for promise in sorted({r["promise"] for r in rows}, reverse=True):
            true = [r["true"] for r in rows if r["promise"] == promise]
            print(f"| {name} | {promise:g} | {min(true):.2f} % | {max(true):.2f} % | {max(true) / max(min(true), 0.01):.1f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("talbot")
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--targets", default="10,5")
    parser.add_argument("--thresholds", default="0.1,0.05")
    parser.add_argument("--scale", type=float, default=0.25, help="of the resolution that the scene asks for")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--reference", type=int, default=4096, help="samples a pixel of each of the two reference renders")
    parser.add_argument("--quick", action="store_true", help="one target, small images and references")
    parser.add_argument("--json")
    args = parser.parse_args()
    if args.quick:
        args.targets, args.thresholds, args.scale, args.reference = "20", "0.2", 0.1, 256
    if not shutil.which("blender"):
        print("SKIPPED: Blender is not installed (apt-get install blender), NOTHING WAS COMPARED")
        return 77
    scenes = args.scenes or [str(pathlib.Path(__file__).resolve().parent.parent / "assets/scenes/cornell.gltf")]
    results = {}
    with tempfile.TemporaryDirectory() as name:
        for scene in scenes:
            programs = {}
            for kind, promises in ((Talbot, args.targets), (Cycles, args.thresholds)):
                programs[kind.name] = measure(kind(args, scene, pathlib.Path(name)), [float(p) for p in promises.split(",")], args.seeds)
            results[pathlib.Path(scene).stem] = programs
            if args.json:
                pathlib.Path(args.json).write_text(json.dumps(results, indent=1))
    print_table(results)
    return 0


if __name__ == "__main__":
    sys.exit(main())
