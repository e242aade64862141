"""Samples of films that are made, and their statistics."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import partial
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from magsplice import _cluster, _magsplice
from magsplice._arguments import LARGEST_SEED, one_of, whole
from magsplice._arrow import Column, Table, split
from magsplice._layout import Floats
from magsplice._layout_film import LayoutFilm
from magsplice._numbers import Numbers

if TYPE_CHECKING:
    import xarray

Preset = Literal["by-hand", "workshop", "jig"]

#: Number of samples and seed of layouts that state none.
_SAMPLING = (1000, 1)

#: Most samples of one call, as of a run of the program.
_MOST_SAMPLES = 10_000_000

#: Most threads, which rayon allows.
_MOST_THREADS = 65_535


class Estimate(NamedTuple):
    """A value estimated from samples, with an interval that holds the true one with 95 %.

    Attributes
    ----------
    value : float
        The estimate.
    low : float
        Lower end of the interval; minus infinity where there are too few samples.
    high : float
        Upper end of the interval; infinity where there are too few samples.
    """

    value: float
    low: float
    high: float

    @classmethod
    def of(cls, numbers: Any) -> Estimate:
        """The estimate with the numbers of the library."""
        return cls(numbers["value"], *numbers["interval"])


@dataclass(frozen=True, repr=False)
class Statistics(Numbers):
    """Mean and percentiles of samples, with intervals of 95 %.

    Attributes
    ----------
    count : int
        Number of samples.
    mean : Estimate
        Mean.
    p1 : Estimate
        1st percentile.
    p5 : Estimate
        5th percentile.
    p50 : Estimate
        Median.
    p95 : Estimate
        95th percentile.
    p99 : Estimate
        99th percentile.
    """

    count: int
    mean: Estimate
    p1: Estimate
    p5: Estimate
    p50: Estimate
    p95: Estimate
    p99: Estimate

    @classmethod
    def _of(cls, numbers: Any) -> Statistics:
        estimates = {key: Estimate.of(value) for key, value in numbers.items() if key != "count"}
        return cls(numbers["count"], **estimates)

    def to_dict(self) -> dict[str, Any]:
        """Numbers by name; estimates as value and ends of the interval."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


@dataclass(frozen=True, eq=False, repr=False)
class Samples(Numbers, Table):
    """Errors of films that are made from one layout: one row for each film.

    The percentiles tell what nineteen of twenty films keep: ``samples.displacement_mm("x").p95``.

    Attributes
    ----------
    name : str
        Name of the film.
    preset : str | None
        Errors that were assumed; None for those of the layout.
    seed : int
        Seed of the samples.
    first : int
        Number of the first sample.
    uniformity_rmse : ndarray
        Uniformity RMSE of R_x, R_y, S_z of each film, shape (n, 3).
    displacement_rmse_mm : ndarray
        RMSE of the displacement along x, y, z of each film, in millimetres, shape (n, 3).
    amplitude : ndarray
        Best-fit amplitude of each film against the ideal film, shape (n,).
    ordered : tuple of 3 ndarrays
        The same three numbers of the film without errors, each with one row.
    """

    name: str
    preset: str | None
    seed: int
    first: int
    uniformity_rmse: Floats
    displacement_rmse_mm: Floats
    amplitude: Floats
    ordered: tuple[Floats, Floats, Floats]

    def __len__(self) -> int:
        return len(self.amplitude)

    def displacement_mm(self, axis: str) -> Statistics:
        """Statistics of the displacement RMSE along ``"x"``, ``"y"`` or ``"z"``, in millimetres."""
        return statistics(self.displacement_rmse_mm[:, "xyz".index(one_of("axis", axis, "xyz"))])

    def uniformity(self, parameter: str) -> Statistics:
        """Statistics of the uniformity RMSE of ``"r_x"``, ``"r_y"`` or ``"s_z"``."""
        names = ("r_x", "r_y", "s_z")
        return statistics(
            self.uniformity_rmse[:, names.index(one_of("parameter", parameter, names))]
        )

    def to_dict(self) -> dict[str, Any]:
        """Medians and 95th percentiles by name; for JSON."""
        uniformity, displacement, amplitude = self.ordered
        along = [self.displacement_mm(axis) for axis in "xyz"]
        return {
            "samples": len(self),
            "seed": self.seed,
            "ordered_displacement_rmse_mm": tuple(displacement[0].tolist()),
            "p50_displacement_rmse_mm": tuple(axis.p50.value for axis in along),
            "p95_displacement_rmse_mm": tuple(axis.p95.value for axis in along),
            "ordered_uniformity_rmse": tuple(uniformity[0].tolist()),
            "p95_uniformity_rmse": tuple(
                self.uniformity(name).p95.value for name in ("r_x", "r_y", "s_z")
            ),
            "ordered_amplitude": float(amplitude[0]),
            "p5_amplitude": statistics(self.amplitude).p5.value,
        }

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


