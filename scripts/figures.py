#!/usr/bin/python3
"""Draws the paper's results, the plate in water, its beam, a focus, and the device of the tutorial.

    scripts/figures.py --program build/release/hertzline --out docs/

runs the program on the shipped scenes and writes docs/paper-result.png, waveform and spectrum for five matching layers and
the rigid wall, docs/plate-in-water.png, the two models of the plate side by side, docs/beam.png, the peak pressure before the
plate, docs/focus-waterfall.png, the pressure across the focus of seven chains over time, and the pictures of the scene in docs/tutorial.md:
docs/burst.png, a run, docs/sweep.png, the band over thickness and preload, and docs/field.png, the peak pressure.
Debian: python3-numpy python3-matplotlib python3-h5py.
"""
import argparse
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np
import pictures  # sets the backend

import matplotlib.pyplot as plt  # noqa: E402

# Scene name, title and colour, from hard layers over soft ones to the wall.
SCENES = [
    ("paper-vitreous-carbon", "vitreous carbon", "#0b6e8a"),
    ("paper-pyrex", "pyrex", "#2a8fbd"),
    ("paper-aluminium", "aluminium", "#5f7f96"),
    ("paper-acrylic", "acrylic", "#c46a1b"),
    ("paper-silicone-rubber", "silicone rubber", "#b03a2e"),
    ("paper-wall", "rigid wall", "#4a4a4a"),
]
FUNDAMENTAL_HZ = 73e3
TIME_US = (0, 400)
SPAN_KHZ = (0, 700)
SPAN_DB = (-60, 6)


def velocity(csv):
    """Returns time [s] and output velocity [m/s]: v_out where there is a layer, the last sphere's at a wall."""
    table = np.genfromtxt(csv, delimiter=",", names=True)
    column = "v_out_m_per_s" if "v_out_m_per_s" in table.dtype.names else "v_last_m_per_s"
    return table["t_s"], table[column]


def spectrum(t, v):
    """Returns frequency [Hz] and level [dB under the maximum] of the whole record, zero-padded and without a window,
    because a burst starts and ends at rest. The definition is that of include/hertzline/spectrum.hpp."""
    padded = 8 * len(v)
    magnitude = np.abs(np.fft.rfft(v, padded))
    step = (t[-1] - t[0]) / (len(t) - 1)
    return np.fft.rfftfreq(padded, step), 20 * np.log10(np.maximum(magnitude / magnitude.max(), 1e-9))


def draw_waveform(axes, t, v, colour, lowest, highest):
    margin = 0.15 * (highest - lowest)
    axes.plot(t * 1e6, v, color=colour, lw=0.9)
    axes.set_xlim(*TIME_US)
    axes.set_ylim(lowest - margin, highest + margin)
    axes.set_xticks(range(0, TIME_US[1] + 1, 100))
    axes.grid(axis="y")
    axes.text(0.985, 0.93, f"peak {v.max():.2f} m/s", transform=axes.transAxes, ha="right", va="top", fontsize=9)


