"""Results of the library. Their attributes are the keys of JSON files of the program."""

from __future__ import annotations

import copy
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from operator import itemgetter
from typing import Any, TypeVar

import numpy as np

from magsplice import _html

T = TypeVar("T")


def _item(index: int, doc: str) -> Any:
    return property(itemgetter(index), doc=doc)


class PerAxis(tuple[T, ...]):
    """Values along x, y, z."""

    x: T = _item(0, "Value along x.")
    y: T = _item(1, "Value along y.")
    z: T = _item(2, "Value along z.")


class PerParameter(tuple[T, ...]):
    """Values of the decoupling parameters R_x, R_y, S_z."""

    r_x: T = _item(0, "Value of R_x.")
    r_y: T = _item(1, "Value of R_y.")
    s_z: T = _item(2, "Value of S_z.")


#: Tuples that replace dictionaries with these keys.
_TUPLES: dict[tuple[str, ...], Callable[[Any], Any]] = {
    ("x", "y", "z"): PerAxis,
    ("r_x", "r_y", "s_z"): PerParameter,
}


def _value(found: Any, of: Callable[[Any], Any]) -> Any:
    """Value of the library with the parts of a list, dictionary or tuple converted by `of`."""
    if isinstance(found, list):
        return [_value(item, of) for item in found]
    if not isinstance(found, dict):
        return found
    parts = _TUPLES.get(tuple(found))
    return of(found) if parts is None else parts(_value(item, of) for item in found.values())


class _Key(property):
    """Attribute of a result with the name of its key."""

    def __init__(self, doc: str, of: Callable[[Any], Any]) -> None:
        super().__init__(lambda result: result.__dict__[self.name])
        self.__doc__ = doc
        self.of = of

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name


def key(doc: str, of: Callable[[Any], Any] = dict) -> Any:
    """Attribute of a result with the value of the key of its name, or None without the key.

    `of` converts a dictionary, or each dictionary of a list. A name that is a Python keyword ends
    with an underscore, which the key does not have.
    """
    return _Key(doc, of)


class Result:
    """An immutable result. It prints as lines of names and numbers."""

    def __init__(self, numbers: Mapping[str, Any], **more: Any) -> None:
        json = {name: value for name, value in numbers.items() if not isinstance(value, np.ndarray)}
        found = {**numbers, **more}
        kinds = reversed(type(self).__mro__)
        declared = (item for kind in kinds for item in vars(kind).items())
        keys = {name: of for name, of in declared if isinstance(of, _Key)}
        values = {name: _value(found.get(name.rstrip("_")), of.of) for name, of in keys.items()}
        self.__dict__.update(values, _json=json)

    def to_dict(self) -> dict[str, Any]:
        """Numbers with the keys of the program's JSON, without arrays of points."""
        return copy.deepcopy(self.__dict__["_json"])

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{type(self).__name__}.{name}: a result does not change")

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        return _are_equal(vars(self), vars(other))

    def __hash__(self) -> int:
        return hash(str(self.__dict__["_json"]))

    def __str__(self) -> str:
        return "\n".join(f"{name:<28} {_html.digits(value)}" for name, value in self._shown())

    def __repr__(self) -> str:
        return f"<magsplice.{type(self).__name__}>\n{self}"

    def _repr_html_(self) -> str:
        return _html.number_table(self._shown())

    def _shown(self) -> Iterator[tuple[str, Any]]:
        return lines(self.__dict__["_json"])


def _are_equal(one: Any, other: Any) -> bool:
    """Whether values are equal, with the arrays in them. NaN is equal to NaN in an array."""
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other, equal_nan=True)
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(_are_equal(one[key], other[key]) for key in one)
    if isinstance(one, (list, tuple)) and type(one) is type(other):
        return len(one) == len(other) and all(map(_are_equal, one, other))
    return bool(one == other)


def lines(numbers: Mapping[str, Any], place: str = "") -> Iterator[tuple[str, str]]:
    """Names, and values with the names of their components and the unit of the name.

    Numbers of inner dictionaries have both names.
    """
    for name, value in numbers.items():
        if isinstance(value, dict):
            text = _shown_numbers(value)
            if text is None:
                yield from lines(value, f"{place}{name}.")
                continue
        elif isinstance(value, list) and any(isinstance(item, dict) for item in value):
            yield from _entries(place + name, value)
            continue
        elif isinstance(value, (list, tuple)) and len(value) == 3 and _are_components(value):
            text = _shown_numbers(dict(zip("xyz", value, strict=True))) or ""
        else:
            text = "none" if value is None else _html.digits(value)
        # Inner names, such as x, have the unit of the outer one.
        found = unit_of(name) or unit_of(place.rstrip("."))
        yield place + name, f"{text} {found}" if found and text != "none" else text


def _entries(name: str, items: list[dict[str, Any]]) -> Iterator[tuple[str, str]]:
    """A line for each of a few entries: its numbers and texts."""
    if len(items) > _MOST_ENTRIES:
        yield name, f"{len(items)} entries"
        return
    for number, item in enumerate(items):
        parts = [f"{text}" if key == "name" else f"{key} {text}" for key, text in lines(item)]
        yield f"{name}[{number}]", "; ".join(parts)


def _are_components(values: Iterable[Any]) -> bool:
    """Whether values may be those along x, y, z: whole numbers are counts or indices."""
    return all(value is None or isinstance(value, float) for value in values)


def _shown_numbers(value: Mapping[str, Any]) -> str | None:
    """Text of components, of an estimate, or of statistics; None for other dictionaries."""
    if tuple(value) in _TUPLES and not any(isinstance(item, dict) for item in value.values()):
        return ", ".join(f"{name} {_html.digits(item)}" for name, item in value.items())
    if set(value) == {"value", "interval"}:
        return estimate_text(value)
    if {"mean", "p50", "p95"} <= set(value):
        of_films = [(name, item) for name, item in value.items() if name != "count"]
        return ", ".join(
            f"{name} {estimate_text(item) if isinstance(item, dict) else _html.digits(item)}"
            for name, item in of_films
        )
    return None


def estimate_text(found: Mapping[str, Any]) -> str:
    """A value with its interval. An end that needs more samples is open."""
    low, high = (float("nan" if end is None else end) for end in found["interval"])
    ends = [f"{end:.6g}" if math.isfinite(end) else "" for end in (low, high)]
    interval = f" ({' .. '.join(ends).strip()})" if any(ends) else ""
    return f"{_html.digits(found['value'])}{interval}"


#: Largest number of entries of a list that are printed.
_MOST_ENTRIES = 12

#: Units by the ends of names, longer ends first.
_UNITS = {
    "_n_per_mm": "N/mm",
    "_per_mm": "1/mm",
    "_n_mm": "N mm",
    "_mm2": "mm2",
    "_mm": "mm",
    "_deg": "deg",
    "_rad": "rad",
    "_t": "T",
    "_n": "N",
}


def unit_of(name: str) -> str:
    """The unit at the end of a name, before a level of confidence; empty without one."""
    stem = name.removesuffix("_95")
    return next((unit for end, unit in _UNITS.items() if stem.endswith(end)), "")
