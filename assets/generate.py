#!/usr/bin/env python3
"""Writes the built-in scenes into assets/scenes/: Python 3 standard library only, the same bytes every time.

--verify makes them in a temporary folder and compares; --tessellate DIR writes spheres as meshes for other viewers.
"""

import argparse
import sys
import tempfile
import time
from pathlib import Path

sys.dont_write_bytecode = True

from generator import cornell, hero, rare_light, report, report_extended, spheres  # noqa: E402
from generator.gltf import Document  # noqa: E402
from generator.validate import InvalidScene, check_scene  # noqa: E402

SCENES_FOLDER = Path(__file__).resolve().parent / "scenes"
MAX_BYTES = 8_000_000
SCENES = {"cornell": (cornell, False), "spheres": (spheres, False), "report": (report, False),
          "report-extended": (report_extended, False), "rare-light": (rare_light, False), "hero": (hero, True)}


def write_scene(name, folder, tessellate=False):
    """Writes and checks one scene; returns the names of its files."""
    module, binary = SCENES[name]
    began = time.monotonic()
    document = Document(name, binary, tessellate)
    module.build(document)
    files = document.save(folder)
    summary = check_scene(folder / (name + (".glb" if binary else ".gltf")), module.LIGHT_TARGET)
    total = sum((folder / file).stat().st_size for file in files)
    if total > MAX_BYTES and not tessellate:
        raise InvalidScene(f"{name}: {total} bytes, more than {MAX_BYTES}")
    print(f"{name}: {total / 1e6:.2f} MB, {summary['triangles']} triangles ({summary['stored']} stored), "
          f"{summary['spheres']} spheres, {summary['materials']} materials, {summary['images']} images, "
          f"{time.monotonic() - began:.1f} s", file=sys.stderr)
    return files


def verify(names):
    """Regenerates scenes aside and compares every byte with the committed files; returns the differences."""
    problems = []
    with tempfile.TemporaryDirectory() as folder:
        written = {file for name in names for file in write_scene(name, Path(folder))}
        for file in sorted(written):
            committed = SCENES_FOLDER / file
            if not committed.exists():
                problems.append(f"{file}: missing from {SCENES_FOLDER}")
            elif committed.read_bytes() != (Path(folder) / file).read_bytes():
                problems.append(f"{file}: differs from what the generator writes")
        if set(names) == set(SCENES):
            strays = {path.name for path in SCENES_FOLDER.iterdir()} - written
            problems += [f"{file}: not written by the generator" for file in sorted(strays)]
    return problems


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="SCENE", help="scenes to write: " + ", ".join(SCENES))
    parser.add_argument("--verify", action="store_true", help="compare with the committed files instead of writing")
    parser.add_argument("--tessellate", metavar="DIR", type=Path, help="write to DIR with spheres as meshes")
    options = parser.parse_args()
    names = options.names or list(SCENES)
    unknown = [name for name in names if name not in SCENES]
    if unknown:
        parser.error(f"no such scene: {', '.join(unknown)}")
    try:
        if options.verify:
            problems = verify(names)
            for problem in problems:
                print(f"generate.py: {problem}; run assets/generate.py", file=sys.stderr)
            return 1 if problems else 0
        folder = options.tessellate or SCENES_FOLDER
        folder.mkdir(parents=True, exist_ok=True)
        for name in names:
            write_scene(name, folder, options.tessellate is not None)
    except InvalidScene as error:
        print(f"generate.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
