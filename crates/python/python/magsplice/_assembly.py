"""Films with other tiles: moved, turned, selected and joined."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import NDArray

from magsplice import _magsplice
from magsplice._layout import Tile, Tiles, rotation_table, vector

if TYPE_CHECKING:
    from typing_extensions import Self

#: Largest number of names in a message.
_MOST_NAMES = 5


class Assembly(_magsplice.Film):
    """Methods that return films with other tiles.

    Tables such as the working volume are unchanged: only the tiles move. ``[expect]`` and
    ``[design]`` are about the original film, and are left out.
    """

    tiles: Tiles

    def _of_text(self, text: str) -> Self:
        """Film of a text, beside the files of this film."""
        raise NotImplementedError

    def moved(self, shift_mm: Sequence[float]) -> Self:
        """Film with its tiles moved by a vector in millimetres.

        The working volume does not move.

        Examples
        --------
        >>> pad = Film([Tile((0, 0, 0.5), (3, 3, 1), (0, 0, 0.12))], name="pad")
        >>> pair = pad + pad.rotated((180, 0, 0)).moved((0, 0, -6))
        >>> pair.tiles.position_mm[:, 2].tolist()
        [0.5, -6.5]
        """
        return self._of_text(_magsplice.moved(self, vector("shift_mm", shift_mm)))

    def rotated(self, rotation: Any, *, about_mm: Sequence[float] = (0.0, 0.0, 0.0)) -> Self:
        """Film with its tiles turned together, as one rigid body.

        The working volume does not turn. Tiles turned by multiples of 90 degrees about an axis
        exchange their sides, so that parallel edges remain exactly parallel.

        Parameters
        ----------
        rotation : (x, y, z), mapping, quaternion, matrix or scipy Rotation
            Rotation vector in degrees, such as ``(180, 0, 0)`` for a half turn about x, or any
            other form of the rotation of a `Tile`.
        about_mm : (x, y, z)
            Fixed point, in millimetres. Default: the origin.
        """
        turn = rotation_table(rotation)
        return self._of_text(_magsplice.rotated(self, turn, vector("about_mm", about_mm)))

    def __add__(self, other: _magsplice.Film) -> Self:
        """Film with the tiles of both films, and the tables of the first one.

        Tiles of the second film keep their recoil permeability and their errors of ``[tolerance]``.
        If a name is in both films, its second tile gets the next free one of ``NAME-2``,
        ``NAME-3``, ...
        """
        if not isinstance(other, _magsplice.Film):
            return NotImplemented
        return self._of_text(_magsplice.joined(self, other))

    def __radd__(self, other: object) -> Self:
        # The sum of a list of films begins with 0.
        return self if isinstance(other, int) and other == 0 else NotImplemented

    def __iter__(self) -> Iterator[Tile]:
        return iter(self.tiles)

    @overload
    def __getitem__(self, key: int) -> Tile: ...
    @overload
    def __getitem__(self, key: str) -> Tile | Self: ...
    @overload
    def __getitem__(self, key: slice | list[int] | NDArray[Any]) -> Self: ...
    def __getitem__(self, key: Any) -> Any:
        """A tile, or the film with some of the tiles.

        ``film[0]`` and ``film["rim-3"]`` are tiles. ``film[:10]``, ``film[[0, 3]]`` and
        ``film[mask]`` are films, and so are ``film["square"]`` with the tiles of a kind, and
        ``film["rim*"]``, where an asterisk stands for any letters.
        """
        if isinstance(key, (int, np.integer)):
            return self.tiles[int(key)]
        if isinstance(key, str):
            if key in self.tiles.names:
                return self.tiles[self.tiles.names.index(key)]
            found: Any = self._named(key)
        else:
            found = np.arange(len(self))[key].tolist()
        return self._of_text(_magsplice.selected(self, found))

    def _named(self, text: str) -> list[int]:
        """Indices of the tiles of a kind, or whose names match a text with asterisks."""
        kinds = [index for index, kind in enumerate(self.tiles.kinds) if kind == text]
        pattern = re.compile(".*".join(map(re.escape, text.split("*"))))
        matching = [index for index, name in enumerate(self.tiles.names) if pattern.fullmatch(name)]
        found = kinds or matching
        if not found:
            known = (
                list(dict.fromkeys(kind for kind in self.tiles.kinds if kind)) + self.tiles.names
            )
            shown = ", ".join(known[:_MOST_NAMES]) + (", ..." if len(known) > _MOST_NAMES else "")
            raise KeyError(f"{text!r} is no tile and no kind of {self.name}, which has {shown}")
        return found
