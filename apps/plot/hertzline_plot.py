#!/usr/bin/python3
"""Draws waveform and spectrum of each column of a NumPy recording of hertzline, or a sweep: hertzline_plot.py FILE -o FILE.png

hertzline runs it for `hertzline plot` and `hertzline run --plot`, with recordings that it has reduced to what a picture shows; by
itself it draws recordings that end in .npy, and tables of `hertzline sweep`. A waveform of many samples is drawn as the smallest
and largest of each pixel. The spectrum is that of docs/measures.md: no window, in dB under the maximum from half the drive's
frequency upward, of the first million samples without a gap. Of a sweep it draws curves over one key that varies, a map over two,
or waveforms; of a search what it looked for over each key and as the search went on.
Debian: python3-numpy python3-matplotlib, for sweeps that end in .h5 python3-h5py.
"""
import argparse
import csv
import dataclasses
import json
import os
import re
import sys

MODULES_MISSING = 3  # exit status
NOT_A_SWEEP = 4
WRONG_USE = 5

FOLDER = os.getcwd()
if __name__ == "__main__":  # a user's settings may ask for LaTeX or a window; matplotlib looks for them in the folder first
    os.chdir("/")
    os.environ.update(MATPLOTLIBRC=os.devnull, MPLBACKEND="agg")
try:
    import matplotlib
    import matplotlib.pyplot as plt
    import numpy as np
    from matplotlib.collections import LineCollection
except ImportError as error:
    print(error, file=sys.stderr)
    sys.exit(MODULES_MISSING)
os.chdir(FOLDER)

SPAN_DB = (-60, 6)
HARMONICS = 10
FEWEST_ROWS = 4  # of a map of a chain over time; fewer spheres have a waveform each
OF_CHAIN = {"v_chain": "velocity", "x_chain": "displacement", "f_chain": "force"}
MAX_STRETCHES = 8192  # of a waveform, and levels of a spectrum: some for each pixel
MAX_SPECTRUM = 1 << 20  # samples
MAX_NUMBERED = 30  # epochs
MAX_WAVEFORMS = 200
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


@dataclasses.dataclass(eq=False)
class Recording:
    """A recording as it is drawn: smallest and largest samples of stretches, and the samples of its spectrum."""

    name: str
    columns: list  # (name, quantity, unit)
    rate: float  # [Hz]
    drive: float  # its frequency [Hz]; None: the recording does not say
    epochs: list  # (number, beginning [s]) of those that begin in the picture
    t: object  # middle of each stretch [s]
    ends: tuple  # [s]
    each: bool  # a stretch is a sample
    low: list  # [column][stretch], NaN where there is no sample
    high: list
    parts: list  # [column], samples without a gap
    part_from: float  # [s]


def reduced_recordings(path):
    """The recordings of `hertzline plot`, which it has reduced."""
    with open(path, encoding="utf-8") as file:
        return [reduced_recording(about, os.path.dirname(path)) for about in json.load(file)]


def reduced_recording(about, folder):
    columns, rate, width = len(about["columns"]), about["sample_rate_hz"], about["width"]
    numbers = np.fromfile(os.path.join(folder, about["numbers"]), dtype="<f8")
    outline, parts = np.split(numbers, [2 * columns * about["stretches"]])
    outline = outline.reshape(columns, 2, -1)
    return Recording(about["name"], about["columns"], rate, about["drive_hz"], about["epochs"],
                     middles(about["first"], width, about["stretches"], rate), (about["first"] / rate, (about["end"] - 1) / rate),
                     width == 1, list(outline[:, 0]), list(outline[:, 1]), list(parts.reshape(columns, -1)),
                     about["part_first"] / rate)


def middles(first, width, count, rate):
    """The middle of each stretch [s]."""
    return (first + width * np.arange(count) + (width - 1) / 2) / rate


