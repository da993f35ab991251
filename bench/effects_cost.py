#!/usr/bin/env python3
"""What effects cost scenes that do not use them: effects_cost.py TALBOT [--only E,...] [--json FILE] [--compile-only]

For each effect E, a scene whose kernel has E compiled in although the scene does not use it is rendered by the program as
shipped and by one from which E was removed at compile time (TALBOT_WITHOUT_EFFECT). Instructions are counted by callgrind,
64x64 pixels less 32x32, so that set-up cancels. The ratio is to stay below 1.01, and both must give the same film. Needs the
build folder that TALBOT stands in, valgrind, and a minute or two for each effect; what is finished is kept in FILE.
"""
import argparse
import base64
import json
import pathlib
import shlex
import struct
import subprocess
import sys
import tempfile
import zlib

LIMIT = 1.01
ROOT = pathlib.Path(__file__).resolve().parent.parent

# Sources beside the kernel that know of an effect.
SOURCES = {
    "environment_image": ["core/lights/light_table.cpp", "core/lights/environment_light.cpp"],
    "punctual_lights": ["core/lights/light_table.cpp"],
    "emissive_meshes": ["core/lights/light_table.cpp"],
    "emissive_texture": ["core/lights/light_table.cpp"],
    "clearcoat": ["core/lights/light_table.cpp"],
    "analytic_spheres": ["core/lights/light_table.cpp"],
    "depth_of_field": ["core/scene/camera.cpp"],
}
# No code of their own: sets of lights are chosen from by one routine, however many there are.
STRUCTURAL = ["many_lights"]


