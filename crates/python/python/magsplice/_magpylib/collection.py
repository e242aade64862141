"""Films as collections of magpylib."""

from __future__ import annotations

from typing import Any

from magsplice._layout_film import LayoutFilm
from magsplice._magpylib.blocks import blocks_of
from magsplice._magpylib.cuboids import MILLI, imported, shifted


def to_magpylib(film: LayoutFilm) -> Any:
    """Film as a `magpylib.Collection` of cuboids, in metres and tesla.

    Parameters
    ----------
    film : LayoutFilm
        The film. Each cuboid has the name of its tile as its label. Tiles with a recoil
        permeability become their cells, with the polarization that agrees with the field.
    """
    magpylib = imported()
    from scipy.spatial.transform import Rotation

    collection = magpylib.Collection(style_label=film.name)
    collection.add(
        *(
            magpylib.magnet.Cuboid(
                position=shifted(position, -MILLI),
                dimension=shifted(size, -MILLI),
                polarization=polarization_t,
                orientation=Rotation.from_quat(rotation),
                style_label=name,
            )
            for name, position, size, polarization_t, rotation in zip(*blocks_of(film), strict=True)
        )
    )
    return collection
