"""Figures with matplotlib, on axes of the caller.

Each function draws on ``ax``, or on new axes, and returns the axes. They need matplotlib:
``pip install "magsplice[plot]"``. `Film.report` draws the figures of the program without it.

Examples
--------
>>> import matplotlib.pyplot as plt  # doctest: +SKIP
>>> figure, (left, right) = plt.subplots(1, 2)  # doctest: +SKIP
>>> magsplice.plot.layout(film, ax=left)  # doctest: +SKIP
>>> magsplice.plot.field_map(film, "bz", ax=right)  # doctest: +SKIP
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from magsplice._layout import Floats, Grid
from magsplice.errors import MagspliceError

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from magsplice._film import Film
    from magsplice._results import Decoupling, Front, Samples

__all__ = [
    "arrows",
    "field_map",
    "front",
    "layout",
    "parameter_map",
    "parameters",
    "resolution_map",
    "samples",
]

#: Points of a map along its longer side.
_MAP_POINTS = 81
#: Points of a curve.
_CURVE_POINTS = 161
#: Arrows along each side of the volume.
_ARROWS = 17
#: Faces of a box, by the signs of their corners: lower and upper, then the four sides.
_CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])


def _axes(ax: Axes | None) -> Axes:
    if ax is not None:
        return ax
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise ImportError(
            'figures need the package matplotlib: pip install "magsplice[plot]"'
        ) from error
    return pyplot.subplots(layout="constrained")[1]


def _grid(film: Film) -> Grid:
    if film.grid is None:
        raise MagspliceError("the layout has no [volume] table, which this figure needs: add one")
    return film.grid


def _turned(vectors: Floats, quaternions: Floats) -> Floats:
    """Vectors turned by quaternions (x, y, z, w), row by row."""
    axis, w = quaternions[..., :3], quaternions[..., 3:]
    cross = 2 * np.cross(axis, vectors)
    turned: Floats = vectors + w * cross + np.cross(axis, cross)
    return turned


def _hull(points: Floats) -> Floats:
    """Convex hull of points in a plane, in order."""

    def half(ordered: list[tuple[float, float]]) -> list[tuple[float, float]]:
        kept: list[tuple[float, float]] = []
        for x, y in ordered:
            while len(kept) > 1:
                (x0, y0), (x1, y1) = kept[-2], kept[-1]
                if (x1 - x0) * (y - y0) > (y1 - y0) * (x - x0):
                    break
                kept.pop()
            kept.append((x, y))
        return kept[:-1]

    ordered = sorted({(float(x), float(y)) for x, y in points})
    return np.array(half(ordered) + half(ordered[::-1]))


def layout(film: Film, ax: Axes | None = None, *, names: bool = False) -> Axes:
    """Tiles from above, coloured by the direction of J, with arrows along it (Dai 2024, Fig. 5).

    Parameters
    ----------
    film : Film
        The film.
    ax : matplotlib.axes.Axes, optional
        Axes to draw on. Default: new ones.
    names : bool
        Whether tiles have their names.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = _axes(ax)
    from matplotlib import colormaps
    from matplotlib.patches import Polygon, Rectangle

    tiles = film.tiles
    j_t = _turned(tiles.polarization_t, tiles.rotation)
    strongest = float(np.linalg.norm(j_t, axis=1).max(initial=0.0)) or 1.0
    colours = colormaps["twilight"]
    for index in np.argsort(tiles.position_mm[:, 2]):
        corners = _turned(
            0.5 * _CORNERS * tiles.size_mm[index],
            np.broadcast_to(tiles.rotation[index], (len(_CORNERS), 4)),
        )
        angle = np.arctan2(j_t[index, 1], j_t[index, 0]) / (2 * np.pi) % 1.0
        colour = colours(angle) if np.hypot(*j_t[index, :2]) > 1e-9 * strongest else "lightgray"
        outline = _hull((corners + tiles.position_mm[index])[:, :2])
        ax.add_patch(Polygon(outline, facecolor=colour, edgecolor="0.3", alpha=0.6))
        if names:
            x, y = tiles.position_mm[index, :2]
            ax.annotate(tiles.names[index], (x, y), ha="center", va="bottom", fontsize="xx-small")
    length = 0.4 * np.median(tiles.size_mm[:, :2].min(axis=1)) / strongest
    x, y, _ = tiles.position_mm.T
    u, v, _ = j_t.T * length
    ax.quiver(
        x - u, y - v, 2 * u, 2 * v, angles="xy", scale_units="xy", scale=1, width=0.004, zorder=3
    )
    if film.volume is not None:
        (x0, x1), (y0, y1) = film.volume.x_mm, film.volume.y_mm
        frame = Rectangle((x0, y0), x1 - x0, y1 - y0, fill=False, edgecolor="tab:blue", ls="--")
        ax.add_patch(frame)
    ax.autoscale_view()
    ax.set(aspect="equal", xlabel="x, mm", ylabel="y, mm", title=film.name)
    return ax