class GltfScene:
    """A room of quads with a lamp, each with a material."""

    def __init__(self):
        self.data = b""
        self.gltf = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [],
                     "materials": [], "accessors": [], "bufferViews": [], "buffers": [], "cameras": []}

    def accessor(self, rows, kind, component=5126):
        flat = [x for row in rows for x in (row if isinstance(row, tuple) else (row,))]
        packed = struct.pack(f"<{len(flat)}{'f' if component == 5126 else 'I'}", *flat)
        self.gltf["bufferViews"].append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(packed)})
        self.data += packed
        entry = {"bufferView": len(self.gltf["bufferViews"]) - 1, "componentType": component, "count": len(rows), "type": kind}
        if kind == "VEC3":
            entry["min"] = [min(r[i] for r in rows) for i in range(3)]
            entry["max"] = [max(r[i] for r in rows) for i in range(3)]
        self.gltf["accessors"].append(entry)
        return len(self.gltf["accessors"]) - 1

    def texture(self, pixels):
        """A square PNG of RGBA tuples."""
        size = round(len(pixels) ** 0.5)
        raw = b"".join(b"\0" + bytes(c for p in pixels[y * size:(y + 1) * size] for c in p) for y in range(size))

        def chunk(kind, body):
            return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
        png = (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", size, size, 8, 6, 0, 0, 0)) +
               chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))
        self.gltf.setdefault("images", []).append({"uri": "data:image/png;base64," + base64.b64encode(png).decode()})
        self.gltf.setdefault("textures", []).append({"source": len(self.gltf["images"]) - 1})
        return {"index": len(self.gltf["textures"]) - 1}

    def material(self, **fields):
        self.gltf["materials"].append({"doubleSided": True, **fields})
        return len(self.gltf["materials"]) - 1

    def quads(self, corners, material):
        positions = [p for quad in corners for p in quad]
        uv = [t for _ in corners for t in ((0.0, 1.0), (1.0, 1.0), (1.0, 0.0), (0.0, 0.0))]
        indices = [4 * q + k for q in range(len(corners)) for k in (0, 1, 2, 0, 2, 3)]
        self.gltf["meshes"].append({"primitives": [{
            "attributes": {"POSITION": self.accessor(positions, "VEC3"), "TEXCOORD_0": self.accessor(uv, "VEC2")},
            "indices": self.accessor(indices, "SCALAR", 5125), "material": material}]})
        self.node({"mesh": len(self.gltf["meshes"]) - 1})

    def node(self, node):
        self.gltf["nodes"].append(node)
        self.gltf["scenes"][0]["nodes"].append(len(self.gltf["nodes"]) - 1)

    def extension(self, name):
        used = self.gltf.setdefault("extensionsUsed", [])
        if name not in used:
            used.append(name)

    def write(self, path):
        self.gltf["buffers"] = [{"byteLength": len(self.data),
                                 "uri": "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()}]
        path.write_text(json.dumps(self.gltf))


def box(lower, upper):
    """Outward quads of an axis-aligned box."""
    (a, b, c), (x, y, z) = lower, upper
    return [[(a, b, z), (x, b, z), (x, y, z), (a, y, z)], [(x, b, c), (a, b, c), (a, y, c), (x, y, c)],
            [(x, b, z), (x, b, c), (x, y, c), (x, y, z)], [(a, b, c), (a, b, z), (a, y, z), (a, y, c)],
            [(a, y, z), (x, y, z), (x, y, c), (a, y, c)], [(a, b, c), (x, b, c), (x, b, z), (a, b, z)]]


def make_scene(effect, path):
    """A room whose kernel is the smallest with `effect`, which the room does not use."""
    scene = GltfScene()
    matte = {"KHR_materials_specular": {"specularFactor": 0}}
    checker = [((230, 60, 30, 255) if (x // 2 + y // 2) % 2 else (20, 90, 200, 255)) for y in range(8) for x in range(8)]
    holes = [(r, g, b, 255 if (i // 3) % 2 else 0) for i, (r, g, b, _) in enumerate(checker)]

    def plain(color, **more):
        wall = {"baseColorFactor": color + [1], "metallicFactor": 0, "roughnessFactor": 0.6}
        wall.update(more.pop("pbr", {}))
        return scene.material(pbrMetallicRoughness=wall, **more)

    def with_extensions(extensions):
        for name in extensions:
            scene.extension(name)
        return {"extensions": extensions} if extensions else {}

    kernel = KERNEL_OF[effect]
    base = with_extensions(matte if kernel == "matte" else {})
    white, red, green = plain([0.7, 0.7, 0.7], **base), plain([0.6, 0.1, 0.1], **base), plain([0.1, 0.5, 0.1], **base)
    thing = {}
    if kernel == "textured":
        slot = "metallicRoughnessTexture" if effect == "base_color_texture" else "baseColorTexture"
        thing = {"pbr": {slot: scene.texture(checker), "metallicFactor": 0.8}}
    elif kernel == "transmissive" and effect != "transmission":
        thing = with_extensions({"KHR_materials_transmission": {"transmissionFactor": 1},
                                 "KHR_materials_volume": {"thicknessFactor": 1}})
    elif kernel == "transmissive":
        thing = {"pbr": {"baseColorTexture": scene.texture(holes)}, "alphaMode": "MASK"}
    elif kernel == "full" and effect == "clearcoat":
        thing = with_extensions({"KHR_materials_sheen": {"sheenColorFactor": [1, 1, 1], "sheenRoughnessFactor": 0.5}})
    elif kernel == "full":
        thing = with_extensions({"KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.2}})
    else:
        thing = dict(base)
    thing = plain([0.8, 0.8, 0.8], **thing)
    room = box((-1, -1, -1), (1, 1, 1))
    scene.quads([room[1], room[4], room[5]], white)
    scene.quads([room[2]], red)
    scene.quads([room[3]], green)
    scene.quads(box((-0.6, -1, -0.6), (-0.05, 0.2, -0.1)), thing)
    scene.quads(box((0.1, -1, -0.2), (0.6, -0.4, 0.4)), thing)
    if effect == "emissive_meshes":
        scene.extension("KHR_lights_punctual")
        scene.gltf["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 8}]}}
        scene.node({"translation": [0, 0.8, 0], "extensions": {"KHR_lights_punctual": {"light": 0}}})
    else:
        lamp = plain([0, 0, 0], emissiveFactor=[1, 1, 1], **base)
        scene.quads([[(-0.3, 0.98, -0.3), (0.3, 0.98, -0.3), (0.3, 0.98, 0.3), (-0.3, 0.98, 0.3)]], lamp)
    scene.gltf["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}]
    scene.node({"camera": 0, "translation": [0, 0, 3.8]})
    scene.write(path)


KERNELS = {
    "full": ["iridescence", "anisotropy", "clearcoat", "sheen", "diffuse_transmission", "dispersion",
             "scattering_medium"],
    "textured": ["normal_map", "vertex_color", "second_uv", "uv_transform", "metallic_roughness_texture",
                 "emissive_texture", "base_color_texture"],
    "transmissive": ["transmission", "thin_wall", "volume_absorption", "alpha_mask", "alpha_blend", "unlit"],
    "glossy": ["specular"],
    "matte": ["glossy", "single_sided", "environment", "environment_image", "punctual_lights", "emissive_meshes",
              "analytic_spheres", "instancing", "depth_of_field"],
}
KERNEL_OF = {effect: kernel for kernel, effects in KERNELS.items() for effect in effects}


def run(command, **options):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)
    if done.returncode != 0:
        sys.exit(f"effects_cost.py: {shlex.join(map(str, command))} failed:\n{done.stdout}")
    return done.stdout


def compile_without(effect, kernel, build, out):
    """Objects of the sources that know the effect, compiled without it."""
    commands = {entry["file"]: entry for entry in json.loads((build / "compile_commands.json").read_text())}
    objects = []
    for source in [f"core/integrate/kernel_{kernel}.cpp"] + SOURCES.get(effect, []):
        entry = commands[str(ROOT / source)]
        words = shlex.split(entry["command"])
        target = out / (pathlib.Path(source).stem + ".o")
        words[words.index("-o") + 1] = str(target)
        words.insert(words.index("-o"), f"-DTALBOT_WITHOUT_EFFECT={effect}")
        words.remove("-MD")
        for option in ("-MT", "-MF"):
            at = words.index(option)
            del words[at:at + 2]
        run(words, cwd=entry["directory"])
        objects.append(str(target))
    return objects


def link(objects, build, target):
    """The program with these objects in front of the library that has the others."""
    command = run(["ninja", "-C", str(build), "-t", "commands", "talbot"]).splitlines()[-1]
    words = shlex.split(command)
    words = words[words.index(":") + 2:] if words[0] == ":" else words
    if "&&" in words:
        words = words[:words.index("&&")]
    words[words.index("-o") + 1] = str(target)
    first_object = next(i for i, w in enumerate(words) if w.endswith(".o"))
    run(words[:first_object] + objects + words[first_object:], cwd=build)


def instructions(program, scene, size):
    with tempfile.TemporaryDirectory() as folder:
        text = run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/out", str(program), str(scene), "--frames",
                    "2", "--threads", "1", "--quiet", "--size", f"{size}x{size}"])
    return int(next(line for line in text.splitlines() if "Collected" in line).split(":")[1])


def film_hash(program, scene, folder):
    report = folder / "report.json"
    run([str(program), str(scene), "--frames", "2", "--quiet", "--size", "64x64", "--report", str(report)])
    return json.loads(report.read_text())["film_hash"]


def measure(effect, talbot, build, out):
    folder = out / effect
    folder.mkdir(parents=True, exist_ok=True)
    scene = folder / "scene.gltf"
    make_scene(effect, scene)
    info = json.loads(run([str(talbot), "info", str(scene), "--json"]))
    kernel = info["kernel"]
    if info["effects"][effect]["active"]:
        sys.exit(f"effects_cost.py: the scene without {effect} uses it: {info['effects'][effect]['witness']}")
    if kernel != KERNEL_OF[effect]:
        sys.exit(f"effects_cost.py: the scene without {effect} takes the kernel {kernel}, not {KERNEL_OF[effect]}")
    without = folder / "talbot"
    link(compile_without(effect, kernel, build, folder), build, without)
    counts = [instructions(program, scene, 64) - instructions(program, scene, 32) for program in (talbot, without)]
    same = film_hash(talbot, scene, folder) == film_hash(without, scene, folder)
    return {"effect": effect, "kernel": kernel, "shipped": counts[0], "without": counts[1], "ratio": counts[0] / counts[1],
            "same_film": same, "within": counts[0] / counts[1] <= LIMIT and same}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("talbot", type=pathlib.Path)
    parser.add_argument("--only", help="effects with commas")
    parser.add_argument("--json", type=pathlib.Path, help="rows measured before are kept unless named by --only")
    parser.add_argument("--compile-only", action="store_true", help="fill the compiler's cache")
    options = parser.parse_args()
    talbot = options.talbot.resolve()
    build = talbot.parent
    out = build / "effects-cost"
    names = options.only.split(",") if options.only else list(KERNEL_OF)
    if unknown := [n for n in names if n not in KERNEL_OF]:
        sys.exit(f"effects_cost.py: no such effect here: {', '.join(unknown)}; there are {', '.join(KERNEL_OF)}")
    rows = {}
    if options.json and options.json.exists():
        rows = {row["effect"]: row for row in json.loads(options.json.read_text())["rows"]}
    for name in names:
        if options.compile_only:
            (out / name).mkdir(parents=True, exist_ok=True)
            compile_without(name, KERNEL_OF[name], build, out / name)
            continue
        if name in rows and not options.only:
            continue
        rows[name] = row = measure(name, talbot, build, out)
        print(f"{name}: {row['ratio']:.4f}", file=sys.stderr, flush=True)
        if options.json:
            options.json.write_text(json.dumps({"limit": LIMIT, "rows": list(rows.values())}, indent=2) + "\n")
    print("| effect not used | kernel | instructions, shipped | built without it | ratio |\n|---|---|---|---|---|")
    for row in rows.values():
        mark = "" if row["within"] else (" **above 1.01**" if row["same_film"] else " **another film**")
        print(f"| {row['effect']} | {row['kernel']} | {row['shipped']:,} | {row['without']:,} | {row['ratio']:.4f}{mark} |")
    for name in STRUCTURAL:
        print(f"| {name} | every | has no code of its own | | |")
    return 0 if all(row["within"] for row in rows.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
