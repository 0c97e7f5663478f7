"""Scenes, and the results of their runs."""

from __future__ import annotations

import array
import difflib
import math
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from . import _native
from ._arguments import Path, file_name, names_in, number, optional_number, refuse, text
from ._samples import Floats, Samples


def scenes() -> dict[str, str]:
    """The shipped scenes: name and description."""
    return _native.shipped_scenes()


def materials() -> dict[str, dict[str, Any]]:
    """The built-in materials by name: density, moduli, sound speed, impedance, strengths and their source, in SI units.

    Solids are for drive.material, chain.material and end.material, fluids for medium.material.
    """
    return {material.pop("name"): material for material in _native.materials()}


def scene(source: Path | Scene = "paper-vitreous-carbon", /, **sections: Mapping[str, Any]) -> Scene:
    """A scene: a file, a shipped scene's name (if both exist, the file is taken), that of a recording, or another scene, with keys
    changed.

        hertzline.scene("paper-vitreous-carbon", end={"thickness_m": 0.4e-3}, drive={"cycles": 10})
        hertzline.scene("mine.toml", materials={"clay": {"density_kg_per_m3": 1900.0}}, end={"material": "clay"})

    scenes/README.md has every section and key, with units. None takes the value of a file back. A drive.file that is given to a scene
    takes the place of its record, with that one's rate, quantity and scale. Raises ValueError with every fault of the scene.
    """
    settings = list(_settings(sections))
    if isinstance(source, Scene):
        return Scene(_native.parse(source.toml, source.name, settings))
    return Scene(_native.read(file_name(source), settings))


def with_values(base: Scene, values: Mapping[str, Any]) -> Scene:
    """The scene with other values of keys: {"chain.preload_n": 0.2}."""
    return Scene(_native.parse(base.toml, base.name, [f"{key}={toml_value(key, value)}" for key, value in values.items()]))


def _settings(sections: Mapping[str, Mapping[str, Any]], prefix: str = "") -> Iterator[str]:
    """The keys as the program's option --set takes them."""
    for name, value in sections.items():
        if not isinstance(name, str):
            refuse(prefix.removesuffix("."), name, "texts as keys")
        key = prefix + (name if re.fullmatch(r"[A-Za-z0-9_-]+(\[\d+\])*", name) else toml_text(name))
        if isinstance(value, Mapping) and (value or not prefix):
            yield from _settings(value, key + ".")
        elif isinstance(value, Mapping):
            yield f"{key}={{}}"  # which no key is
        elif prefix:
            yield f"{key}={'null' if value is None else toml_value(key, value)}"
        else:
            raise TypeError(f"{key}: found {type(value).__name__}, allowed: a dict of the keys of this section")


MOST_ENTRIES = 1_000_000


def refuse_masked(key: str, value: Any) -> None:
    """Raises TypeError for a masked array: NumPy would give the values below the mask."""
    if isinstance(value, np.ma.MaskedArray):
        raise TypeError(f"{key}: found a masked array, allowed: one without a mask, as its filled() gives it")


def plain_value(key: str, value: Any) -> Any:
    """The value without NumPy: a list where it is an array, a tuple or a list; a file's name as a text."""
    refuse_masked(key, value)
    if isinstance(value, os.PathLike):
        return os.fsdecode(value)
    if isinstance(value, (memoryview, array.array)) or (hasattr(value, "__array__") and not isinstance(value, np.generic)):
        value = np.asarray(value)  # of pandas and xarray, too
    if isinstance(value, (list, tuple)) or (isinstance(value, np.ndarray) and value.ndim > 0):
        if len(value) > MOST_ENTRIES:
            raise ValueError(f"{key}: found {len(value)} entries, allowed: at most {MOST_ENTRIES}")
        if isinstance(value, np.ndarray) and value.ndim == 1 and value.dtype.kind in "iuf":
            return value.tolist()
        return [plain_value(f"{key}[{number}]", entry) for number, entry in enumerate(value, 1)]
    return value.item() if isinstance(value, (np.generic, np.ndarray)) else value


def finite_value(key: str, value: Any) -> Any:
    """plain_value() for JSON, which has finite numbers. Raises ValueError for others."""
    value = plain_value(key, value)
    if isinstance(value, list):
        return [finite_value(f"{key}[{number}]", entry) for number, entry in enumerate(value, 1)]
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError(f"{key}: found {value}, allowed: a finite number")
    return value


def toml_text(text: str) -> str:
    """A text as TOML has it, in ASCII."""
    plain = (c if " " <= c <= "~" and c not in '"\\' else f"\\U{ord(c):08X}" for c in text)
    return f'"{"".join(plain)}"'


def toml_value(key: str, value: Any) -> str:
    """A number, integer, word or list of them as TOML has it; numbers read back to the same bits."""
    value = plain_value(key, value)
    if isinstance(value, list) and set(map(type, value)) == {float}:
        return "[" + ", ".join(map(repr, value)) + "]"
    if isinstance(value, list):
        return "[" + ", ".join(toml_value(f"{key}[{number}]", entry) for number, entry in enumerate(value, 1)) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, str):
        return toml_text(value)
    raise TypeError(f"{key}: found {type(value).__name__}, allowed: a number, an integer, a word or a list of them")


