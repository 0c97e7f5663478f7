"""A scene in motion, block by block."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from . import _native
from ._arguments import Path, integer, names_in
from ._samples import Floats
from ._scene import Scene, scene


class Simulation:
    """A scene in motion: it goes as far as it is asked to, beyond output.duration_s, too. It cannot be copied, and a second thread that
    uses it meanwhile gets a RuntimeError.

        simulation = hertzline.Simulation("paper-stream", taps=["v_out"])
        while simulation.t < 1e-3:
            v_out = simulation.advance(1000)["v_out"]
    """

    def __init__(self, base: Scene | Path = "paper-vitreous-carbon", taps: Iterable[str] | None = None) -> None:
        """Starts at sample 0, at static equilibrium. Raises ValueError with every fault, and MemoryError.

        taps: the outputs that are computed; by default those that `hertzline run -o` saves.
        """
        start = base if isinstance(base, Scene) else scene(base)
        self._native = _native.simulation(start._native, None if taps is None else names_in("taps", taps))

    def advance(self, samples: int) -> dict[str, Floats]:
        """Simulates the next samples. Returns each tap's: [sample], or [sample, sphere or contact] of the whole chain.

        Raises RuntimeError when the motion becomes unstable. Other threads run meanwhile. Samples of a call that raises are lost.
        """
        return self._native.advance(integer("samples", samples))

    def __reduce__(self) -> tuple[Any, ...]:
        raise TypeError("a Simulation can neither be copied nor pickled")

    def reset(self) -> None:
        """Goes back to sample 0, at static equilibrium."""
        self._native.reset()

    @property
    def sample(self) -> int:
        """Number of the next sample."""
        return self._native.sample

    @property
    def t(self) -> float:
        """Time of the next sample [s]."""
        return self.sample / self._native.sample_rate_hz

    @property
    def step_s(self) -> float:
        """The step, or the longest piece of a series [s]."""
        return self._native.step_s

    @property
    def steps(self) -> int:
        """Steps or pieces so far."""
        return self._native.steps

    @property
    def contact_events(self) -> int:
        """Openings and closings of all contacts so far."""
        return self._native.contact_events

    @property
    def energy_residual(self) -> float:
        """Energy missing in the ledger over the energy that came and went."""
        return self._native.energy_residual
