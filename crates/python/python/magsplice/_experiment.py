"""Experiments that move a film over its sensor."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from magsplice import _html
from magsplice._arguments import one_of
from magsplice._arrow import Column, Table, split
from magsplice._layout import Floats
from magsplice._points import flattened
from magsplice._results import key
from magsplice._source import OfFilm


class Experiment(OfFilm, Table):
    """Readings of a sensor while the film moves along x, then y, then z, one row for each step.

    NaN where a reading has no position or no parameters.
    """

    readings: int = key("Number of readings.")
    film_mm: Floats = key("Displacement of the film, in millimetres, shape (n, 3).")
    readings_t: Floats = key("Readings, in tesla, shape (n, 3).")
    found_mm: Floats = key(
        "Displacement of the film by the field of the layout, in millimetres, shape (n, 3)."
    )
    parameters: Floats | None = key(
        "R_x, R_y in radians and S_z, shape (n, 3). None without an ideal film."
    )
    closed_form_mm: Floats | None = key(
        """Displacement by the closed form of the ideal film (Dai 2024, Eq. 14), in millimetres,
        shape (n, 3). None without an ideal film."""
    )
    force_n: Floats | None = key("Force, in newton, shape (n, 3). None without ``[elastomer]``.")
    found_force_n: Floats | None = key("Force of `found_mm`, in newton, shape (n, 3), or None.")
    closed_form_force_n: Floats | None = key(
        "Force of `closed_form_mm`, in newton, shape (n, 3), or None."
    )
    saturated: Floats = key("1 where the flux density exceeds the range of the sensor, shape (n,).")

    def __init__(
        self, numbers: Mapping[str, Any], quantities: Mapping[str, tuple[list[str], Floats]]
    ) -> None:
        arrays = {name: rows for name, (_, rows) in quantities.items()}
        arrays["saturated"] = arrays["saturated"].ravel()
        super().__init__(numbers, **arrays)
        self.__dict__["_quantities"] = quantities

    def __str__(self) -> str:
        return f"{super().__str__()}\n{_html.rows_text(self.columns())}"

    def columns(self) -> dict[str, Column]:
        """Columns step, film_dx_mm, ..., bx_t, ..., as in ``magsplice experiment``."""
        columns: dict[str, Column] = {"step": np.arange(1, self.readings + 1)}
        for names, rows in self.__dict__["_quantities"].values():
            columns |= split(tuple(names), rows)
        return columns


def bend_of(
    radius_mm: float | None, along: str, heights_mm: ArrayLike | None
) -> tuple[int, float] | Floats | None:
    """Shape of a bent film; None for a flat one."""
    axis = ("x", "y").index(one_of("bend_along", along, ("x", "y")))
    if radius_mm is not None and heights_mm is not None:
        raise ValueError("bend_radius_mm and heights_mm are both given; give one of them")
    if heights_mm is not None:
        return flattened(heights_mm)[0]
    return None if radius_mm is None else (axis, float(radius_mm))
