"""Pictures, by the script that `hertzline plot` runs. matplotlib is imported when the first one is drawn."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ._samples import Samples
    from ._studies import Table


def _script() -> Any:
    import matplotlib  # noqa: F401  its absence is an ImportError here, and the script's end

    from . import _draw

    return _draw


def draw_samples(samples: Samples, names: Sequence[str], title: str, axes: Any = None) -> Figure:
    import matplotlib

    columns: dict[str, Any] = {"t_s": samples.t}
    about = []
    for name in names:
        values = samples[name]
        channels = values[:, np.newaxis] if values.ndim == 1 else values
        for channel in range(channels.shape[1]):
            label = name if values.ndim == 1 else f"{name} {channel + 1}"
            columns[label] = channels[:, channel]
            about.append((label, label, samples.unit(name)))
    if not about:
        raise ValueError("plot: found no taps, allowed: at least one")
    if len(samples.t) == 0:
        raise ValueError("plot: found no samples, allowed: at least one")
    rows = None if axes is None else np.asarray(axes).reshape(-1, 2) if np.size(axes) % 2 == 0 else np.empty((0, 2))
    if rows is not None and len(rows) != len(about):
        raise ValueError(f"axes: found {np.size(axes)}, allowed: {2 * len(about)}, two for each column")
    with matplotlib.rc_context():
        figure: Figure = _script().draw(
            columns,
            {"columns": about, "sample_rate_hz": samples.sample_rate_hz, "provenance": samples.provenance},
            title,
            rows,
        )
    return figure


def draw_table(table: Table, quantities: Sequence[str], title: str, axes: Any = None) -> Figure:
    import matplotlib

    script = _script()
    plain = table.view(np.ndarray)
    names = plain.dtype.names or ()
    columns = {name: plain[name] if plain.dtype[name].kind == "U" else plain[name].astype(float) for name in names}
    with matplotlib.rc_context():
        figure: Figure = script.draw_sweep(
            script.Sweep(columns, table.units, table.provenance.get("search")), list(quantities), title, axes
        )
    return figure
