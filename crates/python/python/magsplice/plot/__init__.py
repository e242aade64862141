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

from magsplice.plot._curves import front, parameters, samples
from magsplice.plot._maps import arrows, field_map, parameter_map, resolution_map
from magsplice.plot._tiles import layout, recoil

__all__ = [
    "arrows",
    "field_map",
    "front",
    "layout",
    "parameter_map",
    "parameters",
    "recoil",
    "resolution_map",
    "samples",
]
