"""Scenes as text: from tables of Python to TOML."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

BARE_KEY = re.compile(r"[A-Za-z0-9_-]+")


def string(text: str) -> str:
    """A basic string. What JSON escapes, TOML escapes alike, but for one character more."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def key(name: str) -> str:
    return name if BARE_KEY.fullmatch(name) else string(name)


def plain(value: Any) -> Any:
    """A value without types of numpy."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    return value


def inline(value: Any) -> str:
    """A value on one line."""
    value = plain(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return repr(value)
    if isinstance(value, str):
        return string(value)
    if isinstance(value, Mapping):
        entries = ", ".join(f"{key(str(name))} = {inline(entry)}" for name, entry in value.items())
        return "{ " + entries + " }" if entries else "{}"
    if isinstance(value, Sequence):
        return "[" + ", ".join(inline(entry) for entry in value) + "]"
    raise TypeError(f"{value!r} is neither a number, a text, a list nor a dict; a scene has no other values")


def is_table_list(value: Any) -> bool:
    """Whether a value is written as [[name]], table by table."""
    return isinstance(value, list) and bool(value) and all(isinstance(entry, Mapping) for entry in value)


def dumps(tables: Mapping[str, Any]) -> str:
    """The text of a scene: its own keys first, then table by table."""
    parts = [f"{key(name)} = {inline(v)}\n" for name, v in tables.items() if not _is_table(v)]
    for name, value in tables.items():
        if not _is_table(value):
            continue
        head, several = ("[[{}]]", value) if is_table_list(value) else ("[{}]", [value])
        for table in several:
            lines = [f"{key(str(k))} = {inline(v)}\n" for k, v in table.items()]
            parts.append(("\n" if parts else "") + head.format(key(name)) + "\n" + "".join(lines))
    return "".join(parts)


def _is_table(value: Any) -> bool:
    return isinstance(value, Mapping) or is_table_list(value)
