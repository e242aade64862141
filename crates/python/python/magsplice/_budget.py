"""Where the displacement error of films that are made comes from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from magsplice import _magsplice
from magsplice._arguments import whole
from magsplice._arrow import Column, Table, split
from magsplice._layout import Vector
from magsplice._layout_film import LayoutFilm
from magsplice._numbers import Numbers
from magsplice._samples import Estimate, Preset


class BudgetPart(NamedTuple):
    """A part of a budget, or what halving a cause saves.

    Attributes
    ----------
    name : str
        Cause in words, or name of a tile.
    mean_square_mm2 : (float, float, float)
        Mean square of the displacement error along x, y, z, in square millimetres. A part that
        compensates others is negative.
    """

    name: str
    mean_square_mm2: Vector


@dataclass(frozen=True, eq=False, repr=False)
class Budget(Numbers, Table):
    """The expected mean square of the displacement error, divided by where it comes from.

    A table of the parts: ``polars.DataFrame(budget)``.

    Attributes
    ----------
    seed : int
        Seed of the samples.
    samples : int
        Number of samples that checked the division, or divided.
    is_first_order : bool
        Whether the parts are to first order, by exact derivatives; otherwise each is by samples of
        its cause alone, because exact samples differ from the first order by more than 5 %.
    parts : list[BudgetPart]
        Parts, which add up to the total.
    endless_pattern_mm2 : (float, float, float) | None
        Mean square of the splicing pattern without end; None if it is not known.
    total_mm2 : (float, float, float)
        Expected mean square along x, y, z, in square millimetres.
    sampled_mm2 : (float, float, float)
        The same by exact samples.
    mean_square_ratio : tuple of 3 Estimate | None
        Mean square of exact samples over that to first order, along x, y, z; None where it is 0.
    worth_halving : list[BudgetPart]
        What halving each cause saves, the most first.
    tiles_worth_halving : list[BudgetPart]
        What halving all errors of a tile saves, the most first; empty unless `is_first_order`.
    no_pattern : str | None
        Why the error of the splicing pattern is not known; None if it is.
    """

    seed: int
    samples: int
    is_first_order: bool
    parts: list[BudgetPart]
    endless_pattern_mm2: Vector | None
    total_mm2: Vector
    sampled_mm2: Vector
    mean_square_ratio: tuple[Estimate | None, ...]
    worth_halving: list[BudgetPart]
    tiles_worth_halving: list[BudgetPart]
    no_pattern: str | None

    def to_dict(self) -> dict[str, Any]:
        """Parts by name, then the totals, in square millimetres; for JSON."""
        return {
            **{part.name: part.mean_square_mm2 for part in self.parts},
            "total_mm2": self.total_mm2,
            "sampled_mm2": self.sampled_mm2,
            "is_first_order": self.is_first_order,
        }

    def columns(self) -> dict[str, Column]:
        """Columns part, x_mm2, y_mm2, z_mm2."""
        rows = np.array([part.mean_square_mm2 for part in self.parts])
        names: Column = [part.name for part in self.parts]
        return {"part": names, **split(("x_mm2", "y_mm2", "z_mm2"), rows)}


class BudgetedFilm(LayoutFilm):
    """A film with an error budget."""

    def budget(
        self, samples: int = 200, *, preset: Preset | None = None, seed: int | None = None
    ) -> Budget:
        """Where the displacement error of films that are made comes from.

        Its mean square is divided into the splicing pattern, the end of the film, and each cause of
        ``[tolerance]``, as ``magsplice budget`` does.

        Parameters
        ----------
        samples : int
            Number of samples that check the division, or divide, from 20 to 1 000 000.
        preset : {"by-hand", "workshop", "jig"}, optional
            Errors of every tile to assume instead of those of the layout.
        seed : int, optional
            Seed. Default: that of the layout, 1 if it states none.

        Raises
        ------
        ValueError
            If `samples` is out of range.
        MagspliceError
            If the layout has no errors, ideal film or working volume, or a sample has no errors.
        """
        samples = whole("samples", samples, 20, 1_000_000)
        seed = (self._core.sampling or (0, 1))[1] if seed is None else whole("seed", seed, 0)
        numbers = _magsplice.budget(self._core, preset, seed, samples)
        pattern = numbers["endless_pattern_mm2"]
        ratios = numbers["mean_square_ratio"].values()
        return Budget(
            seed=seed,
            samples=samples,
            is_first_order=numbers["is_first_order"],
            parts=_parts(numbers["parts"], "mean_square_mm2"),
            endless_pattern_mm2=None if pattern is None else tuple(pattern.values()),
            total_mm2=tuple(numbers["total_mm2"].values()),
            sampled_mm2=tuple(numbers["sampled_mm2"].values()),
            mean_square_ratio=tuple(None if r is None else Estimate.of(r) for r in ratios),
            worth_halving=_parts(numbers["worth_halving"], "saved_mm2"),
            tiles_worth_halving=_parts(numbers["tiles_worth_halving"], "saved_mm2"),
            no_pattern=numbers.get("no_pattern"),
        )


def _parts(named: list[dict[str, Any]], key: str) -> list[BudgetPart]:
    return [BudgetPart(part["name"], tuple(part[key].values())) for part in named]
