#!/usr/bin/env python3
"""What each unbiased switch of the estimator is worth: error at equal time, through `talbot accuracy SCENE --sweep`.

All settings of a scene run in lock step, octave by octave. The error of each is read off its curve at the seconds that the
shortest of them reached; the work for equal error is (error / error of the default)^2, above 1 where the switch loses.
Usage: estimators.py TALBOT [SCENE.gltf...] [--scenes DIR] [--environment FILE.hdr] [--budget SECONDS] [--size-scale S]
[--json FILE] [--markdown FILE] [--quick]. With --environment the last scene is measured once more under that image.
"""
import argparse
import json
import math
import pathlib
import subprocess
import sys

from gltf_arrays import Gltf

HERE = pathlib.Path(__file__).resolve().parent
SWEEPS = ["sampler=independent,stratified,halton,zsobol", "lights=power,uniform", "roulette=off", "nee=off"]
ENVIRONMENT_SWEEP = "environment-sampling=luminance,none"


def error_at(curve, seconds):
    """Straight on log-log axes between the octaves; the ends go on with half a power, as 1/sqrt(N)."""
    points = [(p["cpu_seconds"], p["relrmse_percent"]) for p in curve if p["relrmse_percent"]]
    if not points:
        return None
    if seconds >= points[-1][0]:
        return points[-1][1] * math.sqrt(points[-1][0] / seconds)
    for (t0, e0), (t1, e1) in zip(points, points[1:]):
        if t0 <= seconds <= t1:
            return e0 * (e1 / e0) ** (math.log(seconds / t0) / math.log(t1 / t0))
    return points[0][1] * math.sqrt(points[0][0] / seconds)


def measure(args, scene, environment):
    width, height = Gltf(scene).size(args.size_scale)
    command = [args.talbot, "accuracy", scene, "--size", f"{width}x{height}", "--threads", str(args.threads), "--max-depth", "9",
               "--budget", str(args.budget), "--json", "-", "--quiet"]
    for sweep in SWEEPS + ([ENVIRONMENT_SWEEP] if environment else []):
        command += ["--sweep", sweep]
    if environment:
        command += ["--environment", environment]
    report = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    curves = {r["configuration"]: r["curve"] for r in report["results"]}
    seconds = min(curve[-1]["cpu_seconds"] for curve in curves.values() if curve)
    errors = {name: error_at(curve, seconds) for name, curve in curves.items()}
    return {"size": [width, height], "cpu_seconds": seconds, "relrmse_percent": errors}


def table(results):
    rows = []
    for result in results.values():
        rows += [name for name in result["relrmse_percent"] if name not in rows]
    rows.sort(key=lambda name: name != "base")
    lines = ["| setting | " + " | ".join(results) + " |", "|---" * (len(results) + 1) + "|"]
    seconds = " | ".join(f"{r['cpu_seconds']:.1f} s" for r in results.values())
    lines.append(f"| CPU seconds each | {seconds} |")
    for name in rows:
        cells = []
        for result in results.values():
            error, base = result["relrmse_percent"].get(name), result["relrmse_percent"]["base"]
            if error is None:
                cells.append("-")
            else:
                cells.append(f"{error:.2f} %" + ("" if name == "base" else f" ({(error / base) ** 2:.2f})"))
        lines.append(f"| {'default' if name == 'base' else '`' + name + '`'} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("talbot")
    parser.add_argument("scene", nargs="*")
    parser.add_argument("--scenes", help="a folder: its .gltf files with separate buffers")
    parser.add_argument("--environment")
    parser.add_argument("--budget", type=float, default=40)
    parser.add_argument("--size-scale", type=float, default=0.25)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--quick", action="store_true", help="small images, six seconds a scene")
    parser.add_argument("--json")
    parser.add_argument("--markdown")
    args = parser.parse_args()
    if args.quick:
        args.size_scale, args.budget = 0.1, 6
    scenes = list(args.scene)
    if args.scenes:
        scenes += sorted(str(f) for f in pathlib.Path(args.scenes).glob("*.gltf") if "uri\": \"data:" not in f.read_text())
    if not scenes:
        scenes = [str(HERE.parent / "assets/scenes/cornell.gltf")]
    results = {pathlib.Path(scene).stem: measure(args, scene, None) for scene in scenes}
    if args.environment:
        name = f"{pathlib.Path(scenes[-1]).stem} in {pathlib.Path(args.environment).stem}"
        results[name] = measure(args, scenes[-1], args.environment)
    text = table(results)
    print(text)
    if args.json:
        pathlib.Path(args.json).write_text(json.dumps(results, indent=1))
    if args.markdown:
        pathlib.Path(args.markdown).write_text(text + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
