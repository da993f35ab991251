#!/usr/bin/env python3
"""Replays interaction scripts with the program and checks its report, its files and its exit codes."""
import json
import os
import subprocess
import sys
import tempfile

SKIP = 77


class Failure(Exception):
    pass


def run(binary, scene, lines, folder, *options):
    script = os.path.join(folder, "script.jsonl")
    report = os.path.join(folder, "report.json")
    if os.path.exists(report):
        os.remove(report)
    with open(script, "w") as file:
        for line in lines:
            file.write((line if isinstance(line, str) else json.dumps(line)) + "\n")
    done = subprocess.run([binary, scene, "--interact", script, "--report", report, *options], cwd=folder,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=200)
    if "no offscreen context" in done.stderr:
        print(f"SKIPPED: no OpenGL, THE VIEWER IS NOT TESTED: {done.stderr.strip()}")
        sys.exit(SKIP)
    result = None
    if os.path.exists(report):
        with open(report) as file:
            result = json.load(file)
    return done, result


def expect(condition, what):
    if not condition:
        raise Failure(what)


def check_tour(binary, scenes, folder):
    done, report = run(binary, os.path.join(scenes, "cornell.gltf"), [
        {"do": "wait", "passes": 1},
        {"do": "measure"},
        {"do": "orbit", "dx": 24, "dy": -6, "frames": 15},
        {"do": "sweep", "path": "materials[1].roughness_factor", "from": 0.2, "to": 0.9, "frames": 8},
        {"do": "expect", "path": "materials[1].roughness_factor", "value": 0.9, "tolerance": 1e-6},
        {"do": "set", "path": "display.tone_map", "value": "agx"},
        {"do": "expect", "path": "display.tone_map", "value": "agx"},
        {"do": "resize", "width": 1100, "height": 800},
        {"do": "wait", "passes": 2},
        {"do": "idle", "seconds": 0.5},
        {"do": "save", "file": "image.png"},
        {"do": "save", "file": "image.exr"},
        {"do": "screenshot", "file": "window.png"},
        {"do": "open", "file": os.path.join(folder, "missing.glb")},
        {"do": "expect", "notice": "missing.glb"},
        {"do": "open", "file": os.path.join(scenes, "spheres.gltf")},
        {"do": "wait", "passes": 1},
    ], folder, "--size", "160x120")
    expect(done.returncode == 0, f"the tour fails: {done.stderr}")
    expect(report["schema"] == "talbot-interaction/1" and report["ok"], "the report is not ok")
    expect(report["scene"].endswith("spheres.gltf"), "the opened scene is not on show")
    expect(report["latency_ms"]["camera"]["count"] >= 10, "orbiting was not measured")
    expect(report["latency_ms"]["material"]["count"] >= 8, "material edits were not measured")
    expect(report["unshown_changes"] == 0, "some changes were never shown")
    expect(report["idle"][0]["samples_per_second"] > 0, "nothing was rendered while idle")
    for file in ("image.png", "image.exr", "window.png"):
        expect(os.path.getsize(os.path.join(folder, file)) > 1000, f"{file} is missing or empty")
    camera = report["latency_ms"]["camera"]
    print(f"latency while orbiting: median {camera['median']:.1f} ms, p95 {camera['p95']:.1f} ms; "
          f"frames p99 {report['frame_ms']['p99']:.1f} ms, OpenGL p99 {report['gl_ms']['p99']:.1f} ms")


def check_effects(binary, scenes, folder):
    """The slider of a clear coat: the first image with the edit has the effect and its kernel, back at zero it has not."""
    def coat(value):
        return [{"do": "set", "path": "materials[1].clearcoat_factor", "value": value}, {"do": "wait", "passes": 1}]
    done, report = run(binary, os.path.join(scenes, "cornell.gltf"), [
        {"do": "wait", "passes": 1},
        {"do": "expect", "kernel": "matte"},
        {"do": "expect", "effect": "-clearcoat"},
        *coat(0.1),
        {"do": "expect", "effect": "clearcoat"},
        {"do": "expect", "kernel": "full"},
        *coat(0),
        {"do": "expect", "effect": "-clearcoat"},
        {"do": "expect", "kernel": "matte"},
    ], folder, "--size", "96x64")
    expect(done.returncode == 0 and report["ok"], f"the coat's slider: {done.stderr}")
    rows = [(row["kernel"], "clearcoat" in row["effects"].split(",")) for row in report["kernels"]]
    expect(rows == [("matte", False), ("full", True), ("matte", False)], f"kernels on show: {report['kernels']}")
    done, _ = run(binary, os.path.join(scenes, "cornell.gltf"),
                  [{"do": "wait", "passes": 1}, {"do": "expect", "effect": "sheen"}], folder, "--size", "64x48")
    expect(done.returncode == 1 and "sheen" in done.stderr, "an effect that is missing goes unnoticed")


def check_failures(binary, scenes, folder):
    scene = os.path.join(scenes, "cornell.gltf")
    done, report = run(binary, scene, [{"do": "expect", "path": "camera.yfov", "value": 9}], folder, "--size", "64x48")
    expect(done.returncode == 1 and report and not report["ok"], "a failed expectation goes unnoticed")
    expect("script.jsonl:1" in done.stderr, "the failed line is not named")
    done, report = run(binary, scene, ["", "{\"do\": \"jump\"}"], folder)
    expect(done.returncode == 2 and report is None, "an unknown action is not a usage error")
    expect("script.jsonl:2" in done.stderr and len(done.stderr.strip().splitlines()) == 1, "not one clear line")
    done, report = run(binary, scene, [{"do": "set", "path": "materials[99].ior", "value": 1}], folder, "--size", "64x48")
    expect(done.returncode == 1 and "materials[99].ior" in done.stderr, "an unknown path goes unnoticed")


def check_random(binary, scenes, folder):
    done, report = run(binary, os.path.join(scenes, "spheres.gltf"), [
        {"do": "random", "count": int(os.environ.get("TALBOT_RANDOM_EDITS", "60")), "seed": 1},
        {"do": "set", "path": "render.width", "value": 64},
        {"do": "set", "path": "render.height", "value": 48},
        {"do": "set", "path": "session.pass_limit", "value": 0},
        {"do": "wait", "passes": 1, "timeout": 100},
    ], folder, "--size", "96x64")
    expect(done.returncode == 0 and report["ok"], f"random edits: {done.stderr}")
    print(f"random edits: {report['frames']} frames")


def main():
    binary, scenes = map(os.path.abspath, sys.argv[1:3])
    try:
        with tempfile.TemporaryDirectory() as folder:
            check_tour(binary, scenes, folder)
            check_effects(binary, scenes, folder)
            check_failures(binary, scenes, folder)
            check_random(binary, scenes, folder)
    except Failure as failure:
        print(f"FAILED: {failure}")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
