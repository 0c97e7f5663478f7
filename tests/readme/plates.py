#!/usr/bin/python3
"""The table of a plate in water has the numbers that the program gives: plates.py PROGRAM DOCUMENT."""
import json
import pathlib
import re
import subprocess
import sys

program, document = sys.argv[1:]
# Scene, settings and measured output of the columns behind those of the paper.
MODELS = [("paper-vitreous-carbon", (), None), ("wet-vitreous-carbon", (), "p_axis"),
          ("wet-vitreous-carbon", ("end.theory=thin",), "p_axis")]


def summary(scene, output, *settings):
    words = [word for setting in settings for word in ("--set", setting)]
    done = subprocess.run([program, "run", scene, "--json", *words], check=True, capture_output=True, text=True)
    whole = json.loads(done.stdout)
    return whole[output] if output else whole


def cells(scene, settings, output):
    """Returns the numbers of a column, row by row, with the digits that the table has."""
    tukey, hann = (summary(scene, output, *settings, f"drive.envelope={envelope}") for envelope in ("tukey", "hann"))
    peaks = output and [summary(scene, output, *settings, f"end.thickness_m={thickness}e-3")["peak_p_axis_pa"] for thickness in (0.5, 1, 2, 2.5)]
    return [[f"{tukey['band_20db_high_hz'] / 1e3:.0f}"],
            [f"{hann['band_20db_high_hz'] / 1e3:.0f}"],
            [f"{level:.1f}" for level in tukey["harmonics_db"][4:6]],
            [f"{100 * spectrum['thd_r']:.0f}" for spectrum in (tukey, hann)],
            [f"{spectrum['bandwidth_6db_hz'] / 1e3:.0f}" for spectrum in (tukey, hann)],
            [f"{peak / 1e3:.1f}" for peak in peaks or []]]


lines = pathlib.Path(document).read_text().splitlines()
head = next(number for number, line in enumerate(lines) if line.startswith("| vitreous carbon, 0.5 mm |"))
rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[head + 2:head + 8]]
wrong = []
for column, model in enumerate(MODELS, start=2):
    for row, wanted in zip(rows, cells(*model)):
        told = re.findall(r"-?\d+(?:\.\d+)?", row[column].replace("\N{MINUS SIGN}", "-"))
        if not told and wanted or told != wanted[:len(told)]:
            wrong.append(f"{row[0]}, column {column + 1}: found {row[column]}, the program gives {', '.join(wanted)}")
print("\n".join(wrong) or "every number of the table is the program's")
sys.exit(bool(wrong))
