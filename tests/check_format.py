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

    def unformatted(batch):
        done = subprocess.run([program, "--dry-run", *batch], stderr=subprocess.PIPE, text=True, check=True)
        return {line.split(":")[0] for line in done.stderr.splitlines() if "[-Wclang-format-violations]" in line}

    # A process a file would spend its time starting.
    cores = os.cpu_count() or 1
    with ThreadPoolExecutor(cores) as workers:
        wrong = sorted(set().union(*workers.map(unformatted, (files[i::cores] for i in range(cores)))))
    for file in wrong:
        print(f"{file}: run clang-format -i on it")
    print(f"{len(wrong)} of {len(files)} files to format")
    return 1 if wrong or not files else 0


if __name__ == "__main__":
    sys.exit(main())
