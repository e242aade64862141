"""Figures of tiles from above."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from magsplice._arguments import one_of
from magsplice._film import Film
from magsplice.errors import MagspliceError
from magsplice.plot._axes import BLUE, axes_or_new

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def layout(film: Film, ax: Axes | None = None, *, names: bool = False) -> Axes:
    """Tiles from above, coloured by the direction of J, with arrows along it (Dai 2024, Fig. 5).

    Parameters
    ----------
    film : Film
        The film.
    names : bool
        Whether to print the names of tiles.
    """
    ax = axes_or_new(ax)
    from matplotlib.patches import Polygon, Rectangle

    tiles = film.tiles
    outlines, j_t, colours = film._outlines()
    strongest = float(np.linalg.norm(j_t, axis=1).max(initial=0.0)) or 1.0
    for index in np.argsort(tiles.position_mm[:, 2]):
        ax.add_patch(Polygon(outlines[index], facecolor=colours[index], edgecolor="0.3"))
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
        frame = Rectangle((x0, y0), x1 - x0, y1 - y0, fill=False, edgecolor=BLUE, ls="--")
        ax.add_patch(frame)
    ax.autoscale_view()
    ax.set(aspect="equal", xlabel="x, mm", ylabel="y, mm", title=film.name)
    return ax


def recoil(
    film: Film, quantity: Literal["weakening", "turn"] = "weakening", ax: Axes | None = None
) -> Axes:
    """Tiles from above, coloured by their weakening or turn by recoil.

    Parameters
    ----------
    film : Film
        A film whose tiles have a recoil permeability.
    quantity : {"weakening", "turn"}
        Lost magnitude of the mean polarization in percent, or its turn in degrees.

    Raises
    ------
    MagspliceError
        If no tile has a recoil permeability.
    """
    one_of("quantity", quantity, ("weakening", "turn"))
    found = film.recoil
    if found is None:
        raise MagspliceError(
            "no tile has a recoil permeability, which this figure needs: give one, such as "
            'film.replace(material={"recoil_permeability": 1.05})'
        )
    ax = axes_or_new(ax)
    from matplotlib.collections import PolyCollection

    values = 100 * found.weakening if quantity == "weakening" else found.angle_deg
    label = {"weakening": "weakening, %", "turn": "turn, degrees"}[quantity]
    order = np.argsort(film.tiles.position_mm[:, 2])
    outlines, *_ = film._outlines()
    drawn = PolyCollection([outlines[index] for index in order], edgecolors="0.3")
    drawn.set_array(values[order])
    drawn.set_clim(min(0.0, values.min()), values.max())
    ax.add_collection(drawn)
    ax.figure.colorbar(drawn, ax=ax, label=label)
    ax.autoscale_view()
    ax.set(aspect="equal", xlabel="x, mm", ylabel="y, mm", title=film.name)
    return ax
