#!/usr/bin/env python3
"""Checks the house rules over the source tree: which folder may include which, how long a file may be, and that tolerances live
in core/math/robust* alone. Usage: check_style.py SOURCE_DIR; exit code 1 and a line for each breach."""
import pathlib
import re
import sys

# A folder may include itself and what stands in its row.
LAYERS = {
    "core/base": [],
    "core/math": ["core/base"],
    "core/geometry": ["core/math", "core/base"],
    "core/scene": ["core/geometry", "core/math", "core/base"],
    "core/scattering": ["core/scene", "core/geometry", "core/math", "core/base"],
    "core/lights": ["core/scene", "core/geometry", "core/math", "core/base"],
    "core/film": ["core/math", "core/base"],
    "core/accuracy": ["core/film", "core/math", "core/base"],
    "core/integrate": ["core/film", "core/scattering", "core/lights", "core/scene", "core/geometry", "core/math", "core/base"],
    "core/session": ["core/integrate", "core/accuracy", "core/film", "core/scattering", "core/lights", "core/scene",
                     "core/geometry", "core/math", "core/base"],
    "core/io": ["core/accuracy", "core/film", "core/scene", "core/geometry", "core/math", "core/base"],
}
OUTSIDE = re.compile(r"#include\s*[<\"](GL/|GLFW/|imgui|EGL/|ui/|app/)")
MAX_LINES = 500
TOLERANCE = re.compile(r"(?<![0-9a-zA-Z_.])(1e-[3-9]f?|0\.000[0-9]{0,2}f?)\b")


def main():
    root = pathlib.Path(sys.argv[1])
    breaches = []
    for file in sorted(p for folder in ("app", "core", "ui", "bench", "oracles", "tests") for p in (root / folder).rglob("*.[hc]*")):
        if file.suffix not in (".h", ".cpp"):
            continue
        name = file.relative_to(root).as_posix()
        lines = file.read_text().splitlines()
        if len(lines) > MAX_LINES:
            breaches.append(f"{name}: {len(lines)} lines, at most {MAX_LINES}")
        layer = "/".join(name.split("/")[:2])
        for number, line in enumerate(lines, 1):
            where = f"{name}:{number}"
            included = re.match(r'#include "((?:core/\w+|app|ui))/', line)
            if layer in LAYERS:
                if OUTSIDE.match(line):
                    breaches.append(f"{where}: the core includes {line.strip()}")
                elif included and included[1] != layer and included[1] not in LAYERS[layer]:
                    breaches.append(f"{where}: {layer} must not include {included[1]}")
            if name.startswith("ui/") and re.match(r'#include "(app|core/scattering|core/lights)/', line):
                breaches.append(f"{where}: ui must not include {line.strip()}")
            code = line.split("//")[0]
            if name.startswith("core/") and not name.startswith("core/math/robust") and TOLERANCE.search(code):
                breaches.append(f"{where}: a tolerance belongs in core/math/robust: {line.strip()}")
    for breach in breaches:
        print(breach)
    print(f"{len(breaches)} breaches")
    return 1 if breaches else 0


if __name__ == "__main__":
    sys.exit(main())
