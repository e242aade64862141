"""Points of calls, and the shapes of results at points."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from magsplice._layout import Floats, Grid

#: A tolerance: a fraction of |B|, a text such as ``"10nT"``, or a number of tesla.
Tolerance = float | str | tuple[float]


def tolerance_of(within: float | str | None, within_t: float | None = None) -> Tolerance | None:
    """Tolerance of two arguments; None without one."""
    if within is not None and within_t is not None:
        raise ValueError("within and within_t are both given; give one of them")
    if within_t is not None:
        return (float(within_t),)
    return within if within is None or isinstance(within, str) else float(within)


def flattened(points: ArrayLike | Grid, name: str = "points") -> tuple[Floats, tuple[int, ...]]:
    """Points as contiguous rows, and the leading shape. Contiguous doubles are not copied."""
    points = points.points_mm if isinstance(points, Grid) else points
    try:
        array: NDArray[np.float64] = np.ascontiguousarray(points, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise type(error)(f"{name} must be numbers of the shape (..., 3): {error}") from None
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ValueError(
            f"{name} have the shape {array.shape}, must have (..., 3): x, y, z along the last axis"
        )
    return array.reshape(-1, 3), array.shape[:-1]


def shaped(values: Mapping[str, Any], shape: tuple[int, ...]) -> dict[str, Any]:
    """Values whose arrays of rows get the leading shape of the points."""
    arrays = {name: of for name, of in values.items() if isinstance(of, np.ndarray)}
    return {**values, **{name: of.reshape(shape + of.shape[1:]) for name, of in arrays.items()}}


def coordinates(dims: Iterable[str], axes: Iterable[Floats]) -> dict[str, Any]:
    """Coordinates in millimetres along dimensions, and components of vectors, for xarray."""
    named = zip("xyz", dims, axes, strict=True)
    found: dict[str, Any] = {name: (dim, values, {"units": "mm"}) for name, dim, values in named}
    return {**found, "component": ("component", ["x", "y", "z"])}
