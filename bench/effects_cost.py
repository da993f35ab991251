#!/usr/bin/env python3
"""What effects cost scenes that do not use them: effects_cost.py PROGRAM [--only E,...] [--json FILE]

For each effect E, a room whose kernel, and the code that shades its surfaces, have E compiled in although the room does not use
it (the worst case) is rendered by the kernels as shipped and by ones from which E was removed at compile time
(TALBOT_WITHOUT_EFFECT); only the kernel concerned is compiled again. Instructions are counted by callgrind, 64x64 pixels less
32x32, so that set-up cancels. The ratio is to stay below 1.01, and both must give the same film. PROGRAM is
bench_effects_cost_room in its build folder. Needs valgrind and some minutes; what is finished is kept in FILE.
"""
import argparse
import concurrent.futures
import json
import pathlib
import shlex
import subprocess
import sys
import tempfile
import threading
import time

LIMIT = 1.01
ROOT = pathlib.Path(__file__).resolve().parent.parent
LIGHTS = "core/lights/light_table.cpp"

# room: effects that its kernel has and it does not use
ROOMS = {
    "full": ["iridescence", "anisotropy", "diffuse_transmission", "dispersion", "scattering_medium"],
    "full-sheen": ["clearcoat"],
    "full-coat": ["sheen"],
    "textured": ["normal_map", "vertex_color", "second_uv", "uv_transform", "metallic_roughness_texture", "emissive_texture"],
    "textured-roughness": ["base_color_texture"],
    "transmissive": ["thin_wall", "volume_absorption", "alpha_mask", "alpha_blend", "unlit"],
    "transmissive-mask": ["transmission"],
    "glossy": ["specular"],
    "matte": ["single_sided", "environment", "environment_image", "punctual_lights", "analytic_spheres", "instancing",
              "depth_of_field"],
    "matte-punctual": ["emissive_meshes"],
}
ROOM_OF = {effect: room for room, effects in ROOMS.items() for effect in effects}
# Sources beside the kernel that know of an effect.
SOURCES = {
    "environment_image": [LIGHTS, "core/lights/environment_light.cpp"],
    "punctual_lights": [LIGHTS],
    "emissive_meshes": [LIGHTS],
    "emissive_texture": [LIGHTS],
    "clearcoat": [LIGHTS],
    "analytic_spheres": [LIGHTS],
    "depth_of_field": ["core/scene/camera.cpp"],
}
# Nothing to remove: kernels without glossy reflection are the matte one, which other rooms take; and lights are chosen by one
# routine, however many there are; and kernels see a scene at rest.
WITHOUT_CODE = {"glossy": "absent from the matte kernel", "many_lights": "no code of its own",
                "motion": "no code in any kernel: the scene is set to a moment between passes"}


def run(command, **options):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)
    if done.returncode != 0:
        sys.exit(f"effects_cost.py: {shlex.join(map(str, command))} failed:\n{done.stdout}")
    return done.stdout


def compile_without(effect, kernel, build, folder):
    """Objects of the sources that know the effect, compiled without it."""
    commands = {entry["file"]: entry for entry in json.loads((build / "compile_commands.json").read_text())}
    objects = []
    for source in [f"core/integrate/kernel_{kernel}.cpp"] + SOURCES.get(effect, []):
        entry = commands[str(ROOT / source)]
        words = shlex.split(entry["command"])
        target = folder / (pathlib.Path(source).stem + ".o")
        words[words.index("-o") + 1] = str(target)
        words.insert(words.index("-o"), f"-DTALBOT_WITHOUT_EFFECT={effect}")
        run(words, cwd=entry["directory"])
        objects.append(str(target))
    return objects


def link(objects, program, build, target):
    """The program with these objects in front of the library that has the others."""
    words = shlex.split(run(["ninja", "-C", str(build), "-t", "commands", program.name]).splitlines()[-1])
    words = words[words.index("&&") + 1:] if words[0] == ":" else words
    words = words[:words.index("&&")] if "&&" in words else words
    words[words.index("-o") + 1] = str(target)
    first_object = next(i for i, word in enumerate(words) if word.endswith(".o"))
    run(words[:first_object] + objects + words[first_object:], cwd=build)


def instructions(program, room):
    def count(size):
        with tempfile.TemporaryDirectory() as folder:
            text = run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/out", str(program), room, str(size)])
        return int(next(line for line in text.splitlines() if "Collected" in line).split(":")[1])
    return count(64) - count(32)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--only", help="effects with commas")
    parser.add_argument("--json", type=pathlib.Path, help="rows measured before are kept unless named by --only")
    parser.add_argument("--jobs", type=int, default=2, help="effects at a time")
    options = parser.parse_args()
    program = options.program.resolve()
    build = program.parent.parent
    names = options.only.split(",") if options.only else list(ROOM_OF)
    if unknown := [n for n in names if n not in ROOM_OF]:
        sys.exit(f"effects_cost.py: no such effect here: {', '.join(unknown)}; there are {', '.join(ROOM_OF)}")
    rows = {}
    if options.json and options.json.exists():
        rows = {row["effect"]: row for row in json.loads(options.json.read_text())["rows"]}
    start = time.monotonic()
    lock, room_locks, counts = threading.Lock(), {room: threading.Lock() for room in ROOMS}, {}

    def shipped(room):
        with room_locks[room]:
            if room not in counts:
                counts[room] = instructions(program, room)
            return counts[room]

    def measure(name):
        room = ROOM_OF[name]
        about = json.loads(run([str(program), room, "64"]))
        if name in about["effects"].split(","):
            sys.exit(f"effects_cost.py: the room '{room}' uses {name}")
        folder = build / "effects-cost" / name
        folder.mkdir(parents=True, exist_ok=True)
        without = folder / program.name
        link(compile_without(name, about["kernel"], build, folder), program, build, without)
        count = instructions(without, room)
        same = json.loads(run([str(without), room, "64"]))["film_hash"] == about["film_hash"]
        ratio = shipped(room) / count
        row = {"effect": name, "room": room, "kernel": about["kernel"], "shipped": shipped(room), "without": count,
               "ratio": ratio, "same_film": same, "within": ratio <= LIMIT and same}
        with lock:
            rows[name] = row
            print(f"{name}: {ratio:.4f}", file=sys.stderr, flush=True)
            if options.json:
                options.json.write_text(json.dumps({"limit": LIMIT, "rows": list(rows.values())}, indent=2) + "\n")

    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for done in [pool.submit(measure, name) for name in names if options.only or name not in rows]:
            done.result()
    rows = {name: rows[name] for name in ROOM_OF if name in rows}
    print("| effect not used | kernel | instructions, shipped | built without it | ratio |\n|---|---|---|---|---|")
    for row in rows.values():
        mark = "" if row["within"] else (" **above 1.01**" if row["same_film"] else " **another film**")
        print(f"| `{row['effect']}` | {row['kernel']} | {row['shipped']:,} | {row['without']:,} | {row['ratio']:.4f}{mark} |")
    for name, why in WITHOUT_CODE.items():
        print(f"| `{name}` | {why} | | | |")
    print(f"\n{sum(not row['within'] for row in rows.values())} of {len(rows)} above the limit; "
          f"{time.monotonic() - start:.0f} s")
    return 0 if all(row["within"] for row in rows.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
