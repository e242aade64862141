"""Films, and the films that searches find."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from magsplice import _cluster, _html, _magsplice
from magsplice._arrow import Column, Table, split
from magsplice._assignment import AssignedFilm
from magsplice._budget import BudgetedFilm
from magsplice._check import CheckedFilm
from magsplice._diagnosis import DiagnosedFilm
from magsplice._forces import LaidFilm
from magsplice._layout import Ideal, PerParameter, Tile, Volume
from magsplice._magpylib.collection import to_magpylib
from magsplice._metrics import Metrics
from magsplice._numbers import Numbers
from magsplice._recoil import RecoilFilm
from magsplice._report import DrawnFilm
from magsplice._samples import MadeFilm, Statistics
from magsplice._sensor import SensedFilm


class Film(
    MadeFilm,
    BudgetedFilm,
    SensedFilm,
    RecoilFilm,
    LaidFilm,
    AssignedFilm,
    DiagnosedFilm,
    CheckedFilm,
    DrawnFilm,
):
    """A spliced film, or any other arrangement of block magnets, with its exact field.

    Lengths are in millimetres, flux density B and polarization J in tesla, field strength H in
    ampere per metre. Points have the shape (..., 3), and so do fields. The film fills z >= 0 as a
    rule, and the sensor is below it, at z < 0. A film does not change; `replace` makes another one.

    Parameters
    ----------
    tiles : iterable of Tile
        The tiles. They may touch and must not overlap.
    name : str
        Name of the film.
    description : str, optional
        Free text.
    ideal : Ideal or mapping, optional
        The ideal film to compare with. `compare`, `decouple`, `tolerance` and `design` need it.
    volume : Volume or mapping, optional
        The region in which the sensor moves. The same methods need it.
    material, expect, design, tolerance, sensor, elastomer : mapping, optional
        Tables of the layout file of these names, such as
        ``tolerance={"preset": "workshop", "size_mm": 0.02}`` or
        ``material={"recoil_permeability": 1.05}``; docs/layout-format.md has all keys.

    Raises
    ------
    LayoutError
        If the film breaks rules of layouts. All broken rules are in ``error.faults``.

    See Also
    --------
    load : The film in a layout file.
    from_magpylib : The film of a magpylib collection.

    Notes
    -----
    The error of a field is at most 2e-14 of the sum, over all tiles, of the magnitudes of the
    fields that the three components of J make alone. All processors are used; the environment
    variable RAYON_NUM_THREADS limits them. The interpreter is free for other threads during work,
    and Ctrl-C interrupts it.

    Source: Dai et al., Magnetochemistry 2024, 10(1), 6, is "Dai 2024".

    Examples
    --------
    >>> film = Film([Tile((0, 0, 0.5), (3, 3, 1), (0, 0, 0.12))], name="one tile")
    >>> film.b([0, 0, -4]).shape
    (3,)
    >>> film.b([[0, 0, -4], [1, 0, -4]]).shape
    (2, 3)
    """

    def __init__(
        self,
        tiles: Iterable[Tile],
        *,
        name: str,
        description: str | None = None,
        ideal: Ideal | Mapping[str, Any] | None = None,
        volume: Volume | Mapping[str, Any] | None = None,
        material: Mapping[str, Any] | None = None,
        expect: Mapping[str, Any] | None = None,
        design: Mapping[str, Any] | None = None,
        tolerance: Mapping[str, Any] | None = None,
        sensor: Mapping[str, Any] | None = None,
        elastomer: Mapping[str, Any] | None = None,
    ) -> None:
        made = Film.from_dict(
            {
                "name": name,
                "description": description,
                "ideal": ideal,
                "volume": volume,
                "material": material,
                "expect": expect,
                "design": design,
                "tolerance": tolerance,
                "sensor": sensor,
                "elastomer": elastomer,
                "tile": tiles,
            }
        )
        self.__dict__.update(made.__dict__)

    def design(
        self,
        *,
        least_amplitude: float | None = None,
        progress: Callable[[str, int, int, float | None], Any] | None = None,
    ) -> Design:
        """Search for the film that decouples best, as ``[design]`` of the layout asks.

        Parameters
        ----------
        least_amplitude : float, optional
            Least best-fit amplitude against the ideal film, instead of that of ``[design]``.
        progress : callable, optional
            Called with the stage, the finished items, their number (0 if it is not known), and the
            best error so far (None before the first film).

        Returns
        -------
        Design
            The film found, and its errors before and after.

        Raises
        ------
        ValueError
            If `least_amplitude` is not above 0.
        MagspliceError
            If the layout has no ``[design]``, or there is no film that keeps its rules.

        Examples
        --------
        >>> better = film.replace(
        ...     design={"vary": ["size", "position", "direction"], "symmetry": "four-fold"}
        ... ).design()  # doctest: +SKIP
        """
        if least_amplitude is not None and not 0 < least_amplitude < np.inf:
            raise ValueError(f"least_amplitude = {least_amplitude}, must be above 0 and finite")
        numbers = _magsplice.design(self._core, least_amplitude, progress)
        film = Film._parsed(numbers["text"], "the film found", self._folder)
        return Design.from_numbers(film, numbers)

    def front(
        self,
        least_amplitudes: Sequence[float] = (0.6, 0.7, 0.8, 0.85, 0.9, 0.95, 1.0, 1.05),
        *,
        client: Any = None,
    ) -> Front:
        """Trade-off of error against amplitude: one search for each least amplitude.

        The searches do not depend on each other, so that they can run on several machines.
        ``magsplice design --front`` begins each at the film found before, too.

        Parameters
        ----------
        least_amplitudes : sequence of float
            Least best-fit amplitudes of the films.
        client : distributed.Client, optional
            Dask client on whose workers the searches run. The films are the same as without.

        Returns
        -------
        Front
            The films that no other film beats in error and in amplitude.
        """
        if client is not None:
            designs = _cluster.gathered(client, partial(_designed, self), least_amplitudes)
        else:
            designs = [self.design(least_amplitude=least) for least in least_amplitudes]
        return front_of(list(least_amplitudes), designs)

    def to_magpylib(self) -> Any:
        """Film as a `magpylib.Collection` of cuboids, in metres and tesla.

        Tiles with a recoil permeability become their cells, with the polarization that agrees with
        the field: magpylib knows no recoil.

        Needs magpylib: ``pip install "magsplice[magpylib]"``.
        """
        return to_magpylib(self)


@dataclass(frozen=True, eq=False, repr=False)
class Design(Numbers):
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
    stages: list[tuple[str, PerParameter]]
    parts: int
    starts_that_agree: int
    short_of: list[str]
    made_before: tuple[Statistics, Statistics, Statistics] | None
    made_after: tuple[Statistics, Statistics, Statistics] | None
    error: float

    @classmethod
    def from_numbers(cls, film: Film, numbers: Any) -> Design:
        """Result with the numbers of the library."""
        made = numbers.get("made")

        def along(films: str) -> tuple[Statistics, Statistics, Statistics] | None:
            if made is None:
                return None
            x, y, z = map(Statistics._of, made[films]["displacement_rmse_mm"].values())
            return x, y, z

        return cls(
            film=film,
            before=Metrics.of(numbers["before"]),
            after=Metrics.of(numbers["after"]),
            five_times_finer=Metrics.of(numbers["five_times_finer"]),
            stages=[
                (of["stage"], tuple(of["uniformity_rmse"].values())) for of in numbers["stages"]
            ],
            parts=numbers["parts"],
            starts_that_agree=numbers["starts_that_agree"],
            short_of=numbers["short_of"],
            made_before=along("before"),
            made_after=along("after"),
            error=numbers["error"],
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


def _designed(film: Film, least_amplitude: float) -> Design:
    return film.design(least_amplitude=least_amplitude)
