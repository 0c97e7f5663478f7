#!/usr/bin/python3
"""Draws waveform and spectrum of each column of a NumPy recording of hertzline, or a sweep: hertzline_plot.py FILE -o FILE.png

hertzline runs it for `hertzline plot` and `hertzline run --plot`; by itself it draws recordings that end in .npy, and tables of
`hertzline sweep`. The spectrum is that of docs/measures.md: all samples, no window, in dB under the maximum from half the
drive's frequency upward. Of a sweep it draws curves over one key that varies, a map over two; of a search what it looked for over
each key and as the search went on.
Debian: python3-numpy python3-matplotlib, for sweeps that end in .h5 python3-h5py.
"""
import argparse
import csv
import json
import os
import sys

MODULES_MISSING = 3  # exit status
NOT_A_SWEEP = 4

FOLDER = os.getcwd()
if __name__ == "__main__":  # a user's settings may ask for LaTeX or a window; matplotlib looks for them in the folder first
    os.chdir("/")
    os.environ.update(MATPLOTLIBRC=os.devnull, MPLBACKEND="agg")
try:
    import matplotlib
    import matplotlib.pyplot as plt
    import numpy as np
except ImportError as error:
    print(error, file=sys.stderr)
    sys.exit(MODULES_MISSING)
os.chdir(FOLDER)

