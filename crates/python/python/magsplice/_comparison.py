"""Comparison with the ideal film, and decoupling parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING

from magsplice._arrow import Column, Table, split
from magsplice._layout import Floats, Grid, Vector
from magsplice._points import coordinates
from magsplice._results import PerAxis, PerParameter, key
from magsplice._source import OfFilm

if TYPE_CHECKING:
    import xarray


class Comparison(OfFilm):
    """The difference of the field of a film from the field of the ideal film (Dai 2024, Eq. 2)."""

    points: int = key("Number of points.")
    component_rmse_t: Vector = key("RMS difference of B_x, B_y, B_z, in tesla.")
    rmse_t: float = key("RMS length of the difference, in tesla.")
    relative_rmse: float = key("`rmse_t` over the root mean square of the ideal B.")
    worst_t: float = key("Largest length of the difference, in tesla.")
    worst_at_mm: Vector = key("First point of the largest difference, in millimetres.")
    amplitude: float = key("Factor of the ideal B that fits B of the film best.")
    scaled_relative_rmse: float | None = key(
        "Relative RMSE against the ideal B times `amplitude`; None if `amplitude` is 0."
    )
    correlation: tuple[float | None, float | None, float | None] = key(
        "Pearson's correlation of each component; None where a component does not vary."
    )
    remark: str | None = key("Remark on an unusual result.")


class Decoupling(OfFilm, Table):
    """Decoupling parameters and their errors (Dai 2024, Eqs. 13 to 15).

    A table of the points with their B and parameters: ``polars.DataFrame(result)``.
    """

    points: int = key("Number of points.")
    reference_mm: Vector = key("Point from which changes count, in millimetres.")
    at_reference: PerParameter[float] = key("R_x, R_y, S_z at the reference point.")
    singular_points_mm: list[Vector] = key("Points without parameters, where B_z = 0.")
    uniformity_rmse: PerParameter[float | None] | None = key(
        """Uniformity RMSE of R_x, R_y, S_z: the standard deviation over the planes normal to the
        own axis of a parameter, averaged over the planes. None where the planes have one point
        each, and for points that form no grid."""
    )
    uniformity_rmse_mm: PerAxis[float | None] | None = key("`uniformity_rmse` in mm.")
    ideal_rmse: PerParameter[float] = key("RMSE of the changes against the ideal film.")
    displacement_rmse_mm: PerAxis[float] = key(
        """RMSE of the displacement along x, y, z computed from the parameters (Dai 2024, Eq. 14),
        in millimetres: `ideal_rmse` over the wavenumber."""
    )
    worst_displacement_error_mm: PerAxis[float] | None = key(
        "Longest error of the displacement at points that form no grid, in millimetres."
    )
    worst_displacement_at_mm: Vector | None = key("Point of the longest error, in millimetres.")
    omitted: dict[str, str] | None = key("Results that need a grid, and the reasons.")
    where: Grid | Floats = key("The grid, or the points in millimetres, shape (..., 3).")
    field_t: Floats = key("B in tesla, shape (..., 3).")
    parameters: Floats = key("R_x, R_y in radians and S_z, shape (..., 3); NaN at singular points.")
    displacement_mm: Floats = key("Displacement by Eq. 14, in millimetres, shape (..., 3).")
    wavenumber_per_mm: float = key("Wavenumber of the ideal film, in radians per millimetre.")

    @property
    def r_x(self) -> Floats:
        """R_x in radians, shape (...); depends on the displacement along x."""
        return self.parameters[..., 0]

    @property
    def r_y(self) -> Floats:
        """R_y in radians, shape (...); depends on the displacement along y."""
        return self.parameters[..., 1]

    @property
    def s_z(self) -> Floats:
        """S_z, shape (...); depends on the displacement along z."""
        return self.parameters[..., 2]

    @property
    def points_mm(self) -> Floats:
        """Points in millimetres, shape (..., 3)."""
        return self.where.points_mm if isinstance(self.where, Grid) else self.where

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
            coords = coordinates(dims, (self.where.x_mm, self.where.y_mm, self.where.z_mm))
            shape: tuple[int, ...] = self.where.counts
        else:
            dims, shape = ("point",), (self.points,)
            coords = coordinates(dims * 3, self.where.reshape(-1, 3).T)
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
