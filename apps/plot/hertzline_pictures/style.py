"""Style and small parts that all pictures share."""
import matplotlib
import numpy as np

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


class WrongUse(ValueError):
    """An option that the file cannot satisfy."""


def plain_text(text):
    """The text as matplotlib shows it: not as mathematics, and not left out because it begins with an underscore."""
    return (" " if text.startswith("_") else "") + text.replace("$", r"\$")


def use_style(**more):
    matplotlib.rcParams.update(STYLE | {"font.size": 9} | more)


def scale_of_unit(largest):
    """A power of ten that numbers are divided by where matplotlib would overflow; else 1."""
    return 10.0 ** np.floor(np.log10(largest)) if largest > 0 and not 1e-100 < largest < 1e100 else 1.0


def unit_of_time(span):
    """Seconds in the unit, and its name, for an axis of this length [s]."""
    return (1e-6, "\u00b5s") if span < 2e-3 else (1e-3, "ms") if span < 2 else (1, "s")


def note(axes, texts):
    axes.text(0.985, 0.95, "\n".join(texts), transform=axes.transAxes, ha="right", va="top", fontsize=8,
              bbox={"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 1.5} if texts else None)


def titled(figure, title):
    """The figure with the title above, if there is one."""
    if title:
        figure.suptitle(title.replace("$", r"\$"), x=0.01, ha="left", fontsize=10)
    return figure