SPAN_DB = (-60, 6)
HARMONICS = 10
COLOURS = ["#0b6e8a", "#c46a1b", "#5f7f96", "#b03a2e", "#4f7a3a", "#6b4c8a"]
STYLE = {
    "text.usetex": False,
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
    """Samples by column, and their description."""
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


def draw(samples, about, title, rows=None):
    """A row of two axes for each column: waveform and spectrum. `rows` are axes of the caller's."""
    matplotlib.rcParams.update(STYLE | {"font.size": 9})
    columns = about["columns"]
    rate, drive, t = about["sample_rate_hz"], drive_frequency(about), samples["t_s"]
    unit_s, unit = (1e-6, "µs") if t[-1] - t[0] < 2e-3 else (1e-3, "ms")
    stretch = longest_stretch(t, rate)
    if rows is None:
        _, rows = plt.subplots(len(columns), 2, figsize=(10, 1.0 + 1.8 * len(columns)), sharex="col",
                               layout="constrained", squeeze=False)
    figure = rows[0, 0].figure
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


class NotASweep(Exception):
    pass


def search_of(provenance):
    """The request of `hertzline optimise`; None: it is a sweep."""
    try:
        return json.loads(provenance).get("search")
    except (TypeError, ValueError, AttributeError):
        return None


def read_hdf5_table(path):
    """Columns by name, their units, and the search."""
    try:
        import h5py
    except ImportError as error:
        print(error, file=sys.stderr)
        sys.exit(MODULES_MISSING)
    with h5py.File(path, "r") as file:
        if "points" not in file or file["points"].dtype.names is None:
            raise NotASweep
        table = file["points"][:]
        units = dict(zip(table.dtype.names, file["points"].attrs["units"]))
        search = search_of(file.attrs.get("provenance"))
    texts = [name for name in table.dtype.names if table[name].dtype.kind == "S"]
    return {name: np.char.decode(table[name]) if name in texts else table[name].astype(float)
            for name in table.dtype.names}, units, search


def read_csv_table(path):
    """The same of a CSV; the units are beside it."""
    with open(path, newline="", encoding="utf-8") as file:
        names, *rows = csv.reader(file)
    units, search = {}, None
    try:
        with open(path + "-metadata.json", encoding="utf-8") as file:
            metadata = json.load(file)
        units = {c["name"]: c["schema:unitText"] for c in metadata["tableSchema"]["columns"]}
        search = metadata["urn:hertzline:provenance"].get("search")
    except (OSError, ValueError, KeyError):
        pass
    columns = {}
    for name, cells in zip(names, zip(*rows)):
        try:
            columns[name] = np.array(cells, dtype=float)
        except ValueError:
            columns[name] = np.array(cells)
    return columns, units, search


class Sweep:
    """A table, its varied keys, and the points that have numbers."""

    def __init__(self, columns, units, search=None):
        self.columns, self.units, self.search = columns, units, search
        names = list(self.columns)
        if names[:1] != ["point"] or "status" not in names:
            raise NotASweep
        status = names.index("status")
        self.keys = [key for key in names[1:status] if len(np.unique(self.columns[key])) > 1] or names[1:2]
        self.numbers = [key for key in self.keys if self.columns[key].dtype.kind == "f"]
        self.words = [key for key in self.keys if key not in self.numbers]
        self.quantities = [name for name in names[status + 1:] if self.columns[name].dtype.kind == "f"]
        self.status = self.columns["status"]

    def label(self, name):
        unit = self.units.get(name)
        return f"{name} [{unit}]" if unit else name

    def chosen(self, names):
        usual = [name for name in ("occupied_20db_hz", "peak_v_out_m_per_s") if name in self.quantities]
        names = names or usual or [name for name in self.quantities if not name.startswith("estimated_")][:2]
        for name in names:
            if name not in self.quantities:
                raise ValueError(f"--quantity: found {name}, allowed: {', '.join(self.quantities)}")
        return names


def read_sweep(path):
    return Sweep(*(read_hdf5_table if path.endswith(".h5") else read_csv_table)(path))


def scale_of(values):
    """Whether the values lie evenly on a logarithmic axis rather than on a linear one."""
    values = np.unique(values)
    if len(values) < 3 or values[0] <= 0:
        return "linear"
    spread = [np.std(steps) / np.mean(steps) for steps in (np.diff(values), np.diff(np.log(values)))]
    return "log" if spread[1] < spread[0] else "linear"


def mark_doubtful(axes, sweep, x, y, points):
    """Marks points that have numbers but are not ok."""
    for status, marker in (("inaccurate", "o"), ("chaotic", "D")):
        there = points & (sweep.status == status)
        if there.any():
            axes.plot(x[there], y[there], marker, ms=5, mfc="none", mec="#b03a2e", ls="", label=status)


def draw_curves(axes, sweep, quantity):
    key = sweep.numbers[0] if sweep.numbers else sweep.words[0]
    x, y = sweep.columns[key], sweep.columns[quantity]
    groups = [(None, np.full(len(x), True))]
    if sweep.numbers and sweep.words:
        word = sweep.columns[sweep.words[0]]
        groups = [(w, word == w) for w in dict.fromkeys(word)]
    for (name, points), colour in zip(groups, COLOURS * len(groups)):
        order = np.flatnonzero(points)
        if sweep.numbers:
            order = order[np.argsort(x[order], kind="stable")]
        axes.plot(x[order], y[order], ".-", color=colour, lw=0.9, ms=3, label=name)
    mark_doubtful(axes, sweep, x, y, np.isfinite(y))
    for status in dict.fromkeys(sweep.status[~np.isfinite(y)]):  # no number: on the axis
        there = ~np.isfinite(y) & (sweep.status == status)
        axes.plot(x[there], np.zeros(there.sum()), "x", color="#b03a2e", ms=6, clip_on=False, ls="",
                  transform=axes.get_xaxis_transform(), label="no number" if status == "ok" else status)
    if sweep.numbers:
        axes.set_xscale(scale_of(x))
    axes.set_xlabel(sweep.label(key))
    axes.set_ylabel(sweep.label(quantity))
    axes.grid()
    if axes.get_legend_handles_labels()[1]:
        axes.legend(fontsize=8, frameon=False)


def draw_map(figure, axes, sweep, quantity):
    slow, fast = sweep.numbers
    x, y, z = sweep.columns[fast], sweep.columns[slow], sweep.columns[quantity]
    scales = scale_of(x), scale_of(y)
    grid = len(np.unique(x)) * len(np.unique(y)) == len(z)
    if grid:
        order = np.lexsort((x, y))
        shape = len(np.unique(y)), len(np.unique(x))
        colours = axes.pcolormesh(*(a[order].reshape(shape) for a in (x, y, z)), shading="nearest", rasterized=True)
    else:
        colours = axes.scatter(x, y, c=z, s=12)
    missing = ~np.isfinite(z)
    for status, colour in zip(dict.fromkeys(sweep.status[missing]), ["#b03a2e", "#222222", "#c46a1b", "#777777"]):
        there = missing & (sweep.status == status)
        axes.plot(x[there], y[there], "x", color=colour, ms=4, ls="", label="no number" if status == "ok" else status)
    mark_doubtful(axes, sweep, x, y, ~missing)
    axes.set_xscale(scales[0])
    axes.set_yscale(scales[1])
    axes.set_xlabel(sweep.label(fast))
    axes.set_ylabel(sweep.label(slow))
    figure.colorbar(colours, ax=axes, label=sweep.label(quantity))
    if axes.get_legend_handles_labels()[1]:
        axes.legend(fontsize=8)


def kept_bounds(sweep):
    """Of each point, whether it has the number that was looked for and keeps to the bounds."""
    kept = np.isfinite(sweep.columns[measure_of(sweep)]) & np.isin(sweep.status, ("ok", "inaccurate"))
    for bound in sweep.search["subject_to"]:
        measure, sign, number = bound.split()
        values = sweep.columns[measure]
        kept &= (values >= float(number)) if sign == ">=" else (values <= float(number))
    return kept


def measure_of(sweep):
    return sweep.search.get("maximise") or sweep.search["minimise"]


def draw_course(axes, sweep, kept):
    """The best so far, evaluation by evaluation."""
    y = sweep.columns[measure_of(sweep)]
    best = (np.fmax if "maximise" in sweep.search else np.fmin).accumulate(np.where(kept, y, np.nan))
    points = sweep.columns["point"]
    axes.plot(points[kept], y[kept], ".", color="#5f7f96", ms=3, alpha=0.6)
    axes.step(points, best, where="post", color="#0b6e8a", lw=1.2)
    axes.set_xlabel("evaluation")


def draw_over_key(axes, sweep, kept, key):
    x, y = sweep.columns[key], sweep.columns[measure_of(sweep)]
    axes.plot(x[~kept], y[~kept], ".", color="#bbbbbb", ms=3, label="beyond a bound")
    axes.plot(x[kept], y[kept], ".", color="#0b6e8a", ms=3)
    best = sweep.columns["point"] == sweep.search["best_point"]
    axes.plot(x[best], y[best], "*", color="#b03a2e", ms=11, ls="", label="best")
    if any(text.startswith(key + "=") and text.endswith(":log") for text in sweep.search["vary"]):
        axes.set_xscale("log")
    axes.set_xlabel(sweep.label(key))


def draw_search(sweep, title):
    """The measure over each key, and over the evaluations."""
    matplotlib.rcParams.update(STYLE | {"font.size": 9})
    kept = kept_bounds(sweep)
    panels = len(sweep.keys) + 1
    columns = min(panels, 3)
    figure, grid = plt.subplots(-(-panels // columns), columns, figsize=(3.6 * columns, 0.4 + 2.9 * -(-panels // columns)),
                                layout="constrained", squeeze=False, sharey=True)
    axes = grid.ravel()
    for spare in axes[panels:]:
        spare.axis("off")
    for key, panel in zip(sweep.keys, axes):
        draw_over_key(panel, sweep, kept, key)
    draw_course(axes[panels - 1], sweep, kept)
    for panel in axes[:panels]:
        panel.grid()
    for row in grid[:, 0]:
        row.set_ylabel(sweep.label(measure_of(sweep)))
    axes[0].legend(fontsize=8, frameon=False)
    if title:
        figure.suptitle(title.replace("$", r"\$"), x=0.01, ha="left", fontsize=10)
    return figure


def draw_sweep(sweep, quantities, title, panels=None):
    """An axes for each quantity. `panels` are axes of the caller's."""
    if sweep.search and not quantities and panels is None:
        return draw_search(sweep, title)
    if len(sweep.numbers) > 2 or len(sweep.words) > 1 or (len(sweep.numbers) == 2 and sweep.words):
        raise ValueError(f"found {len(sweep.keys)} keys that vary ({', '.join(sweep.keys)}), allowed: a number, two numbers, "
                         "or a number and a word")
    matplotlib.rcParams.update(STYLE | {"font.size": 9})
    quantities = sweep.chosen(quantities)
    is_map = len(sweep.numbers) == 2
    if panels is None:
        rows, columns, size = ((1, len(quantities), (5.4 * len(quantities), 4.2)) if is_map else
                               (len(quantities), 1, (7, 0.6 + 2.6 * len(quantities))))
        _, panels = plt.subplots(rows, columns, figsize=size, layout="constrained", squeeze=False)
    panels = np.ravel(panels)
    if len(panels) != len(quantities):
        raise ValueError(f"axes: found {len(panels)}, allowed: {len(quantities)}, one for each quantity")
    figure = panels[0].figure
    for axes, quantity in zip(panels, quantities):
        if is_map:
            draw_map(figure, axes, sweep, quantity)
        else:
            draw_curves(axes, sweep, quantity)
    if title:
        figure.suptitle(title.replace("$", r"\$"), x=0.01, ha="left", fontsize=10)
    return figure


def draw_recording(path, title):
    samples, about = read(path)
    if len(samples) == 0:
        raise ValueError("the recording has no samples")
    return draw(samples, about, title)


def main():
    plt.switch_backend("Agg")
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("recording", help="a recording of hertzline that ends in .npy, or a sweep: .h5, .csv")
    parser.add_argument("-o", "--output", required=True, help="the picture")
    parser.add_argument("--format", help="png, svg or pdf (default: the ending of the picture)")
    parser.add_argument("--title", default="", help="stands above")
    parser.add_argument("--quantity", type=lambda names: names.split(","), default=[], help="of a sweep: draw these numbers")
    arguments = parser.parse_args()
    if arguments.recording.endswith(".npy"):
        figure = draw_recording(arguments.recording, arguments.title)
    else:
        figure = draw_sweep(read_sweep(arguments.recording), arguments.quantity, arguments.title)
    figure.savefig(arguments.output, format=arguments.format, dpi=110, facecolor="white")


if __name__ == "__main__":
    try:
        main()
    except NotASweep:
        print("it is no sweep", file=sys.stderr)
        sys.exit(NOT_A_SWEEP)
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"{error}")
