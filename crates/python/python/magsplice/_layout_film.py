"""Films as layouts: their parts, and how they are made, copied and saved."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from magsplice import _magsplice, _toml
from magsplice._layout import Grid, Ideal, Tiles, Vector, Volume, table_of

if TYPE_CHECKING:
    from typing_extensions import Self


#: Keys of a layout file that may be left out.
_KEYS = (
    "description",
    "history",
    "overlap_mm",
    "ideal",
    "volume",
    "material",
    "expect",
    "design",
    "tolerance",
    "sensor",
    "elastomer",
    "kind",
    "tile",
    "lattice",
)


class LayoutFilm:
    """A film with the parts of its layout."""

    _core: _magsplice.Film
    _text: str
    _origin: str
    _folder: str | None

    @classmethod
    def _made(cls, core: _magsplice.Film, text: str, origin: str, folder: str | None) -> Self:
        film = object.__new__(cls)
        film._core, film._text, film._origin, film._folder = core, text, origin, folder
        return film

    @classmethod
    def _parsed(cls, text: str, origin: str, folder: str | None) -> Self:
        return cls._made(_magsplice.Film.parse(text, origin, folder), text, origin, folder)

    @classmethod
    def from_dict(
        cls, layout: Mapping[str, Any], *, folder: str | os.PathLike[str] | None = None
    ) -> Self:
        """Film of a layout file given as a dictionary; `to_dict` is the inverse.

        Parameters
        ----------
        layout : mapping
            The keys and tables of a layout file, such as ``{"name": "one", "tile": [...]}``. Tables
            may also be `Tile`, `Ideal` and `Volume`, and arrays stand for lists. ``format`` may be
            left out, and keys with the value None count as left out.
        folder : str or path, optional
            Folder of files that the layout names. Default: the working folder.

        Raises
        ------
        LayoutError
            If it is no layout.
        """
        tables = {"format": 1, **{key: table_of(part) for key, part in layout.items()}}
        name = tables.get("name")
        origin = str(name or "layout")
        return cls._parsed(
            _toml.text_of(tables), origin, None if folder is None else os.fspath(folder)
        )

    def to_dict(self) -> dict[str, Any]:
        """Layout in the plain form: one entry of ``tile`` for each tile, all keys as in a file."""
        layout: dict[str, Any] = json.loads(self._core.to_json())
        return layout

    def replace(self, **tables: Any) -> Self:
        """Film with other tables or keys.

        Parameters
        ----------
        **tables
            Keys of a layout file with their new values: ``name``, ``description``, ``ideal``,
            ``volume``, ``material``, ``tolerance``, ``design``, ``sensor``, ``elastomer``,
            ``expect``, and ``tile`` with the tiles. None removes a table.

        Examples
        --------
        >>> volume = film.to_dict()["volume"]  # doctest: +SKIP
        >>> finer = film.replace(volume={**volume, "step_mm": 0.25})  # doctest: +SKIP
        """
        unknown = [key for key, table in tables.items() if table is None and key not in _KEYS]
        if unknown:
            raise TypeError(
                f"{unknown[0]} is no key of a layout, must be one of {', '.join(_KEYS)}"
            )
        return type(self).from_dict({**self.to_dict(), **tables}, folder=self._folder)

    def to_toml(self, *, compact: bool = True) -> str:
        """Layout as TOML, which the program and `loads` read.

        Parameters
        ----------
        compact : bool
            Whether tiles that are mirror images of others are left out. Otherwise there is one
            ``[[tile]]`` for each tile.
        """
        return self._core.to_toml(compact)

    def save(self, path: str | os.PathLike[str], *, compact: bool = True) -> None:
        """Writes the layout as TOML; see `to_toml`. An existing file is replaced."""
        Path(path).write_text(self.to_toml(compact=compact), encoding="utf-8")

    def __reduce__(self) -> tuple[Callable[..., Self], tuple[str, str, str | None]]:
        # The text makes the same film bit for bit. Files that it names must be in reach.
        return type(self)._parsed, (self._text, self._origin, self._folder)

    def __eq__(self, other: object) -> bool:
        """Whether the layouts have the same text, and their files the same folder."""
        if not isinstance(other, LayoutFilm):
            return NotImplemented
        return (self._text, self._folder) == (other._text, other._folder)

    def __hash__(self) -> int:
        return hash((self._text, self._folder))

    def __len__(self) -> int:
        return len(self._core)

    def __repr__(self) -> str:
        return f"<magsplice.Film {self.name!r}: {len(self)} tiles, sha256 {self.sha256[:12]}>"

    @property
    def name(self) -> str:
        """Name of the layout."""
        return self._core.name

    @property
    def description(self) -> str | None:
        """Text of the author about the layout."""
        return self._core.description

    @property
    def history(self) -> list[str]:
        """Steps that led to the layout, one text each."""
        return self._core.history

    @property
    def sha256(self) -> str:
        """SHA-256 of the text of the layout, in hexadecimal."""
        return self._core.sha256

    @property
    def findings(self) -> list[str]:
        """Properties that are allowed but usually a mistake, one sentence each."""
        return self._core.findings

    @cached_property
    def tiles(self) -> Tiles:
        """All tiles, repetitions written out."""
        return Tiles(*self._core.tiles())

    @property
    def ideal(self) -> Ideal | None:
        """The ideal film; None if the layout has none."""
        ideal = self._core.ideal
        return None if ideal is None else Ideal(*ideal)

    @property
    def volume(self) -> Volume | None:
        """The working volume; None if the layout has none."""
        volume = self._core.volume
        if volume is None:
            return None
        *_, lower, upper, step, reference = volume
        x, y, z = zip(lower, upper, strict=True)
        return Volume(x, y, z, step[0] if len(set(step)) == 1 else step, reference)

    @property
    def grid(self) -> Grid | None:
        """The grid of the working volume; None if the layout has none."""
        volume = self._core.volume
        return None if volume is None else Grid(*volume[:3])

    @property
    def reference_mm(self) -> Vector | None:
        """Point of the working volume from which displacements count, in millimetres."""
        volume = self._core.volume
        return None if volume is None else volume[-1]
