"""Fields of films at points and on grids."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from magsplice._arguments import one_of
from magsplice._datasets import coordinates
from magsplice._layout import Floats, Grid
from magsplice._layout_film import LayoutFilm
from magsplice.errors import MagspliceError

if TYPE_CHECKING:
    import xarray

Invalid = Literal["raise", "nan"]


def tolerance(within: float | None, within_t: float | None) -> tuple[bool, float] | None:
    """Whether a tolerance is a fraction, and its value; None without one."""
    if within is not None and within_t is not None:
        raise ValueError("within and within_t are both given: give one of them")
    if within is not None:
        return (True, float(within))
    return None if within_t is None else (False, float(within_t))


def flattened(points: ArrayLike) -> tuple[Floats, tuple[int, ...]]:
    """Points as contiguous rows, and the leading shape. Contiguous doubles are not copied."""
    array: NDArray[np.float64] = np.ascontiguousarray(points, dtype=np.float64)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ValueError(
            f"points have the shape {array.shape}, must have (..., 3): x, y, z along the last axis"
        )
    return array.reshape(-1, 3), array.shape[:-1]


class FieldFilm(LayoutFilm):
    """A film with its field."""

    def b(
        self,
        points: ArrayLike | Grid,
        *,
        within: float | None = None,
        within_t: float | None = None,
        invalid: Invalid = "raise",
    ) -> Floats:
        """Flux density B in tesla.

        Parameters
        ----------
        points : array_like of shape (..., 3), or Grid
            Points in millimetres. An array of contiguous doubles is not copied.
        within : float, optional
            Accepted length of the error as a fraction of |B| at each point, such as 1e-6. Default:
            exact.
        within_t : float, optional
            Accepted length of the error in tesla. Excludes `within`.
        invalid : {"raise", "nan"}
            What happens at points without a field, such as those on exposed edges.

        Returns
        -------
        ndarray of shape (..., 3)
            B at each point; for a grid of shape (nx, ny, nz, 3). Exact values depend on no other
            point and on no number of threads.

        Raises
        ------
        PointsError
            If points have no field, or a tolerance cannot be kept there.
        ValueError
            If the points have another shape.

        Notes
        -----
        Error of the exact field: at most 2e-14 of the sum over tiles (see `error_bound`). On a face
        B is that of the side of larger x, y or z. A tolerance saves time on grids and with many
        tiles: docs/accuracy-and-speed.md.
        """
        return self._field("b", points, within, within_t, invalid)

    def h(
        self,
        points: ArrayLike | Grid,
        *,
        within: float | None = None,
        within_t: float | None = None,
        invalid: Invalid = "raise",
    ) -> Floats:
        """Field strength H in ampere per metre: (B - J) / mu0.

        See `b` for the parameters. A tolerance is that of B.
        """
        return self._field("h", points, within, within_t, invalid)

    def j(self, points: ArrayLike | Grid) -> Floats:
        """Polarization J in tesla of the tile at each point; 0 outside tiles.

        Parameters
        ----------
        points : array_like of shape (..., 3), or Grid
            Points in millimetres.

        Returns
        -------
        ndarray of shape (..., 3)
        """
        return self._field("j", points, None, None, "raise")

    def gradient(
        self,
        points: ArrayLike | Grid,
        *,
        quantity: Literal["b", "h"] = "b",
        invalid: Invalid = "raise",
    ) -> Floats:
        """Gradient of B in tesla per millimetre, or of H in ampere per metre and millimetre.

        Parameters
        ----------
        points : array_like of shape (..., 3), or Grid
            Points in millimetres.
        quantity : {"b", "h"}
            Which field is differentiated.
        invalid : {"raise", "nan"}
            What happens at points without a gradient, such as those on edges.

        Returns
        -------
        ndarray of shape (..., 3, 3)
            Element (..., i, j) is the derivative of component i along coordinate j. The gradient of
            B is mu0 times that of H inside a tile too, so it is symmetric and has no trace.

        Raises
        ------
        PointsError
            If points have no gradient.
        """
        one_of("quantity", quantity, ("b", "h"))
        flat, shape = flattened(points.points_mm if isinstance(points, Grid) else points)
        values, error = self._core.scene.gradient(quantity, flat)
        if error is not None and invalid == "raise":
            raise error
        return values.reshape(*shape, 3, 3)

    def error_bound(self, points: ArrayLike | Grid) -> Floats:
        """Upper bound in tesla of the error of the exact B, shape (...).

        It is 2e-14 of an upper bound of the sum over tiles of the fields that the three components
        of J make alone. A component of B below it may be rounding alone.
        """
        flat, shape = flattened(points.points_mm if isinstance(points, Grid) else points)
        return self._core.scene.error_bounds_t(flat).reshape(shape)

    def ideal_b(self, points: ArrayLike | Grid) -> Floats:
        """Flux density of the ideal film in tesla (Dai 2024, Eq. 2), shape (..., 3).

        NaN at points that are not below the film, at z >= 0.

        Raises
        ------
        MagspliceError
            If the layout has no ideal film.
        """
        flat, shape = flattened(points.points_mm if isinstance(points, Grid) else points)
        return self._core.ideal_b(flat).reshape(*shape, 3)

    def to_xarray(
        self,
        grid: Grid | None = None,
        *,
        within: float | None = None,
        within_t: float | None = None,
    ) -> xarray.Dataset:
        """B on a grid as an xarray dataset with the dimensions x, y, z and component.

        The variable ``b`` is B in tesla, and ``ideal_b`` that of the ideal film, if there is one.

        Parameters
        ----------
        grid : Grid, optional
            Default: the grid of the working volume.
        within, within_t : float, optional
            Tolerance of the field; see `b`.
        """
        import xarray

        grid = self._required_grid() if grid is None else grid
        dims = ("x", "y", "z", "component")
        tesla = {"units": "T"}
        fields = {"b": (dims, self.b(grid, within=within, within_t=within_t), tesla)}
        if self.ideal is not None:
            fields["ideal_b"] = (dims, self.ideal_b(grid), tesla)
        return xarray.Dataset(fields, coordinates(grid), {"film": self.name, "sha256": self.sha256})

    def _required_grid(self) -> Grid:
        if self.grid is None:
            raise MagspliceError(
                "the layout has no [volume] table, which this needs: add one, such as "
                'film.replace(volume={"x_mm": [-2, 2], "y_mm": [-2, 2], "z_mm": [-5, -3], '
                '"step_mm": 0.5})'
            )
        return self.grid

    def _field(
        self,
        quantity: Literal["b", "h", "j"],
        points: ArrayLike | Grid,
        within: float | None,
        within_t: float | None,
        invalid: Invalid,
    ) -> Floats:
        """Field at points or on a grid."""
        within_one = tolerance(within, within_t)
        if invalid not in ("raise", "nan"):
            raise ValueError(f'invalid = {invalid!r}, must be "raise" or "nan"')
        if isinstance(points, Grid):
            shape: tuple[int, ...] = points.counts
            values, error = self._core.scene.field_on_grid(
                quantity, points.lower_mm, points.upper_mm, points.counts, within_one
            )
        else:
            flat, shape = flattened(points)
            values, error = self._core.scene.field(quantity, flat, within_one)
        if error is not None and invalid == "raise":
            raise error
        return values.reshape(*shape, 3)
