#!/usr/bin/env python3
"""run_paths.py FOLDER...: checks that no program or library in them has a run path with an empty entry.

The loader takes an empty entry for the current directory, and would load libraries from there.
"""

import pathlib
import re
import subprocess
import sys


def binaries(folder):
    for path in sorted(folder.rglob("*")):
        if path.is_file() and not path.is_symlink() and path.suffix not in (".o", ".a"):
            with path.open("rb") as file:
                if file.read(4) == b"\x7fELF":
                    yield path


def main():
    checked = 0
    wrong = []
    for path in (path for folder in sys.argv[1:] for path in binaries(pathlib.Path(folder))):
        checked += 1
        text = subprocess.run(["readelf", "--dynamic", "--wide", path], check=True, capture_output=True, text=True).stdout
        for run_path in re.findall(r"\((?:RUNPATH|RPATH)\).*\[(.*)\]", text):
            if "" in run_path.split(":"):
                wrong.append(f"{path}: {run_path}")
    print("\n".join(wrong) or f"{checked} binaries")
    raise SystemExit(1 if wrong or not checked else 0)


if __name__ == "__main__":
    main()
