"""Axes of figures, and what they need of a film."""

from __future__ import annotations

from typing import TYPE_CHECKING

from magsplice._film import Film
from magsplice._layout import Grid
from magsplice.errors import MagspliceError

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def axes_or_new(ax: Axes | None) -> Axes:
    """Axes of the caller, or new ones."""
    if ax is not None:
        return ax
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise ImportError(
            'figures need the package matplotlib: pip install "magsplice[plot]"'
        ) from error
    return pyplot.subplots(layout="constrained")[1]


def grid_of(film: Film) -> Grid:
    """Grid of the working volume, which a figure needs."""
    if film.grid is None:
        raise MagspliceError("the layout has no [volume] table, which this figure needs: add one")
    return film.grid
