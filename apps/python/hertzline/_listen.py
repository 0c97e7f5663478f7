"""A running stream, block by block."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from . import _native


class GapError(RuntimeError):
    """Samples of a stream are missing."""

    def __init__(self, message: str, missing: int) -> None:
        super().__init__(message)
        self.missing = missing
        """How many samples."""


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Consecutive samples of a stream."""

    samples: NDArray[np.float32]
    """In `unit`: shape [sample], [sample, sphere] of v_chain, or [sample, contact] of f_chain."""
    sample: int
    """Index of the first of them since the run's start."""
    fs: float
    """Samples a second [Hz]."""
    seq: int
    """Number of the frame, from 0."""
    missing: int
    """Samples that are missing between the block before and this one."""
    unit: str
    """"m/s", "N" or "Pa"."""
    run: str
    """The run's id."""
    epoch: int
    """Counts the changes of the scene since the run's start; the same for all samples of a block."""
    burst: int
    """The horn's burst that the first sample lies in, from 0."""
    burst_sample: int
    """Index of the first sample since that burst's first one."""

    @property
    def t(self) -> NDArray[np.float64]:
        """Time of each sample since the run's start [s]."""
        times: NDArray[np.float64] = (self.sample + np.arange(len(self.samples))) / self.fs
        return times


def listen(
    endpoint: str = "tcp://127.0.0.1:5573",
    stream: str = "v_out",
    *,
    gaps: Literal["raise", "mark"] = "raise",
    timeout_s: float | None = None,
    curve_key: str | os.PathLike[str] | None = None,
    server_key: str | os.PathLike[str] | None = None,
) -> Live:
    """Connects to a running stream and subscribes to one of its taps.

        with hertzline.listen("tcp://127.0.0.1:5573", "v_out") as live:
            for block in live:
                print(block.t[0], np.abs(block.samples).max())

    gaps: "raise" a GapError where samples are missing, or "mark" the block after them (`block.missing`).
    timeout_s: how long to wait for a message [s]; by default without limit for the first samples, then 15 s.
    curve_key, server_key: files of keys, for an encrypted stream: one's own secret key, the stream's public key.

    Raises ValueError with every wrong argument.
    """
    if gaps not in ("raise", "mark"):
        raise ValueError(f'gaps: found {gaps!r}, allowed: "raise", "mark"')
    keys = [os.fspath(key) if key is not None else None for key in (curve_key, server_key)]
    return Live(_native.listen(endpoint, stream, timeout_s, *keys), endpoint, stream, gaps)


class Live:
    """A connection. Iterates over blocks until the run ends; `close` it, or use it in a `with`. For one thread at a time."""

    def __init__(self, native: _native.Listener, endpoint: str, stream: str, gaps: str) -> None:
        self._native = native
        self._endpoint, self._stream, self._gaps = endpoint, stream, gaps
        self._end_reported = False
        self._kept: Block | None = None  # what follows a gap that was raised

    def __enter__(self) -> Live:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Ends the connection. Also from another thread: whoever iterates is then at the end."""
        self._native.close()

    def __iter__(self) -> Iterator[Block]:
        return self

    def __next__(self) -> Block:
        """The next block. Waits for it, and lets other threads run meanwhile.

        Raises GapError where samples are missing (the next call goes on behind them), TimeoutError when nothing comes in
        time, ConnectionError when the stream refuses or breaks off, ValueError when it does not have the tap.
        """
        if self._kept is not None:
            kept, self._kept = self._kept, None
            return kept
        frame = self._native.next()
        if frame is None:
            self._end()
            raise StopIteration
        block = Block(*frame)
        if block.missing and self._gaps == "raise":
            self._kept = block
            raise GapError(f"{block.missing} samples are missing before sample {block.sample}", block.missing)
        return block

    def _end(self) -> None:
        if self._end_reported:
            return
        self._end_reported = True
        why = self.totals["ended_by"]
        if why == "timeout":
            raise TimeoutError(f"nothing arrived from {self._endpoint}")
        if why == "refused":
            raise ConnectionRefusedError(f"{self._endpoint}: {self._native.refusal}")
        if why == "run broke off":
            raise ConnectionError("the run broke off and another one began")
        if why == "no such stream":
            raise ValueError(f"stream: found {self._stream}, allowed: {', '.join(self._native.streams)}")
        missing = self._native.missing_at_end
        if missing and self._gaps == "raise":
            raise GapError(f"{missing} samples are missing before the end", missing)

    @property
    def totals(self) -> dict[str, Any]:
        """What was received so far and what is missing, with the names of the summary of `hertzline listen`."""
        return self._native.totals()

    @property
    def notices(self) -> list[str]:
        """What the program would warn of, a sentence each."""
        return self._native.notices

    @property
    def provenance(self) -> dict[str, Any]:
        """Where the samples come from: version, scene, integrator, step, estimated error."""
        return self._native.provenance()
