"""A running stream: its samples, block by block, and its scene, which can be changed."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._arguments import Path, file_name, items_of, number, optional_number, text
from ._scene import finite_value


def _files(curve_key: Path | None, server_key: Path | None) -> tuple[bytes | None, bytes | None]:
    own = None if curve_key is None else file_name(curve_key)
    return own, None if server_key is None else file_name(server_key)


class GapError(RuntimeError):
    """Samples of a stream are missing."""

    def __init__(self, message: str, missing: int) -> None:
        super().__init__(message)
        self.missing = missing
        """Count of missing samples."""

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (*self.args, self.missing)


@dataclass(frozen=True, slots=True, eq=False)
class Block:
    """Consecutive samples of a stream."""

    samples: NDArray[np.float32]
    """In `unit`: shape [sample], [sample, sphere] of v_chain, [sample, contact] of f_chain, [sample, point] of p_points, or
    [sample, element] of an array's v_out and others."""
    sample: int
    """Index of the first sample since the run's start."""
    fs: float
    """Samples a second [Hz]."""
    seq: int
    """Number of the frame, from 0."""
    missing: int
    """Samples that are missing between the block before and this one."""
    unit: str
    """"m/s", "m", "N" or "Pa"."""
    run: str
    """The run's id."""
    epoch: int
    """Counts the changes of the scene since the run's start; the same for all samples of a block."""
    burst: int
    """Number of the burst that the first sample lies in, from 0."""
    burst_sample: int
    """Index of the first sample within that burst."""

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
    curve_key: Path | None = None,
    server_key: Path | None = None,
) -> Live:
    """Connects to a running stream and subscribes to one of its taps.

        with hertzline.listen("tcp://127.0.0.1:5573", "v_out") as live:
            for block in live:
                print(block.t[0], np.abs(block.samples).max())

    gaps: "raise" a GapError where samples are missing, or "mark" the block after them (`block.missing`).
    timeout_s: the longest wait for a message [s]; by default without limit for the first samples, then 15 s.
    curve_key, server_key: files of keys, for an encrypted stream: one's own secret key, the stream's public key.

    Raises ValueError with every wrong argument.
    """
    if gaps not in ("raise", "mark"):
        raise ValueError(f'gaps: found {gaps!r}, allowed: "raise", "mark"')
    wait = optional_number("timeout_s", timeout_s)
    native = _native.listen(text("endpoint", endpoint), text("stream", stream), wait, *_files(curve_key, server_key))
    return Live(native, endpoint, stream, gaps)


class Live:
    """A connection. Iterates over blocks until the run ends; `close` it, or use it in a `with`. For one thread at a time."""

    def __init__(self, native: _native.Listener, endpoint: str, stream: str, gaps: str) -> None:
        self._native = native
        self._endpoint, self._stream, self._gaps = endpoint, stream, gaps
        self._gap_at_end_told = False
        self._kept: Block | None = None  # the block after a gap that was raised

    def __enter__(self) -> Live:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Ends the connection, from any thread. An iteration in another thread then ends."""
        self._native.close()

    def __iter__(self) -> Iterator[Block]:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        raise TypeError("a connection can neither be copied nor pickled")

    def __next__(self) -> Block:
        """The next block. Waits for it, and lets other threads run meanwhile.

        Raises GapError where samples are missing (the next call continues behind them). With TimeoutError, when nothing comes in time,
        ConnectionError, when the stream refuses or breaks off, and ValueError, when it does not have the tap, the connection has ended:
        each call after it raises the same.
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
        if missing and self._gaps == "raise" and not self._gap_at_end_told:
            self._gap_at_end_told = True
            raise GapError(f"{missing} samples are missing before the end", missing)

    @property
    def totals(self) -> dict[str, Any]:
        """Counts of received and missing samples, with the names of the summary of `hertzline listen`."""
        return self._native.totals()

    @property
    def notices(self) -> list[str]:
        """The warnings that the program would print, a sentence each."""
        return self._native.notices

    @property
    def provenance(self) -> dict[str, Any]:
        """Origin of the samples: version, scene, integrator, step, estimated error."""
        return self._native.provenance()


def control(
    endpoint: str = "tcp://127.0.0.1:5574",
    *,
    timeout_s: float = 10.0,
    curve_key: Path | None = None,
    server_key: Path | None = None,
) -> Control:
    """Controls a stream that was started with `hertzline stream --control ENDPOINT`.

        live = hertzline.control()
        live["drive.amplitude_m"]
        live.set({"drive.amplitude_m": 2e-6})

    timeout_s: the longest wait for a reply [s].
    curve_key, server_key: files of keys, for an encrypted stream: one's own secret key, the stream's public key.
    """
    return Control(text("endpoint", endpoint), number("timeout_s", timeout_s), *_files(curve_key, server_key))


class Control:
    """The scene of a running stream. Each call is a request of its own; nothing stays connected."""

    def __init__(self, endpoint: str, timeout_s: float, curve_key: bytes | None, server_key: bytes | None) -> None:
        self._connection = (endpoint, timeout_s, curve_key, server_key)

    def _ask(self, request: Mapping[str, Any]) -> dict[str, Any]:
        reply = _native.ask_control(json.dumps(request, allow_nan=False), *self._connection)
        faults = reply.get("faults")
        if faults:
            raise ValueError("\n".join(str(fault.get("message", "refused")) for fault in faults))
        return reply

    def set(self, values: Mapping[str, Any], *, force: bool = False) -> dict[str, Any]:
        """Changes keys of the scene: {"drive.amplitude_m": 2e-6}; None takes an optional value back.

        force: change it even if the stream would then all but stop.

        Returns the reply: `applies_at_sample`, `epoch`, `scene_hash`, `estimated_error`, `estimated_over_s`, `warnings`. Raises
        ValueError with every fault, OSError with the reason when there is no reply.
        """
        request: dict[str, Any] = {"set": {key: finite_value(key, value) for key, value in items_of("values", values).items()}}
        return self._ask(request | {"force": True} if force else request)

    def undo(self) -> dict[str, Any]:
        """Takes the last change back. Returns and raises as `set`."""
        return self._ask({"undo": True})

    def get(self, *keys: str) -> dict[str, dict[str, Any]]:
        """Each key's `value`, `unit`, bounds and `description`; without keys all that the scene has."""
        values: dict[str, dict[str, Any]] = self._ask({"get": list(keys)})["values"]
        return values

    def __getitem__(self, key: str) -> Any:
        """The value of a key: control["drive.amplitude_m"] [m]. Raises ValueError for one that the scene does not have."""
        return self.get(key)[key]["value"]

    def __setitem__(self, key: str, value: Any) -> None:
        self.set({key: value})

    def __contains__(self, key: object) -> bool:
        return key in self.get()

    __iter__ = None