def recording_of(samples, about, name=""):
    """The recording of samples by column, and their description."""
    t, rate = samples["t_s"], about["sample_rate_hz"]
    if len(t) == 0:
        raise ValueError("the recording has no samples")
    index = np.rint(np.asarray(t) * rate).astype(np.int64)
    width = 1
    while (index[-1] - index[0]) // width >= MAX_STRETCHES:
        width *= 2
    stretch = (index - index[0]) // width
    begins = np.flatnonzero(np.diff(stretch, prepend=-1))
    part = longest_part(index)
    low, high, parts = [], [], []
    for column, *_ in about["columns"]:
        v = np.asarray(samples[column], dtype=float)
        for values, choose in ((low, np.minimum), (high, np.maximum)):
            values.append(np.full(stretch[-1] + 1, np.nan))
            values[-1][stretch[begins]] = choose.reduceat(v, begins)
        parts.append(v[part])
    return Recording(name, about["columns"], rate, drive_frequency(about), epochs_in(about, index / rate),
                     middles(index[0], width, stretch[-1] + 1, rate), (index[0] / rate, index[-1] / rate), width == 1, low, high, parts,
                     index[part.start] / rate)


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


def epochs_in(about, t):
    """Number and beginning [s] of the epochs that live changes began."""
    try:
        changes = [(change["epoch"], change["sample"] / about["sample_rate_hz"]) for change in about["provenance"]["changes"]]
    except (KeyError, TypeError):
        return []
    return [(number, begin) for number, begin in changes if t[0] < begin <= t[-1]]


def longest_part(index):
    """The longest part without a gap, as a slice of at most MAX_SPECTRUM samples."""
    edges = np.concatenate(([0], np.flatnonzero(np.diff(index) > 1) + 1, [len(index)]))
    longest = np.argmax(np.minimum(np.diff(edges), MAX_SPECTRUM))
    return slice(edges[longest], min(edges[longest + 1], edges[longest] + MAX_SPECTRUM))


def spectrum(v, rate, lowest):
    """Frequency [Hz] and amplitude [of the largest from `lowest` upward]; None of silence."""
    padded = 4 * len(v)
    magnitude = np.abs(np.fft.rfft(v / (np.abs(v).max() or 1), padded))  # 1e308 has no square
    frequency = np.fft.rfftfreq(padded, 1 / rate)
    largest = magnitude[frequency >= lowest].max(initial=0)
    return (frequency, magnitude / largest) if largest > 0 else None


def band_of(frequency, amplitude, lowest, threshold_db):
    """Where the level first and last reaches the threshold from `lowest` upward, with straight lines between the amplitudes."""
    threshold = 10 ** (threshold_db / 20)
    above = np.flatnonzero((amplitude >= threshold) & (frequency >= lowest))

    def crossing(inside, outside):
        if not 0 <= outside < len(frequency) or frequency[outside] < lowest:
            return frequency[inside]
        share = (amplitude[inside] - threshold) / (amplitude[inside] - amplitude[outside])
        return frequency[inside] + share * (frequency[outside] - frequency[inside])

    return crossing(above[0], above[0] - 1), crossing(above[-1], above[-1] + 1)


def scale_of_unit(largest):
    """A power of ten that numbers are divided by where matplotlib would overflow; else 1."""
    return 10.0 ** np.floor(np.log10(largest)) if largest > 0 and not 1e-100 < largest < 1e100 else 1.0


def joined(values, others):
    """Both in turn."""
    return np.column_stack((values, others)).ravel()


def draw_waveform(axes, recording, column, unit_s, scale, colour):
    low, high = recording.low[column] / scale, recording.high[column] / scale
    if recording.each:
        axes.plot(recording.t / unit_s, low, color=colour, lw=0.8)
    else:
        axes.plot(np.repeat(recording.t, 2) / unit_s, joined(low, high), color=colour, lw=0.8, solid_joinstyle="bevel")


def mark_epochs(axes, recording, unit_s, colour):
    """A line where each live change begins to apply, with the number of its epoch."""
    if not recording.epochs:
        return
    numbers, begins = zip(*recording.epochs)
    lines = [((begin / unit_s, 0), (begin / unit_s, 1)) for begin in begins]
    axes.add_collection(LineCollection(lines, transform=axes.get_xaxis_transform(), color=colour, lw=0.8, ls=(0, (2, 2))), autolim=False)
    for number, begin in recording.epochs if len(numbers) <= MAX_NUMBERED else []:
        axes.text(begin / unit_s, 1.0, f" {number}", transform=axes.get_xaxis_transform(), fontsize=7, va="bottom", color=colour)


def largest_of(recording, column):
    return max(-np.nanmin(recording.low[column]), np.nanmax(recording.high[column]))


