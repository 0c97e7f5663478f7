"""The common part of runs and recordings: samples by name, their spectra and their pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._arguments import names_in, optional_number
from ._plot import draw_samples

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]


class Spectrum(NamedTuple):
    """The spectrum of a whole record, without a window: docs/measures.md defines it."""

    frequency_hz: Floats
    """From 0 to half the sample rate [Hz], equally spaced."""
    amplitude: Floats
    """In the unit of the samples: a sine that fills the record shows its amplitude."""
    measures: dict[str, Any] | None
    """Harmonics, distortion and bands, with the names of the summary; None where the drive's frequency is not known."""


class Samples:
    """Samples at equal distances in time, by the names of their quantities: `v_out` [m/s], `f_last` [N] and so on."""

    @property
    def t(self) -> Floats:
        """Time of each sample since the start of the simulation [s], shape [sample]."""
        raise NotImplementedError

    @property
    def sample_rate_hz(self) -> float:
        """Samples a second [Hz]."""
        raise NotImplementedError

    @property
    def taps(self) -> list[str]:
        """The names for `self[...]`."""
        raise NotImplementedError

    @property
    def provenance(self) -> dict[str, Any]:
        """Origin of the samples: version, scene, integrator, step, estimated error."""
        raise NotImplementedError

    def __getitem__(self, name: str) -> Floats:
        """The samples in the unit of their tap: shape [sample], [sample, sphere] of `v_chain` and `x_chain`, [sample, contact] of
        `f_chain`, [sample, point] of `p_points`, or [sample, element] of an array's `v_out` and others. The name of a column of a
        recording gives one channel: "v3_m_per_s" is the third sphere of `v_chain`.

        Nothing is copied: the array is a view that cannot be written to, and keeps alive what it looks at. (Columns of a foreign
        recording that lie in no regular order are copied.)
        Raises KeyError for another name, with those that are allowed.
        """
        raise NotImplementedError

    def __contains__(self, name: object) -> bool:
        try:
            return isinstance(name, str) and self[name] is not None
        except KeyError:
            return False

    __iter__ = None

    def spectrum(self, name: str, *, band_from_hz: float | None = None) -> Spectrum:
        """Amplitude over frequency of a tap with one channel, or of one channel ("v3_m_per_s"), and its measures, as the program
        computes them.

        band_from_hz: bands are looked for from here upward [Hz]; by default half the drive's frequency.
        """
        return Spectrum(*_native.spectrum(self[name], self.sample_rate_hz, self._drive_hz(), optional_number("band_from_hz", band_from_hz)))

    def plot(self, taps: Sequence[str] | None = None, *, title: str = "", axes: Any = None) -> Figure:
        """Draws waveform and spectrum of taps (by default of those with one channel), as `hertzline plot` does.

        axes: draws into these, two for each tap: waveform and spectrum; by default a figure is made.

        Needs matplotlib. The figure is one of pyplot's: a notebook shows it by itself, a script by `plt.show()`.
        """
        names = [name for name in self.taps if self[name].ndim == 1] if taps is None else names_in("taps", taps)
        drawn = {name: (self[name], self.unit(name)) for name in names}
        recording = {"sample_rate_hz": self.sample_rate_hz, "provenance": self.provenance}
        return draw_samples(drawn, self.t, recording, title, axes)

    def unit(self, name: str) -> str:
        """The unit of a tap: "m/s", "N", "Pa", "m"."""
        raise NotImplementedError

    def _drive_hz(self) -> float | None:
        found: Any = self.provenance
        for key in ("scene", "drive", "frequency_hz"):
            found = found.get(key) if isinstance(found, Mapping) else None
        return float(found) if isinstance(found, (int, float)) and found > 0 else None