class Scene:
    """A device and its drive. Made by `hertzline.scene`; never changes."""

    __slots__ = ("_native",)

    def __init__(self, native: _native.Scene) -> None:
        self._native = native

    @property
    def name(self) -> str:
        """The file's or the shipped scene's name."""
        return self._native.origin

    @property
    def toml(self) -> str:
        """The scene as a file that sets every key."""
        return self._native.toml()

    @property
    def hash(self) -> str:
        """16 hexadecimal digits that identify the scene, as in summaries and recordings of resolved scenes."""
        return self._native.hash()

    @property
    def values(self) -> dict[str, dict[str, Any]]:
        """Section by section every key and its value; None where the program chooses."""
        return self._native.values()

    def __getitem__(self, key: str) -> Any:
        """The value of a key: scene["end.thickness_m"] [m]; of a list, or its entry from 1 on: scene["end.thicknesses_m[1]"]."""
        found: Any = self.values
        name = re.fullmatch(r"([^][]*)((?:\[\d+\])*)", text("key", key))
        for part in name[1].split(".") if name else [""]:
            if not isinstance(found, Mapping) or part not in found:
                raise KeyError(f'found "{key}", allowed: a key of the scene{self._like(key)}')
            found = found[part]
        for entry in map(int, re.findall(r"\d+", name[2] if name else "")):
            if not isinstance(found, list) or not 1 <= entry <= len(found):
                entries = f"an entry from 1 to {len(found)}" if isinstance(found, list) else "no entry: it is no list"
                raise KeyError(f'found "{key}", allowed: {entries}')
            found = found[entry - 1]
        return found

    def _like(self, key: str) -> str:
        keys = [f"{section}.{name}" for section, values in self.values.items() for name in values]
        return "".join(f", as {like}" for like in difflib.get_close_matches(key, keys, 1))

    def __contains__(self, key: object) -> bool:
        try:
            self[key]  # type: ignore[index]
        except (KeyError, TypeError):
            return False
        return True

    __iter__ = None

    def resolved(self) -> Scene:
        """The same scene with integrator and step settled, as it is simulated. Takes some milliseconds."""
        return Scene(self._native.resolved())

    def check(self) -> dict[str, Any]:
        """Numbers that follow from the scene, with the names and units of `hertzline check --json`: masses, stiffnesses,
        frequencies, step and estimated error; and its `warnings`. The costs of files are left out.

        Raises ValueError when the scene cannot be simulated as it is, as with a step beyond the stability limit.
        """
        return self._native.check()

    def run(
        self,
        taps: Iterable[str] | None = None,
        *,
        measure: Iterable[str] = (),
        band_from_hz: float | None = None,
    ) -> Result:
        """Simulates from 0 to output.duration_s, as `hertzline run` does, bit for bit.

        taps: the outputs to keep, such as ["v_out", "v_chain"]; by default those that `hertzline run -o` saves. v_out is always kept.
        measure: taps whose peaks and spectra stand in the summary, too; they are kept as well.
        band_from_hz: bands are looked for from here upward [Hz]; by default half the drive's frequency.

        Raises ValueError with every fault, RuntimeError when the motion becomes unstable, and MemoryError when the run does not fit
        into memory.
        """
        names = None if taps is None else names_in("taps", taps)
        return Result(_native.run(self._native, names, names_in("measure", measure), optional_number("band_from_hz", band_from_hz)))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Scene) and self.toml == other.toml

    def __hash__(self) -> int:
        return hash(self.toml)

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self.toml, self.name)

    def __repr__(self) -> str:
        return f"<hertzline.Scene {self.name} {self.hash}>"


def _restored(toml: str, name: str) -> Scene:
    return Scene(_native.parse(toml, name, []))


class Result(Samples):
    """Results of a run: `result["v_out"]` are samples, `result.summary` the numbers of `hertzline run --json`."""

    def __init__(self, native: _native.Run) -> None:
        self._native = native
        self._t: Floats | None = None

    @property
    def t(self) -> Floats:
        """Time of each sample since the start [s], shape [sample]."""
        if self._t is None:
            self._t = np.arange(self._native.rows) / self._native.sample_rate_hz
            self._t.setflags(write=False)
        return self._t

    @property
    def sample_rate_hz(self) -> float:
        """Samples a second [Hz]."""
        return self._native.sample_rate_hz

    @property
    def taps(self) -> list[str]:
        """The names for `self[...]`: the taps that were asked for, the measured ones, and v_out."""
        return self._native.taps

    def __getitem__(self, name: str) -> Floats:
        return self._native.samples(text("name", name))

    def unit(self, name: str) -> str:
        return self._native.unit(text("name", name))

    @property
    def summary(self) -> dict[str, Any]:
        """The summary of `hertzline run --json`, with the same names and units; without `recordings` and `warnings`."""
        return self._native.summary()

    @property
    def warnings(self) -> list[str]:
        """The program's warnings, a sentence each: an accuracy that is missed, a record that is too short."""
        return self._native.warnings

    @property
    def provenance(self) -> dict[str, Any]:
        """Origin of the samples: version, resolved scene, integrator, step, estimated error."""
        return self._native.provenance()

    def save(self, *paths: Path, taps: Sequence[str] | None = None, wav_scale: float = 1.0) -> None:
        """Writes recordings; the endings pick the formats: .h5, .csv, .npy, .wav, .sigmf-meta, .sigmf-data, .sigmf-collection.

        taps: the outputs that they hold; by default the taps that `run` was asked for.
        wav_scale: full scale of WAV files, in the unit of the samples.

        A file has its name when it is complete. Warns of a WAV whose samples do not fit its full scale. Raises ValueError for wrong
        names, OSError.
        """
        if not paths:
            raise TypeError("save: paths is missing: give at least one file")
        files = [file_name(path) for path in paths]
        self._native.save(files, None if taps is None else names_in("taps", taps), number("wav_scale", wav_scale))

    def __repr__(self) -> str:
        return f"<hertzline.Result {self._native.rows} samples of {', '.join(self.taps)}>"
