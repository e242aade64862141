"""Cuboids of magpylib, and their paths."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from magsplice import _magsplice
from magsplice._layout import Floats


def imported() -> Any:
    """The optional package magpylib."""
    try:
        import magpylib
    except ImportError as error:
        raise ImportError(
            'this needs the package magpylib: pip install "magsplice[magpylib]"'
        ) from error
    return magpylib


def in_mm(metres: Floats) -> Floats:
    """Vectors in millimetres, shape (..., 3). The decimal point moves, exact in every digit."""
    return _shifted(metres, 3)


def in_metres(millimetres: Floats) -> Floats:
    """The inverse of `in_mm`."""
    return _shifted(millimetres, -3)


def _shifted(values: Floats, exponent: int) -> Floats:
    rows = np.ascontiguousarray(values, dtype=float).reshape(-1, 3)
    return _magsplice.shifted(rows, exponent).reshape(np.shape(values))


class Track:
    """A cuboid along its path, or the tiles of a film: arrays of shape (path, 3) or (path, 4)."""

    def __init__(self, cuboid: Any) -> None:
        for key in ("dimension", "polarization"):
            if getattr(cuboid, key) is None:
                raise ValueError(f"{cuboid!r} has no {key}: set it before computing its field")
        self.position = np.atleast_2d(cuboid.position)
        self.size = np.abs(np.atleast_2d(cuboid.dimension))
        self.polarization_t = np.atleast_2d(cuboid.polarization)
        self.rotation = np.atleast_2d(cuboid.orientation.as_quat())

    @property
    def _arrays(self) -> tuple[Floats, ...]:
        return self.position, self.size, self.polarization_t, self.rotation

    @property
    def length(self) -> int:
        """Number of steps of the path."""
        return max(len(array) for array in self._arrays)

    def at(self, step: int) -> tuple[Floats, ...]:
        """Position, size, polarization and rotation at a step; shorter paths stay at their end."""
        return tuple(array[min(step, len(array) - 1)] for array in self._arrays)


def cuboids_of(entry: Any) -> Iterator[Any]:
    """Cuboids of a source entry."""
    magpylib = imported()
    found = entry.sources_all if isinstance(entry, magpylib.Collection) else [entry]
    if not found:
        raise ValueError(f"{entry!r} has no sources")
    for source in found:
        if not isinstance(source, magpylib.magnet.Cuboid):
            raise TypeError(
                f"{source!r} is no cuboid: magsplice computes magpylib.magnet.Cuboid and "
                "collections of them; use magpylib.getB for other sources, and add the fields"
            )
        yield source


def label_of(entry: Any) -> str:
    """Label of an object of magpylib, or its representation."""
    return entry.style.label or f"{entry}"
