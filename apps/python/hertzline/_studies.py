"""Sweeps and searches: many scenes that differ in a few keys, a row each."""

from __future__ import annotations

import copy
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._plot import draw_table
from ._arguments import Path, integer, items_of, names_in, optional_number, text, threads
from ._scene import Scene, refuse_masked, scene, with_values

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.figure import Figure


def sweep(
    base: Scene | Path,
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

    vary: for each key a list or array of values, or a range as text: "FROM..TO:COUNT", "FROM..TO:log:COUNT". The last key
        varies fastest.
    points: a list of points in place of a grid, equally many values for each key: a dict or a DataFrame.
    sobol: the number of points of Sobol's sequence in the ranges of `vary`, which then have no count ("0.01..2:log").
    jobs: threads; by default one for each usable processor. The rows have the same bits for any number.
    measure: taps beside v_out whose peaks and spectra are measured.
    quantities: the numbers of the summary that are kept; by default all.
    band_from_hz: the lower limit of the bands [Hz]; by default half the drive's frequency.
    waveforms: a tap whose samples are kept as float32; with several channels, as "p_points", in a third dimension.

    A point that cannot be simulated is a row with a reason in `status` and `message`; its numbers are NaN. A run repeats a
    row's bits, but for the estimates of its error, when its scene has the row's keys, `step_s` as numerics.step_s, the `poles` of a modal
    plate as numerics.poles, and no numerics.accuracy.
    Raises ValueError with every fault of the plan before anything runs.
    """
    if (vary is None) == (points is None) or (sobol is not None and vary is None):
        raise ValueError("sweep: give either vary, also with sobol, or points")
    count = None if sobol is None else integer("sobol", sobol)
    if count is not None and count < 1:
        raise ValueError(f"sobol: found {count}, allowed: at least 1")
    keys = items_of("points", points) if vary is None else items_of("vary", vary)
    found = _native.sweep(
        _scene_of(base)._native,
        None if vary is None else _varied(keys),
        None if points is None else _points(keys),
        count,
        names_in("measure", measure),
        names_in("quantities", quantities),
        optional_number("band_from_hz", band_from_hz),
        None if waveforms is None else text("waveforms", waveforms),
        threads(jobs),
    )
    return _table(found, len(keys), points is None and sobol is None)


def optimise(
    base: Scene | Path,
    vary: Mapping[str, Any],
    *,
    maximise: str | None = None,
    minimise: str | None = None,
    subject_to: Iterable[str] = (),
    evaluations: int = 2000,
    seed: int = 1,
    jobs: int | None = None,
    measure: Iterable[str] = (),
    band_from_hz: float | None = None,
) -> SearchResult:
    """Searches ranges of keys for the best point within bounds, with the numbers of `hertzline optimise`.

        found = hertzline.optimise(s, {"end.thickness_m": "0.1e-3..2e-3:log", "chain.preload_n": "0.01..2:log"},
                                   maximise="occupied_20db_hz", subject_to=["peak_v_out_m_per_s >= 0.3"], jobs=2)
        found.best["end.thickness_m"], found.best_scene.run().summary

    vary: a range without a count for each key, "FROM..TO" or "FROM..TO:log", or a list of values.
    maximise, minimise: one of them is given, a number of a run's summary.
    subject_to: bounds that a point must keep, "NAME >= NUMBER" or "NAME <= NUMBER".
    evaluations: the most points that are simulated; a search needs some dozens, by its keys.
    seed: with another seed the search starts from other points, 0 to 2**64 - 1.
    jobs: threads; by default one for each usable processor. The result is the same for any number.
    measure: taps beside v_out whose peaks and spectra are measured, and can be the goal or a bound: "v_plate.thd_r".
    band_from_hz: the lower limit of the bands [Hz]; by default half the drive's frequency.

    Raises ValueError with every fault of the request before anything runs.
    """
    seed = integer("seed", seed, 2**64 - 1)
    if seed < 0:
        raise ValueError(f"seed: found {seed}, allowed: 0 to {2**64 - 1}")
    start = _scene_of(base)
    keys = items_of("vary", vary)
    found, summary, warnings = _native.optimise(
        start._native,
        _varied(keys),
        text("maximise", maximise or ""),
        text("minimise", minimise or ""),
        names_in("subject_to", subject_to),
        integer("evaluations", evaluations),
        seed,
        names_in("measure", measure),
        optional_number("band_from_hz", band_from_hz),
        threads(jobs),
    )
    return SearchResult(start, _table(found, len(keys), False), summary, warnings)


def _scene_of(base: Scene | Path) -> Scene:
    return base if isinstance(base, Scene) else scene(base)


def _list(key: str, values: Any) -> _native.Values:
    """The values as numbers, integers or words."""
    refuse_masked(key, values)
    array = np.atleast_1d(np.asarray(values))
    if array.dtype.kind == "O":  # texts of pandas
        array = np.asarray(array.tolist())
    if array.ndim > 1:
        raise TypeError(f"{key}: found an array of {array.ndim} dimensions, allowed: a list of values")
    if array.size == 0:
        raise ValueError(f"{key}: found no values, allowed: at least one")
    if array.dtype.kind == "U":
        words: list[str] = array.tolist()
        return words
    if array.dtype.kind == "i" or (array.dtype.kind == "u" and array.max() < 2**63):
        return np.ascontiguousarray(array, dtype=np.int64)
    if array.dtype.kind in "uf" and array.dtype.itemsize <= 8:
        return np.ascontiguousarray(array, dtype=np.float64)
    raise TypeError(f"{key}: found values of type {array.dtype}, allowed: numbers, integers or words")


def _varied(vary: Mapping[str, Any]) -> list[tuple[str, _native.Values]]:
    if not vary:
        raise ValueError("vary: found no keys, allowed: at least one")
    return [(key, values if isinstance(values, str) else _list(key, values)) for key, values in vary.items()]


def _points(points: Mapping[str, Any]) -> list[tuple[str, _native.Values]]:
    columns = {key: _list(key, values) for key, values in points.items()}
    if not columns:
        raise ValueError("points: found no keys, allowed: at least one")
    lengths = {key: len(column) for key, column in columns.items()}
    if len(set(lengths.values())) > 1:
        raise ValueError(f"points: found columns of different lengths {lengths}, allowed: one length")
    return list(columns.items())


def _table(found: _native.Table, keys: int, grid: bool) -> Table:
    columns, samples, provenance = found
    arrays = {name: np.array(values, dtype=str) if isinstance(values, list) else values for name, _, values in columns}
    rows = len(next(iter(arrays.values())))
    array = np.empty(rows, dtype=[(name, values.dtype) for name, values in arrays.items()])
    for name, values in arrays.items():
        array[name] = values
    table = array.view(Table)
    table.units = {name: unit for name, unit, _ in columns}
    table.keys = [name for name, _, _ in columns[1 : 1 + keys]]
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
    """The keys that vary."""
    grid: bool
    """Whether the points are a grid, in which the last key varies fastest."""
    waveforms: NDArray[np.float32] | None
    """Shape [point, sample], or [point, sample, channel] of a tap with several channels; NaN where a point has fewer."""
    provenance: dict[str, Any]
    """The origin of the rows: version, base scene, plan or search."""

    def __array_finalize__(self, parent: Any) -> None:
        self.units = getattr(parent, "units", {})
        self.keys = getattr(parent, "keys", [])
        self.provenance = getattr(parent, "provenance", {})
        # a part of the table is not a grid, and its waveforms are others
        self.grid = False
        self.waveforms = None

    def __getitem__(self, index: Any) -> Any:
        names = self.dtype.names or ()
        if isinstance(index, str) and index not in names:
            raise KeyError(f'found "{index}", allowed: {", ".join(names)}')
        found = super().__getitem__(index)
        if not isinstance(found, Table):
            return found
        if found.dtype.names is None:
            return found.view(np.ndarray)
        if self.waveforms is not None:
            rows = not (isinstance(index, list) and index and isinstance(index[0], str))  # else columns
            found.waveforms = self.waveforms[index] if rows else self.waveforms
        return found

    def take(self, indices: Any, axis: Any = None, out: Any = None, mode: Any = "raise") -> Any:
        """The rows with these numbers, with their waveforms."""
        found = super().take(indices, axis, out, mode)
        if self.waveforms is not None and isinstance(found, Table):
            found.waveforms = self.waveforms.take(indices, 0, None, mode)
        return found

    def copy(self, order: Any = "C") -> Table:
        """The same table, with its waveforms."""
        found = super().copy(order)
        found.__dict__.update(self.__dict__)
        return found

    def sort(self, axis: Any = -1, kind: Any = None, order: Any = None, **more: Any) -> None:
        """Sorts the rows in place, and their waveforms. They are no grid then."""
        self._arrange(self.view(np.ndarray).argsort(axis, kind, order, **more))

    def partition(self, kth: Any, axis: Any = -1, kind: Any = "introselect", order: Any = None) -> None:
        """Arranges the rows in place as NumPy's, and their waveforms."""
        self._arrange(self.view(np.ndarray).argpartition(kth, axis, kind, order))

    def _arrange(self, rows: NDArray[np.intp]) -> None:
        self[...] = self.view(np.ndarray)[rows]
        self.waveforms = None if self.waveforms is None else self.waveforms[rows]
        self.grid = False

    def __copy__(self) -> Table:
        return self.copy()

    def __deepcopy__(self, memo: dict[int, Any] | None) -> Table:
        found = super().copy()
        found.__dict__.update(copy.deepcopy(self.__dict__, memo))
        return found

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
        coordinates = {"point": plain["point"] if "point" in (self.dtype.names or ()) else np.arange(len(plain))}
        if self.grid:
            coordinates = {key: plain[key][np.sort(np.unique(plain[key], return_index=True)[1])] for key in self.keys}
            dimensions, shape = tuple(self.keys), tuple(len(values) for values in coordinates.values())
        variables: dict[str, Any] = {
            name: (dimensions, plain[name].reshape(shape), {"units": self.units[name]})
            for name in self.dtype.names or ()
            if name not in coordinates
        }
        if self.waveforms is not None:
            of_point = self.waveforms.shape[1:]
            variables["waveforms"] = ((*dimensions, *("sample", "channel")[: len(of_point)]), self.waveforms.reshape(*shape, *of_point), {})
        dataset = xarray.Dataset(variables, coords=coordinates)
        for key in coordinates:
            dataset[key].attrs["units"] = self.units.get(key, "")
        return dataset

    def plot(self, quantities: Sequence[str] = (), *, title: str = "", axes: Any = None) -> Figure:
        """Draws curves over one key that varies, a map over two, as `hertzline plot` does; of a search its goal over each
        key and over the evaluations. Needs matplotlib.

        axes: draws into these, one for each quantity; by default a figure is made.
        """
        return draw_table(self, names_in("quantities", quantities), title, axes)


@dataclass(frozen=True, eq=False)
class SearchResult:
    """The outcome of a search. Made by `hertzline.optimise`."""

    scene: Scene
    """The scene whose keys were varied."""
    table: Table
    """A row for each evaluation, in their order, with the columns of a sweep's table."""
    summary: dict[str, Any]
    """The numbers of `hertzline optimise --json`, with the same names, without `file`: the best point, its
    neighbourhood, how sure it is."""
    warnings: list[str]
    """Sentences: the best point lies beside a cliff or at a limit of a range, only one local search found it, or no point
    keeps to the bounds."""

    @property
    def best(self) -> Any:
        """The row of the best point; None when no point keeps to the bounds."""
        point = self.table.provenance["search"]["best_point"]
        return None if point is None else self.table[np.flatnonzero(self.table["point"] == point)[0]]

    @property
    def best_scene(self) -> Scene:
        """The scene of the best point. Its step is chosen anew: numbers of a run are those of the row within the accuracy, and the same bits
        with the row's `step_s` as numerics.step_s. Raises ValueError when no point keeps to the bounds.
        """
        best = self.best
        if best is None:
            raise ValueError(self.warnings[-1])
        return with_values(self.scene, {key: best[key] for key in self.table.keys})

    def plot(self, quantities: Sequence[str] = (), *, title: str = "", axes: Any = None) -> Figure:
        """Draws the goal over each key and over the evaluations, as `hertzline plot` does. Needs matplotlib."""
        return self.table.plot(quantities, title=title, axes=axes)

    def __repr__(self) -> str:
        return f"<hertzline.SearchResult {len(self.table)} evaluations, best {self.best}>"
