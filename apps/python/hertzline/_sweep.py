"""Sweeps: many scenes that differ in a few keys, a row each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._scene import Scene, names_in, scene, toml_value

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.figure import Figure


def sweep(
    base: Scene | str,
    vary: Mapping[str, Any] | None = None,
    *,
    points: Mapping[str, Any] | None = None,
    sobol: int | None = None,
    jobs: int | None = None,
    measure: Iterable[str] = (),
    quantities: Iterable[str] = (),
    band_from_hz: float | None = None,
    waveforms: str | None = None,
) -> Table:
    """Simulates every point of a grid, with the numbers of `hertzline sweep`: a structured array, a row each.

        hertzline.sweep(s, {"end.thickness_m": np.geomspace(1e-4, 2e-3, 30), "chain.preload_n": "0.01..2:log:30"})

    vary: the values of each key, or a range as the program takes it. Of several keys the last one varies fastest.
    points: instead of `vary` points of your own, for each key as many values.
    sobol: so many points of Sobol's sequence in the ranges of `vary`, which then have no count ("0.01..2:log").
    jobs: threads; by default one for each processor that the process may use. The rows are the same, bit for bit, whatever it is.
    measure: peaks and spectra of these taps beside v_out.
    quantities: only these numbers of the summary; by default all.
    band_from_hz: bands are looked for from here upward [Hz]; by default half the drive's frequency.
    waveforms: a tap whose samples are kept, too, as float32.

    A point that cannot be simulated is a row with its reason: see `status` and `message`; its numbers are NaN. A scene with
    the row's numbers, its `step_s` as numerics.step_s, a modal plate's `poles` as numerics.poles and no numerics.accuracy
    gives the row's bits when it is run.
    Raises ValueError with every fault of the plan before anything runs.
    """
    start = base if isinstance(base, Scene) else scene(base)
    ranges = [f"{key}={_values_text(key, values)}" for key, values in (vary or {}).items()]
    columns, samples, provenance = _native.sweep(
        start._native,
        ranges,
        _points_text(points) if points is not None else "",
        sobol,
        names_in("measure", measure),
        names_in("quantities", quantities),
        band_from_hz,
        waveforms,
        jobs,
    )
    keys = list(points if points is not None else vary or {})
    return _table(columns, keys, vary is not None and sobol is None, samples, provenance)


def _column(key: str, values: Any) -> list[Any]:
    array = np.asarray(values)
    if array.ndim > 1:
        raise TypeError(f"{key}: found an array of {array.ndim} dimensions, allowed: a list of values")
    if array.size == 0:
        raise ValueError(f"{key}: found no values, allowed: at least one")
    return list(np.atleast_1d(array))


def _cell(key: str, value: Any) -> str:
    if not isinstance(value, str):
        return toml_value(key, value)
    if ".." in value or any(character in ',:"' or not character.isprintable() for character in value):
        raise ValueError(f"{key}: found {str(value)!r} in a list, allowed there: a word or a number")
    return str(value)


def _values_text(key: str, values: Any) -> str:
    if isinstance(values, str):
        return values
    return ",".join(_cell(key, value) for value in _column(key, values))


def _points_text(points: Mapping[str, Any]) -> str:
    columns = {key: _column(key, values) for key, values in points.items()}
    if not columns:
        raise ValueError("points: found no keys, allowed: at least one")
    lengths = {key: len(column) for key, column in columns.items()}
    if len(set(lengths.values())) > 1:
        raise ValueError(f"points: found columns of different lengths {lengths}, allowed: one length")
    lines = [",".join(columns)]
    lines += [",".join(_cell(key, value) for key, value in zip(columns, row)) for row in zip(*columns.values())]
    return "\n".join(lines) + "\n"


def _table(
    columns: Sequence[tuple[str, str, Any]], keys: list[str], grid: bool, samples: Any, provenance: dict[str, Any]
) -> Table:
    arrays = {name: np.array(values, dtype=str) if isinstance(values, list) else values for name, _, values in columns}
    rows = len(next(iter(arrays.values())))
    array = np.empty(rows, dtype=[(name, values.dtype) for name, values in arrays.items()])
    for name, values in arrays.items():
        array[name] = values
    table = array.view(Table)
    table.units = {name: unit for name, unit, _ in columns}
    table.keys = keys
    table.grid = grid
    table.waveforms = samples
    table.provenance = provenance
    return table


class Table(np.ndarray[Any, np.dtype[Any]]):
    """A structured array: `point`, the keys that vary, `status`, the numbers of the summary, `integrator`, `scene_hash`
    and `message`. Names carry units, and `units` has them: table["peak_v_out_m_per_s"] [m/s]."""

    units: dict[str, str]
    """The unit of each column; "" of a plain number or a text."""
    keys: list[str]
    """What varies."""
    grid: bool
    """Whether the points are a grid, the last key fastest."""
    waveforms: NDArray[np.float32] | None
    """Shape [point, sample]; NaN where a point is shorter than the longest."""
    provenance: dict[str, Any]
    """What made the rows: version, base scene, plan."""

    def __array_finalize__(self, parent: Any) -> None:
        self.units = getattr(parent, "units", {})
        self.keys = getattr(parent, "keys", [])
        self.provenance = getattr(parent, "provenance", {})
        # a part of the table is no grid, and has not the same waveforms
        self.grid = False
        self.waveforms = None

    def __getitem__(self, index: Any) -> Any:
        found = super().__getitem__(index)
        names = found.dtype.names if isinstance(found, Table) else None
        return found.view(np.ndarray) if isinstance(found, Table) and names is None else found

    def __reduce__(self) -> tuple[Any, ...]:
        reduced: Any = super().__reduce__()
        make, arguments, state = reduced
        return make, arguments, (state, dict(self.__dict__))

    def __setstate__(self, state: Any) -> None:
        of_array, own = state
        super().__setstate__(of_array)
        self.__dict__.update(own)

    def to_pandas(self) -> pandas.DataFrame:
        """A DataFrame with the same columns; `attrs` has the units. Needs pandas."""
        import pandas

        plain = self.view(np.ndarray)
        frame = pandas.DataFrame({name: plain[name] for name in self.dtype.names or ()})
        frame.attrs["units"] = dict(self.units)
        return frame

    def to_xarray(self) -> xarray.Dataset:
        """A Dataset: over the keys that vary when the points are a grid, else over `point`. Variables have `units`.

        Needs xarray.
        """
        import xarray

        plain = self.view(np.ndarray)
        dimensions: tuple[str, ...] = ("point",)
        shape: tuple[int, ...] = (len(plain),)
        coordinates = {"point": plain["point"]}
        if self.grid:
            coordinates = {key: plain[key][np.sort(np.unique(plain[key], return_index=True)[1])] for key in self.keys}
            dimensions, shape = tuple(self.keys), tuple(len(values) for values in coordinates.values())
        variables: dict[str, Any] = {
            name: (dimensions, plain[name].reshape(shape), {"units": self.units[name]})
            for name in self.dtype.names or ()
            if name not in coordinates
        }
        if self.waveforms is not None:
            variables["waveforms"] = ((*dimensions, "sample"), self.waveforms.reshape(*shape, -1), {})
        dataset = xarray.Dataset(variables, coords=coordinates)
        for key in coordinates:
            dataset[key].attrs["units"] = self.units[key]
        return dataset

    def plot(self, quantities: Sequence[str] = (), *, title: str = "", axes: Any = None) -> Figure:
        """Draws curves over one key that varies, a map over two, as `hertzline plot` does. Needs matplotlib.

        axes: draws into these, one for each quantity; by default a figure is made.
        """
        from ._plot import draw_table

        return draw_table(self, names_in("quantities", quantities), title, axes)
