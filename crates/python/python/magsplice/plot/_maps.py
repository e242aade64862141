"""Maps on planes through the working volume."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from magsplice._arguments import one_of
from magsplice._film import Film
from magsplice._layout import Floats, Grid
from magsplice.plot._axes import axes_or_new

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Points of a map along its longer side.
_MAP_POINTS = 81
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
    field_t = film.ideal_b(grid) if of == "ideal" else film.b(grid, invalid="nan")
    if of == "difference":
        field_t = field_t - film.ideal_b(grid)
    if component == "magnitude":
        values, symbol = np.linalg.norm(field_t, axis=-1), "|B|"
    else:
        values, symbol = field_t[..., "xyz".index(component[1])], f"$B_{component[1]}$"
    name = {"film": "", "ideal": " of the ideal film", "difference": ", film minus ideal"}[of]
    if component == "magnitude" and of == "difference":
        symbol, name = "|B of the film - B of the ideal film|", ""
    label = f"{symbol}{name}, mT"
    return _map(1e3 * values[..., 0], grid, z, label, ax, component != "magnitude", **options)


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
    return _map(values, grid, z, label, ax, parameter != "s_z", **options)


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
    return _map(values, grid, z, f"deviation of {axis}, mm", ax, False, **options)


def _plane(film: Film, z_mm: float | None) -> tuple[Grid, float]:
    grid = film._required_grid()
    z = grid.lower_mm[2] if z_mm is None else float(z_mm)
    (x0, y0, _), (x1, y1, _) = grid.lower_mm, grid.upper_mm
    longest = max(x1 - x0, y1 - y0) or 1.0
    counts = [max(2, round(_MAP_POINTS * side / longest)) for side in (x1 - x0, y1 - y0)]
    return Grid((x0, y0, z), (x1, y1, z), (counts[0], counts[1], 1)), z


def _map(
    values: Floats, grid: Grid, z_mm: float, label: str, ax: Axes, centred: bool, **options: Any
) -> Axes:
    if centred:
        most = float(np.nanmax(np.abs(values), initial=0.0)) or 1.0
        options = {"cmap": "RdBu_r", "vmin": -most, "vmax": most, **options}
    mesh = ax.pcolormesh(grid.x_mm, grid.y_mm, values.T, shading="nearest", **options)
    ax.figure.colorbar(mesh, ax=ax, label=label)
    ax.set(aspect="equal", xlabel="x, mm", ylabel="y, mm", title=f"z = {z_mm:g} mm")
    return ax
