#!/usr/bin/python3
"""Draws error against run time of hertzline and of general-purpose solvers.

    build/release/bench_work_precision --json build/work_precision.json
    bench/plots/plot_work_precision.py build/work_precision.json --out docs/work-precision.png

One panel per scene, one line per solver; lower left is better. Debian: python3-numpy python3-matplotlib.
"""
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
import pictures  # noqa: E402  (the path comes first; sets the backend)
import matplotlib.pyplot as plt  # noqa: E402

# Colours of Okabe and Ito, which colour-blind readers tell apart; a marker for each, too. hertzline is drawn heavy,
# unmodified peers dashed, peers with located contacts solid.
OURS = [("#0072b2", "o"), ("#003f63", "s"), ("#7a5fa8", "D"), ("#3d8fc4", "^")]
LEAPFROG = ("#56b4e9", "v")
PEERS = {
    "odeint dopri5": ("#d55e00", "o"),
    "odeint bulirsch_stoer": ("#cc79a7", "v"),
    "odeint runge_kutta_fehlberg78": ("#999999", "P"),
    "odeint adams_bashforth_moulton": ("#8c6d1f", "X"),
    "odeint rk4": ("#4d4d4d", "s"),
    "odeint velocity_verlet": ("#000000", "."),
    "CVODE Adams": ("#009e73", "^"),
    "ARKODE Dormand-Prince": ("#e69f00", "D"),
    "ARKODE Verner 6(5)": ("#b8a000", "<"),
}
TITLES = {
    "paper_vitreous_carbon": "six spheres, vitreous carbon in water",
    "paper_wall": "six spheres at a wall",
    "sonic_vacuum_10": "ten spheres without preload at a wall",
    "small_amplitude_wall": "six spheres, 2 nm: no contact opens",
}
ERRORS = (1e-11, 1e-1)


def look(solver, ours):
    """Returns the line and marker of a solver."""
    if solver in ours:
        colour, marker = LEAPFROG if "leapfrog" in solver else OURS[ours.index(solver) % len(OURS)]
        return {"color": colour, "marker": marker, "lw": 2.4, "ms": 4.5, "zorder": 3}
    base = solver.removesuffix(", located")
    colour, marker = PEERS.get(base, ("#666666", "."))
    located = base != solver
    return {"color": colour, "marker": marker, "lw": 1.4 if located else 1, "ms": 4.5,
            "ls": "-" if located else (0, (3, 2)), "mfc": colour if located else "white"}


def frontier(rows, simulated_s):
    """Returns (seconds a simulated second, error) from loose to tight settings. The error is the largest of the outputs."""
    points = []
    for row in rows:
        error = max(row["error_v_last"], row["error_v_plate"], row["error_v_out"])
        if ERRORS[0] / 10 < error <= ERRORS[1] and math.isfinite(error):
            points.append((row["median_s"] / simulated_s, error))
    return points


def draw_scene(axes, scene, ours):
    solvers = list(dict.fromkeys(row["solver"] for row in scene["results"]))
    for solver in sorted(solvers, key=lambda name: name in ours):
        points = frontier([row for row in scene["results"] if row["solver"] == solver], scene["simulated_s"])
        if points:
            axes.plot(*zip(*points), label=solver, **look(solver, ours))
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_ylim(*ERRORS)
    axes.set_xlim(0.06, 300)
    axes.axvline(1, color="#555555", lw=0.9, ls=":")
    axes.annotate("real time", (1, ERRORS[0]), (-3, 4), textcoords="offset points", ha="right", fontsize=8.5,
                  color="#555555")
    axes.set_title(TITLES.get(scene["scene"], scene["scene"]), loc="left", fontweight="bold", fontsize=11)
    axes.grid(which="major")


def draw(results, png):
    scenes = results["scenes"]
    ours = sorted({row["solver"] for scene in scenes for row in scene["results"] if row["kind"] == "ours"},
                  key=lambda name: ("leapfrog" in name, name))
    pictures.use_style(10)
    columns = min(2, len(scenes))
    rows = math.ceil(len(scenes) / columns)
    figure, panels = plt.subplots(rows, columns, figsize=(5.6 * columns, 4.4 * rows + 1.3), layout="constrained",
                                  sharex=True, sharey=True, squeeze=False)
    for axes, scene in zip(panels.flat, scenes):
        draw_scene(axes, scene, ours)
    for axes in panels.flat[len(scenes):]:
        axes.set_visible(False)
    for axes in panels[-1]:
        axes.set_xlabel("run time per simulated time")
    for axes in panels[:, 0]:
        axes.set_ylabel("relative error (L2, largest of all outputs)")
    handles, labels = panels.flat[0].get_legend_handles_labels()
    order = sorted(range(len(labels)), key=lambda i: (labels[i] not in ours, labels[i]))
    legend_share = 1.05 / figure.get_figheight()
    figure.get_layout_engine().set(rect=(0, legend_share, 1, 1 - legend_share))
    figure.legend([handles[i] for i in order], [labels[i] for i in order], loc="lower center", ncols=4, frameon=False,
                  fontsize=8.5)
    machine = results["machine"]
    figure.suptitle(f"{machine['processor']}, {machine['simd']}, one core, {machine['compiler']}", fontsize=8.5,
                    color="#777777", x=0.99, ha="right")
    figure.savefig(png, dpi=110, facecolor="white")


if __name__ == "__main__":
    pictures.draw_results(__doc__, "bench_work_precision", "docs/work-precision.png", draw)
