#!/usr/bin/python3
"""Draws the processor time of an array against the number of its chains.

    build/release/bench_arrays --json build/arrays.json
    bench/plots/plot_arrays.py build/arrays.json --out docs/array-cost.png

One line for each way of driving them. Debian: python3-matplotlib.
"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
import pictures  # noqa: E402  (the path comes first; sets the backend)
import matplotlib.pyplot as plt  # noqa: E402

# Colours of Okabe and Ito, which colour-blind readers tell apart; a marker for each, too.
DRIVES = {
    "fluid": {"color": "#d55e00", "marker": "o", "label": "coupled through the fluid"},
    "delayed": {"color": "#0072b2", "marker": "s", "label": "no coupling, alike but for delays"},
    "alike": {"color": "#009e73", "marker": "^", "label": "no coupling, alike"},
}
TICKS = (1, 2, 4, 7, 19, 37, 64, 128, 256)


def draw(results, png):
    pictures.use_style(10)
    figure, axes = plt.subplots(figsize=(6.6, 4.4), layout="constrained")
    for drive, look in DRIVES.items():
        points = [(row["elements"], row["us_per_simulated_us"]) for row in results["arrays"] if row["drive"] == drive]
        axes.plot(*zip(*points), lw=1.8, ms=5, **look)
        if drive == "fluid":
            (count, time) = points[-1]
            axes.plot([count / 4, count], [0.4 * time / 16, 0.4 * time], color="#777777", lw=0.9, ls=(0, (4, 3)))
            axes.annotate("$\\propto N^2$", (count / 4, 0.4 * time / 16), (4, -6), textcoords="offset points", va="top", fontsize=9)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xticks(TICKS, [str(count) for count in TICKS], minor=False)
    axes.minorticks_off()
    axes.set_xlabel("chains")
    axes.set_ylabel("processor time per simulated time")
    axes.grid(which="major")
    axes.legend(frameon=False, loc="upper left")
    figure.savefig(png, dpi=110, facecolor="white")


if __name__ == "__main__":
    pictures.draw_results(__doc__, "bench_arrays", "docs/array-cost.png", draw)
