"""Sweeps: curves over one key, a map over two, waveforms. Searches: the measure over each key and as the search went on."""
import matplotlib
import matplotlib.pyplot as plt
import numpy as np

from .recordings import recording_of
from .spectra import levels_up_to, prepare_spectrum, spectrum
from .style import COLOURS, WrongUse, line_style, named_at_most, note, plain_text, titled, unit_of_time, use_style
from .tables import read_waveforms
from .waveforms import MAX_NAMED, draw, draw_waveform, frequencies_of

LONGEST_LEGEND = 12  # entries of one column
MOST_NAMED = 2 * LONGEST_LEGEND - 1  # the colours and dashes there are, but one
MOST_INSIDE = 4  # entries; with more a legend stands beside the axes
LETTERS_AN_INCH = 9  # below an axis
MOST_SLANTED = 12  # words
COUNTED = ("ok", "inaccurate")  # by a search


def scale_of(values):
    """Whether the values lie evenly on a logarithmic axis rather than on a linear one."""
    values = np.unique(values)
    if len(values) < 3 or values[0] <= 0:
        return "linear"
    spread = [np.std(steps) / np.mean(steps) for steps in (np.diff(values), np.diff(np.log(values)))]
    return "log" if spread[1] < spread[0] else "linear"


def edges_of(centres, scale, within):
    """The edges of the cells around each centre: midway to its neighbours on an axis of that scale. within: no cell goes beyond the outer
    centres"""
    to, back = (np.log, np.exp) if scale == "log" else (np.asarray, np.asarray)
    at = to(centres)
    with np.errstate(over="ignore"):
        between = (at[1:] + at[:-1]) / 2
        outer = at[[0, -1]] if within else (at[0] - (between[0] - at[0]), at[-1] + (at[-1] - between[-1]))
        return back(np.concatenate(([outer[0]], between, [outer[1]])))


def write_words(axes, words):
    """Turns the words below an axis where they would overlap."""
    words = list(dict.fromkeys(words))
    width = axes.get_window_extent().width / axes.figure.dpi
    if sum(map(len, words)) > LETTERS_AN_INCH * width:
        axes.tick_params(axis="x", labelrotation=30 if len(words) <= MOST_SLANTED else 90)


