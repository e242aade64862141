"""Curves and histograms."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from magsplice._film import Film, Front
from magsplice._samples import Samples
from magsplice.plot._axes import BARS, BLUE, VERMILION, axes_or_new

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Points of a curve.
_CURVE_POINTS = 161


def parameters(film: Film, ax: Axes | None = None) -> Axes:
    """Change of R_x, R_y, S_z along their own axes, compared with the ideal film.

    Parameters
    ----------
    film : Film
        A film with an ideal film and a working volume.
    """
    ax = axes_or_new(ax)
    grid, reference = film._required_grid(), film.reference_mm
    assert reference is not None
    sign = (-1.0, -1.0, 1.0)
    for axis, symbol in enumerate(("$R_x$", "$R_y$", "$S_z$")):
        points = np.tile(np.array(reference), (_CURVE_POINTS, 1))
        points[:, axis] = np.linspace(grid.lower_mm[axis], grid.upper_mm[axis], _CURVE_POINTS)
        moved = points[:, axis] - reference[axis]
        found = film.decouple(points)
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
    """Histogram of the displacement RMSE of films as made, with the 95th percentile.

    Parameters
    ----------
    made : Samples
        Result of `Film.tolerance`.
    axis : {"x", "y", "z"}
        Axis of the displacement.
    bins : int
        Number of bins.
    """
    ax = axes_or_new(ax)
    index = "xyz".index(axis)
    found = made.displacement_mm(axis)
    p95, nominal = found.p95, found.nominal
    ax.hist(made.displacement_rmse_mm[:, index], bins=bins, color=BARS)
    ax.axvline(p95.value, color=VERMILION, label=f"95th percentile, {p95.value:.3g} mm")
    if np.isfinite((p95.low, p95.high)).all():
        ax.axvspan(p95.low, p95.high, color=VERMILION, alpha=0.2, lw=0)
    ax.axvline(nominal, color=BLUE, ls="--", label=f"as ordered, {nominal:.3g} mm")
    ax.set(xlabel=f"displacement RMSE along {axis}, mm", ylabel="films", title=made.name)
    ax.legend()
    return ax


def front(found: Front, ax: Axes | None = None) -> Axes:
    """Error against amplitude of the films of a trade-off.

    Parameters
    ----------
    found : Front
        Result of `Film.front`.
    """
    ax = axes_or_new(ax)
    columns = found.columns()
    ax.semilogy(columns["amplitude"], columns["error"], "o-")
    ax.set(xlabel="best-fit amplitude", ylabel="minimized error")
    return ax
