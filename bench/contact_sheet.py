#!/usr/bin/env python3
"""Renders every model of a folder with an environment and puts the pictures on one sheet, named.

A model is FOLDER/NAME/*.glb or *.gltf; other encodings in folders below it are left out. Every render is `--strict`. Test panels,
which are flat and have no camera, are seen from the front.
Usage: contact_sheet.py TALBOT --models DIR --environment FILE [--size WxH] [--frames N] [--columns N] [--cell W] [--only NAME,...]
[--pictures DIR] [--output FILE.jpg|.png] [--json FILE] [--quick]. Pictures that --pictures already holds are kept.
Exit code 1 when a model failed or warned; 77: Pillow is not installed (apt-get install python3-pil).
"""
import argparse
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

try:
    from PIL import Image, ImageDraw
except ImportError as error:
    print(f"SKIPPED: {error}; install with: apt-get install python3-pil")
    sys.exit(77)


def models_of(folder):
    models = []
    for directory in sorted(path for path in pathlib.Path(folder).iterdir() if path.is_dir()):
        files = sorted(directory.glob("*.glb")) + sorted(directory.glob("*.gltf"))
        if files:
            models.append((directory.name, files[0]))
    return models


def front_view(args, file):
    """Options for a camera before a flat model without one: its bounds fill the picture."""
    info = subprocess.run([args.talbot, "info", file], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
    bounds = re.search(r"^bounds +\(([^)]*)\) to \(([^)]*)\)", info, re.M)
    if not bounds or not re.search(r"^cameras +0$", info, re.M):
        return []
    low, high = ([float(x) for x in corner.split(",")] for corner in bounds.groups())
    extent = [b - a for a, b in zip(low, high)]
    if extent[2] > 0.4 * max(extent[:2]):
        return []
    width, height = map(int, args.size.split("x"))
    angle = 30
    distance = 0.5 * extent[2] + 0.52 * max(extent[1], extent[0] * height / width) / math.tan(math.radians(angle / 2))
    center = [(a + b) / 2 for a, b in zip(low, high)]
    return ["--orbit", ",".join(f"{x:.9g}" for x in (*center, 0, 90, distance, angle))]


def render(args, name, file, pictures):
    picture, report = pictures / f"{name}.png", pictures / f"{name}.json"
    if not picture.exists():
        command = [args.talbot, file, "--environment", args.environment, "--size", args.size, "--frames", str(args.frames), "--strict",
                   "--output", picture, "--report", report, "--quiet", *front_view(args, file)]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            return {"exit_code": done.returncode, "message": done.stderr.strip()}
    run = json.loads(report.read_text())
    return {"exit_code": 0, "warnings": run["warnings"], "nonfinite": run["nonfinite"], "seconds": run["seconds"]["total"],
            "effects": run["effects"]["active"]}


def sheet_of(args, results, pictures):
    width, height = map(int, args.size.split("x"))
    cell = (args.cell, round(args.cell * height / width))
    columns = min(args.columns, len(results))
    rows = -(-len(results) // columns)
    caption = 14
    sheet = Image.new("RGB", (columns * cell[0], rows * (cell[1] + caption)), (24, 24, 24))
    draw = ImageDraw.Draw(sheet)
    for k, name in enumerate(results):
        x, y = k % columns * cell[0], k // columns * (cell[1] + caption)
        picture = pictures / f"{name}.png"
        if picture.exists():
            sheet.paste(Image.open(picture).convert("RGB").resize(cell, Image.LANCZOS), (x, y))
        draw.text((x + 3, y + cell[1] + 1), name, (230, 230, 230))
    return sheet


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("talbot")
    parser.add_argument("--models", required=True)
    parser.add_argument("--environment", required=True)
    parser.add_argument("--size", default="480x270")
    parser.add_argument("--frames", type=int, default=16)
    parser.add_argument("--columns", type=int, default=7)
    parser.add_argument("--cell", type=int, default=240, help="pixels of a picture's row on the sheet")
    parser.add_argument("--only", default="", help="names, by commas")
    parser.add_argument("--pictures", help="a folder that keeps the pictures and their run records")
    parser.add_argument("--output", default="contact-sheet.jpg")
    parser.add_argument("--quick", action="store_true", help="small pictures of four passes")
    parser.add_argument("--json")
    args = parser.parse_args()
    if args.quick:
        args.size, args.frames = "160x90", 4
    only = set(filter(None, args.only.split(",")))
    results = {}
    with tempfile.TemporaryDirectory() as temporary:
        pictures = pathlib.Path(args.pictures or temporary)
        pictures.mkdir(parents=True, exist_ok=True)
        print("| model | exit code | seconds | warnings |\n|---|---|---|---|")
        for name, file in models_of(args.models):
            if only and name not in only:
                continue
            r = results[name] = render(args, name, file, pictures)
            print(f"| {name} | {r['exit_code']} | {r.get('seconds', 0):.1f} | {'; '.join(r.get('warnings', [r.get('message', '')]))} |",
                  flush=True)
        sheet_of(args, results, pictures).save(args.output, quality=85)
    if args.json:
        pathlib.Path(args.json).write_text(json.dumps(results, indent=1))
    return 1 if any(r["exit_code"] or r["warnings"] for r in results.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
