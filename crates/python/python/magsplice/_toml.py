"""Dictionaries as TOML, for the library to read with all rules of layout files."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from magsplice.errors import LayoutError

#: A control character that JSON does not escape and TOML forbids.
_DELETE = "\x7f"


#: A piece of the text, and its place in the layout, such as ``tile[3].size_mm``.
Piece = tuple[str, str]

#: An error of the parser: line, column, and the message below the line.
_ERROR = re.compile(r"TOML parse error at line (\d+), column (\d+)\n *\|\n *\d+ \|.*\n *\|.*\n(.*)")


def text_of(layout: Mapping[str, Any]) -> str:
    """Layout as TOML: one line for each key, tables inline, keys with the value None omitted."""
    return "".join(piece for line in _lines(layout) for piece, _ in line)


def faults_of(message: str, layout: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Places in a layout, and messages, from the error message about its text."""
    lines = list(_lines(layout))
    found = _ERROR.findall(message)
    return [(_place(lines[int(line) - 1], int(column)), text) for line, column, text in found]


def _place(line: list[Piece], column: int) -> str:
    end, place = 0, ""
    for piece, of_piece in line:
        # Commas and closing brackets have no place of their own.
        place = of_piece or place
        end += len(piece)
        if column <= end:
            break
    return place


def _lines(layout: Mapping[str, Any]) -> Iterator[list[Piece]]:
    for key, value in layout.items():
        if value is not None:
            yield [(f"{_key(key)} = ", key), *_pieces(value, key), ("\n", "")]


def _key(key: str) -> str:
    bare = key.replace("-", "").replace("_", "")
    return key if bare.isalnum() and bare.isascii() else _string(key)


def _string(text: str) -> str:
    # Strings of JSON without surrogates are basic strings of TOML.
    return json.dumps(text, ensure_ascii=False).replace(_DELETE, "\\u007f")


def _pieces(value: Any, place: str) -> Iterator[Piece]:
    if isinstance(value, (bool, np.bool_)):
        yield "true" if value else "false", place
    elif isinstance(value, str):
        yield _string(value), place
    elif isinstance(value, (int, np.integer)):
        yield str(int(value)), place
    elif isinstance(value, (float, np.floating)):
        # Shortest digits that give the same number; TOML writes nan and inf in the same way.
        number = float(value)
        yield repr(number) if math.isfinite(number) else str(number), place
    elif isinstance(value, Mapping):
        yield "{ ", place
        items = [(key, item) for key, item in value.items() if item is not None]
        for number, (key, item) in enumerate(items):
            inner = f"{place}.{key}"
            yield (", " if number else "") + f"{_key(key)} = ", inner
            yield from _pieces(item, inner)
        yield " }", ""
    elif isinstance(value, np.ndarray):
        yield from _pieces(value.tolist(), place)
    elif isinstance(value, (list, tuple)):
        yield "[", place
        for number, item in enumerate(value):
            if number:
                yield ", ", ""
            yield from _pieces(item, f"{place}[{number}]")
        yield "]", ""
    else:
        raise LayoutError(
            f"{place} = {value!r}: a layout holds numbers, texts, lists and mappings, "
            f"not {type(value).__name__}"
        )
