"""Films as collections of magpylib."""

from __future__ import annotations

from typing import Any

from magsplice import _magsplice
from magsplice._magpylib.cuboids import MILLI, imported, shifted


def to_magpylib(film: _magsplice.Film) -> Any:
    """Film as a `magpylib.Collection` of cuboids with the names of their tiles as labels."""
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
            for name, position, size, polarization_t, rotation in zip(*film._blocks(), strict=True)
        )
    )
    return collection
