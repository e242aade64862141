"""The bill of materials of a film."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from magsplice._arrow import Column, Table, split
from magsplice._layout import Vector
from magsplice._results import Result, key, lines


class Part(Result):
    """Identical pieces of magnet: tiles that differ only in position and orientation."""

    part: int = key("Number of the part, from 1; the largest pieces first.")
    count: int = key("Number of pieces.")
    size_mm: Vector = key("Sides, in millimetres.")
    strength_t: float = key("Magnitude of the polarization, in tesla.")
    direction_deg: float | None = key(
        """Angle of the polarization from the first side towards the second, in degrees; None
        without polarization."""
    )
    tilt_deg: float | None = key(
        """Angle of the polarization out of the plane of these sides, in degrees; None without
        polarization."""
    )
    tiles: list[str] = key("Names of its tiles.")
    turned_over: list[str] = key("Names of those of them whose piece lies upside down.")
    sheet_area_mm2: float | None = key(
        """Area of a sheet as thick as the third side, for all pieces with one kerf along each of
        the first two sides, in square millimetres; None without a kerf."""
    )
    bar_length_mm: float | None = key(
        """Length of a bar with the second and third side as its section, for all pieces with one
        kerf each, in millimetres; None without a kerf."""
    )


class Parts(Result, Table):
    """The bill of materials of a film, as in ``magsplice tiles``. A table of the parts.

    ``to_dict()`` also has the layout, as in the JSON of the program.
    """

    name: str = key("Name of the film.")
    kerf_mm: float | None = key("Width of material that a cut removes, in millimetres, if given.")
    parts: list[Part] = key("The parts, largest first.", Part)

    def _shown(self) -> Iterator[tuple[str, Any]]:
        shown = {key: value for key, value in self.to_dict().items() if key in ("name", "kerf_mm")}
        # The names of the tiles are in the table.
        parts = [{**part, "tiles": part["count"]} for part in self.to_dict()["parts"]]
        for part in parts:
            del part["count"], part["turned_over"]
        yield from lines({**shown, "parts": parts})

    def columns(self) -> dict[str, Column]:
        """Columns part, count, a_mm, b_mm, c_mm, strength_t, direction_deg, tilt_deg, tiles, ...

        With a kerf also sheet_area_mm2 and bar_length_mm. Names of tiles are separated by
        semicolons. Angles are NaN for parts without polarization.
        """
        angles = {
            name: np.array([getattr(part, name) for part in self.parts], dtype=float)
            for name in ("direction_deg", "tilt_deg")
        }
        material = {
            name: np.array([getattr(part, name) for part in self.parts], dtype=float)
            for name in ("sheet_area_mm2", "bar_length_mm")
            if self.kerf_mm is not None
        }
        return {
            "part": np.array([part.part for part in self.parts], dtype=np.uint64),
            "count": np.array([part.count for part in self.parts], dtype=np.uint64),
            **split(("a_mm", "b_mm", "c_mm"), np.array([part.size_mm for part in self.parts])),
            "strength_t": np.array([part.strength_t for part in self.parts]),
            **angles,
            "tiles": [";".join(part.tiles) for part in self.parts],
            **material,
            "turned_over": [";".join(part.turned_over) for part in self.parts],
        }