def legend_of(axes, title=None):
    """The legend, if there is anything in it."""
    handles, labels = named_at_most(MOST_NAMED, *axes.get_legend_handles_labels())
    if labels:
        place = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.0)} if len(labels) > MOST_INSIDE else {}
        axes.legend(handles, labels, fontsize=8 if len(labels) <= LONGEST_LEGEND else 6, ncols=-(-len(labels) // LONGEST_LEGEND),
                    edgecolor="none", title=title, title_fontsize=8, **place)


def number_axis(axis, values):
    """Few ticks, as their numbers may be long; between whole numbers there are no fractions."""
    if axis.get_scale() == "linear":
        axis.get_major_locator().set_params(nbins=6, integer=bool(np.all(values == np.round(values))))


def mark_doubtful(axes, sweep, x, y, points):
    """Marks points that have numbers but are not ok."""
    for status, marker in (("inaccurate", "o"), ("chaotic", "D")):
        there = points & (sweep.status == status)
        if there.any():
            axes.plot(x[there], y[there], marker, ms=5, mfc="none", mec="#b03a2e", ls="", label=status)


def mark_missing(axes, sweep, x, y):
    """Marks on the axis the points that have no number."""
    for status in dict.fromkeys(sweep.status[~np.isfinite(y)]):
        of_status = sweep.status == status
        there = ~np.isfinite(y) & of_status
        label = "no number" if status == "ok" else f"{status}, no number" if (of_status & ~there).any() else status
        axes.plot(x[there], np.zeros(there.sum()), "x", color="#b03a2e", ms=6, clip_on=False, ls="",
                  transform=axes.get_xaxis_transform(), label=label)


def groups_of(sweep):
    """The key along the axis, and the points of each word of another key: (word, which points)."""
    key = (sweep.numbers + sweep.words)[0]
    others = [word for word in sweep.words if word != key]
    if not others:
        return key, [(None, np.full(len(sweep.status), True))]
    word = sweep.columns[others[0]]
    return key, [(plain_text(w), word == w) for w in dict.fromkeys(word)]


def draw_curves(axes, sweep, quantity):
    key, groups = groups_of(sweep)
    (x, label), y = sweep.axis(key), sweep.columns[quantity]
    markers = ["o", "s", "^", "v"]  # beside colours, as dashes are
    for number, (name, points) in enumerate(groups):
        order, style = np.flatnonzero(points), line_style(number)
        if sweep.numbers:
            order = order[np.argsort(x[order], kind="stable")]
            axes.plot(x[order], y[order], marker=".", lw=0.9, ms=3, label=name, **style)
        else:  # words have no order that a line could follow
            axes.plot(x[order], y[order], ls="", marker=markers[number // len(COLOURS) % len(markers)], color=style["color"], ms=6, label=name)
    if not sweep.numbers:
        write_words(axes, x)
    mark_doubtful(axes, sweep, x, y, np.isfinite(y))
    mark_missing(axes, sweep, x, y)
    if sweep.numbers:
        axes.set_xscale(scale_of(x))
        number_axis(axes.xaxis, x)
    if sweep.is_field and np.isfinite(y).all() and y.max() > 0:
        mark_half(axes, y.max())
    if focus := sweep.focus():
        axes.axvline(1e3 * focus[key], color="#b03a2e", lw=0.8, ls=(0, (1, 2)), label="focus")
    axes.set_xlabel(label)
    axes.set_ylabel(sweep.label(quantity))
    axes.grid()
    legend_of(axes, next((word for word in sweep.words if word != key), None))


def draw_map(figure, axes, sweep, quantity, limits=(None, None)):
    """limits: of the colours"""
    slow, fast = sweep.numbers
    (x, label_x), (y, label_y), z = sweep.axis(fast), sweep.axis(slow), sweep.columns[quantity]
    scales = scale_of(x), scale_of(y)
    shape = len(np.unique(y)), len(np.unique(x))
    edges = [edges_of(np.unique(at), scale, sweep.is_field) for at, scale in zip((x, y), scales)]
    grid = shape[0] * shape[1] == len(z) == len(set(zip(x, y))) and np.isfinite(np.concatenate(edges)).all()
    if grid:
        order = np.lexsort((x, y))
        colours = axes.pcolormesh(*edges, z[order].reshape(shape), shading="flat", rasterized=True, vmin=limits[0], vmax=limits[1])
    else:
        colours = axes.scatter(x, y, c=z, s=12, vmin=limits[0], vmax=limits[1])
    missing = ~np.isfinite(z)
    for status, colour in zip(dict.fromkeys(sweep.status[missing]), ["#b03a2e", "#222222", "#c46a1b", "#777777"]):
        there = missing & (sweep.status == status)
        axes.plot(x[there], y[there], "x", color=colour, ms=4, ls="", label="no number" if status == "ok" else status)
    mark_doubtful(axes, sweep, x, y, ~missing)
    axes.set_xscale(scales[0])
    axes.set_yscale(scales[1])
    number_axis(axes.xaxis, x)
    number_axis(axes.yaxis, y)
    axes.set_xlabel(label_x)
    axes.set_ylabel(label_y)
    if sweep.is_field and grid:
        draw_beam(axes, *(a[order].reshape(shape) for a in (x, y, z)))
    if focus := sweep.focus():
        axes.plot(1e3 * focus[fast], 1e3 * focus[slow], "+", color="#b03a2e", ms=11, mew=1.4, ls="", label="focus")
    figure.colorbar(colours, ax=axes, label=sweep.label(quantity))
    legend_of(axes)


def mark_half(axes, largest):
    """The level 6 dB under the largest pressure of a line of points."""
    axes.axhline(largest / 2, color="#555555", lw=0.8, ls=(0, (4, 3)))
    axes.annotate("\u22126 dB", (1, largest / 2), (-3, 3), xycoords=axes.get_yaxis_transform(), textcoords="offset points", ha="right",
                  fontsize=8, color="#555555")


def draw_beam(axes, x, y, pressure):
    """Lengths to one scale, and lines at parts of the largest pressure."""
    if "log" not in (axes.get_xscale(), axes.get_yscale()):
        axes.set_aspect("equal")
    if np.isfinite(pressure).all() and pressure.max() > 0:
        lines = axes.contour(x, y, 20 * np.log10(np.maximum(pressure / pressure.max(), 1e-6)), levels=[-20, -12, -6],
                             colors="white", linewidths=0.7, linestyles="solid")
        axes.clabel(lines, fmt="%g dB", fontsize=7)


def kept_bounds(sweep):
    """Of each point, whether it has the number that was looked for and keeps to the bounds."""
    kept = np.isfinite(sweep.columns[measure_of(sweep)]) & np.isin(sweep.status, COUNTED)
    for bound in sweep.search["subject_to"]:
        measure, sign, number = bound.split()
        values = sweep.columns[measure]
        kept &= (values >= float(number)) if sign == ">=" else (values <= float(number))
    return kept


def measure_of(sweep):
    return sweep.search.get("maximise") or sweep.search["minimise"]


def draw_course(axes, sweep, kept):
    """The best so far, evaluation by evaluation."""
    order = np.argsort(sweep.columns["point"], kind="stable")  # a table may be sorted
    y, points, kept = sweep.columns[measure_of(sweep)][order], sweep.columns["point"][order], kept[order]
    best = (np.fmax if "maximise" in sweep.search else np.fmin).accumulate(np.where(kept, y, np.nan))
    axes.plot(points[kept], y[kept], ".", color="#0b6e8a", ms=3, alpha=0.5)
    axes.step(points, best, where="post", color="#0b6e8a", lw=1.2)
    axes.set_xlabel("evaluation")
    axes.set_xlim(0, points.max() + 1)
    note(axes, [] if kept.any() else ["no point counts"])


def draw_over_key(axes, sweep, kept, key):
    x, y = sweep.columns[key], sweep.columns[measure_of(sweep)]
    there, counted = np.isfinite(y), np.isin(sweep.status, COUNTED)
    axes.plot(x[kept], y[kept], ".", color="#0b6e8a", ms=3)
    best = sweep.columns["point"] == sweep.search["best_point"]
    for points, marker, colour, size, label in (
            (there & counted & ~kept, ".", "#bbbbbb", 3, "beyond a bound"), (best & kept, "*", "#b03a2e", 11, "best"),
            *((there & (sweep.status == status), "D", "#b03a2e", 3, status) for status in dict.fromkeys(sweep.status[~counted]))):
        if points.any():
            axes.plot(x[points], y[points], marker, color=colour, mfc="none" if marker == "D" else colour, ms=size, ls="", label=label)
    mark_missing(axes, sweep, x, y)
    if key in sweep.words:
        write_words(axes, x)
    else:
        if any(text.startswith(key + "=") and text.endswith(":log") for text in sweep.search["vary"]):
            axes.set_xscale("log")
        number_axis(axes.xaxis, x)
    axes.set_xlabel(sweep.label(key))


def draw_search(sweep, title):
    """The measure over each key, and over the evaluations."""
    use_style()
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
    legend_of(axes[0])
    return titled(figure, title)


def sections_of(box, quantity):
    """Of a field over a box the three planes through its largest value: (points, quantity, where)."""
    values = box.columns[quantity]
    at = np.argmax(np.where(np.isfinite(values), values, -np.inf))
    return [(box.section(key, box.columns[key][at]), quantity, f"{key[0]} = {1e3 * box.columns[key][at]:.6g} mm") for key in box.keys]


def draw_sweep(sweep, quantities, title, panels=None):
    """An axes for each quantity. `panels` are axes of the caller's."""
    if sweep.search and not quantities and panels is None:
        return draw_search(sweep, title)
    is_box = sweep.is_field and len(sweep.keys) == 3
    if len(sweep.keys) > 2 and not is_box:
        raise WrongUse(f"found {len(sweep.keys)} keys that vary ({', '.join(sweep.keys)}), allowed: one or two")
    use_style()
    quantities = sweep.chosen(quantities)
    is_map = len(sweep.numbers) == 2
    limits = {name: (np.nanmin(sweep.columns[name]), np.nanmax(sweep.columns[name])) for name in quantities} if is_box else {}
    drawn = ([section for quantity in quantities for section in sections_of(sweep, quantity)] if is_box else
             [(sweep, quantity, "") for quantity in quantities])
    if panels is None:
        rows, columns, size = ((len(quantities), 3, (16.2, 4.2 * len(quantities))) if is_box else
                               (1, len(quantities), (5.4 * len(quantities), 4.2)) if is_map else
                               (len(quantities), 1, (7, 0.6 + 2.6 * len(quantities))))
        _, panels = plt.subplots(rows, columns, figsize=size, layout="constrained", squeeze=False)
    panels = np.ravel(panels)
    if len(panels) != len(drawn):
        raise ValueError(f"axes: found {len(panels)}, allowed: {len(drawn)}, {'three' if is_box else 'one'} for each quantity")
    figure = panels[0].figure
    for axes, (part, quantity, text) in zip(panels, drawn):
        if is_map or is_box:
            draw_map(figure, axes, part, quantity, limits.get(quantity, (None, None)))
        else:
            draw_curves(axes, part, quantity)
        axes.set_title(text, fontsize=9)
    return titled(figure, title)


def waveform_recordings(sweep, path, name):
    """A recording for each point that has samples, its number, and the number of points that were looked at."""
    samples, unit, rates, drives, points = read_waveforms(path, name)
    recordings = []
    for v, rate, drive, point in zip(samples, rates, drives, points):
        v = v[:np.flatnonzero(np.isfinite(v))[-1] + 1] if np.isfinite(v).any() else v[:0]
        if len(v) > 0:
            words = ", ".join(value_text(sweep.columns[key][point]) for key in sweep.keys)
            about = {"columns": [(name, name, unit)], "sample_rate_hz": rate}
            recordings.append((recording_of({"t_s": np.arange(len(v)) / rate, name: v}, about, words), point))
            recordings[-1][0].drives = [drive] if drive > 0 else []
    if not recordings:
        raise ValueError("no point has samples")
    return recordings, len(points)


def value_text(value):
    return f"{value:g}" if isinstance(value, float) else str(value)


def draw_waveforms(sweep, path, names, title):
    """Waveforms and spectra of all points, by colour: a legend for a few, a scale for many."""
    use_style()
    if len(names) != 1:
        raise WrongUse(f"--columns: found {', '.join(names)}, allowed: one output of a sweep")
    found, looked_at = waveform_recordings(sweep, path, names[0])
    recordings, points = zip(*found)
    without = [f"{looked_at - len(recordings)} of {looked_at} points without samples"] if looked_at > len(recordings) else []
    few = len(COLOURS) if len(sweep.keys) == len(sweep.numbers) == 1 else MAX_NAMED
    if len(recordings) <= few:
        figure = draw(list(recordings), "; ".join(filter(None, [title, *without])))
        if len(recordings) > 1:
            figure.axes[0].get_legend().set_title(", ".join(map(sweep.label, sweep.keys)), prop={"size": 8})
        return figure
    key = (sweep.numbers + ["point"])[0]
    values = sweep.columns[key][list(points)]
    scale = matplotlib.colors.LogNorm if scale_of(values) == "log" else matplotlib.colors.Normalize
    colours = matplotlib.cm.ScalarMappable(scale(values.min(), values.max()), "viridis")
    figure, (wave, lines) = plt.subplots(2, 1, figsize=(8, 6), layout="constrained")
    unit_s, unit = unit_of_time(max(recording.ends[1] for recording in recordings))
    drive, highest = frequencies_of(recordings)
    prepare_spectrum(lines, highest, drive)
    for recording, value in zip(recordings, values):
        style = {"color": colours.to_rgba(value)}
        draw_waveform(wave, recording, 0, unit_s, 1, style)
        levels = spectrum(recording.parts[0], recording.rate, recording.lowest())
        if levels is not None:
            frequency, level = levels_up_to(highest, *levels)
            lines.plot(frequency / 1e3, level, lw=0.6, **style)
    wave.grid(axis="y")
    wave.set_xlabel(f"time [{unit}]")
    wave.set_ylabel(f"{names[0]} [{recordings[0].columns[0][2]}]")
    lines.set_xlabel("frequency [kHz]")
    lines.set_ylabel("level [dB]")
    figure.colorbar(colours, ax=[wave, lines], label=sweep.label(key))
    note(wave, ([f"{looked_at} of {len(sweep.status)} points"] if looked_at < len(sweep.status) else []) + without)
    return titled(figure, title)
