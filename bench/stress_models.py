#!/usr/bin/env python3
"""Stress mode over every glTF file below a folder: which promises of a moved, scaled, turned or mirrored scene are broken.

Usage: stress_models.py TALBOT --models DIR [--environment FILE|R,G,B] [--size WxH] [--frames N] [--full] [--json FILE]
Exit code 1 when any is.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import time


def stress(args, model):
    command = [args.talbot, "hardcases", "--scene", str(model), "--size", args.size, "--frames", str(args.frames), "--json", "-", "--quiet"]
    if args.environment:
        command += ["--environment", args.environment]
    if args.full:
        command += ["--full"]
    start = time.monotonic()
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        report = json.loads(done.stdout)
    except ValueError:
        report = {"error": done.stderr.strip() or f"exit code {done.returncode}", "transforms": []}
    report["name"] = model.stem
    report["wall_seconds"] = time.monotonic() - start
    return report


def row(report):
    if "error" in report:
        return f"| {report['name']} | {report['error']} | | | | |"
    rows = report["transforms"]
    scaled = [r for r in rows if r["promise"] == "same bytes"]
    moved = [r for r in rows if r["transform"].startswith("moved")]
    other = [r for r in rows if r["promise"] == "relMSE <= 1e-6" and r not in moved]
    turned = [r for r in rows if r["promise"] == "within noise" and r["verdict"] != "-"]
    worst = lambda part: max((r["relmse"] for r in part if r["relmse"] is not None), default=0)
    same = sum(bool(r["same_bytes"]) for r in scaled)
    return (f"| {report['name']} | {same} of {len(scaled)} | {sum(bool(r['same_bytes']) for r in moved)} of {len(moved)}, {worst(moved):.1e} "
            f"| {worst(other):.1e} | {min((r['p_value'] for r in turned), default=1):.2g} "
            f"| {', '.join(r['transform'] for r in rows if r['verdict'] == 'BROKEN') or '-'} |")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("talbot")
    parser.add_argument("--models", required=True)
    parser.add_argument("--environment", default="1,1,1")
    parser.add_argument("--size", default="64x64")
    parser.add_argument("--frames", type=int, default=4)
    parser.add_argument("--full", action="store_true")
    parser.add_argument("--json")
    args = parser.parse_args()
    models = sorted(p for kind in ("*.gltf", "*.glb") for p in pathlib.Path(args.models).rglob(kind))
    if not models:
        print(f"{args.models}: there is no .gltf or .glb below it", file=sys.stderr)
        return 2
    print("| model | powers of two: same bytes | moved: same bytes, worst relMSE | scaled by 1e-5 and 1e5: worst relMSE | turned: least p | broken |")
    print("|---|---|---|---|---|---|")
    reports = []
    for model in models:
        reports.append(stress(args, model))
        print(row(reports[-1]), flush=True)
    if args.json:
        pathlib.Path(args.json).write_text(json.dumps(reports, indent=1))
    return 0 if all(r.get("kept", False) for r in reports) else 1


if __name__ == "__main__":
    sys.exit(main())
