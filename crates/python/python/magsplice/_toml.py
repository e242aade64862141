"""Dictionaries as TOML, for the library to read with all rules of layout files."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from magsplice.errors import LayoutError

#: A control character that JSON does not escape and TOML forbids.
_DELETE = "\x7f"


def text_of(layout: Mapping[str, Any]) -> str:
    """Layout as TOML: one line for each key, tables inline, keys with the value None omitted."""
    lines = [
        f"{_key(key)} = {_value(value, key)}\n"
        for key, value in layout.items()
        if value is not None
    ]
    return "".join(lines)


def _key(key: str) -> str:
    bare = key.replace("-", "").replace("_", "")
    return key if bare.isalnum() and bare.isascii() else _string(key)


def _string(text: str) -> str:
    # Strings of JSON without surrogates are basic strings of TOML.
    return json.dumps(text, ensure_ascii=False).replace(_DELETE, "\\u007f")


def _value(value: Any, place: str) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, str):
        return _string(value)
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        # Shortest digits that give the same number; TOML writes nan and inf in the same way.
        number = float(value)
        return repr(number) if math.isfinite(number) else str(number)
    if isinstance(value, Mapping):
        pairs = [
            f"{_key(key)} = {_value(item, f'{place}.{key}')}"
            for key, item in value.items()
            if item is not None
        ]
        return "{ " + ", ".join(pairs) + " }"
    if isinstance(value, np.ndarray):
        return _value(value.tolist(), place)
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_value(item, f"{place}[{i}]") for i, item in enumerate(value)) + "]"
    raise LayoutError(
        f"{place} = {value!r}: a layout holds numbers, texts, lists and mappings, "
        f"not {type(value).__name__}"
    )
