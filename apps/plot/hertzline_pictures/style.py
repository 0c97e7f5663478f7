"""Style and small parts that all pictures share."""
import matplotlib
import numpy as np
from matplotlib.lines import Line2D

# Readers with deuteranopia, protanopia or tritanopia can tell them apart (Machado et al. 2009, doi:10.1109/TVCG.2009.113).
COLOURS = ["#0b6e8a", "#c46a1b", "#202040", "#8a8a6a", "#c04fd8", "#2fc4c4"]
DASHES = ["solid", (0, (5, 1.5)), (0, (1.2, 1.2)), (0, (5, 1.5, 1.2, 1.5))]
LONGEST_NAME = 36
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


def line_style(number):
    """Colour and dashes of the curve with that number: the colours first, then the same ones dashed."""
    return {"color": COLOURS[number % len(COLOURS)], "ls": DASHES[number // len(COLOURS) % len(DASHES)]}


def shortened(name, most=LONGEST_NAME):
    """The name without its middle, if it is long: beginnings and ends tell files apart."""
    return name if len(name) <= most else f"{name[:most // 2]}\u2026{name[-(most // 2):]}"


def named_at_most(most, handles, labels):
    """Handles and labels of a legend: the first ones, and how many more there are."""
    if len(labels) <= most:
        return handles, labels
    return [*handles[:most], Line2D([], [], ls="none")], [*labels[:most], f"and {len(labels) - most} more"]


def use_style(**more):
    matplotlib.rcParams.update(STYLE | {"font.size": 9} | more)


def scale_of_unit(largest):
    """A power of ten that numbers are divided by where matplotlib would overflow; else 1."""
    return 10.0 ** np.floor(np.log10(largest)) if largest > 0 and not 1e-100 < largest < 1e100 else 1.0


def unit_of_time(span):
    """Seconds in the unit, and its name, for an axis of this length [s]."""
    return (1e-6, "\u00b5s") if span < 2e-3 else (1e-3, "ms") if span < 2 else (1, "s")


def note(axes, texts, above=0):
    """Text over the axes, where it hides no curve. above: [points]"""
    axes.set_title("\n".join(texts), loc="right", fontsize=8, pad=3 + above)


def titled(figure, title):
    """The figure with the title above, if there is one."""
    if title:
        figure.suptitle(title.replace("$", r"\$"), x=0.01, ha="left", fontsize=10)
    return figure
