"""Tables of `hertzline sweep`, `hertzline optimise` and `hertzline field`, in HDF5 or CSV."""
import contextlib
import csv
import json

import numpy as np

from .recordings import drives_of
from .style import WrongUse, plain_text


MAX_WAVEFORMS = 200


class NotASweep(Exception):
    pass


class Unreadable(Exception):
    """A file that is damaged, or not there. Names it."""

    def __init__(self, path, reason):
        super().__init__(f"cannot read {path}: {reason}")


def object_in(value):
    """The JSON object that this is, or that its text is; an empty one where there is none."""
    if isinstance(value, (str, bytes)):
        try:
            value = json.loads(value)
        except ValueError:
            return {}
    return value if isinstance(value, dict) else {}


@contextlib.contextmanager
def open_hdf5(path):
    """The file, for a block. Raises Unreadable."""
    import h5py
    try:
        with h5py.File(path, "r") as file:
            yield file
    except OSError as error:
        raise Unreadable(path, error) from error


def read_hdf5_table(path):
    """Columns by name, their units, and provenance."""
    with open_hdf5(path) as file:
        if "points" not in file or file["points"].dtype.names is None:
            raise NotASweep
        table = file["points"][:]
        units = dict(zip(table.dtype.names, file["points"].attrs["units"]))
        provenance = object_in(file.attrs.get("provenance"))
    texts = [name for name in table.dtype.names if table[name].dtype.kind == "S"]
    return {name: np.char.decode(table[name]) if name in texts else table[name].astype(float)
            for name in table.dtype.names}, units, provenance


def read_csv_table(path):
    """The same of a CSV; the units are beside it."""
    try:
        with open(path, newline="", encoding="utf-8") as file:
            names, *rows = csv.reader(file)
    except (OSError, ValueError, csv.Error) as error:
        raise Unreadable(path, error) from error
    if names[:1] != ["point"]:
        raise NotASweep
    rows = [row for row in rows if row]
    for number, row in enumerate(rows, 1):
        if len(row) != len(names):
            raise Unreadable(path, f"row {number} behind the header: found {len(row)} cells, allowed: {len(names)}")
    if not rows:
        raise Unreadable(path, "it has no rows")
    units, provenance = {}, {}
    try:
        with open(path + "-metadata.json", encoding="utf-8") as file:
            metadata = json.load(file)
        units = {c["name"]: c["schema:unitText"] for c in metadata["tableSchema"]["columns"]}
        provenance = object_in(metadata["urn:hertzline:provenance"])
    except (OSError, ValueError, KeyError):
        pass
    columns = {}
    for name, cells in zip(names, zip(*rows)):
        try:
            columns[name] = np.array(cells, dtype=float)
        except ValueError:
            columns[name] = np.array(cells)
    return columns, units, provenance


class Sweep:
    """A table, its varied keys, and the points that have numbers."""

    def __init__(self, columns, units, provenance):
        self.columns, self.units, self.provenance = columns, units, provenance
        self.search = provenance.get("search")  # the request of `hertzline optimise`; None: it is a sweep
        self.focus_m = object_in(object_in(provenance.get("scene")).get("array")).get("focus_m")
        names = list(self.columns)
        if names[:1] != ["point"] or "status" not in names:
            raise NotASweep
        status = names.index("status")
        self.is_field = names[1:status] == ["x_m", "y_m", "z_m"]
        self.keys = [key for key in names[1:status] if len(np.unique(self.columns[key])) > 1] or names[1:2]
        self.numbers = [key for key in self.keys if self.columns[key].dtype.kind == "f"]
        self.words = [key for key in self.keys if key not in self.numbers]
        self.quantities = [name for name in names[status + 1:] if self.columns[name].dtype.kind == "f"]
        self.status = self.columns["status"]

    def label(self, name):
        unit = self.units.get(name)
        return f"{name} [{unit}]" if unit else name

    def axis(self, key):
        """Values of a key along an axis, and its label; coordinates of a field in mm."""
        if self.is_field:
            return 1e3 * self.columns[key], f"{key[0]} [mm]"
        values = self.columns[key]
        return np.array([plain_text(word) for word in values]) if key in self.words else values, self.label(key)

    def section(self, key, value):
        """The points where a key has this value."""
        there = self.columns[key] == value
        return Sweep({name: column[there] for name, column in self.columns.items()}, self.units, self.provenance)

    def focus(self):
        """The array's focus by the name of each coordinate [m], where it lies on the line or plane of the points; else None."""
        if not self.is_field or not self.focus_m:
            return None
        focus = dict(zip(("x_m", "y_m", "z_m"), self.focus_m))
        within = all(self.columns[key].min() - 1e-9 <= value <= self.columns[key].max() + 1e-9 for key, value in focus.items())
        return focus if within else None

    def chosen(self, names):
        usual = [name for name in ("occupied_20db_hz", "peak_v_out_m_per_s", "peak_pa") if name in self.quantities]
        names = names or usual or [name for name in self.quantities if not name.startswith("estimated_")][:2]
        self.require("--quantity", names)
        return names

    def require(self, argument, names):
        for name in names:
            if name not in self.quantities:
                raise WrongUse(f"{argument}: found {name}, allowed: {', '.join(self.quantities)}")


def read_sweep(path):
    return Sweep(*(read_hdf5_table if path.endswith(".h5") else read_csv_table)(path))


def read_waveforms(path, name):
    """Samples of each point, NaN after its last one, their unit, and of each point its rate, its drive's frequency [Hz], NaN without one,
    and its number."""
    with open_hdf5(path) as file:
        there = [key for key in file if key != "points"]
        if name not in there:
            raise WrongUse(f"--columns: found {name}, allowed: {', '.join(there) or 'a sweep that was made with --waveforms'}")
        table, samples = file["points"], file[name]
        if samples.ndim > 2:
            raise WrongUse(f"--columns: found {name} with {samples.shape[2]} channels, allowed: an output with one")
        provenance = object_in(file.attrs.get("provenance"))

        def of_points(key, otherwise):
            return table[key] if key in table.dtype.names else np.full(len(table), otherwise)

        rates = of_points("output.sample_rate_hz", provenance["scene"]["output"]["sample_rate_hz"])
        if provenance.get("records") and not provenance.get("frequency_given"):  # each record has its own
            drives = of_points("fundamental_hz", np.nan)
        else:
            drives = of_points("drive.frequency_hz", next(iter(drives_of({"provenance": provenance})), np.nan))
        chosen = np.unique(np.linspace(0, len(table) - 1, min(len(table), MAX_WAVEFORMS)).astype(int))
        return samples[list(chosen)], samples.attrs.get("units", ""), rates[chosen], drives[chosen], chosen
