"""Positions and forces from readings of a sensor below a film."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from magsplice._arrow import Column, Table, split
from magsplice._layout import Floats, Vector, three_of
from magsplice._points import flattened
from magsplice._results import key, lines
from magsplice._source import OfFilm

#: Meanings of the numbers in `Readings.status`.
STATUS = (
    "in the volume",
    "outside the volume",
    "ambiguous",
    "not found",
    "saturated",
    "incomplete",
    "contradicting",
)

#: Names of the columns of arrays.
_COLUMNS = {
    "displacement_mm": ("dx_mm", "dy_mm", "dz_mm"),
    "deviation_mm": ("deviation_x_mm", "deviation_y_mm", "deviation_z_mm"),
    "force_n": ("fx_n", "fy_n", "fz_n"),
    "closed_form_mm": ("closed_form_dx_mm", "closed_form_dy_mm", "closed_form_dz_mm"),
    "stray_t": ("stray_x_t", "stray_y_t", "stray_z_t"),
    "stray_deviation_t": ("stray_deviation_x_t", "stray_deviation_y_t", "stray_deviation_z_t"),
    "rotation_deg": ("rotation_x_deg", "rotation_y_deg", "rotation_z_deg"),
    "rotation_deviation_deg": (
        "rotation_deviation_x_deg",
        "rotation_deviation_y_deg",
        "rotation_deviation_z_deg",
    ),
}


#: Number of readings whose arrays are printed.
_MOST_ROWS = 3


class Readings(OfFilm, Table):
    """Results from readings of a sensor. NaN where a reading has no value."""

    readings: int = key("Number of readings.")
    displacement_mm: Floats = key(
        """Displacement of the sensor from the reference point, or from its position at rest, in
        millimetres, shape (..., 3). The film moves in the opposite direction."""
    )
    deviation_mm: Floats | None = key("Standard deviations, shape (..., 3). None without noise.")
    force_n: Floats | None = key("Force on the film, shape (..., 3). None without ``[elastomer]``.")
    closed_form_mm: Floats | None = key(
        """Displacement by the closed form of the ideal film (Dai 2024, Eq. 14), in millimetres,
        shape (..., 3). None without an ideal film."""
    )
    status: NDArray[np.uint8] = key(
        """0: in the volume; 1: outside; 2: two positions have the reading; 3: none has; 4:
        saturated; 5: a component is missing; 6: the sensors of a head contradict each other beyond
        the noise, as 1 of 1000 does by chance; shape (...)."""
    )
    stray_t: Floats | None = key(
        "Stray field along the axes of the board, shape (..., 3). None unless it is fitted."
    )
    stray_deviation_t: Floats | None = key("Standard deviations, shape (..., 3).")
    rotation_deg: Floats | None = key(
        "Rotation vector of the board against the film, shape (..., 3). None unless it is fitted."
    )
    rotation_deviation_deg: Floats | None = key("Standard deviations, shape (..., 3).")
    chi_squared_over_freedom: Floats | None = key(
        """Squares of the residuals over the noise, over their expectation, shape (...). None unless
        more readings are there than numbers."""
    )
    messages: list[str] = key(
        "The reason why a reading has no position in the volume; an empty text where it has one."
    )

    def columns(self) -> dict[str, Column]:
        """Columns dx_mm, dy_mm, dz_mm, then columns of the other arrays, and status."""
        columns: dict[str, Column] = {}
        for name, components in _COLUMNS.items():
            array = getattr(self, name)
            if array is not None:
                columns |= split(components, array)
        if self.chi_squared_over_freedom is not None:
            columns["chi_squared_over_freedom"] = self.chi_squared_over_freedom.ravel()
        return {**columns, "status": self.status.ravel()}

    def _shown(self) -> Iterator[tuple[str, Any]]:
        counts = np.bincount(self.status.ravel(), minlength=len(STATUS))
        yield from super()._shown()
        for name in _COLUMNS:
            array = getattr(self, name)
            rows = () if array is None else array.reshape(-1, 3)[:_MOST_ROWS]
            for index, row in enumerate(rows):
                yield from lines({f"[{index}]": row.tolist()}, name)
            if array is not None and array.size > 3 * _MOST_ROWS:
                yield name, f"{array.size // 3 - _MOST_ROWS} more"
        yield from ((text, count) for text, count in zip(STATUS, counts, strict=True) if count)


#: Numbers that are fitted to the readings of all sensors of a head.
HeadFit = Literal["position", "stray-field", "pose"]


def at_rest(name: str, readings_t: ArrayLike) -> Floats:
    """Readings of a sensor at rest, at least one, of finite numbers."""
    flat, _ = flattened(readings_t, name)
    if not len(flat):
        raise ValueError(f"{name} has no readings, must have at least one")
    if not np.isfinite(flat).all():
        raise ValueError(f"{name} has readings that are not finite numbers")
    return flat


def constant_or_rest(
    constant_t: Sequence[float], zero: ArrayLike | None, rest: ArrayLike | None
) -> tuple[Vector, Floats | None, Floats | None]:
    """Constant part of readings, and readings at rest. ValueError for more than one of them."""
    x, y, z = (float(value) for value in constant_t)
    if not np.isfinite((x, y, z)).all():
        raise ValueError(f"constant_t = {constant_t}, must be finite numbers")
    if sum([any((x, y, z)), zero is not None, rest is not None]) > 1:
        raise ValueError("more than one of constant_t, zero and rest is given; give one")
    zero_t = None if zero is None else at_rest("zero", zero)
    return (x, y, z), zero_t, None if rest is None else at_rest("rest", rest)


def noise_of(noise_t: float | Sequence[float] | None) -> Vector | None:
    """Standard deviations along x, y, z in tesla. ValueError unless each is above 0, up to 1 T."""
    found = three_of(noise_t)
    if found is not None and not (np.isfinite(found).all() and min(found) > 0):
        raise ValueError(f"noise_t = {noise_t}, must be above 0 and finite")
    if found is not None and max(found) > 1:
        raise ValueError(
            f"noise_t = {noise_t}, must be at most 1 (tesla, not uT: {max(found) / 1e6:g}?)"
        )
    return found
