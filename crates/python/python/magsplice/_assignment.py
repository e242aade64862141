"""Measured tiles, and their orientations at the places of a film."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from magsplice._layout import Vector
from magsplice._results import Result, key

#: Largest number of starts.
MOST_STARTS = 10_000


class MeasuredTile(NamedTuple):
    """A cut and measured tile.

    Attributes
    ----------
    tile : str
        The name.
    polarization_t : sequence of 3 floats or float
        J along the sides of its part, in tesla, or only its magnitude.
    part : int or str, optional
        Number of its part, from 1, as listed by ``magsplice tiles``, or the name of a tile or of a
        kind of this part alone. Not needed if the film has one part, or if the sides identify it.
    size_mm : sequence of 3 floats, optional
        Sides in the order of the part's sides, in millimetres. Default: as ordered.
    """

    tile: str
    polarization_t: Sequence[float] | float
    part: int | str | None = None
    size_mm: Sequence[float] | None = None


class PlacedTile(NamedTuple):
    """A tile with its actual or planned orientation at its place.

    Attributes
    ----------
    place : str
        Name of the place, which is the name of the tile in the film.
    tile : str
        Name of the measured tile.
    up : str
        The upward side of the measured tile, such as ``"+z"``.
    mark_deg : float
        Direction of the mark, in degrees from the x axis of the film towards its y axis. During the
        measurement the mark is drawn along +x of the part, or along +y if x is upright.
    centre_mm : sequence of 3 floats, optional
        Centre, in millimetres. Default: the centre of the place.
    mark : str
        The axis of the measured tile along its mark. It follows from `up`.
    is_placed : bool
        Whether the tile is already placed.
    """

    place: str
    tile: str
    up: str
    mark_deg: float
    centre_mm: Sequence[float] | None = None
    mark: str = ""
    is_placed: bool = False


class Shim(Result):
    """A tile with adjustable strength."""

    place: str = key("Name of the place.")
    strength_t: float = key("Strength in tesla, negative if reversed.")


def _three(values: Sequence[float] | None) -> Vector | None:
    if values is None:
        return None
    x, y, z = (float(value) for value in values)
    return x, y, z


def measured_row(tile: MeasuredTile) -> tuple[str, str | None, Vector | None, list[float]]:
    """Name, part, sides, and J or its magnitude, for the library."""
    j_t = np.atleast_1d(np.asarray(tile.polarization_t, dtype=float)).ravel().tolist()
    part = None if tile.part is None else str(tile.part)
    return tile.tile, part, _three(tile.size_mm), j_t


def placed_row(tile: PlacedTile) -> tuple[str, str, Vector | None, str, float]:
    """Place, tile, centre, upper side and direction of the mark, for the library."""
    return tile.place, tile.tile, _three(tile.centre_mm), tile.up, float(tile.mark_deg)


def measurement_errors(
    strength: float | None, direction_deg: float | None, size_mm: float | None
) -> tuple[float, float, float | None] | None:
    """Standard deviations, checked against their ranges; None if none is given."""
    if (strength, direction_deg, size_mm) == (None, None, None):
        return None
    named = {"strength": (strength, 0.5), "direction": (direction_deg, 45), "size": (size_mm, 10)}
    for (name, (value, most)), unit in zip(named.items(), ("", "_deg", "_mm"), strict=True):
        if value is not None and not 0 <= value <= most:
            raise ValueError(f"{name}_error{unit} = {value}, must be from 0 to {most:g}")
    return strength or 0.0, direction_deg or 0.0, size_mm
