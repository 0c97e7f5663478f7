"""The scene of a running stream: reads and changes it."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any

from . import _native

Path = str | os.PathLike[str]


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

    timeout_s: how long to wait for a reply [s].
    curve_key, server_key: files of keys, for an encrypted stream: one's own secret key, the stream's public key.
    """
    keys = [os.fspath(key) if key is not None else None for key in (curve_key, server_key)]
    return Control(endpoint, timeout_s, *keys)


class Control:
    """The scene of a running stream. Each call is a request of its own; nothing stays connected."""

    def __init__(self, endpoint: str, timeout_s: float, curve_key: str | None, server_key: str | None) -> None:
        self._connection = (endpoint, timeout_s, curve_key, server_key)

    def _ask(self, request: Mapping[str, Any]) -> dict[str, Any]:
        endpoint, timeout_s, curve_key, server_key = self._connection
        reply = _native.ask_control(endpoint, json.dumps(request), timeout_s, curve_key, server_key)
        faults = reply.get("faults")
        if faults:
            raise ValueError("\n".join(str(fault.get("message", "refused")) for fault in faults))
        return reply

    def set(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Changes keys of the scene: {"drive.amplitude_m": 2e-6}; None takes an optional value back.

        Returns the reply: `applies_at_sample`, `epoch`, `scene_hash`. Raises ValueError with every fault, OSError without a reply.
        """
        return self._ask({"set": dict(values)})

    def undo(self) -> dict[str, Any]:
        """Takes the last change back. Returns and raises as `set`."""
        return self._ask({"undo": True})

    def get(self, *keys: str) -> dict[str, dict[str, Any]]:
        """Each key's `value`, `unit`, bounds and `description`; without keys all that the scene has."""
        values: dict[str, dict[str, Any]] = self._ask({"get": list(keys)})["values"]
        return values

    def __getitem__(self, key: str) -> Any:
        """The value of a key: control["drive.amplitude_m"] [m]."""
        return self.get(key)[key]["value"]

    def __setitem__(self, key: str, value: Any) -> None:
        self.set({key: value})
