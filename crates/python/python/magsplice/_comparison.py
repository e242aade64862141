"""Comparison with the ideal film, and decoupling parameters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from magsplice import _magsplice
from magsplice._arrow import Column, Table, split
from magsplice._datasets import coordinates
from magsplice._field import FieldFilm, flattened, tolerance
from magsplice._layout import Floats, Grid, PerParameter, Vector
from magsplice._numbers import Numbers

if TYPE_CHECKING:
    import xarray


@dataclass(frozen=True, repr=False)
class Comparison(Numbers):
    """The difference of the field of a film from that of the ideal film (Dai 2024, Eq. 2).

    Attributes
    ----------
    points : int
        Number of points.
    component_rmse_t : (float, float, float)
        Root of the mean squared difference of B_x, B_y, B_z, in tesla.
    rmse_t : float
        Root of the mean squared length of the difference, in tesla.
    relative_rmse : float
        `rmse_t` over the root mean square of the ideal B.
    worst_t : float
        Largest length of the difference, in tesla.
    worst_at_mm : (float, float, float)
        First point where it occurs, in millimetres.
    amplitude : float
        Factor that brings the ideal B closest to that of the film.
    scaled_relative_rmse : float | None
        Relative RMSE against the ideal B times `amplitude`; None if that is 0.
    correlation : tuple[float | None, float | None, float | None]
        Pearson's correlation of each component; None where a component does not vary.
    """

    points: int
    component_rmse_t: Vector
    rmse_t: float
    relative_rmse: float
    worst_t: float
    worst_at_mm: Vector
    amplitude: float
    scaled_relative_rmse: float | None
    correlation: tuple[float | None, float | None, float | None]

    def to_dict(self) -> dict[str, Any]:
        """Numbers by name; for JSON."""
        return dict(vars(self))


@dataclass(frozen=True, eq=False, repr=False)
class Decoupling(Numbers, Table):
    """Decoupling parameters and their errors (Dai 2024, Eqs. 13 to 15).

    A table of the points with their B and parameters: ``polars.DataFrame(result)``.

    Attributes
    ----------
    where : Grid | ndarray
        The grid, or the points in millimetres, shape (..., 3).
    field_t : ndarray
        B in tesla, shape (..., 3).
    parameters : ndarray
        R_x, R_y in radians and S_z, shape (..., 3). NaN at singular points.
    at_reference : (float, float, float)
        R_x, R_y, S_z at the reference point.
    reference_mm : (float, float, float)
        Point from which changes count, in millimetres.
    singular_mm : ndarray
        Points with B_z = 0, where no parameters exist, shape (n, 3). They enter no average.
    uniformity_rmse : (float | None, float | None, float | None) | None
        Uniformity RMSE of R_x, R_y, S_z: the standard deviation over the planes normal to the
        own axis of a parameter, averaged over the planes. None where the planes have one point
        each, and for points that are no grid.
    ideal_rmse : (float, float, float)
        RMSE of the parameters' changes from the reference point against those of the ideal
        film.
    displacement_rmse_mm : (float, float, float)
        RMSE of the displacement along x, y, z that the parameters give (Dai 2024, Eq. 14), in
        millimetres: `ideal_rmse` over the wavenumber.
    wavenumber_per_mm : float
        Wavenumber of the ideal film, in radians per millimetre.
    """

    where: Grid | Floats
    field_t: Floats
    parameters: Floats
    at_reference: Vector
    reference_mm: Vector
    singular_mm: Floats
    uniformity_rmse: PerParameter | None
    ideal_rmse: Vector
    displacement_rmse_mm: Vector
    wavenumber_per_mm: float

    @property
    def r_x(self) -> Floats:
        """R_x in radians, shape (...): follows the displacement along x."""
        return self.parameters[..., 0]

    @property
    def r_y(self) -> Floats:
        """R_y in radians, shape (...): follows the displacement along y."""
        return self.parameters[..., 1]

    @property
    def s_z(self) -> Floats:
        """S_z, shape (...): follows the displacement along z."""
        return self.parameters[..., 2]

    @property
    def points_mm(self) -> Floats:
        """Points in millimetres, shape (..., 3)."""
        return self.where.points_mm if isinstance(self.where, Grid) else self.where

    @property
    def displacement_mm(self) -> Floats:
        """Displacement from the reference point by Eq. 14, in millimetres, shape (..., 3)."""
        change = self.parameters - np.array(self.at_reference)
        moved: Floats = change * np.array([-1.0, -1.0, 1.0]) / self.wavenumber_per_mm
        return moved

    def to_dict(self) -> dict[str, Any]:
        """Errors by name; for JSON."""
        return {
            "points": self.parameters.size // 3,
            "singular_points": len(self.singular_mm),
            "uniformity_rmse": self.uniformity_rmse,
            "ideal_rmse": self.ideal_rmse,
            "displacement_rmse_mm": self.displacement_rmse_mm,
        }

    def columns(self) -> dict[str, Column]:
        """Columns x_mm, y_mm, z_mm, bx_t, by_t, bz_t, r_x_rad, r_y_rad, s_z."""
        return {
            **split(("x_mm", "y_mm", "z_mm"), self.points_mm),
            **split(("bx_t", "by_t", "bz_t"), self.field_t),
            **split(("r_x_rad", "r_y_rad", "s_z"), self.parameters),
        }

    def to_xarray(self) -> xarray.Dataset:
        """Variables b, r_x, r_y and s_z with the dimensions x, y, z (and component), or point.

        Raises
        ------
        ImportError
            If xarray is not installed: ``pip install "magsplice[xarray]"``.
        """
        import xarray

        if isinstance(self.where, Grid):
            dims: tuple[str, ...] = ("x", "y", "z")
            coords = coordinates(self.where)
            shape: tuple[int, ...] = self.where.counts
        else:
            dims, shape = ("point",), (self.parameters.size // 3,)
            x, y, z = self.where.reshape(-1, 3).T
            millimetres = {"units": "mm"}
            coords = {
                "x": ("point", x, millimetres),
                "y": ("point", y, millimetres),
                "z": ("point", z, millimetres),
                "component": ("component", ["x", "y", "z"]),
            }
        radians = {"units": "rad"}
        return xarray.Dataset(
            {
                "b": ((*dims, "component"), self.field_t.reshape(*shape, 3), {"units": "T"}),
                "r_x": (dims, self.r_x.reshape(shape), radians),
                "r_y": (dims, self.r_y.reshape(shape), radians),
                "s_z": (dims, self.s_z.reshape(shape), {}),
            },
            coords,
        )


class ComparedFilm(FieldFilm):
    """A film that is compared with the ideal film."""

    def compare(
        self,
        points: ArrayLike | None = None,
        *,
        within: float | None = None,
        within_t: float | None = None,
    ) -> Comparison:
        """Comparison of B with that of the ideal film (Dai 2024, Eq. 2).

        Parameters
        ----------
        points : array_like of shape (..., 3), optional
            Points below the film, in millimetres. Default: the grid of the working volume.
        within, within_t : float, optional
            Tolerance of the field; see `b`.

        Returns
        -------
        Comparison

        Raises
        ------
        MagspliceError
            If the layout has no ideal film, or points are not below the film.
        """
        flat = None if points is None else flattened(points)[0]
        return Comparison(**_magsplice.compare(self._core, flat, tolerance(within, within_t)))

    def decouple(
        self,
        points: ArrayLike | None = None,
        *,
        within: float | None = None,
        within_t: float | None = None,
    ) -> Decoupling:
        """Decoupling parameters R_x, R_y, S_z and their errors (Dai 2024, Eqs. 13 to 15).

        Parameters
        ----------
        points : array_like of shape (..., 3), optional
            Points in millimetres. Default: the grid of the working volume, of which alone there is
            a uniformity RMSE.
        within, within_t : float, optional
            See `b`.

        Returns
        -------
        Decoupling

        Raises
        ------
        MagspliceError
            If the layout has no ideal film or no working volume, or the parameters do not exist.
        """
        where: Grid | Floats
        shape: tuple[int, ...]
        if points is None:
            grid = self._required_grid()
            shape = grid.counts
            flat, where = None, grid
        else:
            flat, shape = flattened(points)
            where = flat.reshape(*shape, 3)
        numbers = _magsplice.decouple(self._core, flat, tolerance(within, within_t))
        uniformity = numbers.get("uniformity_rmse")
        singular = np.array(numbers["singular_points_mm"], dtype=float)
        return Decoupling(
            where=where,
            field_t=numbers["field_t"].reshape(*shape, 3),
            parameters=numbers["parameters"].reshape(*shape, 3),
            at_reference=tuple(numbers["at_reference"].values()),
            reference_mm=numbers["reference_mm"],
            singular_mm=singular.reshape(-1, 3),
            uniformity_rmse=None if uniformity is None else tuple(uniformity.values()),
            ideal_rmse=tuple(numbers["ideal_rmse"].values()),
            displacement_rmse_mm=tuple(numbers["displacement_rmse_mm"].values()),
            wavenumber_per_mm=numbers["wavenumber_per_mm"],
        )
