"""Waveform and spectrum of each column of recordings; the spheres of a chain as a map over time."""
import re

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection

from .recordings import MAX_STRETCHES, furthest_from_0
from .spectra import HARMONICS, draw_spectrum, prepare_spectrum
from .style import COLOURS, note, plain_text, scale_of_unit, titled, unit_of_time, use_style

FEWEST_ROWS = 4  # of a map of a chain over time; fewer spheres have a waveform each
OF_CHAIN = {"v_chain": "velocity", "x_chain": "displacement", "f_chain": "force"}
MAX_NUMBERED = 30  # epochs


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
    values = np.array([furthest_from_0(recording.low[column], recording.high[column]) for _, column in panel])
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


def draw_panel(wave, lines, panel, colours, ends, unit_s, highest, drive, many):
    """Draws one column of each recording: waveforms and spectra. With many recordings their names are in it.

    ends: of the time axis, which all panels share [s].
    """
    scale = scale_of_unit(max(largest_of(recording, column) for recording, column in panel))
    prepare_spectrum(lines, highest, drive)
    peaks, bands = [], []
    for (recording, column), colour in zip(panel, colours):
        draw_waveform(wave, recording, column, unit_s, scale, colour)
        draw_record(wave, recording, column, unit_s, scale)
        mark_epochs(wave, recording, unit_s, colour if many else "#555555")
        before = plain_text(f"{recording.name}: ") if many else ""
        peaks.append(f"{before}peak {largest_of(recording, column) + 0:.3g}")  # + 0: silence has no sign
        part = recording.parts[column]
        bands.append(before + draw_spectrum(lines, part, recording.rate, recording.drive or drive, highest, colour))
        length = len(part) / recording.rate
        if length < 0.999 * (recording.ends[1] - recording.ends[0]):
            bands.append(f"of {length:.3g} s from {recording.part_from:.4g} s on")
    wave.set_xlim(ends[0] / unit_s, ends[1] / unit_s)
    wave.grid(axis="y")
    note(lines, bands)
    if many:
        wave.legend([line for line in wave.get_lines() if line.get_marker() != "."], peaks, fontsize=8, edgecolor="none", loc="upper right")
    else:
        note(wave, peaks)
    recording, column = panel[0]
    name, quantity, of = recording.columns[column]
    label = quantity if name.startswith(quantity) else name
    of = f"{of} \u00d7 {scale:g}".strip() if scale != 1 else of
    wave.set_ylabel(plain_text(f"{label} [{of}]" if of else label))
    lines.set_ylabel("level [dB]")


def draw(recordings, title, rows=None):
    """A row of two axes for each panel: waveforms and spectra. `rows` are axes of the caller's."""
    use_style(**{"agg.path.chunksize": 10000})
    panels = panels_of(recordings)
    if rows is None and len(recordings) == 1:
        panels = chain_panels(panels)
    many = len(recordings) > 1
    drive = next((recording.drive for recording in recordings if recording.drive), None)
    nyquist = max(recording.rate for recording in recordings) / 2
    highest = min(nyquist, (HARMONICS + 0.5) * drive if drive else nyquist)
    ends = (min(recording.ends[0] for recording in recordings),
            max(max(recording.ends[1], recording.ends[0] + 1 / recording.rate) for recording in recordings))
    unit_s, unit = unit_of_time(ends[1] - ends[0])
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
        draw_panel(wave, lines, panel, colours, ends, unit_s, highest, drive, many)
    epochs = "      dotted: live changes" if any(recording.epochs for recording in recordings) else ""
    rows[-1, 0].set_xlabel(f"time [{unit}]" + epochs)
    for lines in [rows[number, 1] for number, panel in enumerate(panels) if not is_map(panel)][-1:]:
        lines.tick_params(labelbottom=True)
        lines.set_xlabel("frequency [kHz]" + (f"      f = {drive / 1e3:g} kHz, lines at its multiples" if drive else ""))
    return titled(figure, title)
