"""Results of searches for films."""

from __future__ import annotations

from magsplice._figures import Figures, Statistics
from magsplice._results import PerParameter, Result, key


class Metrics(Figures[float]):
    """Errors of a film over a grid, from its exact field."""

    points: int = key("Number of points of the grid.")
    ideal_rmse: PerParameter[float] = key("RMSE of the parameters' changes against the ideal film.")
    scaled_relative_rmse: float | None = key("Relative RMSE of B against the scaled ideal B.")


class MadeFilms(Result):
    """Errors of films as made, from the film before a search and from the film found."""

    samples: int = key("Number of samples of each film.")
    seed: int = key("Seed of the samples, the same for both films.")
    preset: str | None = key("Preset of the errors; None for the errors of ``[tolerance]``.")
    before: Figures[Statistics] | None = key(
        "Errors of the film before the search; None without an initial layout.", Figures
    )
    after: Figures[Statistics] = key("Errors of the film found.", Figures)


class OutOfRange(Result):
    """Points of the working volume where the field leaves the range of the sensor."""

    points: int = key("Number of these points.")
    of: int = key("Number of all points.")
    axis: str = key("Axis along which a reading exceeds the range most, as a ratio.")
    largest_t: float = key("Largest magnitude of a reading along this axis, without the limit.")
    range_t: float = key("Range along this axis.")
    sensor: int | None = key("Number of the sensor of a head, from 1; None for a single sensor.")


class SearchStage(Result):
    """A stage of a search."""

    stage: str = key("Name of the stage.")
    uniformity_rmse: PerParameter[float | None] = key("Uniformity RMSE over the volume at the end.")
