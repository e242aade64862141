"""Expectations of a film, and their outcomes."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import numpy as np

from magsplice._layout import Floats, Vector
from magsplice._recoil import RecoilEstimate
from magsplice._results import Result, key

Status = Literal["ok", "failed", "error"]

#: Columns of a baseline.
_BASELINE = ("x_mm", "y_mm", "z_mm", "bx_t", "by_t", "bz_t")


class Percentile(Result):
    """A percentile of films as made."""

    per_cent: float = key("Which percentile.")
    value: float = key("Its estimate.")
    samples: int = key("Number of samples.")


class Outcome(Result):
    """An expectation of a layout with its value."""

    expectation: str = key("Key in the layout file, such as ``uniformity_rmse.r_x``.")
    status: Status = key(
        "Whether the bound is kept (ok), broken (failed), or could not be checked (error)."
    )
    error: str | None = key("The reason why it cannot be evaluated, or None.")
    value: float | None = key(
        """Computed value, in the unit of the key. For films as made, the limit of the percentile
        that is compared with the bound."""
    )
    at_most: float | None = key("Upper bound, if any.")
    at_least: float | None = key("Lower bound, if any.")
    margin: float | None = key("Distance from the bound; negative if the value breaks it.")
    at_mm: Vector | None = key("Point of the largest difference from the baseline, in millimetres.")
    tile: str | None = key("Tile nearest to the working volume.")
    percentile: Percentile | None = key("Percentile of films as made.", Percentile)


class Check(Result):
    """Expectations of a film with their values."""

    file: str = key("Name of the text of the layout.")
    status: Status = key("Worst status of the expectations; also ``failed`` with findings.")
    error: str | None = key("Always None: a film has a valid layout.")
    layout: str = key("Name of the layout.")
    sha256: str = key("SHA-256 of the text of the layout.")
    tiles: int = key("Number of tiles.")
    findings: list[str] = key("Allowed properties that are usually a mistake.")
    expectations: list[Outcome] = key("One for each bound of ``[expect]``.", Outcome)
    recoil_estimates: list[RecoilEstimate] | None = key(
        "The effect of recoil to first order; None without a permeability.", RecoilEstimate
    )

    def __getitem__(self, expectation: str) -> Outcome:
        """Outcome of an expectation, by its key."""
        by_key = {found.expectation: found for found in self.expectations}
        if expectation not in by_key:
            raise KeyError(
                f"{expectation}: must be one of {', '.join(by_key) or 'no expectations'}"
            )
        return by_key[expectation]


def read_baseline(path: Path) -> tuple[Floats, Floats] | str:
    """Points in millimetres and B in tesla, as written by ``magsplice field``, or the fault."""
    try:
        with path.open(encoding="utf-8") as file:
            names = [name.strip() for name in file.readline().split(",")]
            absent = [name for name in _BASELINE if name not in names]
            if absent:
                columns = f"{', '.join(absent)}, must have {','.join(_BASELINE)}"
                raise ValueError(f"{path}: line 1: no column {columns}")
            rows = np.loadtxt(file, delimiter=",", ndmin=2)
    except (OSError, ValueError) as error:
        return f"cannot read the baseline: {error}"
    rows = rows[:, [names.index(name) for name in _BASELINE]]
    return np.ascontiguousarray(rows[:, :3]), np.ascontiguousarray(rows[:, 3:])
