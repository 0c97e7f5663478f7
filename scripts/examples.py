#!/usr/bin/python3
"""Runs the notebooks of docs/examples and draws their pictures.

    scripts/examples.py --build build/release --out docs/examples

runs each of them with the Python package of that build and writes each picture of plt.show(): NAME-1.png and so on.
Debian: python3-numpy python3-matplotlib.
"""
import argparse
import os
import pathlib
import runpy
import sys

arguments = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
arguments.add_argument("--build", type=pathlib.Path, required=True, help="a build of hertzline")
arguments.add_argument("--out", type=pathlib.Path, required=True, help="folder of the pictures")
arguments = arguments.parse_args()
os.environ["HERTZLINE_PROGRAM"] = str((arguments.build / "hertzline").resolve())
sys.path.insert(0, str((arguments.build / "python").resolve()))

import matplotlib  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402


def run(notebook):
    drawn = 0

    def show():
        nonlocal drawn
        for number in plt.get_fignums():
            drawn += 1
            plt.figure(number).savefig(arguments.out / f"{notebook.stem.replace('_', '-')}-{drawn}.png", dpi=90,
                                       facecolor="white", metadata={"Software": None})
        plt.close("all")

    plt.show = show
    print(f"== {notebook.stem}", flush=True)
    runpy.run_path(str(notebook))
    assert drawn, f"{notebook} shows no picture"


arguments.out.mkdir(parents=True, exist_ok=True)
for path in sorted((pathlib.Path(__file__).resolve().parent.parent / "docs/examples").glob("*.py")):
    run(path)
