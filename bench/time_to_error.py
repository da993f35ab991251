#!/usr/bin/env python3
"""Seconds of sampling to relMSE 0.01, of Talbot, Cycles (Debian's blender) and Mitsuba 3, in turn in one run.

Every program is measured against its own converged image, with the same number of bounces and threads, no denoiser and no
clamping. relMSE of one render is the variance between renders of other seeds, per pixel and channel, over r^2 + 0.01, with r
the mean of all of them. A pilot finds the samples a pixel that come near the target; from there 1/N takes it to the target.
Seconds are of sampling alone, for the size that the scene asks for, though a share of it is rendered (--scale): CPU seconds of
all threads over their number, since wall-clock times of a machine that others use say more about them. The JSON file has both.
The programs take turns, and a ratio is the median over the rounds.
Usage: time_to_error.py TALBOT [SCENE.gltf...] [--scenes DIR] [--scale S] [--seeds N] [--most SPP] [--spp N] [--threads N] [--bounces N]
[--mitsuba PYTHON] [--without NAME,...] [--json FILE] [--quick]. PYTHON is an interpreter that has Mitsuba 3.
"""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import numpy as np

from child_clock import run_timed
from cycles_compare import read_pfm
from gltf_arrays import Gltf
from scene_arguments import scene_parser, scenes_of

HERE = pathlib.Path(__file__).resolve().parent
TARGET = 0.01
PILOT = 8
LEAST = 4


