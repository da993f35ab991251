#!/usr/bin/env python3
"""Latencies of the viewer, measured through its own frame loop offscreen: change to first image that shows it.

Usage: interaction.py TALBOT [SCENE...] [--size WxH] [--threads N] [--quick] [--environment FILE] [--json FILE]
Without SCENE the built-in default and the Cornell box. OpenGL is whatever renders offscreen here; its time is stated apart.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent


def script(scene, frames):
    return [{"do": "wait", "passes": 2}, {"do": "measure"},
            {"do": "orbit", "dx": 5 * frames, "dy": -40, "frames": frames}, {"do": "wait", "passes": 1},
            {"do": "orbit", "dx": -5 * frames, "dy": 40, "frames": frames}, {"do": "wait", "passes": 1},
            {"do": "sweep", "path": "materials[0].roughness_factor", "from": 0.2, "to": 0.9, "frames": frames},
            {"do": "wait", "passes": 1}, {"do": "open", "file": str(scene)}, {"do": "wait", "passes": 1},
            {"do": "idle", "seconds": 1 if frames < 60 else 5}]


def run(args, scene):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        steps, report = folder / "steps.jsonl", folder / "report.json"
        steps.write_text("".join(json.dumps(step) + "\n" for step in script(scene.resolve(), 12 if args.quick else 60)))
        command = [args.talbot, scene, "--interact", steps, "--report", report, "--size", args.size, "--threads",
                   str(args.threads), "--quiet"]
        if args.environment:
            command += ["--environment", args.environment]
        subprocess.run(command, check=True)
        return json.loads(report.read_text())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("talbot")
    parser.add_argument("scenes", nargs="*", type=pathlib.Path)
    parser.add_argument("--size", default="960x540")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--environment")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--json", type=pathlib.Path)
    args = parser.parse_args()
    scenes = args.scenes or [ROOT / "assets/scenes" / name for name in ("hero.glb", "cornell.gltf")]
    reports = {str(scene): run(args, scene) for scene in scenes}
    print(f"{args.size}, {args.threads} threads, {next(iter(reports.values()))['opengl']}; milliseconds\n")
    print("| scene | orbit median | p95 | material median | p95 | open to image | UI frame p99 | OpenGL median | idle Msamples/s |")
    print("|---|---|---|---|---|---|---|---|---|")
    for scene, r in reports.items():
        latency = r["latency_ms"]
        print("| {} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.1f} | {:.0f} | {:.2f} |".format(
            pathlib.Path(scene).stem, latency["camera"]["median"], latency["camera"]["p95"], latency["material"]["median"],
            latency["material"]["p95"], latency["scene"]["median"], r["frame_ms"]["p99"], r["gl_ms"]["median"],
            r["idle"][0]["samples_per_second"] / 1e6))
    if args.json:
        args.json.write_text(json.dumps(reports, indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
