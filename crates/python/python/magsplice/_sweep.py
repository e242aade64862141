"""Results of a film for several values of a parameter."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Generic, TypeVar

import numpy as np

from magsplice import _html
from magsplice._arrow import Column, Table

F = TypeVar("F")


class Sweep(Table, Generic[F]):
    """Results for values of a parameter. A table with one row for each value.

    Attributes
    ----------
    parameter : str
        Name of the parameter.
    values : list
        Its values.
    films : list[Film]
        The film of each value.
    results : list
        The result of each film.
    """

    def __init__(self, parameter: str, values: list[Any], films: list[F], results: list[Any]):
        self.parameter = parameter
        self.values = values
        self.films = films
        self.results = results

    def __len__(self) -> int:
        return len(self.values)

    def columns(self) -> dict[str, Column]:
        """The values of the parameter, and every number of the results by its name.

        Numbers of inner results have the names of both, such as ``uniformity_rmse.r_x``. A missing
        number is NaN. Values that are no numbers become texts.
        """
        rows = [dict(_numbers("result", result)) for result in self.results]
        names = list(dict.fromkeys(name for row in rows for name in row))
        return {
            self.parameter: _column(self.values),
            **{name: np.array([row.get(name, np.nan) for row in rows]) for name in names},
        }

    def __repr__(self) -> str:
        return f"<magsplice.Sweep of {self.parameter}: {len(self)} values>"

    def __str__(self) -> str:
        return _html.rows_text(self.columns())

    def _repr_html_(self) -> str:
        return _html.rows_table(self.columns())


def values_of(
    parameter: str, values: Sequence[Any], film_of: Callable[[Any], F], result: Callable[[F], Any]
) -> Sweep[F]:
    """The sweep of films by their values."""
    films = [film_of(value) for value in values]
    return Sweep(parameter, list(values), films, [result(film) for film in films])


def _column(values: Sequence[Any]) -> Column:
    try:
        return np.array([float(value) for value in values])
    except (TypeError, ValueError):
        return [str(value) for value in values]


def _numbers(name: str, value: Any) -> Iterator[tuple[str, float]]:
    """The numbers of a result, with their names."""
    if hasattr(value, "to_dict"):
        yield from _of_mapping("", value.to_dict())
    elif isinstance(value, Mapping):
        yield from _of_mapping("", value)
    else:
        yield from _of_item(name, value)


def _of_mapping(place: str, numbers: Mapping[str, Any]) -> Iterator[tuple[str, float]]:
    for name, value in numbers.items():
        if isinstance(value, Mapping):
            yield from _of_mapping(f"{place}{name}.", value)
        else:
            yield from _of_item(place + name, value)


def _of_item(name: str, value: Any) -> Iterator[tuple[str, float]]:
    if isinstance(value, (int, float, np.integer, np.floating)):
        yield name, float(value)
        return
    if isinstance(value, (list, tuple, np.ndarray)):
        numbers = np.asarray(value, dtype=object).ravel().tolist()
        # Longer lists have one entry for each point or tile.
        if len(numbers) == 3 and all(isinstance(of, (int, float)) for of in numbers):
            yield from (
                (f"{name}.{axis}", float(of)) for axis, of in zip("xyz", numbers, strict=True)
            )