def prepare_spectrum(axes, highest, drive):
    axes.set_xlim(0, highest / 1e3)
    axes.set_ylim(*SPAN_DB)
    axes.set_yticks([-60, -40, -20, 0])
    axes.grid(axis="y")
    axes.axhline(-20, color="#555555", lw=0.8, ls=(0, (4, 3)))
    for k in range(1, int(highest // drive) + 1 if drive else 1):
        axes.axvline(k * drive / 1e3, color="#bbbbbb", lw=0.6, zorder=0)


def levels_up_to(highest, frequency, amplitude):
    """Frequencies, and levels [dB]; of many the largest of each pixel."""
    shown = np.searchsorted(frequency, highest, side="right")
    begins = np.arange(0, shown, -(-shown // MAX_STRETCHES))
    return frequency[begins], 20 * np.log10(np.maximum(np.maximum.reduceat(amplitude[:shown], begins), 1e-15))


def draw_spectrum(axes, v, rate, drive, highest, colour):
    """Draws the levels. Returns the band at -20 dB as text."""
    lowest = drive / 2 if drive else 0
    lines = spectrum(v, rate, lowest)
    if lines is None:
        return "silence"
    low, high = (edge / 1e3 for edge in band_of(*lines, lowest, -20))
    axes.axvspan(low, high, color=colour, alpha=0.08, lw=0)
    frequency, level = levels_up_to(highest, *lines)
    axes.fill_between(frequency / 1e3, level, SPAN_DB[0], color=colour, alpha=0.15, lw=0)
    axes.plot(frequency / 1e3, level, color=colour, lw=0.8)
    return f"\u221220 dB: {low:.4g} to {high:.4g} kHz"


def panels_of(recordings):
    """The columns of each panel: (recording, index of its column). Recordings of one column each share a panel."""
    if all(len(recording.columns) == 1 for recording in recordings):
        return [[(recording, 0) for recording in recordings]]
    panels = {}
    for recording in recordings:
        for column, (name, *_) in enumerate(recording.columns):
            panels.setdefault(name, []).append((recording, column))
    return list(panels.values())


def chain_panels(panels):
    """Panels in which the spheres, or contacts, of one recording share a map."""
    together = {}
    for panel in panels:
        for recording, column in panel:
            name, quantity, _ = recording.columns[column]
            together.setdefault(quantity if quantity in OF_CHAIN else name, []).append((recording, column))
    return [part for panel in together.values() for part in ([panel] if is_map(panel) else [[one] for one in panel])]


def is_map(panel):
    recording, column = panel[0]
    return len(panel) >= FEWEST_ROWS and recording.columns[column][1] in OF_CHAIN and all(other is recording for other, _ in panel)


def draw_chain(axes, panel, unit_s):
    """Draws one quantity of all spheres, or contacts, over time."""
    recording = panel[0][0]
    values = np.array([(recording.low[column] + recording.high[column]) / 2 for _, column in panel])
    numbers = [int(re.search(r"\d+", recording.columns[column][0])[0]) for _, column in panel]
    _, quantity, unit = recording.columns[panel[0][1]]
    quantity = OF_CHAIN[quantity]
    largest = np.nanmax(np.abs(values)) or 1
    scale = scale_of_unit(largest)
    signed = quantity != "force"
    begin, end = recording.ends
    image = axes.imshow(values / scale, aspect="auto", origin="lower", interpolation="nearest", rasterized=True,
                        extent=(begin / unit_s, max(end, begin + 1 / recording.rate) / unit_s, numbers[0] - 0.5, numbers[-1] + 0.5),
                        cmap="RdBu_r" if signed else "magma", vmin=-largest / scale if signed else None, vmax=largest / scale)
    mark_epochs(axes, recording, unit_s, "#555555")
    axes.set_ylabel("contact, from the horn" if quantity == "force" else "sphere, from the horn")
    axes.yaxis.get_major_locator().set_params(integer=True)
    of = f"{unit} \u00d7 {scale:g}" if scale != 1 else unit
    axes.figure.colorbar(image, ax=axes, label=f"{quantity} [{of}]", pad=0.01)


def note(axes, texts):
    axes.text(0.985, 0.95, "\n".join(texts), transform=axes.transAxes, ha="right", va="top", fontsize=8,
              bbox={"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 1.5} if texts else None)


def draw_panel(wave, lines, panel, colours, unit_s, highest, drive, many):
    """Draws one column of each recording: waveforms and spectra. With many recordings their names are in it."""
    scale = scale_of_unit(max(largest_of(recording, column) for recording, column in panel))
    prepare_spectrum(lines, highest, drive)
    peaks, bands = [], []
    for (recording, column), colour in zip(panel, colours):
        draw_waveform(wave, recording, column, unit_s, scale, colour)
        mark_epochs(wave, recording, unit_s, colour if many else "#555555")
        before = f"{recording.name}: ".replace("$", r"\$") if many else ""
        peaks.append(f"{before}peak {largest_of(recording, column):.3g}")
        part = recording.parts[column]
        bands.append(before + draw_spectrum(lines, part, recording.rate, recording.drive or drive, highest, colour))
        length = len(part) / recording.rate
        if length < 0.999 * (recording.ends[1] - recording.ends[0]):
            bands.append(f"of {length:.3g} s from {recording.part_from:.4g} s on")
    wave.set_xlim(min(recording.ends[0] for recording, _ in panel) / unit_s,
                  max(max(recording.ends[1], recording.ends[0] + 1 / recording.rate) for recording, _ in panel) / unit_s)
    wave.grid(axis="y")
    note(lines, bands)
    if many:
        wave.legend(wave.get_lines(), peaks, fontsize=8, edgecolor="none", loc="upper right")
    else:
        note(wave, peaks)
    recording, column = panel[0]
    name, quantity, of = recording.columns[column]
    label = quantity if name.startswith(quantity) else name
    of = f"{of} \u00d7 {scale:g}".strip() if scale != 1 else of
    wave.set_ylabel(f"{label} [{of}]" if of else label)
    lines.set_ylabel("level [dB]")


def draw(recordings, title, rows=None):
    """A row of two axes for each panel: waveforms and spectra. `rows` are axes of the caller's."""
    matplotlib.rcParams.update(STYLE | {"font.size": 9, "agg.path.chunksize": 10000})
    panels = panels_of(recordings)
    if rows is None and len(recordings) == 1:
        panels = chain_panels(panels)
    many = len(recordings) > 1
    drive = next((recording.drive for recording in recordings if recording.drive), None)
    nyquist = max(recording.rate for recording in recordings) / 2
    highest = min(nyquist, (HARMONICS + 0.5) * drive if drive else nyquist)
    span = max(recording.ends[1] for recording in recordings) - min(recording.ends[0] for recording in recordings)
    unit_s, unit = (1e-6, "\u00b5s") if span < 2e-3 else (1e-3, "ms") if span < 2 else (1, "s")
    if rows is None:
        _, rows = plt.subplots(len(panels), 2, figsize=(10, 1.0 + sum(3.5 if is_map(panel) else 1.8 for panel in panels)), sharex="col",
                               layout="constrained", squeeze=False)
    figure = rows[0, 0].figure
    for number, (panel, (wave, lines)) in enumerate(zip(panels, rows)):
        if is_map(panel):
            wave.remove()
            lines.remove()
            rows[number, 0] = figure.add_subplot(rows[number, 0].get_gridspec()[number, :])
            draw_chain(rows[number, 0], panel, unit_s)
            continue
        colours = [COLOURS[(recordings.index(recording) if many else number) % len(COLOURS)] for recording, _ in panel]
        draw_panel(wave, lines, panel, colours, unit_s, highest, drive, many)
    epochs = "      dotted: live changes" if any(recording.epochs for recording in recordings) else ""
    rows[-1, 0].set_xlabel(f"time [{unit}]" + epochs)
    for lines in [rows[number, 1] for number, panel in enumerate(panels) if not is_map(panel)][-1:]:
        lines.tick_params(labelbottom=True)
        lines.set_xlabel("frequency [kHz]" + (f"      f = {drive / 1e3:g} kHz, lines at its multiples" if drive else ""))
    if title:
        figure.suptitle(title.replace("$", r"\$"), x=0.01, ha="left", fontsize=10)
    return figure


class NotASweep(Exception):
    pass


class WrongUse(ValueError):
    pass


def search_of(provenance):
    """The request of `hertzline optimise`; None: it is a sweep."""
    return provenance.get("search")


def object_in(text):
    """The JSON object in a text; an empty one where there is none."""
    try:
        found = json.loads(text)
    except (TypeError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


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
        search = search_of(object_in(file.attrs.get("provenance")))
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
        usual = [name for name in ("occupied_20db_hz", "peak_v_out_m_per_s", "peak_pa") if name in self.quantities]
        names = names or usual or [name for name in self.quantities if not name.startswith("estimated_")][:2]
        for name in names:
            if name not in self.quantities:
                raise WrongUse(f"--quantity: found {name}, allowed: {', '.join(self.quantities)}")
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


def groups_of(sweep):
    """The key along the axis, and the points of each word of another key: (word, which points)."""
    key = (sweep.numbers + sweep.words)[0]
    others = [word for word in sweep.words if word != key]
    if not others:
        return key, [(None, np.full(len(sweep.status), True))]
    word = sweep.columns[others[0]]
    return key, [(w, word == w) for w in dict.fromkeys(word)]


def draw_curves(axes, sweep, quantity):
    key, groups = groups_of(sweep)
    x, y = sweep.columns[key], sweep.columns[quantity]
    for (name, points), colour in zip(groups, COLOURS * len(groups)):
        order = np.flatnonzero(points)
        if sweep.numbers:
            order = order[np.argsort(x[order], kind="stable")]
            axes.plot(x[order], y[order], ".-", color=colour, lw=0.9, ms=3, label=name)
        else:  # words have no order that a line could follow
            axes.plot(x[order], y[order], "o", color=colour, ms=6, label=name)
    if not sweep.numbers and sum(map(len, dict.fromkeys(x))) > 60:
        axes.tick_params(axis="x", labelrotation=30)
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
    is_field = sweep.units.get(fast) == sweep.units.get(slow) == "m" and {fast, slow} <= {"x_m", "y_m", "z_m"}
    unit = 1e3 if is_field else 1
    x, y, z = unit * sweep.columns[fast], unit * sweep.columns[slow], sweep.columns[quantity]
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
    axes.set_xlabel(f"{fast[0]} [mm]" if is_field else sweep.label(fast))
    axes.set_ylabel(f"{slow[0]} [mm]" if is_field else sweep.label(slow))
    if is_field and grid:
        draw_beam(axes, *(a[order].reshape(shape) for a in (x, y, z)))
    figure.colorbar(colours, ax=axes, label=sweep.label(quantity))
    if axes.get_legend_handles_labels()[1]:
        axes.legend(fontsize=8)


def draw_beam(axes, x, y, pressure):
    """Lengths to one scale, and the line of half the largest pressure."""
    if "log" not in (axes.get_xscale(), axes.get_yscale()):
        axes.set_aspect("equal")
    if np.isfinite(pressure).all() and min(pressure.shape) > 1:
        lines = axes.contour(x, y, 20 * np.log10(np.maximum(pressure / pressure.max(), 1e-6)), levels=[-20, -12, -6],
                             colors="white", linewidths=0.7, linestyles="solid")
        axes.clabel(lines, fmt="%g dB", fontsize=7)


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
    if len(sweep.keys) > 2:
        raise WrongUse(f"found {len(sweep.keys)} keys that vary ({', '.join(sweep.keys)}), allowed: one or two")
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


def read_waveforms(path, name):
    """Samples of each point, NaN after its last one, their unit, and the rate of each point [Hz]."""
    try:
        import h5py
    except ImportError as error:
        print(error, file=sys.stderr)
        sys.exit(MODULES_MISSING)
    with h5py.File(path, "r") as file:
        there = [key for key in file if key != "points"]
        if name not in there:
            raise WrongUse(f"--columns: found {name}, allowed: {', '.join(there) or 'a sweep that was made with --waveforms'}")
        table, samples = file["points"], file[name]
        provenance = object_in(file.attrs.get("provenance"))
        key = "output.sample_rate_hz"
        rate = table[key][:] if key in table.dtype.names else np.full(len(table), provenance["scene"]["output"]["sample_rate_hz"])
        drive = drive_frequency({"provenance": provenance})
        chosen = np.unique(np.linspace(0, len(table) - 1, min(len(table), MAX_WAVEFORMS)).astype(int))
        return samples[list(chosen)], samples.attrs.get("units", ""), rate[chosen], drive, chosen


def waveform_recordings(sweep, path, name):
    """A recording for each point that has samples, and its number."""
    samples, unit, rates, drive, points = read_waveforms(path, name)
    recordings = []
    for v, rate, point in zip(samples, rates, points):
        v = v[:np.flatnonzero(np.isfinite(v))[-1] + 1] if np.isfinite(v).any() else v[:0]
        if len(v) > 0:
            words = ", ".join(value_text(sweep.columns[key][point]) for key in sweep.keys)
            about = {"columns": [(name, name, unit)], "sample_rate_hz": rate}
            recordings.append((recording_of({"t_s": np.arange(len(v)) / rate, name: v}, about, words), point))
    for recording, _ in recordings:
        recording.drive = drive
    if not recordings:
        raise ValueError("no point has samples")
    return recordings


def value_text(value):
    return f"{value:g}" if isinstance(value, float) else str(value)


def draw_waveforms(sweep, path, names, title):
    """Waveforms and spectra of all points, by colour: a legend for a few, a scale for many."""
    matplotlib.rcParams.update(STYLE | {"font.size": 9})
    if len(names) != 1:
        raise WrongUse(f"--columns: found {', '.join(names)}, allowed: one output of a sweep")
    recordings, points = zip(*waveform_recordings(sweep, path, names[0]))
    if len(recordings) <= len(COLOURS):
        figure = draw(list(recordings), title)
        if len(recordings) > 1:
            figure.axes[0].get_legend().set_title(", ".join(map(sweep.label, sweep.keys)), prop={"size": 8})
        return figure
    key = (sweep.numbers + ["point"])[0]
    values = sweep.columns[key][list(points)]
    scale = matplotlib.colors.LogNorm if scale_of(values) == "log" else matplotlib.colors.Normalize
    colours = matplotlib.cm.ScalarMappable(scale(values.min(), values.max()), "viridis")
    figure, (wave, lines) = plt.subplots(2, 1, figsize=(8, 6), layout="constrained")
    first = recordings[0]
    span = max(recording.ends[1] for recording in recordings)
    unit_s, unit = (1e-6, "\u00b5s") if span < 2e-3 else (1e-3, "ms")
    highest = min(first.rate / 2, (HARMONICS + 0.5) * first.drive if first.drive else first.rate / 2)
    prepare_spectrum(lines, highest, first.drive)
    for recording, value in zip(recordings, values):
        colour = colours.to_rgba(value)
        draw_waveform(wave, recording, 0, unit_s, 1, colour)
        found = spectrum(recording.parts[0], recording.rate, recording.drive / 2 if recording.drive else 0)
        if found is not None:
            frequency, level = levels_up_to(highest, *found)
            lines.plot(frequency / 1e3, level, color=colour, lw=0.6)
    wave.grid(axis="y")
    wave.set_xlabel(f"time [{unit}]")
    wave.set_ylabel(f"{names[0]} [{first.columns[0][2]}]")
    lines.set_xlabel("frequency [kHz]")
    lines.set_ylabel("level [dB]")
    figure.colorbar(colours, ax=[wave, lines], label=sweep.label(key))
    if len(sweep.status) > MAX_WAVEFORMS:
        note(wave, [f"{len(recordings)} of {len(sweep.status)} points"])
    if title:
        figure.suptitle(title.replace("$", r"\$"), x=0.01, ha="left", fontsize=10)
    return figure


def list_of(text):
    return text.split(",")


def figure_of(arguments):
    path = arguments.recording
    if path.endswith(".json"):
        return draw(reduced_recordings(path), arguments.title)
    if path.endswith(".npy"):
        return draw([recording_of(*read(path))], arguments.title)
    sweep = read_sweep(path)
    if arguments.columns:
        if not path.endswith(".h5"):
            raise WrongUse("--columns: found a sweep as CSV, allowed: one that ends in .h5 and was made with --waveforms")
        return draw_waveforms(sweep, path, arguments.columns, arguments.title)
    return draw_sweep(sweep, arguments.quantity, arguments.title)


def main():
    plt.switch_backend("Agg")
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("recording", help="a recording of hertzline that ends in .npy, or a sweep: .h5, .csv")
    parser.add_argument("-o", "--output", required=True, help="the picture")
    parser.add_argument("--format", help="png, svg or pdf (default: the ending of the picture)")
    parser.add_argument("--title", default="", help="stands above")
    parser.add_argument("--quantity", type=list_of, default=[], help="of a sweep: draw these numbers")
    parser.add_argument("--columns", type=list_of, default=[], help="of a sweep: draw the waveforms of this output")
    arguments = parser.parse_args()
    figure_of(arguments).savefig(arguments.output, format=arguments.format, dpi=110, facecolor="white")


if __name__ == "__main__":
    try:
        main()
    except NotASweep:
        print("it is no sweep", file=sys.stderr)
        sys.exit(NOT_A_SWEEP)
    except WrongUse as error:
        print(error, file=sys.stderr)
        sys.exit(WRONG_USE)
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"{error}")
