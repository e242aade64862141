"""Results of films: numbers, arrays and tables."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from magsplice import _html, _magsplice
from magsplice._arrow import Column, Table, split
from magsplice._layout import Floats, Grid, Vector

if TYPE_CHECKING:
    import os

    import xarray

    from magsplice._film import Film

__all__ = [
    "Comparison",
    "Decoupling",
    "Design",
    "Estimate",
    "Figure",
    "Front",
    "Metrics",
    "Page",
    "Readings",
    "Report",
    "Samples",
    "Statistics",
]


class _Numbers:
    """A result that prints as lines of names and numbers."""

    def to_dict(self) -> dict[str, Any]:
        """Numbers by name, without arrays of points; for JSON."""
        raise NotImplementedError

    def __str__(self) -> str:
        return "\n".join(f"{name:<28} {_html.digits(value)}" for name, value in self._shown())

    def __repr__(self) -> str:
        return f"<magsplice.{type(self).__name__}>\n{self}"

    def _shown(self) -> list[tuple[str, Any]]:
        return list(self.to_dict().items())

    def _repr_html_(self) -> str:
        return _html.number_table(self._shown())


@dataclass(frozen=True, repr=False)
class Comparison(_Numbers):
    """The difference of the field of a film from that of the ideal film (Dai 2024, Eq. 2).

    Attributes
    ----------
    points : int
        Number of points.
    component_rmse_t : (float, float, float)
        Root of the mean squared difference of B_x, B_y, B_z, in tesla.
    rmse_t : float
        Root of the mean squared length of the difference, in tesla.
    relative_rmse : float
        `rmse_t` over the root mean square of the ideal B.
    worst_t : float
        Largest length of the difference, in tesla.
    worst_at_mm : (float, float, float)
        First point where it occurs, in millimetres.
    amplitude : float
        Factor that brings the ideal B closest to that of the film.
    scaled_relative_rmse : float | None
        Relative RMSE against the ideal B times `amplitude`; None if that is 0.
    correlation : tuple[float | None, float | None, float | None]
        Pearson's correlation of each component; None where a component does not vary.
    """

    points: int
    component_rmse_t: Vector
    rmse_t: float
    relative_rmse: float
    worst_t: float
    worst_at_mm: Vector
    amplitude: float
    scaled_relative_rmse: float | None
    correlation: tuple[float | None, float | None, float | None]

    def to_dict(self) -> dict[str, Any]:
        """Numbers by name; for JSON."""
        return dict(vars(self))


@dataclass(frozen=True, eq=False, repr=False)
class Decoupling(_Numbers, Table):
    """Decoupling parameters and their errors (Dai 2024, Eqs. 13 to 15).

    A table of the points with their B and parameters: ``polars.DataFrame(result)``.

    Attributes
    ----------
    where : Grid | ndarray
        The grid, or the points in millimetres, shape (..., 3).
    field_t : ndarray
        B in tesla, shape (..., 3).
    parameters : ndarray
        R_x, R_y in radians and S_z, shape (..., 3). NaN at singular points.
    at_reference : (float, float, float)
        R_x, R_y, S_z at the reference point.
    reference_mm : (float, float, float)
        Point from which changes count, in millimetres.
    singular_mm : ndarray
        Points with B_z = 0, where no parameters exist, shape (n, 3). They enter no average.
    uniformity_rmse : (float, float, float) | None
        Uniformity RMSE of R_x, R_y, S_z: the standard deviation over the planes normal to the
        own axis of a parameter, averaged over the planes. None for points that are no grid.
    ideal_rmse : (float, float, float)
        RMSE of the parameters' changes from the reference point against those of the ideal
        film.
    displacement_rmse_mm : (float, float, float)
        RMSE of the displacement along x, y, z that the parameters give (Dai 2024, Eq. 14), in
        millimetres: `ideal_rmse` over the wavenumber.
    wavenumber_per_mm : float
        Wavenumber of the ideal film, in radians per millimetre.
    """

    where: Grid | Floats
    field_t: Floats
    parameters: Floats
    at_reference: Vector
    reference_mm: Vector
    singular_mm: Floats
    uniformity_rmse: Vector | None
    ideal_rmse: Vector
    displacement_rmse_mm: Vector
    wavenumber_per_mm: float

    @property
    def r_x(self) -> Floats:
        """R_x in radians, shape (...): follows the displacement along x."""
        return self.parameters[..., 0]

    @property
    def r_y(self) -> Floats:
        """R_y in radians, shape (...): follows the displacement along y."""
        return self.parameters[..., 1]

    @property
    def s_z(self) -> Floats:
        """S_z, shape (...): follows the displacement along z."""
        return self.parameters[..., 2]

    @property
    def points_mm(self) -> Floats:
        """Points in millimetres, shape (..., 3)."""
        return self.where.points_mm if isinstance(self.where, Grid) else self.where

    @property
    def displacement_mm(self) -> Floats:
        """Displacement from the reference point by Eq. 14, in millimetres, shape (..., 3)."""
        change = self.parameters - np.array(self.at_reference)
        moved: Floats = change * np.array([-1.0, -1.0, 1.0]) / self.wavenumber_per_mm
        return moved

    def to_dict(self) -> dict[str, Any]:
        """Errors by name; for JSON."""
        return {
            "points": self.parameters.size // 3,
            "singular_points": len(self.singular_mm),
            "uniformity_rmse": self.uniformity_rmse,
            "ideal_rmse": self.ideal_rmse,
            "displacement_rmse_mm": self.displacement_rmse_mm,
        }

    def columns(self) -> dict[str, Column]:
        """Columns x_mm, y_mm, z_mm, bx_t, by_t, bz_t, r_x_rad, r_y_rad, s_z."""
        return {
            **split(("x_mm", "y_mm", "z_mm"), self.points_mm),
            **split(("bx_t", "by_t", "bz_t"), self.field_t),
            **split(("r_x_rad", "r_y_rad", "s_z"), self.parameters),
        }

    def to_xarray(self) -> xarray.Dataset:
        """Variables b, r_x, r_y and s_z with the dimensions x, y, z (and component), or point.

        Raises
        ------
        ImportError
            If xarray is not installed: ``pip install "magsplice[xarray]"``.
        """
        import xarray

        from magsplice._film import coordinates

        if isinstance(self.where, Grid):
            dims: tuple[str, ...] = ("x", "y", "z")
            coords = coordinates(self.where)
            shape: tuple[int, ...] = self.where.counts
        else:
            dims, shape = ("point",), (self.parameters.size // 3,)
            x, y, z = self.where.reshape(-1, 3).T
            millimetres = {"units": "mm"}
            coords = {
                "x": ("point", x, millimetres),
                "y": ("point", y, millimetres),
                "z": ("point", z, millimetres),
                "component": ("component", ["x", "y", "z"]),
            }
        radians = {"units": "rad"}
        return xarray.Dataset(
            {
                "b": ((*dims, "component"), self.field_t.reshape(*shape, 3), {"units": "T"}),
                "r_x": (dims, self.r_x.reshape(shape), radians),
                "r_y": (dims, self.r_y.reshape(shape), radians),
                "s_z": (dims, self.s_z.reshape(shape), {}),
            },
            coords,
        )


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


@dataclass(frozen=True, repr=False)
class Statistics(_Numbers):
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
        estimates = {key: Estimate(*value) for key, value in numbers.items() if key != "count"}
        return cls(numbers["count"], **estimates)

    def to_dict(self) -> dict[str, Any]:
        """Numbers by name; estimates as value and ends of the interval."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


