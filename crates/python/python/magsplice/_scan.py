"""Scans of the field of a film: measured scans, fitted, and computed scans of films as made."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from magsplice._arguments import one_of
from magsplice._arrow import Column, Table, split
from magsplice._layout import Floats, Vector
from magsplice._magsplice import Film
from magsplice._points import shaped
from magsplice._results import PerParameter, Result, key
from magsplice._source import OfFilm

Unknown = Literal["strength", "offset", "rotation", "start"]

#: Parameters of a scan that can be fitted.
UNKNOWNS: tuple[Unknown, ...] = ("strength", "offset", "rotation", "start")


class FittedScan(Result):
    """Parameters of a scan."""

    strength: float = key("Strength of all tiles, relative to the layout.")
    offset_t: Vector = key("Constant reading, in tesla.")
    rotation_deg: Vector = key("Rotation vector of the sensor, in degrees.")
    start_mm: Vector = key("Position of the sensor at the origin of the scan, in millimetres.")


class Plateau(Result):
    """Outliers that share the extreme of a component, as readings of a sensor at its limit do."""

    axis: str = key("Component: x, y or z.")
    reading_t: float = key("Its largest or smallest reading, in tesla.")
    outliers: int = key("Number of outliers with this reading.")


class ExcludedReadings(Result):
    """Indices of the readings that a fit does not use, with leading axes flattened."""

    incomplete: NDArray[np.intp] = key("Readings with a missing component, NaN.")
    saturated: NDArray[np.intp] = key("Readings at the limit of the sensor's range.")
    outliers: NDArray[np.intp] = key("Readings that contradict the fit of the others.")
    plateau: Plateau | None = key("Outliers that share an extreme.", Plateau)

    def __init__(self, numbers: Mapping[str, Any]) -> None:
        indices = {name: of for name, of in numbers.items() if name != "plateau"}
        super().__init__(numbers, **{name: np.array(of, np.intp) for name, of in indices.items()})


class SensorPlacement(Result):
    """Axes and place of a sensor whose readings the film as ordered explains."""

    sensor_axes: list[str] = key(
        "Component of the field that the sensor reads as x, y, z, such as ``-y`` for a reversed y."
    )
    stage_axes: list[str] = key("The same for the positions.")
    fitted: FittedScan = key("Fitted parameters of the scan.", FittedScan)
    residual_t: float = key("Standard deviation of the residuals of one component, in tesla.")


class ScanUniformity(Result):
    """Uniformity RMSE of R_x, R_y, S_z of a scan; None where positions form no planes."""

    readings: PerParameter[float | None] = key("Of the readings.")
    corrected: PerParameter[float | None] = key("Of the readings without offset and rotation.")
    simulated: PerParameter[float | None] = key("Of the field of the layout at the same places.")
    omitted: PerParameter[Any] = key("The reasons for undefined uniformities.")
    singular: int = key("Number of readings without parameters, because B_z is 0.")


class Scan(OfFilm, Table):
    """A fitted scan. A table of its readings in the frame of the film."""

    readings: int = key("Number of readings.")
    grid: tuple[int, int, int] | None = key(
        "Counts of positions along x, y, z. None if they are no grid."
    )
    missing_mm: list[Vector] = key("Positions of the grid without a reading.")
    repeated: list[int] = key("Indices of readings at the position of an earlier one.")
    fitted: FittedScan = key("Fitted parameters.", FittedScan)
    deviation: FittedScan = key(
        "Standard deviations of the fitted parameters; 0 for parameters that are not fitted.",
        FittedScan,
    )
    sensor_axes: list[str] = key(
        "Component of the field that the sensor reads as x, y, z, such as ``-y`` for a reversed y."
    )
    stage_axes: list[str] = key("The same for the positions.")
    residual_t: float = key(
        "Standard deviation of the residuals of one component, without excluded readings, in tesla."
    )
    excluded: ExcludedReadings = key("Readings that the fit does not use.", ExcludedReadings)
    uniformity_rmse: ScanUniformity | None = key(
        "Uniformity RMSE of the scan. None without an ideal film.", ScanUniformity
    )
    places_mm: Floats = key(
        "Positions of the sensor in the frame of the film, in millimetres, shape (..., 3)."
    )
    b_t: Floats = key(
        "Readings without offset and rotation of the sensor, in tesla, shape (..., 3)."
    )
    simulated_b_t: Floats = key(
        "Field of the layout there, times the fitted strength, in tesla, shape (..., 3)."
    )
    residual_b_t: Floats = key("Difference of the two, in tesla, shape (..., 3).")

    def __init__(
        self,
        numbers: Mapping[str, Any],
        places: Mapping[str, Floats],
        quantities: Mapping[str, tuple[list[str], Floats]],
        shape: tuple[int, ...],
    ) -> None:
        arrays = {name: rows for name, (_, rows) in quantities.items() if name != "excluded"}
        super().__init__(numbers, **shaped({**places, **arrays}, shape))
        self.__dict__["_quantities"] = quantities

    def columns(self) -> dict[str, Column]:
        """Columns x_mm, ..., bx_t, ..., as in the table of ``magsplice scan --save``."""
        columns = dict(split(("x_mm", "y_mm", "z_mm"), self.places_mm))
        for names, rows in self.__dict__["_quantities"].values():
            columns |= split(tuple(names), rows)
        return columns


class SampledScan(OfFilm, Table):
    """A film as made, and the readings of its sensor. A table of the readings."""

    seed: int = key("Seed of the random numbers.")
    sample: int = key("Number of the sample.")
    readings: int = key("Number of readings.")
    saturated: int = key("Number of readings at the limit of the sensor's range.")
    scan: FittedScan = key("Parameters that `Film.scan` of `film` should find.", FittedScan)
    film: Film = key("The film as made.")
    points_mm: Floats = key("Positions of the readings in millimetres, shape (..., 3).")
    readings_t: Floats = key("Readings of the sensor in tesla, shape (..., 3).")

    def columns(self) -> dict[str, Column]:
        """Columns x_mm, y_mm, z_mm, bx_t, by_t, bz_t, which ``magsplice scan`` reads."""
        points = split(("x_mm", "y_mm", "z_mm"), self.points_mm)
        return {**points, **split(("bx_t", "by_t", "bz_t"), self.readings_t)}


def fitted_words(fit: Collection[Unknown] | Literal["all"]) -> list[str]:
    """Parameters to fit. ValueError for other words."""
    if isinstance(fit, str) and fit == "all":
        return list(UNKNOWNS)
    if isinstance(fit, str) or not isinstance(fit, Collection):
        shown = ", ".join(f'"{word}"' for word in UNKNOWNS)
        raise ValueError(f'fit = {fit!r}, must be "all" or a list of {shown}')
    return [one_of("fit", word, UNKNOWNS) for word in fit]


def check_scan(points: Floats, readings: Floats) -> None:
    """ValueError unless there is a finite position for each reading."""
    if len(points) != len(readings):
        raise ValueError(f"{len(readings)} readings for {len(points)} points, must be as many")
    if not np.isfinite(points).all():
        first = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
        raise ValueError(f"points_mm[{first}] is not finite; readings may be NaN, positions not")
