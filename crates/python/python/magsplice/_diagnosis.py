"""Which tiles of a film that was made are faulty, from a scan of its field."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from magsplice import _magsplice
from magsplice._arrow import Column, Table, split
from magsplice._field import flattened
from magsplice._layout import Floats, Vector, three_of
from magsplice._layout_film import LayoutFilm
from magsplice._numbers import Numbers
from magsplice._samples import Preset

Kind = Literal["strength", "turn", "direction", "displacement"]
Unknown = Literal["strength", "offset", "rotation", "start"]

#: What may be fitted of a scan, in the order of the library.
_UNKNOWNS = ("strength", "offset", "rotation", "start")


class FaultyTile(NamedTuple):
    """An error of a tile that neither noise nor ordinary errors explain.

    Attributes
    ----------
    tile : str
        Name of the tile.
    kind : {"strength", "turn", "direction", "displacement"}
        What is wrong: the magnitude of J, the tile with its J, J within the tile, or its position.
    magnitude : float
        Relative change of the strength, or the length of the vector of all components that are more
        than noise, in degrees or millimetres.
    components : tuple of float
        The change of strength; turns about x, y, z in degrees; turns of J in the plane of the film
        and out of it in degrees; or displacements along x, y, z in millimetres.
    deviations : tuple of float
        Standard deviations of the components.
    chi_squared : float
        Rise of chi squared without this error.
    ln_probability : float
        Natural logarithm of the probability that chance gives as much for one error.
    alternatives : list[tuple[str, str]]
        Tiles and kinds that explain the readings nearly as well in its place, the best first.
    """

    tile: str
    kind: Kind
    magnitude: float
    components: tuple[float, ...]
    deviations: tuple[float, ...]
    chi_squared: float
    ln_probability: float
    alternatives: list[tuple[str, Kind]]


@dataclass(frozen=True, eq=False, repr=False)
class Diagnosis(Numbers, Table):
    """What a scan tells of the tiles of a film. A table of their errors, one row for each tile.

    Attributes
    ----------
    faulty : list[FaultyTile]
        Errors that are named, the surest first.
    is_complete : bool
        Whether all significant errors are named.
    is_residual_too_large : bool
        Whether noise and errors of tiles do not explain the residual.
    residual_t : float
        Root mean square of the residual of a component, in tesla.
    chi_squared : float
        Sum of the squares of residuals over those of the noise, and of ordinary errors over their
        deviations.
    degrees_of_freedom : int
        Expectation of `chi_squared`.
    scan_strength : float
        Strength of all tiles over that of the layout.
    scan_offset_t : (float, float, float)
        Constant reading, in tesla.
    scan_rotation_deg : (float, float, float)
        Rotation vector of the sensor, in degrees.
    scan_start_mm : (float, float, float)
        Position of the sensor at the origin of the scan, in millimetres.
    names : list[str]
        Names of the tiles.
    position_mm, rotation_deg, size_mm : ndarray
        Errors of the tiles in the film that explains the readings, shape (n, 3).
    strength : ndarray
        Relative errors of their strength, shape (n,).
    direction_deg : ndarray
        Turns of J in the plane of the film and out of it, in degrees, shape (n, 2).
    """

    faulty: list[FaultyTile]
    is_complete: bool
    is_residual_too_large: bool
    residual_t: float
    chi_squared: float
    degrees_of_freedom: int
    scan_strength: float
    scan_offset_t: Vector
    scan_rotation_deg: Vector
    scan_start_mm: Vector
    names: list[str]
    position_mm: Floats
    rotation_deg: Floats
    size_mm: Floats
    strength: Floats
    direction_deg: Floats

    def to_dict(self) -> dict[str, Any]:
        """Faulty tiles by name, then the numbers of the scan; for JSON."""
        return {
            **{f"{found.tile} {found.kind}": found.magnitude for found in self.faulty},
            "is_complete": self.is_complete,
            "residual_t": self.residual_t,
            "is_residual_too_large": self.is_residual_too_large,
            "chi_squared": self.chi_squared,
            "degrees_of_freedom": self.degrees_of_freedom,
        }

    def columns(self) -> dict[str, Column]:
        """Columns name, dx_mm, rotation_x_deg, size_x_mm, strength, in_plane_deg, ..."""
        return {
            "name": self.names,
            **split(("dx_mm", "dy_mm", "dz_mm"), self.position_mm),
            **split(("rotation_x_deg", "rotation_y_deg", "rotation_z_deg"), self.rotation_deg),
            **split(("size_x_mm", "size_y_mm", "size_z_mm"), self.size_mm),
            "strength": self.strength,
            **split(("in_plane_deg", "out_of_plane_deg"), self.direction_deg),
        }


class DiagnosedFilm(LayoutFilm):
    """A film whose faulty tiles are found."""

    def diagnose(
        self,
        points_mm: ArrayLike,
        readings_t: ArrayLike,
        *,
        noise_t: float | Sequence[float] | None = None,
        preset: Preset | None = None,
        as_ordered: bool = False,
        fit: Collection[Unknown] = (),
        false_alarm: float = 0.01,
    ) -> Diagnosis:
        """Tiles that are weak, turned or displaced, from a scan of the field near the film.

        An error is named if neither the noise nor the ordinary errors of tiles explain it, as
        ``magsplice diagnose`` does. What recoil adds to the field is that of the film as ordered.

        Parameters
        ----------
        points_mm : array_like of shape (..., 3)
            Positions of the scan in the frame of the film, in millimetres.
        readings_t : array_like of shape (..., 3)
            Readings of the sensor of ``[sensor]`` there, in tesla; without this table B.
        noise_t : float or sequence of 3 floats, optional
            Standard deviation of a reading along each axis, in tesla. Default: that of
            ``[sensor]``.
        preset : {"by-hand", "workshop", "jig"}, optional
            Ordinary errors of every tile instead of those of ``[tolerance]``.
        as_ordered : bool
            Whether tiles that are not named count as exactly as ordered, whatever ``[tolerance]``
            states.
        fit : collection of {"strength", "offset", "rotation", "start"}
            What is not known of the scan and fitted: the strength of all tiles, a constant reading,
            the rotation of the sensor, its position at the origin of the scan.
        false_alarm : float
            Probability that a tile of a film without faulty tiles is named.

        Raises
        ------
        ValueError
            If there are not as many readings as points, `fit` has another word, or `preset` and
            `as_ordered` are both given.
        MagspliceError
            If the noise is not known, or the scan cannot be diagnosed.
        """
        points, _ = flattened(points_mm)
        readings, _ = flattened(readings_t)
        if len(points) != len(readings):
            raise ValueError(f"{len(readings)} readings for {len(points)} points, must be as many")
        unknown = [word for word in fit if word not in _UNKNOWNS]
        if isinstance(fit, str) or unknown:
            raise ValueError(f"fit = {fit!r}, must be a list of words of {', '.join(_UNKNOWNS)}")
        if preset is not None and as_ordered:
            raise ValueError("preset and as_ordered are both given: give one of them")
        free = [word in fit for word in _UNKNOWNS]
        found = _magsplice.diagnose(
            self._core, points, readings, three_of(noise_t), preset, as_ordered, free, false_alarm
        )
        scan, errors = found["scan"], found["errors"]
        return Diagnosis(
            faulty=[_faulty(tile) for tile in found["faulty"]],
            is_complete=found["is_complete"],
            is_residual_too_large=found["is_residual_too_large"],
            residual_t=found["residual_t"],
            chi_squared=found["chi_squared"],
            degrees_of_freedom=found["degrees_of_freedom"],
            scan_strength=scan["strength"],
            scan_offset_t=scan["offset_t"],
            scan_rotation_deg=scan["rotation_deg"],
            scan_start_mm=scan["start_mm"],
            names=self.tiles.names,
            position_mm=errors[:, :3],
            rotation_deg=np.degrees(errors[:, 3:6]),
            size_mm=errors[:, 6:9],
            strength=np.ascontiguousarray(errors[:, 9]),
            direction_deg=np.degrees(errors[:, 10:]),
        )


def _faulty(tile: dict[str, Any]) -> FaultyTile:
    # The library states strengths in per cent.
    scale = 0.01 if tile["kind"] == "strength" else 1.0
    values, deviations = zip(*tile["components"].values(), strict=True)
    return FaultyTile(
        tile["tile"],
        tile["kind"],
        scale * tile["magnitude"],
        tuple(scale * value for value in values),
        tuple(scale * deviation for deviation in deviations),
        tile["chi_squared"],
        tile["ln_probability"],
        [(other["tile"], other["kind"]) for other in tile["alternatives"]],
    )
