"""Forces and torques of tiles on each other, and placement orders."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from magsplice._arrow import Column, Table, split
from magsplice._layout import Floats, Vector
from magsplice._results import Result, key
from magsplice._source import OfLayout

_FORCE = ("force_x_n", "force_y_n", "force_z_n")
_TORQUE = ("torque_x_n_mm", "torque_y_n_mm", "torque_z_n_mm")


class Load(Result):
    """A force and a torque."""

    name: str | None = key("Name of the tile; None for the sum of all tiles.")
    force_n: Vector = key("Force, in newton.")
    torque_n_mm: Vector = key(
        """Torque in newton millimetres, about the centre of the tile; for the sum of all tiles,
        about the origin."""
    )


class _Loads(Table):
    """Forces and torques, one row for each tile."""

    #: Key of the rows.
    _rows: str

    @property
    def _loads(self) -> list[Load]:
        loads: list[Load] = getattr(self, self._rows)
        return loads

    @property
    def names(self) -> list[str]:
        """Names of the tiles."""
        return [load.name or "" for load in self._loads]

    @property
    def force_n(self) -> Floats:
        """Force on each tile in newton, shape (n, 3)."""
        return np.array([load.force_n for load in self._loads], dtype=float).reshape(-1, 3)

    @property
    def torque_n_mm(self) -> Floats:
        """Torque about the centre of each tile in newton millimetres, shape (n, 3)."""
        return np.array([load.torque_n_mm for load in self._loads], dtype=float).reshape(-1, 3)

    def columns(self) -> dict[str, Column]:
        """Columns name, force_x_n, ..., torque_x_n_mm, ..."""
        loads = {**split(_FORCE, self.force_n), **split(_TORQUE, self.torque_n_mm)}
        return {"name": self.names, **loads}


class PlacementOrder(Result, _Loads):
    """A placement order of tiles, each glued at its place.

    The holding force of a step is the magnitude of the force on its tile by the tiles already
    placed. The holding force of an order is the largest of its steps. A table of the steps.
    """

    source: str = key("``given``, ``least`` or ``stated``.")
    holding_n: float = key("Holding force of the order, in newton.")
    hardest_step: int = key("Step of the largest force, from 1.")
    given_holding_n: float = key("Holding force of the order of the layout file.")
    bound_n: float | None = key("Lower bound for all orders, if the order was searched.")
    greedy_holding_n: float | None = key("Holding force of the order built backwards, if searched.")
    seed: int | None = key("Seed of the search.")
    steps: list[Load] = key("Load on the tile of each step by the tiles placed before.", Load)

    _rows = "steps"


class Forces(OfLayout, _Loads):
    """The load on each tile of a film by all others. A table of the tiles."""

    recoil: dict[str, float] | None = key(
        """Number of ``cells``, ``level`` of their division, and in newton ``change_n``, the largest
        change of the force on a tile by recoil, and ``error_n``, an estimate of the largest error
        of this force, from two divisions of the tiles; None without recoil."""
    )
    tiles: list[Load] = key("Load on each tile by all others.", Load)
    sum: Load = key("Sum of all loads, zero up to round-off without iron.", Load)
    order: PlacementOrder | None = key("Loads in a placement order, if requested.", PlacementOrder)

    _rows = "tiles"


def steps_of(order: str | Sequence[str], names: list[str]) -> list[int]:
    """Index of the tile of each step."""
    placed = [order] if isinstance(order, str) else list(order)
    index = {name: number for number, name in enumerate(names)}
    wrong = [name for name in placed if name not in index]
    if isinstance(order, str) or wrong:
        shown = wrong[0] if wrong else order
        raise ValueError(f'order: {shown!r}, must be "given", "least" or the names of all tiles')
    twice = next((name for step, name in enumerate(placed) if name in placed[:step]), None)
    if twice is not None:
        raise ValueError(f"order: {twice!r} is placed twice")
    if len(placed) < len(names):
        raise ValueError(f"order: has {len(placed)} tiles, must have all {len(names)}")
    return [index[name] for name in placed]
