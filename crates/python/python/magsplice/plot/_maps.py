"""Maps on planes through the working volume."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from magsplice._arguments import one_of
from magsplice._film import Film
from magsplice._layout import Floats, Grid
from magsplice.errors import MagspliceError
from magsplice.plot._axes import axes_or_new

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Points of a map along its longer side.
_MAP_POINTS = 81
#: Values of one sign may exceed zero on the other side by this fraction of their range.
_ONE_SIGN = 0.02
#: Error bounds by which a component of B must exceed zero, as in a report.
_BOUNDS_OF_ZERO = 2.0
#: Arrows along each side of the volume.
_ARROWS = 17


def field_map(
    film: Film,
    component: Literal["bx", "by", "bz", "magnitude"] = "bz",
    ax: Axes | None = None,
    *,
    z_mm: float | None = None,
    of: Literal["film", "ideal", "difference"] = "film",
    **options: Any,
) -> Axes:
    """Map of B in millitesla on a plane of the working volume (Dai 2024, Fig. 6).

    The rules are those of a report: round-off is 0, the maps of the film and of its ideal film have
    the same colour scale, and values of one sign have a sequential scale.

    Parameters
    ----------
    film : Film
        A film with a working volume.
    component : {"bx", "by", "bz", "magnitude"}
        The mapped quantity.
    z_mm : float, optional
        Height of the plane. Default: the lowest of the volume.
    of : {"film", "ideal", "difference"}
        B of the film, of the ideal film, or film minus ideal film.
    **options
        Passed to ``pcolormesh``.
    """
    one_of("component", component, ("bx", "by", "bz", "magnitude"))
    one_of("of", of, ("film", "ideal", "difference"))
    ax = axes_or_new(ax)
    grid, z = _plane(film, z_mm)
    round_off_t = _BOUNDS_OF_ZERO * film.error_bound(grid)[..., np.newaxis]
    film_t = film.b(grid, invalid="nan")

    def mapped(field_t: Floats) -> Floats:
        field_t = np.where(np.abs(field_t) <= round_off_t, 0.0, field_t)
        if component == "magnitude":
            return np.asarray(1e3 * np.linalg.norm(field_t, axis=-1)[..., 0])
        return np.asarray(1e3 * field_t[..., 0, "xyz".index(component[1])])

    if of == "difference":
        values = mapped(film_t - film.ideal_b(grid))
        compared = [values]
    else:
        ideal_t = film.ideal_b(grid) if of == "ideal" else _comparable_t(film, grid)
        compared = [mapped(field_t) for field_t in (film_t, ideal_t) if field_t is not None]
        values = compared[-1 if of == "ideal" else 0]
    symbol = "|B|" if component == "magnitude" else f"$B_{component[1]}$"
    name = {"film": "", "ideal": " of the ideal film", "difference": ", film minus ideal"}[of]
    if component == "magnitude" and of == "difference":
        symbol, name = "|B of the film - B of the ideal film|", ""
    label = f"{symbol}{name}, mT"
    options = {**_colours(compared), **options}
    return _map(values, grid, z, label, ax, **options)


def arrows(
    film: Film,
    ax: Axes | None = None,
    *,
    normal: Literal["x", "y", "z"] = "y",
    at_mm: float = 0.0,
) -> Axes:
    """Directions of B on a plane through the working volume, coloured by |B| (Dai 2024, Fig. 3).

    Parameters
    ----------
    film : Film
        A film with a working volume.
    normal : {"x", "y", "z"}
        Axis normal to the plane.
    at_mm : float
        Coordinate of the plane along this axis.
    """
    ax = axes_or_new(ax)
    volume = film._required_grid()
    across = "xyz".index(normal)
    i, j = (axis for axis in range(3) if axis != across)
    lower, upper, counts = list(volume.lower_mm), list(volume.upper_mm), [_ARROWS] * 3
    lower[across] = upper[across] = at_mm
    counts[across] = 1
    grid = Grid(
        (lower[0], lower[1], lower[2]),
        (upper[0], upper[1], upper[2]),
        (counts[0], counts[1], counts[2]),
    )
    points = grid.points_mm.reshape(-1, 3)
    field_t = film.b(points, invalid="nan")
    magnitude = np.linalg.norm(field_t, axis=1)
    directions = field_t / np.where(magnitude > 0, magnitude, 1.0)[:, None]
    drawn = ax.quiver(
        points[:, i], points[:, j], directions[:, i], directions[:, j], 1e3 * magnitude, pivot="mid"
    )
    ax.figure.colorbar(drawn, ax=ax, label="|B|, mT")
    ax.set(
        aspect="equal",
        xlabel=f"{'xyz'[i]}, mm",
        ylabel=f"{'xyz'[j]}, mm",
        title=f"{normal} = {at_mm:g} mm",
    )
    return ax


def parameter_map(
    film: Film,
    parameter: Literal["r_x", "r_y", "s_z"] = "r_x",
    ax: Axes | None = None,
    *,
    z_mm: float | None = None,
    **options: Any,
) -> Axes:
    """Map of a decoupling parameter on a plane of the working volume (Dai 2024, Figs. 7 and 8).

    Parameters
    ----------
    film : Film
        A film with an ideal film and a working volume.
    parameter : {"r_x", "r_y", "s_z"}
        The parameter.
    z_mm, **options
        See `field_map`.
    """
    ax = axes_or_new(ax)
    grid, z = _plane(film, z_mm)
    one_of("parameter", parameter, ("r_x", "r_y", "s_z"))
    values = getattr(film.decouple(grid.points_mm), parameter)[..., 0]
    label = {"r_x": "$R_x$, rad", "r_y": "$R_y$, rad", "s_z": "$S_z$"}[parameter]
    if parameter != "s_z":
        options = {**_colours([values]), **options}
    return _map(values, grid, z, label, ax, **options)


def resolution_map(
    film: Film,
    axis: Literal["x", "y", "z"] = "x",
    ax: Axes | None = None,
    *,
    z_mm: float | None = None,
    noise_t: float | None = None,
    **options: Any,
) -> Axes:
    """Map of the standard deviation of the position from one reading, in millimetres.

    Parameters
    ----------
    film : Film
        A film with a working volume.
    axis : {"x", "y", "z"}
        Axis of the position.
    noise_t : float, optional
        Standard deviation of a reading, in tesla. Default: the noise of ``[sensor]``.
    z_mm, **options
        See `field_map`.
    """
    ax = axes_or_new(ax)
    grid, z = _plane(film, z_mm)
    values = film.resolution(grid, noise_t=noise_t)[..., 0, "xyz".index(axis)]
    options = {"vmin": 0.0, **options}
    return _map(values, grid, z, f"deviation of {axis}, mm", ax, **options)


def _plane(film: Film, z_mm: float | None) -> tuple[Grid, float]:
    grid = film._required_grid()
    z = grid.lower_mm[2] if z_mm is None else float(z_mm)
    (x0, y0, _), (x1, y1, _) = grid.lower_mm, grid.upper_mm
    longest = max(x1 - x0, y1 - y0) or 1.0
    counts = [max(2, round(_MAP_POINTS * side / longest)) for side in (x1 - x0, y1 - y0)]
    return Grid((x0, y0, z), (x1, y1, z), (counts[0], counts[1], 1)), z


def _comparable_t(film: Film, grid: Grid) -> Floats | None:
    """B of the ideal film; None where there is none, so that no map is compared with it."""
    try:
        return film.ideal_b(grid)
    except (MagspliceError, ValueError):
        return None


def _colours(compared: list[Floats]) -> dict[str, Any]:
    """Colour scale of values whose zero has a meaning, the same for all compared maps."""
    finite = [values[np.isfinite(values)] for values in compared]
    low = min((float(values.min()) for values in finite if values.size), default=0.0)
    high = max((float(values.max()) for values in finite if values.size), default=0.0)
    slight = _ONE_SIGN * (max(high, 0.0) - min(low, 0.0))
    if high > slight and low >= -slight:
        return {"cmap": "viridis", "vmin": low if low > 0.5 * high else 0.0, "vmax": high}
    if low < -slight and high <= slight:
        return {"cmap": "viridis", "vmin": low, "vmax": high if high < 0.5 * low else 0.0}
    most = max(high, -low) or 1.0
    return {"cmap": "RdBu_r", "vmin": -most, "vmax": most}


def _sides(centres: Floats) -> Floats:
    """Sides of cells around these points. The map ends at the first and the last of them."""
    return np.concatenate([centres[:1], 0.5 * (centres[1:] + centres[:-1]), centres[-1:]])


def _map(values: Floats, grid: Grid, z_mm: float, label: str, ax: Axes, **options: Any) -> Axes:
    sides = (_sides(np.asarray(grid.x_mm)), _sides(np.asarray(grid.y_mm)))
    mesh = ax.pcolormesh(*sides, values.T, shading="flat", **options)
    ax.figure.colorbar(mesh, ax=ax, label=label)
    ax.set(aspect="equal", xlabel="x, mm", ylabel="y, mm", title=f"z = {z_mm:g} mm")
    return ax
