"""Forces and torques of tiles on each other, and orders in which they are laid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from magsplice import _magsplice
from magsplice._arguments import whole
from magsplice._arrow import Column, Table, split
from magsplice._layout import Floats, Vector
from magsplice._layout_film import LayoutFilm
from magsplice._numbers import Numbers

_FORCE = ("force_x_n", "force_y_n", "force_z_n")
_TORQUE = ("torque_x_n_mm", "torque_y_n_mm", "torque_z_n_mm")


@dataclass(frozen=True, eq=False, repr=False)
class _Loads(Numbers, Table):
    """Forces and torques, one row for each tile."""

    names: list[str]
    force_n: Floats
    torque_n_mm: Floats

    def columns(self) -> dict[str, Column]:
        """Columns name, force_x_n, ..., torque_x_n_mm, ..."""
        loads = {**split(_FORCE, self.force_n), **split(_TORQUE, self.torque_n_mm)}
        return {"name": self.names, **loads}


@dataclass(frozen=True, eq=False, repr=False)
class LayingOrder(_Loads):
    """An order in which tiles are laid, each at its place, where it is glued.

    The holding of a step is the magnitude of the force on its tile by those that lie already. That
    of an order is the largest of its steps. A table of the steps.

    Attributes
    ----------
    names : list[str]
        Tile of each step.
    force_n : ndarray
        Force on the tile of each step by those laid before, in newton, shape (n, 3).
    torque_n_mm : ndarray
        Torque about the centre of the tile, in newton millimetres, shape (n, 3).
    holding_n : float
        Holding of the order, in newton.
    given_holding_n : float
        Holding of the order of the layout file.
    bound_n : float | None
        No order has a smaller holding; None unless the order was searched.
    greedy_holding_n : float | None
        Holding of the order that is built backwards, tile by tile; None unless it was searched.
    """

    holding_n: float
    given_holding_n: float
    bound_n: float | None
    greedy_holding_n: float | None

    @property
    def hardest_step(self) -> int:
        """Step of the largest force, from 0."""
        return int(np.argmax(np.linalg.norm(self.force_n, axis=1)))

    def to_dict(self) -> dict[str, Any]:
        """Holdings by name; for JSON."""
        return {
            "steps": len(self.names),
            "hardest_step": self.hardest_step,
            "hardest_tile": self.names[self.hardest_step],
            "holding_n": self.holding_n,
            "given_holding_n": self.given_holding_n,
            "bound_n": self.bound_n,
            "greedy_holding_n": self.greedy_holding_n,
        }


@dataclass(frozen=True, eq=False, repr=False)
class Forces(_Loads):
    """The load on each tile of a film by all others. A table of the tiles.

    Attributes
    ----------
    names : list[str]
        Names of the tiles.
    force_n : ndarray
        Force in newton, shape (n, 3).
    torque_n_mm : ndarray
        Torque about the centre of the tile, in newton millimetres, shape (n, 3).
    sum_force_n : (float, float, float)
        Sum of all forces: zero but for round-off.
    sum_torque_n_mm : (float, float, float)
        Sum of all torques about the origin: zero but for round-off.
    order : LayingOrder | None
        Loads while the tiles are laid; None unless an order was asked for.
    recoil_change_n : float | None
        Largest change of the force on a tile by recoil; None without recoil.
    recoil_error_n : float | None
        Estimate of the largest error of such a force, from two divisions of the tiles.
    """

    sum_force_n: Vector
    sum_torque_n_mm: Vector
    order: LayingOrder | None
    recoil_change_n: float | None
    recoil_error_n: float | None

    def to_dict(self) -> dict[str, Any]:
        """Largest loads by name; for JSON."""
        largest: dict[str, Any] = {}
        for key, loads in (("force_n", self.force_n), ("torque_n_mm", self.torque_n_mm)):
            magnitudes = np.linalg.norm(loads, axis=1)
            largest[f"largest_{key}"] = float(magnitudes.max())
            largest[f"tile_of_largest_{key}"] = self.names[int(magnitudes.argmax())]
        order = {} if self.order is None else self.order.to_dict()
        recoil = {}
        if self.recoil_change_n is not None:
            recoil = {
                "recoil_change_n": self.recoil_change_n,
                "recoil_error_n": self.recoil_error_n,
            }
        return {"tiles": len(self.names), **largest, **recoil, **order}


class LaidFilm(LayoutFilm):
    """A film whose tiles act on each other while they are laid."""

    def forces(
        self,
        order: Literal["given", "least"] | Sequence[str] | None = None,
        *,
        seed: int = 1,
        turned_error: float = 1e-9,
    ) -> Forces:
        """Forces and torques of the tiles on each other, as ``magsplice forces`` prints them.

        Tiles with parallel edges have them in closed form, exact to round-off, also where they
        touch. Tiles with a recoil permeability are divided into 27 cells or more, with the
        polarization that they have in the whole film.

        Parameters
        ----------
        order : {"given", "least"} or sequence of str, optional
            Order of laying: that of the layout, the one with the least holding that is found, or
            the names of all tiles. Default: none.
        seed : int
            Seed of the random numbers of the search for the least holding.
        turned_error : float
            Largest relative error of the force of two tiles that are turned against each other,
            from 1e-13 to 0.1.

        Raises
        ------
        ValueError
            If the order has not each tile once, or `turned_error` is out of range.
        MagspliceError
            If there are more than 4000 tiles or cells, or the force of turned tiles is not known to
            `turned_error`.
        """
        if not 1e-13 <= turned_error <= 0.1:
            raise ValueError(f"turned_error = {turned_error}, must be from 1e-13 to 0.1")
        seed = whole("seed", seed, 0)
        names = self.tiles.names
        steps = None if order is None or order == "least" else _steps(order, names)
        found = _magsplice.forces(
            self._core, turned_error, steps, seed if order == "least" else None
        )
        laying = None
        if order is not None:
            laid = found["order"]
            laying = LayingOrder(
                *_loads(laid["steps"]),
                laid["holding_n"],
                laid["given_holding_n"],
                laid.get("bound_n"),
                laid.get("greedy_holding_n"),
            )
        recoil = found.get("recoil", {"change_n": None, "error_n": None})
        return Forces(
            *_loads(found["tiles"]),
            found["sum"]["force_n"],
            found["sum"]["torque_n_mm"],
            laying,
            recoil["change_n"],
            recoil["error_n"],
        )


def _loads(tiles: list[dict[str, Any]]) -> tuple[list[str], Floats, Floats]:
    """Names, forces and torques of tiles."""
    force_n, torque_n_mm = (
        np.array([tile[key] for tile in tiles], dtype=float).reshape(-1, 3)
        for key in ("force_n", "torque_n_mm")
    )
    return [tile["name"] for tile in tiles], force_n, torque_n_mm


def _steps(order: str | Sequence[str], names: list[str]) -> list[int]:
    """Index of the tile of each step."""
    if order == "given":
        return list(range(len(names)))
    laid = [order] if isinstance(order, str) else list(order)
    index = {name: number for number, name in enumerate(names)}
    wrong = [name for name in laid if name not in index]
    if isinstance(order, str) or wrong:
        shown = wrong[0] if wrong else order
        raise ValueError(f'order: {shown!r}, must be "given", "least" or the names of all tiles')
    twice = next((name for step, name in enumerate(laid) if name in laid[:step]), None)
    if twice is not None:
        raise ValueError(f"order: {twice!r} is laid twice")
    if len(laid) < len(names):
        raise ValueError(f"order: has {len(laid)} tiles, must have all {len(names)}")
    return [index[name] for name in laid]
