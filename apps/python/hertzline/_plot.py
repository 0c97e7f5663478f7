"""Pictures, by the modules that `hertzline plot` runs. matplotlib is imported when the first one is drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def _script() -> Any:
    from . import _draw

    return _draw


def draw_samples(
    taps: Mapping[str, tuple[NDArray[np.float64], str]],
    t: NDArray[np.float64],
    recording: Mapping[str, Any],
    title: str,
    axes: Any = None,
) -> Figure:
    """taps: samples and unit of each; t: their times [s]; recording: sample_rate_hz and provenance."""
    import matplotlib

    columns: dict[str, Any] = {"t_s": t}
    about = []
    for name, (values, unit) in taps.items():
        channels = values[:, np.newaxis] if values.ndim == 1 else values
        for channel in range(channels.shape[1]):
            label = name if values.ndim == 1 else f"{name} {channel + 1}"
            columns[label] = channels[:, channel]
            about.append((label, label, unit))
    if not about:
        raise ValueError("plot: found no taps, allowed: at least one")
    if len(t) == 0:
        raise ValueError("plot: found no samples, allowed: at least one")
    rows = None if axes is None else np.asarray(axes).reshape(-1, 2) if np.size(axes) % 2 == 0 else np.empty((0, 2))
    if rows is not None and len(rows) != len(about):
        raise ValueError(f"axes: found {np.size(axes)}, allowed: {2 * len(about)}, two for each column")
    script = _script()
    with matplotlib.rc_context():
        figure: Figure = script.draw([script.recording_of(columns, {"columns": about, **recording})], title, rows)
    return figure


def draw_table(table: Any, quantities: Sequence[str], title: str, axes: Any = None) -> Figure:
    """table: a structured array with `units` of its columns, and `provenance`."""
    import matplotlib

    script = _script()
    plain = table.view(np.ndarray)
    names = plain.dtype.names or ()
    columns = {name: plain[name] if plain.dtype[name].kind == "U" else plain[name].astype(float) for name in names}
    sweep = script.Sweep(columns, table.units, table.provenance)
    sweep.require("quantities", quantities)
    if len(plain) == 0:
        raise ValueError("plot: found no rows, allowed: at least one")
    with matplotlib.rc_context():
        figure: Figure = script.draw_sweep(sweep, list(quantities), title, axes)
    return figure
