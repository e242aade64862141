"""Results of the library. Their attributes are the keys of JSON files of the program."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping
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
        pairs = zip(vars(self).values(), vars(other).values(), strict=True)
        return all(
            np.array_equal(a, b, equal_nan=True) if isinstance(a, np.ndarray) else a == b
            for a, b in pairs
        )

    def __hash__(self) -> int:
        return hash(str(self.__dict__["_json"]))

    def __str__(self) -> str:
        return "\n".join(f"{name:<28} {_html.digits(value)}" for name, value in self._shown())

    def __repr__(self) -> str:
        return f"<magsplice.{type(self).__name__}>\n{self}"

    def _repr_html_(self) -> str:
        return _html.number_table(self._shown())

    def _shown(self) -> Iterator[tuple[str, Any]]:
        return _lines(self.__dict__["_json"])


def _lines(numbers: Mapping[str, Any], place: str = "") -> Iterator[tuple[str, Any]]:
    """Names and numbers. Numbers of inner dictionaries have both names."""
    for name, value in numbers.items():
        if isinstance(value, dict):
            inner = list(value.values())
            if tuple(value) in _TUPLES and not any(isinstance(item, dict) for item in inner):
                yield place + name, inner
            else:
                yield from _lines(value, f"{place}{name}.")
        elif isinstance(value, list) and any(isinstance(item, dict) for item in value):
            yield place + name, f"{len(value)} entries"
        else:
            yield place + name, value
