#!/usr/bin/env python3
"""Writes the tables of keys in scenes/README.md as the program prints them: scene_keys.py HERTZLINE [--check]

--check writes nothing. Exit status 1 where the tables differ.
"""
import pathlib
import re
import subprocess
import sys

README = pathlib.Path(__file__).resolve().parent.parent / "scenes/README.md"


def main():
    program, *check = sys.argv[1:]
    rows = subprocess.run([program, "scenes", "--keys"], check=True, capture_output=True, text=True).stdout
    found = README.read_text(encoding="utf-8")
    text = found
    for section in dict.fromkeys(re.findall(r"^[|] `(\w+)[.]", rows, re.MULTILINE)):
        row = rf"(^[|] `{section}[.].*\n)+"
        table = re.search(row, rows, re.MULTILINE)[0]
        text, tables = re.subn(row, lambda _: table, text, flags=re.MULTILINE)
        if tables != 1:
            raise SystemExit(f"{README}: {tables} tables of the keys of [{section}], expected 1")
    if text == found:
        return
    if check == ["--check"]:
        raise SystemExit(f"{README}: its tables are not those of `hertzline scenes --keys`; scripts/scene_keys.py writes them")
    README.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
