"""Recordings of the program, of `Result.save`, or of others."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from . import _native
from ._arguments import Path, file_name, optional_number, text
from ._samples import Floats, Samples


def load(path: Path, *, sample_rate_hz: float | None = None) -> Recording:
    """Reads a recording, whole: .h5, .csv, .npy, .wav, .sigmf-meta, .sigmf-data, .sigmf-collection, .sigmf.

    `sample_rate_hz` is the rate of a file without one, or another one than its own. Warns of samples that are left out.
    Raises ValueError for another ending, OSError for a file that cannot be read or is damaged.
    """
    native = _native.load(file_name(path), optional_number("sample_rate_hz", sample_rate_hz))
    for warning in native.warnings:
        warnings.warn(warning, stacklevel=2)
    return Recording(native)


class Recording(Samples):
    """Samples of a file. Where some are missing, `gaps` has their place and count, and `t` leaps."""

    def __init__(self, native: _native.Recording) -> None:
        self._native = native
        self._columns = native.columns
        self._quantities = list(dict.fromkeys(quantity or name for name, quantity, _ in self._columns))
        self._t: Floats | None = None

    @property
    def t(self) -> Floats:
        """Time of each sample since the start of its simulation [s], shape [sample].

        Raises ValueError when the file has no sample rate and load() was given none.
        """
        if self._t is None:
            if not self.sample_rate_hz > 0:
                raise ValueError("t: the file has no sample rate, allowed: load(path, sample_rate_hz=...)")
            samples = np.empty(self._native.rows, dtype=np.int64)
            stretches = self._native.stretches
            ends = [row for _, row in stretches[1:]] + [self._native.rows]
            for (first, row), end in zip(stretches, ends):
                samples[row:end] = first + np.arange(end - row)
            self._t = samples / self._native.sample_rate_hz
            self._t.setflags(write=False)
        return self._t

    @property
    def gaps(self) -> list[tuple[int, int]]:
        """Gaps: (the row behind the gap, the count of missing samples)."""
        stretches = self._native.stretches
        return [
            (row, first - (before + row - row_before))
            for (before, row_before), (first, row) in zip(stretches, stretches[1:])
        ]

    @property
    def sample_rate_hz(self) -> float:
        """Samples a second [Hz]; 0 when the file does not tell."""
        return self._native.sample_rate_hz

    @property
    def taps(self) -> list[str]:
        """The names for `self[...]`, beside those of single columns."""
        return list(self._quantities)

    @property
    def columns(self) -> list[tuple[str, str, str]]:
        """Name, quantity and unit of each column of the file."""
        return list(self._columns)

    def __getitem__(self, name: str) -> Floats:
        return self._native.samples(text("name", name))

    def unit(self, name: str) -> str:
        """The unit of a tap or column; "" where the file has none."""
        for column, quantity, unit in self._columns:
            if name in (quantity, column):
                return unit
        raise KeyError(f'found "{name}", allowed: {", ".join(dict.fromkeys(quantity or column for column, quantity, _ in self._columns))}')

    def spectrum(self, name: str, *, band_from_hz: float | None = None) -> Any:
        if self.gaps:
            raise ValueError(f"spectrum: found {len(self.gaps)} gaps in the recording, allowed: none")
        return super().spectrum(name, band_from_hz=band_from_hz)

    @property
    def provenance(self) -> dict[str, Any]:
        """Origin of the samples, from the file: version, scene, integrator, step, estimated error."""
        provenance = self._native.provenance()
        return provenance if isinstance(provenance, dict) else {}

    def __repr__(self) -> str:
        return f"<hertzline.Recording {self._native.rows} samples of {', '.join(self.taps)}>"