def draw_spectrum(axes, t, v, colour):
    frequency, level = spectrum(t, v)
    axes.fill_between(frequency / 1e3, level, SPAN_DB[0], color=colour, alpha=0.15, lw=0)
    axes.plot(frequency / 1e3, level, color=colour, lw=0.9)
    axes.axhline(-20, color="#555555", lw=0.8, ls=(0, (4, 3)))
    axes.set_xlim(*SPAN_KHZ)
    axes.set_ylim(*SPAN_DB)
    axes.set_xticks(range(0, SPAN_KHZ[1] + 1, 100))
    axes.set_yticks([-60, -40, -20, 0])
    axes.grid(axis="y")
    harmonics = np.arange(1, SPAN_KHZ[1] * 1e3 // FUNDAMENTAL_HZ + 1) * FUNDAMENTAL_HZ / 1e3
    axes.plot(harmonics, np.full_like(harmonics, SPAN_DB[1]), "v", color="#777777", ms=3.5, clip_on=False)


def explain(axes):
    """Labels the marks of the spectra above the topmost one."""
    for k in range(1, int(SPAN_KHZ[1] * 1e3 // FUNDAMENTAL_HZ) + 1):
        axes.annotate(f"{k}f", (k * FUNDAMENTAL_HZ / 1e3, SPAN_DB[1]), (0, 4), textcoords="offset points",
                      ha="center", fontsize=8, color="#666666")
    axes.annotate("−20 dB", (SPAN_KHZ[1], -20), (0, 3), textcoords="offset points", ha="right", fontsize=8,
                  color="#555555")


def draw_all(csv_of, png):
    """Draws six rows, waveform left and spectrum right, with one scale for all layers and another for the wall."""
    records = {scene: velocity(csv_of(scene)) for scene, _, _ in SCENES}
    layers = np.concatenate([v for scene, (_, v) in records.items() if scene != "paper-wall"])
    pictures.use_style()
    figure, rows = plt.subplots(len(SCENES), 2, figsize=(10, 10.5), sharex="col", layout="constrained")
    for (scene, title, colour), (wave, lines) in zip(SCENES, rows):
        t, v = records[scene]
        wall = scene == "paper-wall"
        scale = v if wall else layers
        draw_waveform(wave, t, v, colour, scale.min(), scale.max())
        draw_spectrum(lines, t, v, colour)
        wave.set_title(title, loc="left", fontweight="bold", fontsize=11, color=colour)
        wave.set_ylabel("$v_\\mathrm{last}$ [m/s]" if wall else "$v_\\mathrm{out}$ [m/s]")
        lines.set_ylabel("level [dB]")
    explain(rows[0, 1])
    rows[-1, 0].set_xlabel("time [µs]")
    rows[-1, 1].set_xlabel("frequency [kHz]      f = 73 kHz")
    figure.savefig(png, dpi=110, facecolor="white")


# The models side by side: scene name with changes, title, colour. The rows of the picture: columns, labels and scales of each model.
MODELS = [
    (["paper-vitreous-carbon", "--set", "drive.envelope=tukey"], "the paper's plate: one mass, a vacuum", "#c46a1b"),
    (["wet-vitreous-carbon"], "four modes, water", "#0b6e8a"),
]
ROWS = [
    (("f_last_n", "f_last_n"), ("force on the plate [N]", "force on the plate [N]"), (1, 1)),
    (("v_plate_m_per_s", "v_centre_m_per_s"), ("plate's centre [m/s]", "plate's centre [m/s]"), (1, 1)),
    (("v_out_m_per_s", "p_axis_pa"), ("velocity into the medium [m/s]", "pressure at 10 mm [kPa]"), (1, 1e-3)),
]


def draw_models(csv_of, png):
    """Draws waveforms and spectra of force, plate and output, a pair of columns for each model."""
    pictures.use_style()
    figure, axes = plt.subplots(len(ROWS), 2 * len(MODELS), figsize=(14, 6.5), sharex="col", layout="constrained")
    for m, (_, title, colour) in enumerate(MODELS):
        table = np.genfromtxt(csv_of(m), delimiter=",", names=True)
        t = table["t_s"]
        for (columns, labels, scales), row in zip(ROWS, axes):
            values = table[columns[m]] * scales[m]
            wave, lines = row[2 * m], row[2 * m + 1]
            wave.plot(t * 1e6, values, color=colour, lw=0.8)
            wave.set_xlim(*TIME_US)
            wave.set_ylabel(labels[m])
            wave.grid(axis="y")
            draw_spectrum(lines, t, values - values[0], colour)
        axes[0, 2 * m].set_title(title, loc="left", fontweight="bold", fontsize=11, color=colour)
        explain(axes[0, 2 * m + 1])
        axes[-1, 2 * m].set_xlabel("time [µs]")
        axes[-1, 2 * m + 1].set_xlabel("frequency [kHz]      f = 73 kHz")
    figure.savefig(png, dpi=110, facecolor="white")


def run_models(program, folder):
    for m, (scene, _, _) in enumerate(MODELS):
        subprocess.run([program, "run", *scene, "--tap", "f_last", "-o", folder / f"model-{m}.csv"], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def run_scenes(program, folder):
    for scene, _, _ in SCENES:
        subprocess.run([program, "run", scene, "-o", folder / f"{scene}.csv"], check=True, stdout=subprocess.DEVNULL)


# The scene that the tutorial describes.
TUTORIAL = pathlib.Path(__file__).resolve().parent.parent / "docs" / "tutorial.md"
DEVICE = "my-device.toml"

SWEEP = [DEVICE, "--vary", "end.thickness_m=0.2mm..1mm:log:30", "--vary", "chain.preload_n=0.02..2:log:30"]

FIELD = ["wet-vitreous-carbon", "--plane", "x=-8mm..8mm:161,z=0..31mm:156"]

FOCUS = ["seven-chains", "--set", "array.coupling=none", "--set", "drive.cycles=3", "--set", "output.duration_s=150us",
         "--plane", "x=-30mm..30mm:121,z=40mm", "--waveforms"]

# The command that makes a table, the options of its picture, and the picture.
TABLES = [(["run", DEVICE], [], "burst"), (["sweep", *SWEEP], [], "sweep"),
          (["field", DEVICE, "--set", "end.model=modal", "--plane", "x=-8mm..8mm:41,z=1mm..31mm:31"], [], "field"),
          (["field", *FIELD], [], "beam"),
          (["field", *FOCUS], ["--kind", "waterfall", "--from", "20us"], "focus-waterfall")]


def draw_table(program, folder, command, options, png):
    """Draws the table that the command makes."""
    program = pathlib.Path(program).resolve()
    quiet = {"check": True, "cwd": folder, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    table = f"{png.stem}.h5"
    subprocess.run([program, *command, "-o", table], **quiet)
    subprocess.run([program, "plot", table, "-o", png.resolve(), *options], **quiet)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--program", default="build/release/hertzline", help="the hertzline to run (%(default)s)")
    parser.add_argument("--out", type=pathlib.Path, default="docs", help="folder of the picture (%(default)s)")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        run_scenes(arguments.program, folder)
        run_models(arguments.program, folder)
        draw_all(lambda scene: folder / f"{scene}.csv", arguments.out / "paper-result.png")
        draw_models(lambda model: folder / f"model-{model}.csv", arguments.out / "plate-in-water.png")
        scene = re.search(r"^```toml\n(.*?)^```", TUTORIAL.read_text(encoding="utf-8"), re.M | re.S)[1]
        (folder / DEVICE).write_text(scene, encoding="utf-8")
        for command, options, picture in TABLES:
            draw_table(arguments.program, folder, command, options, arguments.out / f"{picture}.png")
    print(*(arguments.out / f"{name}.png" for name in ("paper-result", "plate-in-water", *(picture for *_, picture in TABLES))), sep="\n")


if __name__ == "__main__":
    try:
        main()
    except (OSError, subprocess.CalledProcessError) as error:
        sys.exit(f"figures.py: {error}")
