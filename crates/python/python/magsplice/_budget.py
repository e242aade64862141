"""The displacement error of films as made, split into its causes."""

from __future__ import annotations

import numpy as np

from magsplice._arrow import Column, Table, split
from magsplice._figures import Estimate
from magsplice._results import PerAxis, Result, key
from magsplice._source import OfFilm


class BudgetPart(Result):
    """A part of a budget."""

    name: str = key("Cause in words.")
    mean_square_mm2: PerAxis[float] = key(
        """Mean square of the displacement error along x, y, z, in square millimetres. A part that
        compensates other parts is negative."""
    )
    share: PerAxis[float] = key("Share of the total.")


class Improvement(Result):
    """The reduction of the error by halved errors of a cause or tile."""

    name: str = key("Cause in words, or name of a tile.")
    saved_mm2: PerAxis[float] = key("Reduction of the total, in square millimetres.")


class Budget(OfFilm, Table):
    """The expected mean square of the displacement error, divided by its causes.

    A table of the parts: ``polars.DataFrame(budget)``.
    """

    seed: int = key("Seed of the samples.")
    samples: int = key("Number of samples that checked or computed the division.")
    is_first_order: bool = key(
        """Whether the parts are to first order, by exact derivatives. Otherwise each part comes
        from samples of its cause alone, because exact samples differ from the first order by more
        than 5 %."""
    )
    parts: list[BudgetPart] = key("Parts that add up to the total.", BudgetPart)
    endless_pattern_mm2: PerAxis[float] | None = key(
        "Mean square of the endless splicing pattern; None if unknown."
    )
    no_pattern: str | None = key("The reason why it is unknown.")
    total_mm2: PerAxis[float] = key("Expected mean square, in square millimetres.")
    sampled_mm2: PerAxis[float] = key("Mean square by exact samples.")
    mean_square_ratio: PerAxis[Estimate | None] = key(
        "Mean square of exact samples over first order; None where the first order is 0.", Estimate
    )
    worth_halving: list[Improvement] = key("Savings by cause, largest first.", Improvement)
    tiles_worth_halving: list[Improvement] = key(
        """Savings by halving all errors of a tile, largest first; empty unless
        `is_first_order`.""",
        Improvement,
    )

    def columns(self) -> dict[str, Column]:
        """Columns part, x_mm2, y_mm2, z_mm2."""
        rows = np.array([part.mean_square_mm2 for part in self.parts])
        names: Column = [part.name for part in self.parts]
        return {"part": names, **split(("x_mm2", "y_mm2", "z_mm2"), rows)}
