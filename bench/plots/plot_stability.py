#!/usr/bin/python3
"""Draws the largest stable step, measured and as `hertzline check` advises, against each axis.

    build/release/bench_stability --json build/stability.json
    bench/plots/plot_stability.py build/stability.json --out docs/stability.png

One row per method, one column per axis. Debian: python3-matplotlib.
"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
import pictures  # noqa: E402  (the path comes first; sets the backend)
import matplotlib.pyplot as plt  # noqa: E402

# Colours of Okabe and Ito, which colour-blind readers tell apart.
MEASURED = {"color": "#0072b2", "marker": "o", "ms": 4.5, "lw": 2.2, "label": "measured: longest step that does not blow up"}
LIMIT = {"color": "#d55e00", "marker": "s", "ms": 3.5, "lw": 1.4, "label": "check: largest stable step"}
RECOMMENDED = {"color": "#009e73", "marker": "v", "ms": 3.5, "lw": 1.2, "ls": (0, (3, 2)),
               "label": "check: recommended for an error of 1e-4"}
NONE = {"color": "#0072b2", "marker": "^", "ms": 5, "lw": 0, "mfc": "white",
        "label": "measured: none up to 100 times the advice"}

STEPS_NS = (0.4, 2e4)


def draw_panel(axes, rows):
    """Draws one method along one axis. A value of zero is drawn a decade left of the smallest other one."""
    values = [row["value"] for row in rows]
    least = min(value for value in values if value > 0)
    places = [value if value > 0 else least / 10 for value in values]
    axes.plot(places, [1e9 * row["recommended_s"] for row in rows], **RECOMMENDED)
    axes.plot(places, [1e9 * row["advised_limit_s"] for row in rows], **LIMIT)
    found = [(x, 1e9 * row["measured_s"]) for x, row in zip(places, rows) if row["measured_s"] is not None]
    none = [x for x, row in zip(places, rows) if row["measured_s"] is None]
    axes.plot([x for x, _ in found], [y for _, y in found], **MEASURED)
    axes.plot(none, [STEPS_NS[1] / 1.5] * len(none), **NONE)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(*STEPS_NS)
    axes.grid(which="major")
    if 0 in values:
        axes.annotate("0", (least / 10, STEPS_NS[0]), (0, 3), textcoords="offset points", ha="center")


def draw(rows, png):
    rows = [row for row in rows if row["axis"] != "combination"]
    methods = list(dict.fromkeys(row["integrator"] for row in rows))
    axes_names = list(dict.fromkeys(row["axis"] for row in rows))
    pictures.use_style(9)
    figure, panels = plt.subplots(len(methods), len(axes_names), figsize=(2.9 * len(axes_names), 2.3 * len(methods) + 0.9),
                                  layout="constrained", sharex="col", sharey=True, squeeze=False)
    for line, method in zip(panels, methods):
        for axes, name in zip(line, axes_names):
            own = [row for row in rows if row["integrator"] == method and row["axis"] == name]
            draw_panel(axes, own)
            if axes in panels[-1]:
                axes.set_xlabel(f"{name} [{own[0]['unit']}]")
        line[0].set_ylabel(f"{method}\nstep [ns]")
    entries = {}
    for axes in panels.flat:
        entries.update(zip(*reversed(axes.get_legend_handles_labels())))
    legend_share = 0.35 / figure.get_figheight()
    figure.get_layout_engine().set(rect=(0, legend_share, 1, 1 - legend_share))
    figure.legend(entries.values(), entries.keys(), loc="lower center", ncols=4, frameon=False, fontsize=8.5)
    figure.savefig(png, dpi=100, facecolor="white")


if __name__ == "__main__":
    pictures.draw_results(__doc__, "bench_stability", "docs/stability.png", draw)
