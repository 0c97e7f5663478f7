"""Arguments of functions as the native part takes them; others are refused by their name, with what was found and what is allowed."""

from __future__ import annotations

import operator
import os
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

Path = str | os.PathLike[str]


def refuse(argument: str, value: Any, allowed: str) -> None:
    raise TypeError(f"{argument}: found {type(value).__name__} {value!r:.100}, allowed: {allowed}")


def is_flag(value: Any) -> bool:
    return isinstance(value, (bool, np.bool_))


def number(argument: str, value: Any) -> float:
    """A number, of Python or NumPy."""
    if is_flag(value) or isinstance(value, (str, bytes)) or not hasattr(value, "__float__") or np.ndim(value) > 0:
        refuse(argument, value, "a number")
    return float(value)


def integer(argument: str, value: Any, most: int = 2**63 - 1) -> int:
    """An integer, of Python or NumPy, that the native part can hold."""
    if is_flag(value) or not hasattr(value, "__index__") or np.ndim(value) > 0:
        refuse(argument, value, "an integer")
    found = operator.index(value)
    if not -most <= found <= most:
        allowed = f"at most {most}" if found > most else f"at least {-most}"
        raise ValueError(f"{argument}: found {found}, allowed: {allowed}")
    return found


def threads(jobs: Any) -> int | None:
    return None if jobs is None else integer("jobs", jobs, 2**31 - 1)


def optional_number(argument: str, value: Any) -> float | None:
    return None if value is None else number(argument, value)


def text(argument: str, value: Any) -> str:
    if not isinstance(value, str):
        refuse(argument, value, "a text")
    return utf8(value)


def utf8(value: str) -> str:
    return value.encode("utf-8", "backslashreplace").decode()  # half a surrogate pair is no text elsewhere


def names_in(argument: str, names: Iterable[str]) -> list[str]:
    """A list of names; one by itself, which would be taken letter by letter, is refused."""
    if isinstance(names, str):
        raise TypeError(f'{argument}: found the text "{names}", allowed: a list of names, as ["{names}"]')
    if not isinstance(names, Iterable):
        refuse(argument, names, "a list of names")
    found = list(names)
    for name in found:
        if not isinstance(name, str):
            raise TypeError(f"{argument}: found {name!r}, allowed: text in each place of the list")
    return [utf8(name) for name in found]


def items_of(argument: str, mapping: Any) -> dict[str, Any]:
    """A dict, or what has columns as a DataFrame does."""
    if not isinstance(mapping, Mapping) and not hasattr(mapping, "items"):
        refuse(argument, mapping, "a dict of keys and values")
    found = dict(mapping.items())
    for key in found:
        if not isinstance(key, str):
            refuse(argument, key, "texts as keys")
    return found


def file_name(path: Path) -> bytes:
    """The bytes of a file's name."""
    name = os.fsencode(path)
    if not name or b"\0" in name:
        raise ValueError(f"found the file name {os.fsdecode(name)!r}, allowed: names with characters, none of them null")
    return name
