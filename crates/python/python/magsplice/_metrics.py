"""Errors of a film that a search compares."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from magsplice._layout import PerParameter, Vector
from magsplice._numbers import Numbers


@dataclass(frozen=True, repr=False)
class Metrics(Numbers):
    """Errors of a film over a grid, from its exact field.

    Attributes
    ----------
    points : int
        Number of points of the grid.
    uniformity_rmse : (float | None, float | None, float | None)
        Uniformity RMSE of R_x, R_y, S_z; None where planes have one point each.
    ideal_rmse : (float, float, float)
        RMSE of the parameters' changes against the ideal film.
    displacement_rmse_mm : (float, float, float)
        RMSE of the displacement along x, y, z, in millimetres.
    amplitude : float
        Best-fit amplitude against the ideal film.
    scaled_relative_rmse : float | None
        RMSE of B against the ideal film times the amplitude, relative to the latter.
    """

    points: int
    uniformity_rmse: PerParameter
    ideal_rmse: Vector
    displacement_rmse_mm: Vector
    amplitude: float
    scaled_relative_rmse: float | None

    @classmethod
    def of(cls, numbers: Any) -> Metrics:
        """The errors with the numbers of the library."""
        triples = ("uniformity_rmse", "ideal_rmse", "displacement_rmse_mm")
        return cls(**{**numbers, **{key: tuple(numbers[key].values()) for key in triples}})

    def to_dict(self) -> dict[str, Any]:
        """Numbers by name; for JSON."""
        return dict(vars(self))
