#!/usr/bin/python3
"""Draws waveform and spectrum of each column of a NumPy recording of hertzline: hertzline_plot.py FILE.npy -o FILE.png

hertzline runs it for `hertzline plot` and `hertzline run --plot`; by itself it draws recordings that end in .npy. The
spectrum is that of docs/measures.md: all samples, no window, in dB under the maximum from half the drive's frequency upward.
Debian: python3-numpy python3-matplotlib.
"""
import argparse
import json
import sys

MODULES_MISSING = 3  # exit status

try:
    import matplotlib
    import numpy as np

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
except ImportError as error:
    print(error, file=sys.stderr)
    sys.exit(MODULES_MISSING)

SPAN_DB = (-60, 6)
HARMONICS = 10
COLOURS = ["#0b6e8a", "#c46a1b", "#5f7f96", "#b03a2e", "#4f7a3a", "#6b4c8a"]
STYLE = {
    "font.family": "DejaVu Sans",
    "axes.edgecolor": "#8a8a8a",
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.labelcolor": "#333333",
    "xtick.color": "#555555",
    "ytick.color": "#555555",
    "text.color": "#222222",
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.7,
}


def read(path):
    """Samples by column, and what the recording says of them."""
    with open(path, "rb") as file:
        samples = np.load(file, max_header_size=10**7)
        return samples, json.loads(np.load(file).item())


def drive_frequency(about):
    """In Hz; None: the recording does not say."""
    try:
        frequency = float(about["provenance"]["scene"]["drive"]["frequency_hz"])
        return frequency if frequency > 0 else None
    except (KeyError, TypeError, ValueError):
        return None


def longest_stretch(t, rate):
    """The longest part without a gap, as a slice."""
    ends = np.flatnonzero(np.diff(t) > 1.5 / rate) + 1
    edges = np.concatenate(([0], ends, [len(t)]))
    longest = np.argmax(np.diff(edges))
    return slice(edges[longest], edges[longest + 1])


def spectrum(v, rate, lowest):
    """Frequency [Hz] and level [dB under the maximum from `lowest` upward]; None of silence."""
    padded = 4 * len(v)
    magnitude = np.abs(np.fft.rfft(v, padded))
    frequency = np.fft.rfftfreq(padded, 1 / rate)
    largest = magnitude[frequency >= lowest].max(initial=0)
    return (frequency, 20 * np.log10(np.maximum(magnitude / largest, 1e-15))) if largest > 0 else None


def band_of(frequency, level, lowest, threshold_db):
    """Where the level first and last reaches the threshold from `lowest` upward, with straight lines between the amplitudes."""
    amplitude, threshold = 10 ** (level / 20), 10 ** (threshold_db / 20)
    above = np.flatnonzero((amplitude >= threshold) & (frequency >= lowest))

    def crossing(inside, outside):
        if not 0 <= outside < len(frequency) or frequency[outside] < lowest:
            return frequency[inside]
        share = (amplitude[inside] - threshold) / (amplitude[inside] - amplitude[outside])
        return frequency[inside] + share * (frequency[outside] - frequency[inside])

    return crossing(above[0], above[0] - 1), crossing(above[-1], above[-1] + 1)


def draw_waveform(axes, t, v, rate, unit_s, colour):
    gaps = np.flatnonzero(np.diff(t) > 1.5 / rate) + 1
    axes.plot(np.insert(t, gaps, np.nan) / unit_s, np.insert(v, gaps, np.nan), color=colour, lw=0.8)
    axes.set_xlim(t[0] / unit_s, max(t[-1], t[0] + 1 / rate) / unit_s)
    axes.grid(axis="y")
    axes.text(0.985, 0.95, f"peak {np.abs(v).max():.3g}", transform=axes.transAxes, ha="right", va="top", fontsize=8)


def draw_spectrum(axes, v, rate, drive, colour):
    lowest = drive / 2 if drive else 0
    highest = min(rate / 2, (HARMONICS + 0.5) * drive if drive else rate / 2)
    axes.set_xlim(0, highest / 1e3)
    axes.set_ylim(*SPAN_DB)
    axes.set_yticks([-60, -40, -20, 0])
    axes.grid(axis="y")
    axes.axhline(-20, color="#555555", lw=0.8, ls=(0, (4, 3)))
    for k in range(1, int(highest // drive) + 1 if drive else 1):
        axes.axvline(k * drive / 1e3, color="#bbbbbb", lw=0.6, zorder=0)
    lines = spectrum(v, rate, lowest)
    if lines is None:
        axes.text(0.5, 0.5, "silence", transform=axes.transAxes, ha="center")
        return
    frequency, level = lines
    low, high = (edge / 1e3 for edge in band_of(frequency, level, lowest, -20))
    axes.axvspan(low, high, color=colour, alpha=0.08, lw=0)
    shown = frequency <= highest
    axes.fill_between(frequency[shown] / 1e3, level[shown], SPAN_DB[0], color=colour, alpha=0.15, lw=0)
    axes.plot(frequency[shown] / 1e3, level[shown], color=colour, lw=0.8)
    axes.text(0.985, 0.95, f"−20 dB: {low:.4g} to {high:.4g} kHz", transform=axes.transAxes, ha="right",
              va="top", fontsize=8)


def draw(samples, about, title):
    matplotlib.rcParams.update(STYLE | {"font.size": 9})
    columns = about["columns"]
    rate, drive, t = about["sample_rate_hz"], drive_frequency(about), samples["t_s"]
    unit_s, unit = (1e-6, "µs") if t[-1] - t[0] < 2e-3 else (1e-3, "ms")
    stretch = longest_stretch(t, rate)
    figure, rows = plt.subplots(len(columns), 2, figsize=(10, 1.0 + 1.8 * len(columns)), sharex="col",
                                layout="constrained", squeeze=False)
    for (name, quantity, of), (wave, lines), colour in zip(columns, rows, COLOURS * len(columns)):
        v = samples[name].astype(float)
        draw_waveform(wave, t, v, rate, unit_s, colour)
        draw_spectrum(lines, v[stretch], rate, drive, colour)
        label = quantity if name.startswith(quantity) else name
        wave.set_ylabel(f"{label} [{of}]" if of else label)
        lines.set_ylabel("level [dB]")
    rows[-1, 0].set_xlabel(f"time [{unit}]")
    rows[-1, 1].set_xlabel("frequency [kHz]" + (f"      f = {drive / 1e3:g} kHz, lines at its multiples" if drive else ""))
    if title:
        figure.suptitle(title.replace("$", r"\$"), x=0.01, ha="left", fontsize=10)
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("recording", help="a recording of hertzline that ends in .npy")
    parser.add_argument("-o", "--output", required=True, help="the picture")
    parser.add_argument("--format", help="png, svg or pdf (default: the ending of the picture)")
    parser.add_argument("--title", default="", help="stands above")
    arguments = parser.parse_args()
    samples, about = read(arguments.recording)
    if len(samples) == 0:
        sys.exit("the recording has no samples")
    draw(samples, about, arguments.title).savefig(arguments.output, format=arguments.format, dpi=110, facecolor="white")


if __name__ == "__main__":
    try:
        main()
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"{error}")