@dataclass(frozen=True, eq=False, repr=False)
class Samples(_Numbers, Table):
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
        return statistics(self.displacement_rmse_mm[:, "xyz".index(axis)])

    def uniformity(self, parameter: str) -> Statistics:
        """Statistics of the uniformity RMSE of ``"r_x"``, ``"r_y"`` or ``"s_z"``."""
        return statistics(self.uniformity_rmse[:, ("r_x", "r_y", "s_z").index(parameter)])

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


#: What the numbers in `Readings.status` mean.
STATUS = ("in the volume", "outside the volume", "ambiguous", "not found", "saturated")


@dataclass(frozen=True, eq=False, repr=False)
class Readings(Table):
    """What was found from readings of a sensor. NaN where a reading has no value.

    Attributes
    ----------
    displacement_mm : ndarray
        Displacement of the sensor from the reference point, in millimetres, shape (..., 3). The
        film moves by the opposite.
    deviation_mm : ndarray | None
        Standard deviations of it, in millimetres, shape (..., 3). None without noise.
    force_n : ndarray | None
        Force on the film, in newton, shape (..., 3). None without ``[elastomer]``.
    closed_form_mm : ndarray | None
        Displacement by the closed form of the ideal film (Dai 2024, Eq. 14), in millimetres,
        shape (..., 3). None without an ideal film.
    status : ndarray of uint8
        0: in the volume; 1: outside; 2: two positions have the reading; 3: none has; 4:
        saturated; shape (...).
    messages : list[str]
        Why a reading has no position in the volume; an empty text where it has one.
    """

    displacement_mm: Floats
    deviation_mm: Floats | None
    force_n: Floats | None
    closed_form_mm: Floats | None
    status: NDArray[np.uint8]
    messages: list[str]

    def columns(self) -> dict[str, Column]:
        """Columns dx_mm, dy_mm, dz_mm, then those of the other arrays, and status."""
        columns = split(("dx_mm", "dy_mm", "dz_mm"), self.displacement_mm)
        others = (
            (("deviation_x_mm", "deviation_y_mm", "deviation_z_mm"), self.deviation_mm),
            (("fx_n", "fy_n", "fz_n"), self.force_n),
            (
                ("closed_form_dx_mm", "closed_form_dy_mm", "closed_form_dz_mm"),
                self.closed_form_mm,
            ),
        )
        for names, array in others:
            if array is not None:
                columns |= split(names, array)
        return {**columns, "status": self.status.ravel()}

    def __repr__(self) -> str:
        counts = np.bincount(self.status.ravel(), minlength=len(STATUS))
        told = ", ".join(
            f"{count} {text}" for count, text in zip(counts, STATUS, strict=True) if count
        )
        return f"<magsplice.Readings: {told or 'none'}>"


