"""Expectations of a film, and whether it meets them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from magsplice import _magsplice
from magsplice._layout import Floats, Vector
from magsplice._layout_film import LayoutFilm
from magsplice._numbers import Numbers

Status = Literal["ok", "failed", "error"]

#: Columns of a baseline.
_BASELINE = ("x_mm", "y_mm", "z_mm", "bx_t", "by_t", "bz_t")


@dataclass(frozen=True)
class Outcome:
    """One expectation of a layout with its value.

    Attributes
    ----------
    expectation : str
        Key in the layout file, such as ``uniformity_rmse.r_x``.
    error : str | None
        Why it cannot be evaluated; None if it can.
    value : float | None
        Computed value, in the unit of the key. For films that are made, the limit of the percentile
        that is compared with the bound.
    at_most : float | None
        Upper bound, if it has one.
    at_least : float | None
        Lower bound, if it has one.
    margin : float | None
        Distance of the value from its bound; negative if the value breaks it.
    at_mm : (float, float, float) | None
        Point of the largest difference from the baseline, in millimetres.
    tile : str | None
        Tile that is nearest to the working volume.
    percentile : tuple[float, float, int] | None
        Which percentile of films that are made, its estimate, and the number of samples.
    """

    expectation: str
    error: str | None
    value: float | None
    at_most: float | None
    at_least: float | None
    margin: float | None
    at_mm: Vector | None
    tile: str | None
    percentile: tuple[float, float, int] | None

    @property
    def status(self) -> Status:
        """Whether the bound is kept (ok), broken (failed), or could not be checked (error)."""
        if self.margin is None:
            return "error"
        return "ok" if self.margin >= 0 else "failed"


@dataclass(frozen=True, repr=False)
class Check(Numbers):
    """Expectations of a film with their values.

    Attributes
    ----------
    outcomes : list[Outcome]
        One for each bound of ``[expect]``.
    """

    outcomes: list[Outcome]

    @property
    def status(self) -> Status:
        """Worst status of all expectations; ok without any."""
        found = {outcome.status for outcome in self.outcomes}
        return "error" if "error" in found else "failed" if "failed" in found else "ok"

    def __getitem__(self, expectation: str) -> Outcome:
        """Outcome of an expectation, by its key."""
        by_key = {found.expectation: found for found in self.outcomes}
        if expectation not in by_key:
            raise KeyError(
                f"{expectation}: must be one of {', '.join(by_key) or 'no expectations'}"
            )
        return by_key[expectation]

    def to_dict(self) -> dict[str, Any]:
        """Status, value and bound by expectation; for JSON."""
        return {
            found.expectation: found.error
            or f"{found.status}: {found.value:.6g}, must be "
            + (
                f"at most {found.at_most}"
                if found.at_least is None
                else f"at least {found.at_least}"
            )
            for found in self.outcomes
        }


class CheckedFilm(LayoutFilm):
    """A film with expectations."""

    def check(self) -> Check:
        """Values of everything that ``[expect]`` bounds, as ``magsplice check`` compares them.

        Each expectation is evaluated by itself, so that one that cannot be does not hide the
        others. Nothing is written: a baseline is read, and never replaced.

        Returns
        -------
        Check
            ``film.check().status`` is ``"ok"`` if the film meets all expectations.

        Raises
        ------
        MagspliceError
            If the film cannot be evaluated.
        """
        name = _magsplice.baseline_file(self._core)
        held, fault = None, None
        if name is not None:
            try:
                held = _baseline(Path(self._folder or ".") / name)
            except (OSError, ValueError) as error:
                fault = f"cannot read the baseline: {error}"
        outcomes = [_outcome(numbers) for numbers in _magsplice.check(self._core, held)]
        if fault is not None:
            outcomes = [
                replace(found, error=fault) if found.expectation == "field" else found
                for found in outcomes
            ]
        return Check(outcomes)


def _outcome(numbers: dict[str, Any]) -> Outcome:
    percentile = numbers.get("percentile")
    return Outcome(
        expectation=numbers["expectation"],
        error=numbers["error"],
        value=numbers["value"],
        at_most=numbers.get("at_most"),
        at_least=numbers.get("at_least"),
        margin=numbers["margin"],
        at_mm=numbers.get("at_mm"),
        tile=numbers.get("tile"),
        percentile=None if percentile is None else tuple(percentile.values()),
    )


def _baseline(path: Path) -> tuple[Floats, Floats]:
    """Points in millimetres and B in tesla of a baseline, as ``magsplice field`` writes it."""
    with path.open(encoding="utf-8") as file:
        names = [name.strip() for name in file.readline().split(",")]
        absent = [name for name in _BASELINE if name not in names]
        if absent:
            raise ValueError(
                f"{path}: line 1: no column {', '.join(absent)}, must have {','.join(_BASELINE)}"
            )
        rows = np.loadtxt(file, delimiter=",", ndmin=2)
    rows = rows[:, [names.index(name) for name in _BASELINE]]
    return np.ascontiguousarray(rows[:, :3]), np.ascontiguousarray(rows[:, 3:])
