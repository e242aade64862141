"""Positions and forces from readings of a sensor below a film."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from magsplice import _magsplice
from magsplice._arrow import Column, Table, split
from magsplice._field import FieldFilm, flattened
from magsplice._layout import Floats, Grid, Vector, three_of

#: What the numbers in `Readings.status` mean.
STATUS = ("in the volume", "outside the volume", "ambiguous", "not found", "saturated")


@dataclass(frozen=True, eq=False, repr=False)
class Readings(Table):
    """What was found from readings of a sensor. NaN where a reading has no value.

    Attributes
    ----------
    displacement_mm : ndarray
        Displacement of the sensor from the reference point, or from where it was at rest, in
        millimetres, shape (..., 3). The film moves by the opposite.
    deviation_mm : ndarray | None
        Standard deviations of it, in millimetres, shape (..., 3). None without noise.
    force_n : ndarray | None
        Force on the film, in newton, shape (..., 3). None without ``[elastomer]``.
    closed_form_mm : ndarray | None
        Displacement by the closed form of the ideal film (Dai 2024, Eq. 14), in millimetres,
        shape (..., 3). None without an ideal film.
    status : ndarray of uint8
        0: in the volume; 1: outside; 2: two positions have the reading; 3: none has; 4:
        saturated; shape (...).
    messages : list[str]
        Why a reading has no position in the volume; an empty text where it has one.
    """

    displacement_mm: Floats
    deviation_mm: Floats | None
    force_n: Floats | None
    closed_form_mm: Floats | None
    status: NDArray[np.uint8]
    messages: list[str]

    def columns(self) -> dict[str, Column]:
        """Columns dx_mm, dy_mm, dz_mm, then those of the other arrays, and status."""
        columns = split(("dx_mm", "dy_mm", "dz_mm"), self.displacement_mm)
        others = (
            (("deviation_x_mm", "deviation_y_mm", "deviation_z_mm"), self.deviation_mm),
            (("fx_n", "fy_n", "fz_n"), self.force_n),
            (
                ("closed_form_dx_mm", "closed_form_dy_mm", "closed_form_dz_mm"),
                self.closed_form_mm,
            ),
        )
        for names, array in others:
            if array is not None:
                columns |= split(names, array)
        return {**columns, "status": self.status.ravel()}

    def __repr__(self) -> str:
        counts = np.bincount(self.status.ravel(), minlength=len(STATUS))
        told = ", ".join(
            f"{count} {text}" for count, text in zip(counts, STATUS, strict=True) if count
        )
        return f"<magsplice.Readings: {told or 'none'}>"


class SensedFilm(FieldFilm):
    """A film with the positions of a sensor below it."""

    def read(
        self,
        readings_t: ArrayLike,
        *,
        noise_t: float | Sequence[float] | None = None,
        constant_t: Sequence[float] = (0.0, 0.0, 0.0),
        zero: ArrayLike | None = None,
        rest: ArrayLike | None = None,
    ) -> Readings:
        """Displacements, and forces, from what a Hall sensor reads below the film.

        Positions are found by the exact field and its gradient. Errors of the positions are those
        of the field, 2e-14 of the sum over tiles, over its gradient.

        Parameters
        ----------
        readings_t : array_like of shape (..., 3)
            Readings in tesla, as the sensor of ``[sensor]`` gives them; without this table it is a
            point that reads B.
        noise_t : float or sequence of 3 floats, optional
            Standard deviation of a reading along each axis, in tesla. Default: that of
            ``[sensor]``.
        constant_t : sequence of 3 floats
            What every reading contains besides the film's field, in tesla, such as a stray field.
        zero : array_like of shape (..., 3), optional
            Readings of the sensor at rest at the reference point, in tesla. What their mean has
            beyond the field there is subtracted from all readings. Excludes `constant_t`.
        rest : array_like of shape (..., 3), optional
            Readings of the sensor at rest, in tesla, in no field but that of the film.
            Displacements count from its position. Excludes `constant_t` and `zero`.

        Returns
        -------
        Readings
            Displacements from the reference point, with standard deviations if there is noise, and
            forces if the layout has an ``[elastomer]``.

        Raises
        ------
        MagspliceError
            If the layout has no working volume, the sensor cannot read the field, or the mean of
            `rest` has no position.
        ValueError
            If more than one of `constant_t`, `zero` and `rest` is given, one has no readings or
            none that are finite numbers, or a noise is not above 0.
        """
        flat, shape = flattened(readings_t)
        x, y, z = (float(value) for value in constant_t)
        if not np.isfinite((x, y, z)).all():
            raise ValueError(f"constant_t = {constant_t}, must be finite numbers")
        given = [any((x, y, z)), zero is not None, rest is not None]
        if sum(given) > 1:
            raise ValueError("more than one of constant_t, zero and rest is given: give one")
        numbers = _magsplice.read(
            self._core,
            flat,
            _noise_of(noise_t),
            (x, y, z),
            None if zero is None else _at_rest("zero", zero),
            None if rest is None else _at_rest("rest", rest),
        )

        def shaped(array: Floats | None) -> Floats | None:
            return None if array is None else array.reshape(*shape, 3)

        return Readings(
            displacement_mm=numbers["displacement_mm"].reshape(*shape, 3),
            deviation_mm=shaped(numbers["deviation_mm"]),
            force_n=shaped(numbers["force_n"]),
            closed_form_mm=shaped(numbers["closed_form_mm"]),
            status=numbers["status"].reshape(shape),
            messages=numbers["messages"],
        )

    def resolution(
        self,
        points: ArrayLike | Grid | None = None,
        *,
        noise_t: float | Sequence[float] | None = None,
    ) -> Floats:
        """Standard deviations of the position that one reading gives, in millimetres.

        The shape is (..., 3). No unbiased estimate from one reading has smaller ones (the bound of
        Cramér and Rao).

        Parameters
        ----------
        points : array_like of shape (..., 3), or Grid, optional
            Points in millimetres. Default: the grid of the working volume.
        noise_t : float or sequence of 3 floats, optional
            Standard deviation of a reading along each axis, in tesla. Default: that of
            ``[sensor]``.

        Raises
        ------
        ValueError
            If neither `noise_t` nor the layout states a noise, or a noise is not above 0.
        MagspliceError
            If the layout has no working volume, or the sensor cannot read the field.
        """
        points = self._required_grid() if points is None else points
        flat, shape = flattened(points.points_mm if isinstance(points, Grid) else points)
        found = _magsplice.resolution(self._core, flat, _noise_of(noise_t))
        if found is None:
            raise ValueError(
                "noise_t is missing and the layout has no [sensor] with noise: "
                "give noise_t in tesla, such as 5e-6"
            )
        return found.reshape(*shape, 3)


def _at_rest(name: str, readings_t: ArrayLike) -> Floats:
    flat, _ = flattened(readings_t)
    if not len(flat):
        raise ValueError(f"{name} has no readings, must have one at least")
    if not np.isfinite(flat).all():
        raise ValueError(f"{name} has readings that are not finite numbers")
    return flat


def _noise_of(noise_t: float | Sequence[float] | None) -> Vector | None:
    """Standard deviations along x, y, z in tesla. ValueError unless each is above 0."""
    found = three_of(noise_t)
    if found is not None and not (np.isfinite(found).all() and min(found) > 0):
        raise ValueError(f"noise_t = {noise_t}, must be above 0 and finite")
    return found
