#!/usr/bin/env python3
"""Checks that every source is as clang-format 14 would have it. Usage: check_format.py SOURCE_DIR; exit code 1 and a line for each
file that is not, 77 without that version of clang-format."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

VERSION = 14


def formatter():
    for name in (f"clang-format-{VERSION}", "clang-format"):
        program = shutil.which(name)
        if program:
            text = subprocess.run([program, "--version"], capture_output=True, text=True, check=False).stdout
            found = re.search(r"version (\d+)", text)
            if found and int(found.group(1)) == VERSION:
                return program
    return None


def main():
    program = formatter()
    if not program:
        print(f"SKIPPED: clang-format {VERSION} is not installed (apt-get install clang-format)")
        return 77
    root = pathlib.Path(sys.argv[1])
    files = sorted(str(p) for folder in ("app", "core", "ui", "bench", "oracles", "tests") for p in (root / folder).rglob("*")
                   if p.suffix in (".h", ".cpp"))

    def is_formatted(file):
        return subprocess.run([program, "--dry-run", "-Werror", file], stderr=subprocess.DEVNULL, check=False).returncode == 0

    with ThreadPoolExecutor(os.cpu_count()) as workers:
        wrong = [file for file, good in zip(files, workers.map(is_formatted, files)) if not good]
    for file in wrong:
        print(f"{file}: run clang-format -i on it")
    print(f"{len(wrong)} of {len(files)} files to format")
    return 1 if wrong or not files else 0


if __name__ == "__main__":
    sys.exit(main())