def statistics(values: NDArray[np.float64]) -> Statistics:
    """Mean and percentiles of an array of samples, with intervals of 95 %.

    The interval of the mean is that of normal errors. Those of percentiles lie between order
    statistics, whatever the distribution.

    Raises
    ------
    ValueError
        Without samples.
    """
    numbers = _magsplice.statistics(np.ascontiguousarray(values, dtype=np.float64).ravel())
    if numbers is None:
        raise ValueError("there are no samples")
    return Statistics._of(numbers)


class MadeFilm(LayoutFilm):
    """A film with the films that are made from it."""

    def tolerance(
        self,
        samples: int | None = None,
        *,
        preset: Preset | None = None,
        seed: int | None = None,
        first: int = 0,
        threads: int | None = None,
        client: Any = None,
        partition: int | None = None,
        progress: Callable[[int, int], Any] | None = None,
    ) -> Samples:
        """Decoupling errors of films that are made, with the errors of ``[tolerance]``.

        Sample number i depends on the seed and on i alone. Any division of the samples into calls,
        threads or workers gives the same bits.

        Parameters
        ----------
        samples : int, optional
            Number of films, up to 10 million. Default: that of the layout, 1000 if it states none.
        preset : {"by-hand", "workshop", "jig"}, optional
            Errors of every tile to assume instead of those of the layout.
        seed : int, optional
            Seed. Default: that of the layout, 1 if it states none.
        first : int
            Number of the first sample.
        threads : int, optional
            Number of threads. Default: all processors, and 1 in a task of a client.
        client : distributed.Client, optional
            Dask client on whose workers the samples are computed. A worker that is lost costs time
            and no sample. docs/python-cluster.md describes clusters.
        partition : int, optional
            Number of samples of a task of the client. Default: so many that there are 8 tasks for
            each thread of the workers, and at most 10 000.
        progress : callable, optional
            Called with the number of finished samples and the number of all.

        Returns
        -------
        Samples
            Errors of each film, and the percentiles over all.

        Raises
        ------
        MagspliceError
            If the layout has no errors, ideal film or working volume, or a sample has no errors.
        """
        stated = self._core.sampling or _SAMPLING
        count = stated[0] if samples is None else whole("samples", samples, 1, _MOST_SAMPLES)
        seed = stated[1] if seed is None else whole("seed", seed, 0)
        first = whole("first", first, 0, LARGEST_SEED - count)
        threads = None if threads is None else whole("threads", threads, 1, _MOST_THREADS)
        partition = None if partition is None else whole("partition", partition, 1, _MOST_SAMPLES)
        if client is not None:
            draw = partial(_drawn, self, preset, seed, threads or 1)
            arrays = _cluster.samples(client, draw, first, count, partition, progress)
        else:
            arrays = _magsplice.samples(self._core, preset, seed, first, count, threads, progress)
        return Samples(self.name, preset, seed, first, *arrays, _magsplice.nominal(self._core))


def _drawn(
    film: LayoutFilm, preset: str | None, seed: int, threads: int, first: int, count: int
) -> tuple[Floats, Floats, Floats]:
    return _magsplice.samples(film._core, preset, seed, first, count, threads)