@dataclass(frozen=True, repr=False)
class Metrics(_Numbers):
    """Errors of a film over a grid, from its exact field.

    Attributes
    ----------
    points : int
        Number of points of the grid.
    uniformity_rmse : (float, float, float)
        Uniformity RMSE of R_x, R_y, S_z.
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
    uniformity_rmse: Vector
    ideal_rmse: Vector
    displacement_rmse_mm: Vector
    amplitude: float
    scaled_relative_rmse: float | None

    def to_dict(self) -> dict[str, Any]:
        """Numbers by name; for JSON."""
        return dict(vars(self))


@dataclass(frozen=True, eq=False, repr=False)
class Design(_Numbers):
    """A film that a search found, with its errors before and after.

    Attributes
    ----------
    film : Film
        The film found; ``film.save("better.toml")`` writes it.
    before : Metrics
        Errors of the film before the search, over its working volume.
    after : Metrics
        Errors of the film found, over the working volume.
    five_times_finer : Metrics
        Errors of the film found, over the design grid refined five times.
    stages : list[tuple[str, (float, float, float)]]
        Stages of the search, and the uniformity RMSE after each.
    parts : int
        Number of distinct parts.
    starts_that_agree : int
        Number of starts whose error is within a tenth of the best.
    short_of : list[str]
        Demands that the film misses. Empty if it meets all.
    made_before : tuple[Statistics, Statistics, Statistics] | None
        Displacement RMSE along x, y, z of films that are made from the film before, in
        millimetres; None unless the design counts them (``under = "tolerance"``).
    made_after : tuple[Statistics, Statistics, Statistics] | None
        The same of the film found.
    error : float
        What the search minimizes: the root of the weighted sum of squares of the three
        uniformity or displacement RMSE (in millimetres), by the goal of ``[design]``; 95th
        percentiles where the design counts films that are made; the scaled relative RMSE of B
        for the goal ``field``.
    """

    film: Film
    before: Metrics
    after: Metrics
    five_times_finer: Metrics
    stages: list[tuple[str, Vector]]
    parts: int
    starts_that_agree: int
    short_of: list[str]
    made_before: tuple[Statistics, Statistics, Statistics] | None
    made_after: tuple[Statistics, Statistics, Statistics] | None
    error: float

    @classmethod
    def from_numbers(cls, film: Film, numbers: Any, brief: dict[str, Any]) -> Design:
        """Result with the numbers of the library, of a search with this table ``[design]``."""
        made = numbers["made"]
        after = Metrics(**numbers["after"])

        def along(key: str) -> tuple[Statistics, Statistics, Statistics] | None:
            if made is None:
                return None
            x, y, z = (Statistics._of(axis) for axis in made[key])
            return x, y, z

        made_after = along("after_displacement_rmse_mm")
        errors: Sequence[float] = after.uniformity_rmse
        if made_after is not None:
            errors = [axis.p95.value for axis in made_after]
        elif brief.get("goal") == "displacement":
            errors = after.displacement_rmse_mm
        weights = [brief.get("weights", {}).get(key, 1.0) for key in ("r_x", "r_y", "s_z")]
        error = float(np.sqrt(np.dot(weights, np.square(errors))))
        if brief.get("goal") == "field":
            error = np.inf if after.scaled_relative_rmse is None else after.scaled_relative_rmse
        return cls(
            film,
            Metrics(**numbers["before"]),
            after,
            Metrics(**numbers["five_times_finer"]),
            numbers["stages"],
            numbers["parts"],
            numbers["starts_that_agree"],
            numbers["short_of"],
            along("before_displacement_rmse_mm"),
            made_after,
            error,
        )

    def to_dict(self) -> dict[str, Any]:
        """Numbers by name; for JSON."""
        return {
            "tiles": len(self.film),
            "error": self.error,
            "parts": self.parts,
            "before_displacement_rmse_mm": self.before.displacement_rmse_mm,
            "after_displacement_rmse_mm": self.after.displacement_rmse_mm,
            "before_uniformity_rmse": self.before.uniformity_rmse,
            "after_uniformity_rmse": self.after.uniformity_rmse,
            "before_amplitude": self.before.amplitude,
            "after_amplitude": self.after.amplitude,
            "starts_that_agree": self.starts_that_agree,
            "short_of": self.short_of,
        }


@dataclass(frozen=True, eq=False)
class Front(Table):
    """The films of a trade-off of error against amplitude, in ascending order of the amplitude.

    No other film that was found is as good in error and amplitude and better in one of them, and
    every film has the amplitude it was asked for.

    Attributes
    ----------
    least_amplitudes : list[float]
        Amplitude that was asked for, of each film.
    designs : list[Design]
        The films.
    """

    least_amplitudes: list[float]
    designs: list[Design]

    def __len__(self) -> int:
        return len(self.designs)

    def columns(self) -> dict[str, Column]:
        """Columns least_amplitude, amplitude, error, displacement_x_mm, ..., parts, film."""
        rows = np.array([d.after.displacement_rmse_mm for d in self.designs], dtype=float)
        return {
            "least_amplitude": np.array(self.least_amplitudes),
            "amplitude": np.array([d.after.amplitude for d in self.designs]),
            "error": np.array([d.error for d in self.designs]),
            **split(("displacement_x_mm", "displacement_y_mm", "displacement_z_mm"), rows),
            "parts": np.array([d.parts for d in self.designs], dtype=np.uint64),
            "film": [d.film.name for d in self.designs],
        }

    def _repr_html_(self) -> str:
        return _html.rows_table(self.columns())


def front_of(least_amplitudes: Sequence[float], designs: Sequence[Design]) -> Front:
    """Films that keep their amplitude and that no other film beats."""
    pairs = zip(least_amplitudes, designs, strict=True)
    kept = sorted(
        ((d.after.amplitude, -d.error, least, d) for least, d in pairs if not d.short_of),
        key=lambda entry: entry[:2],
    )
    front: list[tuple[float, Design]] = []
    best = np.inf
    # From the largest amplitude on, each film must have a smaller error than all stronger ones.
    for _, minus_error, least, design in reversed(kept):
        if -minus_error < best:
            best = -minus_error
            front.append((least, design))
    front.reverse()
    return Front([least for least, _ in front], [design for _, design in front])


class Figure(NamedTuple):
    """A figure of a report. A notebook shows its SVG.

    Attributes
    ----------
    name : str
        Name of its files, without extension.
    caption : str
        What the figure shows.
    svg : str
        The figure as SVG.
    png : bytes
        The figure as PNG, 300 dots per inch.
    csv : str
        The numbers that the figure shows, with one header line.
    """

    name: str
    caption: str
    svg: str
    png: bytes
    csv: str

    def _repr_svg_(self) -> str:
        return self.svg

    def __repr__(self) -> str:
        return f"<magsplice.Figure {self.name!r}: {self.caption}>"


class Page:
    """An HTML page that loads no other file. A notebook shows it in a frame.

    Attributes
    ----------
    html : str
        The page.
    """

    html: str

    def __init__(self, html: str, height_px: int = 600) -> None:
        self.html = html
        self._height_px = height_px

    def _repr_html_(self) -> str:
        return _html.frame(self.html, self._height_px)

    def __repr__(self) -> str:
        return f"<magsplice.{type(self).__name__}: {len(self.html)} characters of HTML>"


class Report(Page):
    """Figures of a film, and the page that shows them.

    Attributes
    ----------
    figures : dict[str, Figure]
        Figures by name.
    absent : list[str]
        What the report lacks, and why.
    """

    figures: dict[str, Figure]
    absent: list[str]

    def __init__(
        self, figures: list[tuple[str, str, str, bytes, str]], html: str, absent: list[str]
    ) -> None:
        super().__init__(html, 900)
        self.figures = {figure[0]: Figure(*figure) for figure in figures}
        self.absent = absent

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Writes report.html and SVG, PNG and CSV of each figure; returns the path of the page.

        Parameters
        ----------
        folder : str or path
            Folder, which is made if it is not there. Files of these names are replaced.
        """
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        for figure in self.figures.values():
            (folder / f"{figure.name}.svg").write_text(figure.svg, encoding="utf-8")
            (folder / f"{figure.name}.png").write_bytes(figure.png)
            (folder / f"{figure.name}.csv").write_text(figure.csv, encoding="utf-8")
        page = folder / "report.html"
        page.write_text(self.html, encoding="utf-8")
        return page
