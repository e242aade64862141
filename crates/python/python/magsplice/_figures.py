"""Figures of a film: measures of its decoupling, and the statistics of films as made."""

from __future__ import annotations

from typing import Any, Generic, TypeVar

from magsplice._results import PerAxis, PerParameter, Result, estimate_text, key

T = TypeVar("T")


class Estimate(Result):
    """A value estimated from samples, with its interval of 95 % confidence."""

    value: float = key("The estimate.")
    interval: tuple[float, float] = key("Ends of the interval; infinite with too few samples.")

    @property
    def low(self) -> float:
        """Lower end of the interval."""
        return self.interval[0]

    @property
    def high(self) -> float:
        """Upper end of the interval."""
        return self.interval[1]

    def __repr__(self) -> str:
        return estimate_text({"value": self.value, "interval": self.interval})


class Statistics(Result):
    """Mean and percentiles of samples, with intervals of 95 %."""

    count: int = key("Number of samples.")
    mean: Estimate = key("Mean.", Estimate)
    p1: Estimate = key("1st percentile.", Estimate)
    p5: Estimate = key("5th percentile.", Estimate)
    p50: Estimate = key("Median.", Estimate)
    p95: Estimate = key("95th percentile.", Estimate)
    p99: Estimate = key("99th percentile.", Estimate)


class SampledFigure(Statistics):
    """A figure of films as made."""

    nominal: float = key("The figure of the film as ordered.")


def _figure(numbers: dict[str, Any]) -> Statistics:
    return SampledFigure(numbers) if "nominal" in numbers else Statistics(numbers)


class Figures(Result, Generic[T]):
    """Figures of a film over points of its working volume: numbers or statistics."""

    uniformity_rmse: PerParameter[T | None] = key(
        "Uniformity RMSE of R_x, R_y, S_z; None where planes have one point each.", _figure
    )
    displacement_rmse_mm: PerAxis[T] = key("RMSE of the displacement, in millimetres.", _figure)
    amplitude: T = key("Best-fit amplitude against the ideal film.", _figure)
