"""Which measured tile goes to which place of a film, and which way round."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from magsplice import _magsplice
from magsplice._arguments import whole
from magsplice._arrow import Column, Table, split
from magsplice._layout import Vector
from magsplice._layout_film import LayoutFilm
from magsplice._numbers import Numbers
from magsplice._samples import Statistics

#: Largest number of starts.
_MOST_STARTS = 10_000

#: Errors of measurements beyond which nothing was measured: of the strength, in degrees, in mm.
_MOST_STRENGTH, _MOST_DIRECTION_DEG, _MOST_SIZE_MM = 0.5, 45.0, 10.0


#: Keys of a row of the plan, in the order of `PlacedTile`.
_PLACED = ("place", "tile", "up", "mark_deg", "centre_mm")


class MeasuredTile(NamedTuple):
    """A tile that was cut and measured.

    Attributes
    ----------
    tile : str
        Its name.
    polarization_t : sequence of 3 floats or float
        J along the sides of its part, in tesla, or only its magnitude.
    part : int or str, optional
        Number of its part, from 1, as ``magsplice tiles`` lists the parts, or the name of a tile or
        of a kind of this part alone. Not needed if the film has one part, or if the sides tell it.
    size_mm : sequence of 3 floats, optional
        Its sides in the order of those of the part, in millimetres. Default: as ordered.
    """

    tile: str
    polarization_t: Sequence[float] | float
    part: int | str | None = None
    size_mm: Sequence[float] | None = None


class PlacedTile(NamedTuple):
    """A tile and how it lies, or will lie, at its place.

    Attributes
    ----------
    place : str
        Name of the place: of the tile of the film.
    tile : str
        Name of the measured tile.
    up : str
        The side of the measured tile that is up, such as ``"+z"``.
    mark_deg : float
        Where its mark points, from the x axis of the film towards its y axis, in degrees. The mark
        is drawn along +x of the part when the tile is measured; along +y if x is upright.
    position_mm : sequence of 3 floats, optional
        Centre, in millimetres. Default: that of the place.
    """

    place: str
    tile: str
    up: str
    mark_deg: float
    position_mm: Sequence[float] | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Assignment(Numbers, Table):
    """A film with the tile of each place. A table of the plan, one row for each place.

    Attributes
    ----------
    film : Film
        The film with its measured tiles. Its ``[tolerance]`` has the errors of laying, and those of
        the measurements.
    plan : list[PlacedTile]
        The tile of each place, in the order of the places. The tile of a shim is ``"shim"``.
    marks : list[str]
        The axis of each tile that its mark shows.
    laid : list[bool]
        Whether each tile lies already.
    rms_mm : float
        RMS displacement error over the working volume and its three axes, in millimetres.
    in_order_rms_mm : float
        The same of the tiles in the order in which they were given.
    ordered_rms_mm : float
        The same of the film as ordered.
    starts_rms_mm : list[float]
        The same, by the linear model, at which each search ended, least first.
    measured_rms_mm : Statistics or None
        The distribution of the RMS with the errors of the measurements, if they are given.
    spares : int
        Number of the tiles that are left.
    shims : dict[str, float]
        Strength of the tile at each shim in tesla, negative if it is reversed.
    """

    film: LayoutFilm
    plan: list[PlacedTile]
    marks: list[str]
    laid: list[bool]
    rms_mm: float
    in_order_rms_mm: float
    ordered_rms_mm: float
    starts_rms_mm: list[float]
    measured_rms_mm: Statistics | None
    spares: int
    shims: dict[str, float]

    def to_dict(self) -> dict[str, Any]:
        """RMS errors, spares and shims by name; for JSON."""
        return {
            "rms_mm": self.rms_mm,
            "in_order_rms_mm": self.in_order_rms_mm,
            "ordered_rms_mm": self.ordered_rms_mm,
            "spares": self.spares,
            **{f"{place} strength_t": strength for place, strength in self.shims.items()},
        }

    def columns(self) -> dict[str, Column]:
        """Columns place, tile, x_mm, y_mm, z_mm, up, mark, mark_deg, laid, as in a plan file."""
        centres = np.array([placed.position_mm for placed in self.plan], dtype=float).reshape(-1, 3)
        return {
            "place": [placed.place for placed in self.plan],
            "tile": [placed.tile for placed in self.plan],
            **split(("x_mm", "y_mm", "z_mm"), centres),
            "up": [placed.up for placed in self.plan],
            "mark": self.marks,
            "mark_deg": np.array([placed.mark_deg for placed in self.plan]),
            "laid": ["yes" if laid else "no" for laid in self.laid],
        }


class AssignedFilm(LayoutFilm):
    """A film whose places take measured tiles."""

    def assign(
        self,
        measured: Iterable[MeasuredTile],
        *,
        placed: Iterable[PlacedTile] = (),
        shims: Iterable[str] = (),
        may_turn_over: bool = True,
        starts: int = 16,
        seed: int = 1,
        strength_error: float | None = None,
        direction_error_deg: float | None = None,
        size_error_mm: float | None = None,
    ) -> Assignment:
        """The measured tiles at the places where the displacement error of the film is least.

        As ``magsplice assign`` does: local searches from many starts, by the exact derivatives and
        then the exact field. What recoil adds to the field is that of the film as ordered.

        Parameters
        ----------
        measured : iterable of MeasuredTile
            The tiles in the box, spares included.
        placed : iterable of PlacedTile
            Tiles of the box that lie already. They stay, and the others make up for them.
        shims : iterable of str
            Places of tiles whose strength is chosen.
        may_turn_over : bool
            Whether the side that was up when a tile was measured may be down.
        starts : int
            Number of random starts, from 1 to 10 000.
        seed : int
            Seed of the random numbers.
        strength_error, direction_error_deg, size_error_mm : float, optional
            Standard deviations of the errors of the measurements: of the strength as a fraction up
            to 0.5, of the direction of J about each axis normal to it up to 45 degrees, and of each
            side up to 10 mm. With any of them `Assignment.measured_rms_mm` is known.

        Raises
        ------
        ValueError
            If `starts` or an error is out of range.
        MagspliceError
            If the layout has no ideal film or no working volume, a tile breaks a rule, or the
            tiles cannot be assigned. All tiles that break rules are named.

        Examples
        --------
        >>> import magsplice
        >>> squares = [(x, y, 0.5) for x in (-2.5, 2.5) for y in (-2.5, 2.5)]
        >>> film = magsplice.Film(
        ...     [magsplice.Tile(at, (3, 3, 1), (0, 0, 0.12)) for at in squares],
        ...     name="four squares",
        ...     ideal={"wavelength_mm": 10, "thickness_mm": 1, "amplitude_t": 0.12},
        ...     volume={"x_mm": [-1, 1], "y_mm": [-1, 1], "z_mm": [-4, -3], "step_mm": 0.5},
        ... )
        >>> strengths_t = [0.121, 0.118, 0.12, 0.119, 0.122]
        >>> tiles = [magsplice.MeasuredTile(f"cut-{n}", t) for n, t in enumerate(strengths_t)]
        >>> found = film.assign(tiles)
        >>> found.spares, found.rms_mm <= found.in_order_rms_mm
        (1, True)
        """
        starts, seed = whole("starts", starts, 1, _MOST_STARTS), whole("seed", seed, 0)
        errors = (
            _within("strength_error", strength_error, _MOST_STRENGTH),
            math.radians(_within("direction_error_deg", direction_error_deg, _MOST_DIRECTION_DEG)),
            None
            if size_error_mm is None
            else _within("size_error_mm", size_error_mm, _MOST_SIZE_MM),
        )
        known = (strength_error, direction_error_deg, size_error_mm) != (None, None, None)
        numbers = _magsplice.assign(
            self._core,
            [_measured(MeasuredTile(*tile)) for tile in measured],
            [_placed(PlacedTile(*tile)) for tile in placed],
            list(shims),
            may_turn_over,
            starts,
            seed,
            errors if known else None,
        )
        plan, statistics = numbers["plan"], numbers.get("measured_rms_mm")
        return Assignment(
            film=self._parsed(numbers["text"], "the assigned film", self._folder),
            plan=[PlacedTile(*(row[key] for key in _PLACED)) for row in plan],
            marks=[row["mark"] for row in plan],
            laid=[row["is_laid"] for row in plan],
            rms_mm=numbers["rms_mm"],
            in_order_rms_mm=numbers["in_order_rms_mm"],
            ordered_rms_mm=numbers["ordered_rms_mm"],
            starts_rms_mm=numbers["starts_rms_mm"],
            measured_rms_mm=None if statistics is None else Statistics._of(statistics),
            spares=numbers["spares"],
            shims={shim["place"]: shim["strength_t"] for shim in numbers["shims"]},
        )


def _within(name: str, value: float | None, most: float) -> float:
    """A standard deviation in its range; 0 by default."""
    if value is None:
        return 0.0
    if not 0 <= value <= most:
        raise ValueError(f"{name} = {value}, must be from 0 to {most:g}")
    return float(value)


def _three(values: Sequence[float] | None) -> Vector | None:
    if values is None:
        return None
    x, y, z = (float(value) for value in values)
    return x, y, z


def _measured(tile: MeasuredTile) -> tuple[str, str | None, Vector | None, list[float]]:
    j_t = np.atleast_1d(np.asarray(tile.polarization_t, dtype=float)).ravel().tolist()
    part = None if tile.part is None else str(tile.part)
    return tile.tile, part, _three(tile.size_mm), j_t


def _placed(tile: PlacedTile) -> tuple[str, str, Vector | None, str, float]:
    return tile.place, tile.tile, _three(tile.position_mm), tile.up, float(tile.mark_deg)