def _plane(film: Film, z_mm: float | None) -> tuple[Grid, float]:
    grid = _grid(film)
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
        What the map shows.
    ax : matplotlib.axes.Axes, optional
        Axes to draw on. Default: new ones.
    z_mm : float, optional
        Height of the plane. Default: the lowest of the volume.
    of : {"film", "ideal", "difference"}
        B of the film, of the ideal film, or film minus ideal film.
    **options
        Passed to ``pcolormesh``.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = _axes(ax)
    grid, z = _plane(film, z_mm)
    field_t = film.ideal_b(grid) if of == "ideal" else film.b(grid, invalid="nan")
    if of == "difference":
        field_t = field_t - film.ideal_b(grid)
    if component == "magnitude":
        values, symbol = np.linalg.norm(field_t, axis=-1), "|B|"
    else:
        values, symbol = field_t[..., "xyz".index(component[1])], f"$B_{component[1]}$"
    name = {"film": "", "ideal": " of the ideal film", "difference": ", film minus ideal"}[of]
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
    ax : matplotlib.axes.Axes, optional
        Axes to draw on. Default: new ones.
    normal : {"x", "y", "z"}
        Axis normal to the plane.
    at_mm : float
        Coordinate of the plane along this axis.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = _axes(ax)
    volume = _grid(film)
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
    ax : matplotlib.axes.Axes, optional
        Axes to draw on. Default: new ones.
    z_mm : float, optional
        Height of the plane. Default: the lowest of the volume.
    **options
        Passed to ``pcolormesh``.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = _axes(ax)
    grid, z = _plane(film, z_mm)
    values = getattr(film.decouple(grid.points_mm), parameter)[..., 0]
    label = {"r_x": "$R_x$, rad", "r_y": "$R_y$, rad", "s_z": "$S_z$"}[parameter]
    return _map(values, grid, z, label, ax, parameter != "s_z", **options)


def parameters(film: Film, ax: Axes | None = None) -> Axes:
    """Change of R_x, R_y, S_z along their own axes, beside that of the ideal film.

    Parameters
    ----------
    film : Film
        A film with an ideal film and a working volume.
    ax : matplotlib.axes.Axes, optional
        Axes to draw on. Default: new ones.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = _axes(ax)
    grid, reference = _grid(film), film.reference_mm
    assert reference is not None
    sign = (-1.0, -1.0, 1.0)
    for axis, symbol in enumerate(("$R_x$", "$R_y$", "$S_z$")):
        points = np.tile(np.array(reference), (_CURVE_POINTS, 1))
        points[:, axis] = np.linspace(grid.lower_mm[axis], grid.upper_mm[axis], _CURVE_POINTS)
        moved = points[:, axis] - reference[axis]
        found: Decoupling = film.decouple(points)
        change = found.parameters[:, axis] - found.at_reference[axis]
        (line,) = ax.plot(moved, change, label=f"{symbol} along {'xyz'[axis]}")
        ideal = sign[axis] * found.wavenumber_per_mm * moved
        ax.plot(moved, ideal, color=line.get_color(), ls=":", lw=1)
    ax.set(xlabel="displacement from the reference point, mm", ylabel="change of the parameter")
    ax.legend(title="dotted: ideal film")
    return ax


def samples(
    made: Samples, axis: Literal["x", "y", "z"] = "x", ax: Axes | None = None, *, bins: int = 50
) -> Axes:
    """Histogram of the displacement RMSE of films that are made, with the 95th percentile.

    Parameters
    ----------
    made : Samples
        Result of `Film.tolerance`.
    axis : {"x", "y", "z"}
        Axis of the displacement.
    ax : matplotlib.axes.Axes, optional
        Axes to draw on. Default: new ones.
    bins : int
        Number of bins.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = _axes(ax)
    index = "xyz".index(axis)
    p95 = made.displacement_mm(axis).p95
    ax.hist(made.displacement_rmse_mm[:, index], bins=bins, color="0.7")
    ax.axvline(p95.value, color="tab:red", label=f"95th percentile, {p95.value:.3g} mm")
    if np.isfinite((p95.low, p95.high)).all():
        ax.axvspan(p95.low, p95.high, color="tab:red", alpha=0.2, lw=0)
    ordered = made.ordered[1][0, index]
    ax.axvline(ordered, color="tab:blue", ls="--", label=f"as ordered, {ordered:.3g} mm")
    ax.set(xlabel=f"displacement RMSE along {axis}, mm", ylabel="films", title=made.name)
    ax.legend()
    return ax


def front(found: Front, ax: Axes | None = None) -> Axes:
    """Error against amplitude of the films of a trade-off.

    Parameters
    ----------
    found : Front
        Result of `Film.front`.
    ax : matplotlib.axes.Axes, optional
        Axes to draw on. Default: new ones.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = _axes(ax)
    columns = found.columns()
    ax.semilogy(columns["amplitude"], columns["error"], "o-")
    ax.set(xlabel="best-fit amplitude", ylabel="error that is minimized")
    return ax


def resolution_map(
    film: Film,
    axis: Literal["x", "y", "z"] = "x",
    ax: Axes | None = None,
    *,
    z_mm: float | None = None,
    noise_t: float | None = None,
    **options: Any,
) -> Axes:
    """Map of the standard deviation of the position that one reading gives, in millimetres.

    Parameters
    ----------
    film : Film
        A film with a working volume.
    axis : {"x", "y", "z"}
        Axis of the position.
    ax : matplotlib.axes.Axes, optional
        Axes to draw on. Default: new ones.
    z_mm : float, optional
        Height of the plane. Default: the lowest of the volume.
    noise_t : float, optional
        Standard deviation of a reading, in tesla. Default: that of ``[sensor]``.
    **options
        Passed to ``pcolormesh``.

    Returns
    -------
    matplotlib.axes.Axes
    """
    ax = _axes(ax)
    grid, z = _plane(film, z_mm)
    values = film.resolution(grid, noise_t=noise_t)[..., 0, "xyz".index(axis)]
    return _map(values, grid, z, f"deviation of {axis}, mm", ax, False, **options)
