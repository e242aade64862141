"""Films as collections of magpylib."""

from __future__ import annotations

from typing import Any

from magsplice import _magsplice
from magsplice._magpylib.cuboids import imported, in_metres


def to_magpylib(film: _magsplice.Film) -> Any:
    """Film as a `magpylib.Collection` of cuboids with the names of their tiles as labels.

    Images of the tiles in iron are cuboids too: the field is right before all planes of iron.
    """
    magpylib = imported()
    from scipy.spatial.transform import Rotation

    names, position_mm, size_mm, *directions = film._blocks()
    rows = zip(names, in_metres(position_mm), in_metres(size_mm), *directions, strict=True)
    collection = magpylib.Collection(style_label=film.name)
    collection.add(
        *(
            magpylib.magnet.Cuboid(
                position=position,
                dimension=size,
                polarization=polarization_t,
                orientation=Rotation.from_quat(rotation),
                style_label=name,
            )
            for name, position, size, polarization_t, rotation in rows
        )
    )
    return collection
