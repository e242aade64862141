"""Samples of films as made, and their statistics."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from magsplice import _magsplice
from magsplice._arguments import one_of
from magsplice._arrow import Column, Table, split
from magsplice._figures import Estimate, Figures, SampledFigure, Statistics
from magsplice._layout import Floats
from magsplice._results import key
from magsplice._source import OfFilm

if TYPE_CHECKING:
    import xarray

Preset = Literal["by-hand", "workshop", "jig"]


class SampledFilm(OfFilm, Figures[SampledFigure]):
    """Statistics of films as made, of one layout."""

    film: str = key("Hash of all inputs of a sample except the seed.")
    seed: int = key("Seed of the samples.")
    first: int = key("Number of the first sample.")
    count: int = key("Number of samples.")
    overlap_mm: float | None = key(
        """Depth to which tiles overlap in the first 20 samples, in millimetres, because the errors
        of neighbours are independent. 0 without overlaps; None for sorted tiles."""
    )
    in_iron_mm: float | None = key(
        """Depth to which tiles reach into the iron of the layout in the first 20 samples, in
        millimetres; placed tiles cannot. 0 if they do not; None without iron."""
    )
    yield_made: Estimate | None = key(
        "Share that keeps ``[expect.made]``; None without bounds.", Estimate
    )


class Samples(Table):
    """Errors of films as made, of one layout: one row for each film.

    Nineteen of twenty films keep the 95th percentile: ``samples.displacement_mm("x").p95``.

    Attributes
    ----------
    name : str
        Name of the film.
    preset : str | None
        Assumed errors; None for the errors of the layout.
    first : int
        Number of the first sample.
    uniformity_rmse : ndarray
        Uniformity RMSE of R_x, R_y, S_z of each film, shape (n, 3).
    displacement_rmse_mm : ndarray
        RMSE of the displacement along x, y, z of each film, in millimetres, shape (n, 3).
    amplitude : ndarray
        Best-fit amplitude of each film against the ideal film, shape (n,).
    statistics : SampledFilm
        Statistics of the films, and the figures of the film without errors.
    """

    def __init__(
        self, errors: Floats, statistics: dict[str, Any], preset: str | None = None
    ) -> None:
        self.uniformity_rmse, self.displacement_rmse_mm = errors[:, :3], errors[:, 3:6]
        self.amplitude = np.ascontiguousarray(errors[:, 6])
        self.statistics = SampledFilm(statistics)
        self.name, self.first, self.preset = self.statistics.layout, self.statistics.first, preset

    def __len__(self) -> int:
        return len(self.amplitude)

    def displacement_mm(self, axis: str) -> SampledFigure:
        """Statistics of the displacement RMSE along ``"x"``, ``"y"`` or ``"z"``, in millimetres."""
        along: SampledFigure = getattr(
            self.statistics.displacement_rmse_mm, one_of("axis", axis, "xyz")
        )
        return along

    def uniformity(self, parameter: str) -> SampledFigure | None:
        """Statistics of the uniformity RMSE of ``"r_x"``, ``"r_y"`` or ``"s_z"``."""
        name = one_of("parameter", parameter, ("r_x", "r_y", "s_z"))
        of: SampledFigure | None = getattr(self.statistics.uniformity_rmse, name)
        return of

    def to_dict(self) -> dict[str, Any]:
        """The statistics, with the keys of the program's JSON."""
        return self.statistics.to_dict()

    def __repr__(self) -> str:
        return f"<magsplice.Samples>\n{self.statistics}"

    def _repr_html_(self) -> str:
        return self.statistics._repr_html_()

    def columns(self) -> dict[str, Column]:
        """Columns sample, uniformity_r_x, ..., displacement_x_mm, ..., amplitude."""
        return {
            "sample": np.arange(self.first, self.first + len(self), dtype=np.uint64),
            **split(("uniformity_r_x", "uniformity_r_y", "uniformity_s_z"), self.uniformity_rmse),
            **split(
                ("displacement_x_mm", "displacement_y_mm", "displacement_z_mm"),
                self.displacement_rmse_mm,
            ),
            "amplitude": self.amplitude,
        }

    def to_xarray(self) -> xarray.Dataset:
        """Variables uniformity_rmse, displacement_rmse_mm and amplitude along sample."""
        import xarray

        sample = np.arange(self.first, self.first + len(self))
        return xarray.Dataset(
            {
                "uniformity_rmse": (("sample", "parameter"), self.uniformity_rmse),
                "displacement_rmse_mm": (("sample", "axis"), self.displacement_rmse_mm),
                "amplitude": ("sample", self.amplitude),
            },
            {"sample": sample, "parameter": ["r_x", "r_y", "s_z"], "axis": ["x", "y", "z"]},
        )


def statistics(values: ArrayLike) -> Statistics:
    """Mean and percentiles of an array of samples, with intervals of 95 %.

    The interval of the mean assumes normal errors. Intervals of percentiles are order statistics,
    valid for any distribution.

    Raises
    ------
    ValueError
        If there are no samples.
    """
    numbers = _magsplice.statistics(np.ascontiguousarray(values, dtype=np.float64).ravel())
    if numbers is None:
        raise ValueError("there are no samples")
    return Statistics(numbers)