class Talbot:
    def __init__(self, args):
        self.args = args

    def run(self, scene, seed, spp, scale, folder):
        image = folder / "talbot.pfm"
        width, height = Gltf(scene).size(scale)
        # Cycles' count of bounces sees emission after one more scattering event. Without --report: its record measures what
        # --max-depth removes, which is no part of the picture.
        cpu, wall = run_timed([self.args.talbot, scene, "--frames", str(spp), "--size", f"{width}x{height}", "--threads",
                        str(self.args.threads), "--max-depth", str(self.args.bounces + 1), "--seed", str(seed), "--output", image,
                        "--quiet"])
        return width * height * spp, cpu, wall, read_pfm(image)

    def render(self, scene, seed, spp, scale, folder):
        # The difference of two lengths is sampling alone, as for the others.
        short, long = self.run(scene, seed, max(1, spp // 8), scale, folder), self.run(scene, seed, spp, scale, folder)
        samples = long[0] - short[0]
        return {"cpu": samples / (long[1] - short[1]) * self.args.threads, "wall": samples / (long[2] - short[2])}, long[3]


def run_script(command, name):
    done = subprocess.run(command, capture_output=True, text=True)
    figures = re.search(r"^\{.*\}$", done.stdout, re.M)
    if done.returncode != 0 or not figures:
        raise SystemExit(f"{name} failed:\n{done.stdout[-1500:]}{done.stderr[-1500:]}")
    run = json.loads(figures.group(0))
    return {"cpu": run["samples_per_cpu_second"] * run["threads"], "wall": run["samples_per_second"]}


class Cycles:
    def __init__(self, args):
        self.args = args

    def render(self, scene, seed, spp, scale, folder):
        image = folder / "cycles.pfm"
        rate = run_script(["blender", "-b", "--factory-startup", "-P", HERE / "cycles_scene.py", "--", scene, str(spp),
                           str(self.args.threads), str(self.args.bounces), image, str(seed), str(scale)], "blender")
        return rate, read_pfm(image)


class Mitsuba:
    def __init__(self, args, variant):
        self.args, self.variant = args, variant

    def render(self, scene, seed, spp, scale, folder):
        image = folder / "mitsuba.pfm"
        rate = run_script([self.args.mitsuba, HERE / "mitsuba_scene.py", self.variant, scene, str(spp), str(self.args.threads),
                           str(self.args.bounces + 1), str(seed), str(scale), image], "Mitsuba")
        return rate, read_pfm(image)


def relmse(images):
    stack = np.array(images)
    return float(np.mean(stack.var(0, ddof=1) / (stack.mean(0) ** 2 + 0.01)))


def samples_for_target(args, program, scene, folder):
    pilot = relmse([program.render(scene, 900 + seed, PILOT, args.scale, folder)[1] for seed in range(2)])
    wanted = PILOT * pilot / TARGET
    spp = LEAST
    while spp < args.most and spp < wanted:
        spp *= 2
    return spp


def measure(args, programs, scene, folder):
    """Renders of all programs in turn; the variance of a few brightest paths makes single figures rough."""
    spp = {name: args.spp or samples_for_target(args, program, scene, folder) for name, program in programs.items()}
    images = {name: [] for name in programs}
    rates = {name: [] for name in programs}
    for seed in range(args.seeds):
        for name, program in programs.items():
            rate, image = program.render(scene, seed, spp[name], args.scale, folder)
            rates[name].append(rate)
            images[name].append(image)
    width, height = Gltf(scene).size(1)
    rows = {}
    for name in programs:
        error = relmse(images[name])
        samples = width * height * spp[name] * error / TARGET
        seconds = {clock: [samples / rate[clock] for rate in rates[name]] for clock in ("cpu", "wall")}
        rows[name] = {"spp": spp[name], "relmse": error, "relmse_spp": error * spp[name], "mean": float(np.mean(images[name])),
                      "samples_per_second": float(np.median([rate["cpu"] for rate in rates[name]])),
                      "seconds": float(np.median(seconds["cpu"])), "rounds": seconds}
    ours = rows["Talbot"]["rounds"]
    for row in rows.values():
        for clock, name in (("cpu", "ratio"), ("wall", "wall_ratio")):
            row[name] = float(np.median([b / a for a, b in zip(ours[clock], row["rounds"][clock])]))
    return rows


def print_table(results, names):
    print("| scene | " + " | ".join(f"{n}: Msamples/s, relMSE x spp, seconds" for n in names) +
          " | ratio of seconds to Talbot's (by wall clock) |")
    print("|---" * (len(names) + 2) + "|")
    for scene, rows in results.items():
        cells = [f"{rows[n]['samples_per_second'] / 1e6:.2f}, {rows[n]['relmse_spp']:.3g}, {rows[n]['seconds']:.1f}" for n in names]
        ratios = [f"{rows[n]['ratio']:.1f} ({rows[n]['wall_ratio']:.1f})" for n in names[1:]]
        print(f"| {scene} | " + " | ".join(cells) + " | " + ", ".join(ratios) + " |")


def main():
    parser = scene_parser(__doc__, "small images, two seeds, at most 32 samples a pixel")
    parser.add_argument("--scale", type=float, default=0.5)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("--most", type=int, default=256, help="samples a pixel that are not exceeded")
    parser.add_argument("--spp", type=int, help="that many samples a pixel, without a pilot")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--bounces", type=int, default=8)
    parser.add_argument("--mitsuba", help="an interpreter that has Mitsuba 3; without it Mitsuba is left out")
    parser.add_argument("--without", default="", help="of Cycles, scalar_rgb, llvm_ad_rgb")
    args = parser.parse_args()
    if args.quick:
        args.scale, args.seeds, args.most = 0.15, 2, 32
    scenes = scenes_of(args)
    programs = {"Talbot": Talbot(args)}
    if shutil.which("blender"):
        programs["Cycles"] = Cycles(args)
    else:
        print("Blender is not installed (apt-get install blender): Cycles is left out", file=sys.stderr)
    if args.mitsuba:
        programs["scalar_rgb"] = Mitsuba(args, "scalar_rgb")
        programs["llvm_ad_rgb"] = Mitsuba(args, "llvm_ad_rgb")
    for name in filter(None, args.without.split(",")):
        programs.pop(name, None)
    results = {}
    loads = [os.getloadavg()[0]]
    with tempfile.TemporaryDirectory() as name:
        for scene in scenes:
            results[pathlib.Path(scene).stem] = measure(args, programs, scene, pathlib.Path(name))
            loads.append(os.getloadavg()[0])
            if args.json:
                pathlib.Path(args.json).write_text(json.dumps({"settings": vars(args), "load": loads, "scenes": results}, indent=1))
    print_table(results, list(programs))
    print(f"\nLoad of the machine while measuring: {min(loads):.1f} to {max(loads):.1f} ({os.cpu_count()} cores, {args.threads} threads).")
    return 0


if __name__ == "__main__":
    sys.exit(main())
