"""The cuboids whose fields a film adds up."""

from __future__ import annotations

from magsplice._layout import Floats
from magsplice._layout_film import LayoutFilm


def blocks_of(film: LayoutFilm) -> tuple[list[str], Floats, Floats, Floats, Floats]:
    """Names, centres and sides in millimetres, polarizations and rotations.

    They are the tiles, or with a recoil permeability their cells, with the names of their tiles.
    """
    tiles = film.tiles
    cells = film._core.cells()
    if cells is None:
        return tiles.names, tiles.position_mm, tiles.size_mm, tiles.polarization_t, tiles.rotation
    owners, *arrays = cells
    position_mm, size_mm, polarization_t, rotation = arrays
    names = [tiles.names[owner] for owner in owners]
    return names, position_mm, size_mm, polarization_t, rotation
