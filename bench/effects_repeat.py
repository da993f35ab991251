#!/usr/bin/env python3
"""Whether the ledger's prices are repeatable: effects_repeat.py TALBOT [SCENE...] [--runs N] [--size WxH] [--json FILE]

Prices every effect of each scene in so many runs of `talbot effects` and compares the shares of the time. For effects whose mean
share is above 2 % in size the runs must lie within 10 % of their mean. Without SCENE the built-in scenes.
"""
import argparse
import json
import pathlib
import subprocess
import sys
import time

LEAST = 2.0     # per cent of the time: smaller effects are listed, but not judged
WITHIN = 0.10   # of the mean
ROOT = pathlib.Path(__file__).resolve().parent.parent


def prices(talbot, scene, size):
    command = [talbot, "effects", scene, "--json", "--quiet"] + (["--size", size] if size else [])
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"effects_repeat.py: {scene}: {done.stderr.strip()}")
    return {row["effect"]: row["price"] for row in json.loads(done.stdout)["effects"] if row["price"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("talbot")
    parser.add_argument("scenes", nargs="*", type=pathlib.Path)
    parser.add_argument("--runs", type=int, default=2)
    parser.add_argument("--size")
    parser.add_argument("--quick", action="store_true", help="the scene of analytic spheres alone")
    parser.add_argument("--json", type=pathlib.Path)
    options = parser.parse_args()
    names = ("spheres.gltf",) if options.quick else ("spheres.gltf", "cornell.gltf", "report-extended.gltf", "hero.glb")
    rows, start = [], time.monotonic()
    for scene in options.scenes or [ROOT / "assets" / "scenes" / name for name in names]:
        runs = [prices(options.talbot, scene, options.size) for _ in range(options.runs)]
        for effect in runs[0]:
            shares = [run[effect]["time_percent"] for run in runs]
            mean = sum(shares) / len(shares)
            off = max(abs(share - mean) for share in shares)
            rows.append({"scene": scene.stem, "effect": effect, "shares": shares,
                         "spreads": [run[effect]["time_spread"] for run in runs], "off_by": off / abs(mean) if mean else 0,
                         "judged": abs(mean) > LEAST, "within": abs(mean) <= LEAST or off <= WITHIN * abs(mean)})
    print("| scene | effect | share of the time in each run, % | farthest from the mean |\n|---|---|---|---|")
    for row in sorted(rows, key=lambda r: -abs(r["shares"][0])):
        if not row["judged"]:
            continue
        mark = "" if row["within"] else " **above 10 %**"
        shares = ", ".join(f"{s:.2f} +- {d:.2f}" for s, d in zip(row["shares"], row["spreads"]))
        print(f"| {row['scene']} | `{row['effect']}` | {shares} | {100 * row['off_by']:.1f} %{mark} |")
    judged = [row for row in rows if row["judged"]]
    missed = [row for row in judged if not row["within"]]
    print(f"\n{len(judged)} of {len(rows)} prices are above {LEAST:.0f} % of the time, {len(missed)} of them not repeatable; "
          f"{time.monotonic() - start:.0f} s")
    if options.json:
        options.json.write_text(json.dumps({"within": WITHIN, "least": LEAST, "rows": rows}, indent=2) + "\n")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
