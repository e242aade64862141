"""Axes of figures."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes


#: Colours of lines, as in reports.
BLUE, VERMILION, BARS = "#0072b2", "#d55e00", "#a6cee3"


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
