"""Waveform and spectrum of each column of recordings; the spheres of a chain as a map over time."""
import re

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection

from .recordings import MAX_STRETCHES, furthest_from_0
from .spectra import HARMONICS, draw_spectrum, prepare_spectrum
from .style import line_style, named_at_most, note, plain_text, scale_of_unit, shortened, titled, unit_of_time, use_style

FEWEST_ROWS = 4  # of a map of a chain over time; fewer spheres have a waveform each
OF_CHAIN = {"v_chain": "velocity", "x_chain": "displacement", "f_chain": "force"}
MAX_NUMBERED = 30  # epochs
MAX_NAMED = 10  # recordings, in a legend
MAX_SHADED = 3  # spectra
MAX_ROW_NUMBERS = 15  # beside a map


def draw_record(axes, recording, column, unit_s, scale):
    """Dots on the motion that the program made of them."""
    if recording.record and recording.record[0] == recording.columns[column][1]:
        _, t, values = recording.record
        shown = np.flatnonzero((t >= recording.ends[0]) & (t <= recording.ends[1]))
        shown = shown[:: -(-len(shown) // MAX_STRETCHES) or 1]
        axes.plot(t[shown] / unit_s, values[shown] / scale, ls="none", marker=".", ms=2, color="#222222", zorder=3)


def joined(values, others):
    """Both in turn."""
    return np.column_stack((values, others)).ravel()


def draw_waveform(axes, recording, column, unit_s, scale, style):
    """Returns the line. Samples between two gaps are points."""
    low, high, t = recording.low[column] / scale, recording.high[column] / scale, recording.t / unit_s
    if recording.each:
        line, = axes.plot(t, low, lw=0.8, **style)
    else:
        line, = axes.plot(np.repeat(t, 2), joined(low, high), lw=0.8, solid_joinstyle="bevel", **style)
    there = np.concatenate(([False], np.isfinite(low), [False]))
    alone = there[1:-1] & ~there[:-2] & ~there[2:]
    if alone.any():
        axes.plot(t[alone], high[alone], ls="none", marker=".", ms=3, color=style["color"])
    return line


def mark_epochs(axes, recording, unit_s, colour):
    """A line where each live change begins to apply, with the number of its epoch. One that began before has its number only."""
    if not recording.epochs:
        return
    numbers, begins = zip(*recording.epochs)
    lines = [((begin / unit_s, 0), (begin / unit_s, 1)) for begin in begins if begin > recording.ends[0]]
    axes.add_collection(LineCollection(lines, transform=axes.get_xaxis_transform(), color=colour, lw=0.8, ls=(0, (2, 2))), autolim=False)
    for number, begin in recording.epochs if len(numbers) <= MAX_NUMBERED else []:
        axes.text(begin / unit_s, 1.0, f" {number}", transform=axes.get_xaxis_transform(), fontsize=7, va="bottom", color=colour)


def largest_of(recording, column):
    return max(-np.nanmin(recording.low[column]), np.nanmax(recording.high[column]))


def panels_of(recordings):
    """The columns of each panel, (recording, index of its column): those of one name and unit. Recordings of one column each share a panel
    if their units are the same."""
    alone = all(len(recording.columns) == 1 for recording in recordings)
    panels = {}
    for recording in recordings:
        for column, (name, _, unit) in enumerate(recording.columns):
            panels.setdefault((None if alone else name, unit), []).append((recording, column))
    return list(panels.values())


def label_of(recording, column):
    """The name of a column without its unit: "v_out", "v_last_2"."""
    name, quantity, _ = recording.columns[column]
    begin = re.match(rf"{re.escape(quantity)}(_\d+)?(?=_|$)", name)
    return begin[0] if begin else name


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


def limits_of(ends, unit_s):
    """The ends of a time axis, with room for peaks of the first and the last sample."""
    margin = 0.005 * (ends[1] - ends[0])
    return (ends[0] - margin) / unit_s, (ends[1] + margin) / unit_s


def draw_chain(axes, panel, unit_s):
    """Draws one quantity of all spheres, or contacts, over time."""
    recording = panel[0][0]
    values = np.array([furthest_from_0(recording.low[column], recording.high[column]) for _, column in panel])
    numbers = [int(re.search(r"\d+", recording.columns[column][0])[0]) for _, column in panel]
    _, quantity, unit = recording.columns[panel[0][1]]
    quantity = OF_CHAIN[quantity]
    largest = np.nanmax(np.abs(values)) or 1
    scale = scale_of_unit(largest)
    signed = quantity != "force"
    begin, end = recording.span
    rows = range(numbers[0], numbers[0] + len(numbers))
    image = axes.imshow(values / scale, aspect="auto", origin="lower", interpolation="nearest", rasterized=True,
                        extent=(begin / unit_s, end / unit_s, rows[0] - 0.5, rows[-1] + 0.5),
                        cmap="RdBu_r" if signed else "magma", vmin=-largest / scale if signed else None, vmax=largest / scale)
    mark_epochs(axes, recording, unit_s, "#555555")
    axes.set_ylabel("contact, from the horn" if quantity == "force" else "sphere, from the horn")
    if numbers == list(rows):
        axes.yaxis.get_major_locator().set_params(integer=True)
    else:  # some of them were chosen
        step = -(-len(numbers) // MAX_ROW_NUMBERS)
        axes.set_yticks(rows[::step], numbers[::step])
    of = f"{unit} \u00d7 {scale:g}" if scale != 1 else unit
    axes.set_xlim(limits_of(recording.span, unit_s))
    axes.figure.colorbar(image, ax=axes, label=f"{quantity} [{of}]", pad=0.01)


def draw_panel(wave, lines, panel, styles, ends, unit_s, highest, drive, many):
    """Draws one column of each recording: waveforms and spectra. With many recordings their names are in it.

    ends: of the time axis, which all panels share [s]. drive: that of all recordings [Hz]; None: they have several, or none.
    """
    scale = scale_of_unit(max(largest_of(recording, column) for recording, column in panel))
    prepare_spectrum(lines, highest, drive)
    labels = list(dict.fromkeys(label_of(*one) for one in panel))
    peaks, bands, handles = [], [], []
    for (recording, column), style in zip(panel, styles):
        handles.append(draw_waveform(wave, recording, column, unit_s, scale, style))
        draw_record(wave, recording, column, unit_s, scale)
        mark_epochs(wave, recording, unit_s, style["color"] if many else "#555555")
        part = recording.parts[column]
        band = draw_spectrum(lines, part, recording.rate, recording.lowest(drive), highest, style, len(panel) <= MAX_SHADED)
        length = len(part) / recording.rate
        if length < 0.999 * (recording.ends[1] - recording.ends[0]):
            band += f", of {length:.3g} s from {recording.part_from:.4g} s on"
        name = shortened(recording.name) + (f" {label_of(recording, column)}" if len(labels) > 1 else "")
        before = plain_text(f"{name}: ") if many else ""
        unit = plain_text(recording.columns[column][2])
        peaks.append(f"{before}peak {largest_of(recording, column) + 0:.3g} {unit}".rstrip())  # + 0: silence has no sign
        bands.append(before + band)
    wave.set_xlim(limits_of(ends, unit_s))
    wave.grid(axis="y")
    numbered = 8 if any(recording.epochs for recording, _ in panel) else 0
    if many:
        wave.legend(*named_at_most(MAX_NAMED, handles, peaks), fontsize=8, frameon=False, loc="lower right", bbox_to_anchor=(1, 1),
                    borderaxespad=(1.6 + numbered) / 8, labelspacing=0.2)  # above, where it hides no curve
        note(lines, named_at_most(MAX_NAMED, handles, bands)[1])
    else:
        note(wave, peaks, above=numbered)
        note(lines, bands)
    of = panel[0][0].columns[panel[0][1]][2]
    of = f"{of} \u00d7 {scale:g}".strip() if scale != 1 else of
    label = labels[0] if len(labels) == 1 else ""
    wave.set_ylabel(plain_text(f"{label} [{of}]".strip() if of else label))
    lines.set_ylabel("level [dB]")


def height_of(panel):
    """In inches, with a line above for each spectrum."""
    return 3.5 if is_map(panel) else 1.8 + 0.14 * min(len(panel), MAX_NAMED + 1)


def frequencies_of(recordings):
    """The drive's frequency of all recordings that say one, None where they have several or none, and the end of the axis of spectra [Hz]."""
    drives = {frequency for recording in recordings for frequency in recording.drives}
    nyquist = max(recording.rate for recording in recordings) / 2
    return next(iter(drives)) if len(drives) == 1 else None, min(nyquist, (HARMONICS + 0.5) * max(drives, default=np.inf))


def notes_on_time(recordings):
    """The meaning of the marks on waveforms."""
    horn = {recording.record[0] for recording in recordings if recording.record}
    shown = {quantity for recording in recordings for _, quantity, _ in recording.columns}
    return (["dotted: live changes"] if any(recording.epochs for recording in recordings) else []) + (
        ["dots: the record that drives the horn"] if horn & shown else [])


def draw(recordings, title, rows=None):
    """A row of two axes for each panel: waveforms and spectra. `rows` are axes of the caller's."""
    use_style(**{"agg.path.chunksize": 10000})
    panels = panels_of(recordings)
    if rows is None and len(recordings) == 1:
        panels = chain_panels(panels)
    many = len(recordings) > 1
    drive, highest = frequencies_of(recordings)
    ends = min(recording.span[0] for recording in recordings), max(recording.span[1] for recording in recordings)
    unit_s, unit = unit_of_time(ends[1] - ends[0])
    if rows is None:
        heights = [height_of(panel) for panel in panels]
        _, rows = plt.subplots(len(panels), 2, figsize=(10, 1.0 + sum(heights)), sharex="col", layout="constrained", squeeze=False,
                               gridspec_kw={"height_ratios": heights})
    figure = rows[0, 0].figure
    for number, (panel, (wave, lines)) in enumerate(zip(panels, rows)):
        if is_map(panel):
            wave.remove()
            lines.remove()
            rows[number, 0] = figure.add_subplot(rows[number, 0].get_gridspec()[number, :])
            draw_chain(rows[number, 0], panel, unit_s)
            continue
        styles = [line_style(recordings.index(recording) if many else number) for recording, _ in panel]
        draw_panel(wave, lines, panel, styles, ends, unit_s, highest, drive, many)
    rows[-1, 0].set_xlabel("      ".join([f"time [{unit}]", *notes_on_time(recordings)]))
    for wave, lines in [rows[number] for number, panel in enumerate(panels) if not is_map(panel)][-1:]:
        wave.tick_params(labelbottom=True)
        lines.tick_params(labelbottom=True)
        lines.set_xlabel("frequency [kHz]" + (f"      f = {drive / 1e3:g} kHz, lines at its multiples" if drive else ""))
    return titled(figure, title)
