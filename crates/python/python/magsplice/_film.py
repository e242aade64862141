"""Films, and results of searches and assignments."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from magsplice import _cluster, _findings, _html, _magsplice, _toml
from magsplice._arguments import LARGEST_SEED, one_of, whole
from magsplice._arrow import Column, Table, split
from magsplice._assignment import (
    MOST_STARTS,
    MeasuredTile,
    PlacedTile,
    Shim,
    measured_row,
    measurement_errors,
    placed_row,
)
from magsplice._budget import Budget
from magsplice._check import Check, read_baseline
from magsplice._comparison import Comparison, Decoupling
from magsplice._figures import Statistics
from magsplice._forces import Forces, steps_of
from magsplice._head import HEAD_KEYS, Head
from magsplice._layout import (
    KEYS,
    Floats,
    Grid,
    Ideal,
    Lattice,
    Tile,
    Tiles,
    Vector,
    Volume,
    table_of,
)
from magsplice._magpylib.collection import to_magpylib
from magsplice._parts import Parts
from magsplice._points import coordinates, flattened, shaped, tolerance_of
from magsplice._recoil import Recoil, RecoilEstimate
from magsplice._report import (
    LIVE_PX,
    VIEW_PX,
    Figure,
    Page,
    Report,
    film_html,
    live_html,
    view_html,
)
from magsplice._results import Result, key
from magsplice._samples import Preset, Samples
from magsplice._search import MadeFilms, Metrics, OutOfRange, SearchStage
from magsplice._sensed import Sensed
from magsplice._source import OfFilm
from magsplice._sweep import Sweep, values_of
from magsplice.errors import LayoutError, MagspliceError

if TYPE_CHECKING:
    import xarray

Invalid = Literal["raise", "nan"]

#: Largest number of samples of one call, as in the program.
_MOST_SAMPLES = 10_000_000
#: Largest number of threads, a limit of rayon.
_MOST_THREADS = 65_535


class Film(Sensed):
    """A spliced film, or any other arrangement of block magnets, with its exact field.

    Lengths are in millimetres, flux density B and polarization J in tesla, field strength H in
    ampere per metre. Points and fields have the shape (..., 3). The film usually fills z >= 0, and
    the sensor is below it, at z < 0. A film is immutable; `replace` returns another film.

    Parameters
    ----------
    tiles : iterable of Tile
        The tiles. They may touch, but must not overlap by more than `overlap_mm`.
    name : str
        Name of the film.
    description : str, optional
        Free text.
    overlap_mm : float, optional
        Depth by which tiles may overlap in millimetres, for positions with few decimals. Default:
        0; the round-off of computed positions is always allowed.
    ideal : Ideal or mapping, optional
        The ideal film to compare with. `compare`, `decouple`, `tolerance` and `design` need it.
    volume : Volume or mapping, optional
        The region in which the sensor moves. The same methods need it.
    material, expect, design, tolerance, sensor, elastomer : mapping, optional
        Tables of the layout file with these names, such as ``tolerance={"preset": "workshop",
        "size_mm": 0.02}`` or ``material={"recoil_permeability": 1.05}``; docs/layout-format.md has
        all keys.
    lattice : iterable of Lattice or mapping, optional
        Tiles of cut films, in addition to `tiles`.

    Raises
    ------
    LayoutError
        If the film breaks rules of layouts. All broken rules are in ``error.faults``.

    Notes
    -----
    The error of a field is at most 1e-13 of the sum, over all tiles, of the magnitudes of the
    fields of the three components of J. All processors are used; the environment variable
    RAYON_NUM_THREADS sets their number, at most four per processor. The interpreter is free for
    other threads during work, and Ctrl-C interrupts it. A method raises MagspliceError if the
    layout lacks a required table.

    "Dai 2024" is Dai et al., Magnetochemistry 2024, 10(1), 6.

    Examples
    --------
    >>> film = Film([Tile((0, 0, 0.5), (3, 3, 1), (0, 0, 0.12))], name="one tile")
    >>> film.b([0, 0, -4]).shape
    (3,)
    >>> film.b([[0, 0, -4], [1, 0, -4]]).shape
    (2, 3)
    """

    def __new__(
        cls,
        tiles: Iterable[Tile] = (),
        *,
        name: str,
        description: str | None = None,
        overlap_mm: float | None = None,
        ideal: Ideal | Mapping[str, Any] | None = None,
        volume: Volume | Mapping[str, Any] | None = None,
        material: Mapping[str, Any] | None = None,
        expect: Mapping[str, Any] | None = None,
        design: Mapping[str, Any] | None = None,
        tolerance: Mapping[str, Any] | None = None,
        sensor: Mapping[str, Any] | None = None,
        elastomer: Mapping[str, Any] | None = None,
        lattice: Iterable[Lattice | Mapping[str, Any]] | None = None,
    ) -> Film:
        return cls.from_dict(
            {
                "name": name,
                "description": description,
                "overlap_mm": overlap_mm,
                "ideal": ideal,
                "volume": volume,
                "material": material,
                "expect": expect,
                "design": design,
                "tolerance": tolerance,
                "sensor": sensor,
                "elastomer": elastomer,
                "tile": tiles,
                "lattice": lattice,
            }
        )

    @classmethod
    def from_dict(
        cls, layout: Mapping[str, Any], *, folder: str | os.PathLike[str] | None = None
    ) -> Film:
        """Film of a layout file given as a dictionary; `to_dict` is the inverse.

        Parameters
        ----------
        layout : mapping
            The keys and tables of a layout file, such as ``{"name": "one", "tile": [...]}``. Tables
            may also be `Tile`, `Ideal` and `Volume`, and lists may be arrays. ``format`` may be
            omitted, and keys with the value None count as omitted.
        folder : str or path, optional
            Folder of files referenced by the layout. Default: the working folder.

        Raises LayoutError if the mapping is no layout.
        """
        film = _of_tables(layout, folder)
        _findings.warn(film)
        return film

    def to_dict(self) -> dict[str, Any]:
        """Layout in the plain form: one entry of ``tile`` for each tile, keys as in a file."""
        layout: dict[str, Any] = json.loads(self._to_json())
        return layout

    def replace(self, **tables: Any) -> Film:
        """Film with other tables or keys.

        Parameters
        ----------
        **tables
            Keys of a layout file with their new values: ``name``, ``description``,
            ``overlap_mm``, ``ideal``, ``volume``, ``material``, ``tolerance``, ``design``,
            ``sensor``, ``elastomer``, ``expect``, and ``tile`` with the tiles. None removes a
            table. A mapping changes the keys that it has; the value None removes a key. A mapping
            with a ``preset`` of ``tolerance`` or a ``part`` of ``sensor``, which stands for a
            whole table, replaces the table. A setting of the part, such as ``gain_sel``, also
            changes noise, counts and range.

        Examples
        --------
        >>> finer = film.replace(volume={"step_mm": 0.25})  # doctest: +SKIP
        """
        unknown = [key for key, table in tables.items() if table is None and key not in KEYS]
        if unknown:
            raise TypeError(f"{unknown[0]} is no key of a layout, must be one of {', '.join(KEYS)}")
        before = self.to_dict()
        if self._has_default_reference:
            # It follows the ends of the volume.
            before.get("volume", {}).pop("reference_mm", None)
        after = {**before, **{name: _merged(name, before, table) for name, table in tables.items()}}
        film = _of_tables(after, self._source[-1])
        _findings.warn(film, self.findings)
        return film

    def _of_text(self, text: str) -> Film:
        # A part of a film, or tiles beside the ideal film, are rarely a mistake here.
        return _of_text_without_lines(text, self.name, self._source[-1])

    def save(self, path: str | os.PathLike[str], *, compact: bool = True) -> None:
        """Writes the layout as TOML; see `to_toml`. An existing file is replaced."""
        Path(path).write_text(self.to_toml(compact=compact), encoding="utf-8")

    def __reduce__(self) -> tuple[Callable[..., Film], tuple[str, str, str | None]]:
        # The text gives the same film bit for bit. Its files must be reachable.
        return film_of_text, self._source

    def __eq__(self, other: object) -> bool:
        """Whether the layouts have the same names and numbers, with tiles in the same order."""
        return self._is_same(other) if isinstance(other, Film) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._to_json())

    def __repr__(self) -> str:
        return f"<magsplice.Film {self.name!r}: {len(self)} tiles, sha256 {self.sha256[:12]}>"

    def _repr_html_(self) -> str:
        rows: list[tuple[str, Any]] = []
        if self.ideal is not None:
            ideal = self.ideal
            text = f"wavelength {ideal.wavelength_mm:g} mm, thickness {ideal.thickness_mm:g} mm, "
            rows.append(("ideal film", f"{text}amplitude {ideal.amplitude_t:g} T"))
        if self.volume is not None and self.grid is not None:
            ranges = zip("xyz", (self.volume.x_mm, self.volume.y_mm, self.volume.z_mm), strict=True)
            x, y, z = (f"{axis} {low:g} .. {high:g}" for axis, (low, high) in ranges)
            rows.append(("working volume", f"{x}, {y}, {z} mm, {len(self.grid)} points"))
        return film_html(self, rows)

    @cached_property
    def tiles(self) -> Tiles:  # type: ignore[override]
        """All tiles, with repetitions expanded."""
        return Tiles(*self._tiles())

    @property
    def ideal(self) -> Ideal | None:
        """The ideal film; None if the layout has none."""
        ideal = self._ideal
        return None if ideal is None else Ideal(*ideal)

    @property
    def volume(self) -> Volume | None:
        """The working volume; None if the layout has none."""
        volume = self._volume
        if volume is None:
            return None
        *_, lower, upper, step, reference = volume
        x, y, z = zip(lower, upper, strict=True)
        return Volume(x, y, z, step[0] if len(set(step)) == 1 else step, reference)

    @property
    def head(self) -> Head | None:
        """The sensors that are read as one weighted sum; None if the layout has a single sensor."""
        if self._head is None:
            return None
        board, spacing_mm, places, weights = self._head
        return Head(board, spacing_mm, tuple(places), tuple(weights))

    @property
    def grid(self) -> Grid | None:
        """The grid of the working volume; None if the layout has none."""
        return None if self._volume is None else Grid(*self._volume[:3])

    @property
    def reference_mm(self) -> Vector | None:
        """Point of the working volume from which displacements count, in millimetres."""
        return None if self._volume is None else self._volume[-1]

    def b(
        self,
        points: ArrayLike | Grid,
        *,
        within: float | str | None = None,
        within_t: float | None = None,
        invalid: Invalid = "raise",
    ) -> Floats:
        """Flux density B in tesla.

        Parameters
        ----------
        points : array_like of shape (..., 3), or Grid
            Points in millimetres. An array of contiguous doubles is not copied.
        within : float or str, optional
            Accepted length of the error: a fraction of |B| at each point below 0.1, such as 1e-6,
            or a flux density with a unit (T, mT, uT, nT), such as ``"10nT"``. Default: exact.
        within_t : float, optional
            Accepted length of the error in tesla. Excludes `within`.
        invalid : {"raise", "nan"}
            Handling of points without a field, such as points on exposed edges.

        Returns
        -------
        ndarray of shape (..., 3)
            B at each point; for a grid of shape (nx, ny, nz, 3). Exact values do not depend on
            other points or on the number of threads.

        Raises
        ------
        PointsError
            If points have no field, or cannot keep the tolerance.
        ValueError
            If the points have another shape, or the tolerance is out of range.

        Notes
        -----
        Error of the exact field: at most 1e-13 of the sum over tiles (see `error_bound`). On a face
        B is the limit from the side of larger x, y or z. A tolerance saves time on grids and with
        many tiles: docs/accuracy-and-speed.md.
        """
        return self._field("b", points, within, within_t, invalid)

    def h(
        self,
        points: ArrayLike | Grid,
        *,
        within: float | str | None = None,
        within_t: float | None = None,
        invalid: Invalid = "raise",
    ) -> Floats:
        """Field strength H in ampere per metre: (B - J) / mu0; see `b`, also for the tolerance."""
        return self._field("h", points, within, within_t, invalid)

    def j(self, points: ArrayLike | Grid) -> Floats:
        """Polarization J in tesla of the tile at each point, shape (..., 3); 0 outside tiles."""
        return self._field("j", points, None, None, "raise")

    def gradient(
        self,
        points: ArrayLike | Grid,
        *,
        quantity: Literal["b", "h"] = "b",
        invalid: Invalid = "raise",
    ) -> Floats:
        """Gradient of B in tesla per millimetre, or of H in ampere per metre and millimetre.

        Parameters
        ----------
        points : array_like of shape (..., 3), or Grid
            Points in millimetres.
        quantity : {"b", "h"}
            The field to differentiate.
        invalid : {"raise", "nan"}
            Handling of points without a gradient, such as points on edges.

        Returns
        -------
        ndarray of shape (..., 3, 3)
            Element (..., i, j) is the derivative of component i along coordinate j. The gradient of
            B is mu0 times the gradient of H, also inside tiles, so it is symmetric without trace.

        Raises
        ------
        PointsError
            If points have no gradient.
        """
        one_of("quantity", quantity, ("b", "h"))
        flat, shape = flattened(points)
        values, error = self._scene.gradient(quantity, flat)
        if error is not None and invalid == "raise":
            raise error
        return values.reshape(*shape, 3, 3)

    def error_bound(self, points: ArrayLike | Grid) -> Floats:
        """Upper bound in tesla of the error of the exact B, shape (...).

        It is 1e-13 of an upper bound of the sum over tiles of the magnitudes of the fields of the
        three components of J. A component of B below the bound may be pure rounding.
        """
        flat, shape = flattened(points)
        return self._scene.error_bounds_t(flat).reshape(shape)

    def ideal_b(self, points: ArrayLike | Grid) -> Floats:
        """Flux density of the ideal film in tesla (Dai 2024, Eq. 2), shape (..., 3).

        NaN at points that are not below the film, at z >= 0.
        """
        flat, shape = flattened(points)
        return self._ideal_b(flat).reshape(*shape, 3)

    def to_xarray(
        self,
        grid: Grid | None = None,
        *,
        within: float | str | None = None,
        within_t: float | None = None,
    ) -> xarray.Dataset:
        """B on a grid as an xarray dataset with the dimensions x, y, z and component.

        The variable ``b`` is B in tesla, and ``ideal_b`` is B of the ideal film, if there is one.

        Parameters
        ----------
        grid : Grid, optional
            Default: the grid of the working volume.
        within, within_t : optional
            Tolerance of the field; see `b`.
        """
        import xarray

        grid = self._required_grid() if grid is None else grid
        dims, tesla = ("x", "y", "z", "component"), {"units": "T"}
        fields = {"b": (dims, self.b(grid, within=within, within_t=within_t), tesla)}
        if self.ideal is not None:
            fields["ideal_b"] = (dims, self.ideal_b(grid), tesla)
        coords = coordinates("xyz", (grid.x_mm, grid.y_mm, grid.z_mm))
        return xarray.Dataset(fields, coords, {"film": self.name, "sha256": self.sha256})

    def _required_grid(self) -> Grid:
        if self.grid is None:
            raise MagspliceError(
                "the layout has no [volume] table, which this needs: add one, such as "
                'film.replace(volume={"x_mm": [-2, 2], "y_mm": [-2, 2], "z_mm": [-5, -3], '
                '"step_mm": 0.5})'
            )
        return self.grid

    def _field(
        self,
        quantity: Literal["b", "h", "j"],
        points: ArrayLike | Grid,
        within: float | str | None,
        within_t: float | None,
        invalid: Invalid,
    ) -> Floats:
        """Field at points or on a grid."""
        accepted = tolerance_of(within, within_t)
        one_of("invalid", invalid, ("raise", "nan"))
        if isinstance(points, Grid):
            shape: tuple[int, ...] = points.counts
            values, error = self._scene.field_on_grid(
                quantity, points.lower_mm, points.upper_mm, points.counts, accepted
            )
        else:
            flat, shape = flattened(points)
            values, error = self._scene.field(quantity, flat, accepted)
        if error is not None and invalid == "raise":
            raise error
        return values.reshape(*shape, 3)

    def compare(
        self,
        points: ArrayLike | None = None,
        *,
        within: float | str | None = None,
        within_t: float | None = None,
    ) -> Comparison:
        """Comparison of B with B of the ideal film (Dai 2024, Eq. 2).

        Parameters
        ----------
        points : array_like of shape (..., 3), optional
            Points below the film, in millimetres. Default: the grid of the working volume.
        within, within_t : optional
            Tolerance of the field; see `b`.

        Raises
        ------
        MagspliceError
            If points are not below the film.
        """
        flat = None if points is None else flattened(points)[0]
        return Comparison(_magsplice.compare(self, flat, tolerance_of(within, within_t)))

    def decouple(
        self,
        points: ArrayLike | None = None,
        *,
        within: float | str | None = None,
        within_t: float | None = None,
    ) -> Decoupling:
        """Decoupling parameters R_x, R_y, S_z and their errors (Dai 2024, Eqs. 13 to 15).

        Parameters
        ----------
        points : array_like of shape (..., 3), optional
            Points in millimetres. Default: the grid of the working volume. A uniformity RMSE needs
            the grid.
        within, within_t : optional
            See `b`.

        Raises
        ------
        MagspliceError
            If the parameters do not exist.
        """
        flat, shape = (None, ()) if points is None else flattened(points)
        where: Grid | Floats
        if flat is None:
            where = self._required_grid()
            shape = where.counts
        else:
            where = flat.reshape(*shape, 3)
        numbers, more = _magsplice.decouple(self, flat, tolerance_of(within, within_t))
        return Decoupling(numbers, where=where, **shaped(more, shape))

    def check(self) -> Check:
        """Values of all quantities bounded by ``[expect]``, as in ``magsplice check``.

        Expectations are evaluated independently: the failure of one does not hide the others.
        ``film.check().status`` is ``"ok"`` if the film meets all. A baseline is read, never
        written.
        """
        return Check(_magsplice.check(self, self._baseline()))

    def _baseline(self) -> Any:
        """The baseline of the layout, or the reason why it cannot be read."""
        name = self._baseline_file
        return None if name is None else read_baseline(Path(self._source[-1] or ".") / name)

    @cached_property
    def recoil(self) -> Recoil | None:
        """The effect of recoil; None if no tile has a recoil permeability above 1.

        It is solved once, at the first evaluation of the film. Every field and result of the film
        comes from the cells.

        Raises
        ------
        MagspliceError
            If tiles overlap, or B does not reach the requested error with 120 000 cells.
        """
        found = _magsplice.recoil(self)
        if found is None:
            return None
        numbers, more = found
        for value in more.values():
            if isinstance(value, np.ndarray):
                # The result is kept.
                value.flags.writeable = False
        return Recoil(numbers, names=self.tiles.names, **more)

    def recoil_estimate(self, mu_r: float = 1.05) -> RecoilEstimate | None:
        """The effect of recoil to first order, as in ``magsplice plan`` and ``check``.

        Parameters
        ----------
        mu_r : float
            Relative recoil permeability of all tiles. No effect if the layout has its own.

        Returns
        -------
        RecoilEstimate | None
            None if the layout has no ideal film, no working volume or more than 1000 tiles, or its
            figures are undefined.

        Raises
        ------
        ValueError
            If `mu_r` is not a permeability.
        MagspliceError
            If tiles overlap.
        """
        found = _magsplice.recoil_estimate(self, mu_r)
        return None if found is None else RecoilEstimate(found)

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
        """Decoupling errors of films as made, with the errors of ``[tolerance]``.

        Sample number i depends on the seed and on i alone. The result does not depend on the
        division of the samples into calls, threads or workers.

        Parameters
        ----------
        samples : int, optional
            Number of films, up to 10 million. Default: the number in the layout, else 1000.
        preset : {"by-hand", "workshop", "jig"}, optional
            Typical errors of every tile, instead of the errors of the layout.
        seed : int, optional
            Seed. Default: the seed in the layout, else 1.
        first : int
            Number of the first sample.
        threads : int, optional
            Number of threads, at most four per processor. Default: all processors, and 1 in a task
            of a client.
        client : distributed.Client, optional
            Dask client whose workers compute the samples. The loss of a worker costs time, but no
            sample. docs/python-cluster.md describes clusters.
        partition : int, optional
            Number of samples of a task of the client. Default: for 8 tasks per thread of the
            workers, at most 10 000.
        progress : callable, optional
            Called with the number of finished samples and the total number.

        Raises
        ------
        MagspliceError
            If the errors of a sample cannot be computed.
        """
        stated = self._sampling
        count = stated[0] if samples is None else whole("samples", samples, 1, _MOST_SAMPLES)
        seed = stated[1] if seed is None else whole("seed", seed, 0)
        first = whole("first", first, 0, LARGEST_SEED - count)
        threads = None if threads is None else whole("threads", threads, 1, _MOST_THREADS)
        partition = None if partition is None else whole("partition", partition, 1, _MOST_SAMPLES)
        if client is not None:
            draw = partial(_magsplice.samples, self, preset, seed, threads=threads or 1)
            errors = _cluster.samples(client, draw, first, count, partition, progress)
        else:
            errors = _magsplice.samples(self, preset, seed, first, count, threads, progress)
        return Samples(errors, _magsplice.sampled(self, preset, seed, first, errors), preset)

    def budget(
        self, samples: int = 200, *, preset: Preset | None = None, seed: int | None = None
    ) -> Budget:
        """The displacement error of films as made, split into its causes.

        The mean square is divided into the splicing pattern, the end of the film, and each cause of
        ``[tolerance]``, as in ``magsplice budget``.

        Parameters
        ----------
        samples : int
            Number of samples that check or compute the division, from 20 to 1 000 000.
        preset : {"by-hand", "workshop", "jig"}, optional
            Typical errors of every tile, instead of the errors of the layout.
        seed : int, optional
            Seed. Default: the seed in the layout, else 1.

        Raises
        ------
        ValueError
            If `samples` is out of range.
        MagspliceError
            If the errors of a sample cannot be computed.
        """
        samples = whole("samples", samples, 20, 1_000_000)
        seed = self._sampling[1] if seed is None else whole("seed", seed, 0)
        return Budget(_magsplice.budget(self, preset, seed, samples))

    def forces(
        self,
        order: Literal["given", "least"] | Sequence[str] | None = None,
        *,
        seed: int = 1,
        turned_error: float = 1e-9,
    ) -> Forces:
        """Forces and torques of the tiles on each other, as in ``magsplice forces``.

        For tiles with parallel edges they have a closed form, exact to round-off, even in contact.
        Tiles with a recoil permeability are divided into 27 cells or more, with their polarization
        in the whole film.

        Parameters
        ----------
        order : {"given", "least"} or sequence of str, optional
            Placement order: the order of the layout, the order with the smallest holding force
            found, or the names of all tiles. Default: none.
        seed : int
            Seed of the search for the smallest holding force.
        turned_error : float
            Largest relative error of the force of two tiles turned against each other, from 1e-13
            to 0.1.

        Raises
        ------
        ValueError
            If the order does not have each tile once, or `turned_error` is out of range.
        MagspliceError
            If there are more than 4000 tiles or cells, or the force of turned tiles does not reach
            `turned_error`.
        """
        if not 1e-13 <= turned_error <= 0.1:
            raise ValueError(f"turned_error = {turned_error}, must be from 1e-13 to 0.1")
        seed = whole("seed", seed, 0)
        chosen: str | list[int] | None = None
        if order is not None:
            chosen = order if order in ("given", "least") else steps_of(order, self.tiles.names)
        return Forces(_magsplice.forces(self, turned_error, chosen, seed))

    def assign(
        self,
        measured: Iterable[MeasuredTile],
        *,
        placed: Iterable[PlacedTile] = (),
        shims: Iterable[str] = (),
        may_turn_over: bool = True,
        starts: int | None = None,
        seed: int = 1,
        strength_error: float | None = None,
        direction_error_deg: float | None = None,
        size_error_mm: float | None = None,
    ) -> Assignment:
        """The assignment of measured tiles to places that minimizes the displacement error.

        As in ``magsplice assign``: local searches from many starts, by the exact derivatives and
        then the exact field. Recoil adds the same field as in the film as ordered.

        Parameters
        ----------
        measured : iterable of MeasuredTile
            The tiles in the box, including spares.
        placed : iterable of PlacedTile
            Tiles of the box already placed. They stay; the remaining tiles compensate.
        shims : iterable of str
            Places of tiles with adjustable strength.
        may_turn_over : bool
            Whether tiles may be turned over from their orientation as measured.
        starts : int, optional
            Number of random starts, from 1 to 10 000. By default 16 at a time, until 4 of them
            agree on the best assignment, at most 128.
        seed : int
            Seed of the random numbers.
        strength_error, direction_error_deg, size_error_mm : float, optional
            Standard deviations of the errors of the measurements: of the strength as a fraction up
            to 0.5, of the direction of J about each axis normal to it up to 45 degrees, and of each
            side up to 10 mm. With any of them `Assignment.measured_rms_mm` is computed.

        Raises
        ------
        ValueError
            If `starts` or an error is out of range.
        MagspliceError
            If a tile breaks a rule, or the tiles cannot be assigned. The message lists all tiles
            that break rules.

        Examples
        --------
        >>> import magsplice
        >>> squares = [(x, y, 0.5) for x in (-2.5, 2.5) for y in (-2.5, 2.5)]
        >>> film = magsplice.Film(
        ...     [magsplice.Tile(at, (3, 3, 1), (0, 0, 0.12)) for at in squares],
        ...     name="four squares",
        ...     ideal={"wavelength_mm": 10, "thickness_mm": 1, "amplitude_t": 0.12},
        ...     volume={"x_mm": [-1, 1], "y_mm": [-1, 1], "z_mm": [-4, -3], "step_mm": 0.5},
        ... )
        >>> strengths_t = [0.121, 0.118, 0.12, 0.119, 0.122]
        >>> tiles = [magsplice.MeasuredTile(f"cut-{n}", t) for n, t in enumerate(strengths_t)]
        >>> found = film.assign(tiles)
        >>> found.spares, found.rms_mm <= found.in_order_rms_mm
        (1, True)
        """
        if starts is not None:
            starts = whole("starts", starts, 1, MOST_STARTS)
        seed = whole("seed", seed, 0)
        errors = measurement_errors(strength_error, direction_error_deg, size_error_mm)
        numbers, text = _magsplice.assign(
            self,
            [measured_row(MeasuredTile(*tile)) for tile in measured],
            [placed_row(PlacedTile(*tile)) for tile in placed],
            list(shims),
            may_turn_over,
            starts,
            seed,
            errors,
        )
        film = film_of_text(text, "the assigned film", self._source[-1])
        return Assignment(numbers, film=film)

    def design(
        self,
        *,
        least_amplitude: float | None = None,
        progress: Callable[[str, int, int, float | None], Any] | None = None,
    ) -> Design:
        """Search for the film with the best decoupling under the rules of ``[design]``.

        Parameters
        ----------
        least_amplitude : float, optional
            Smallest best-fit amplitude against the ideal film, instead of the value in
            ``[design]``.
        progress : callable, optional
            Called with the stage, the number of finished items, the total number (0 if unknown),
            and the best error so far (None before the first film).

        Raises
        ------
        ValueError
            If `least_amplitude` is not above 0.
        MagspliceError
            If the search finds no film.

        Warns
        -----
        LayoutWarning
            If the film found does not meet its demands, `Design.short_of`.

        Examples
        --------
        >>> better = film.replace(
        ...     design={"vary": ["size", "position", "direction"], "symmetry": "four-fold"}
        ... ).design()  # doctest: +SKIP
        """
        if least_amplitude is not None and not 0 < least_amplitude < np.inf:
            raise ValueError(f"least_amplitude = {least_amplitude}, must be above 0 and finite")
        numbers, text = _magsplice.design(self, least_amplitude, False, progress)
        _findings.warn_of_search(numbers["short_of"])
        return Design(numbers, film=film_of_text(text, "the film found", self._source[-1]))

    def front(
        self,
        least_amplitudes: Sequence[float] = (0.6, 0.7, 0.8, 0.85, 0.9, 0.95, 1.0, 1.05),
        *,
        client: Any = None,
    ) -> Front:
        """Trade-off of error against amplitude: one search for each smallest amplitude.

        The searches are independent and can run on several machines. ``magsplice design --front``
        also begins each search at the film found before.

        Parameters
        ----------
        least_amplitudes : sequence of float
            Smallest best-fit amplitudes of the films.
        client : distributed.Client, optional
            Dask client whose workers run the searches. It does not change the films.

        Returns
        -------
        Front
            The films that no other film beats in both error and amplitude.
        """
        searches = [partial(self.design, least_amplitude=least) for least in least_amplitudes]
        if client is None:
            return front_of(least_amplitudes, [search() for search in searches])
        return front_of(least_amplitudes, _cluster.gathered(client, searches))

    def sweep(
        self,
        parameter: str | Callable[[Film, Any], Film],
        values: Iterable[Any],
        result: Callable[[Film], Any] | None = None,
    ) -> Sweep[Film]:
        """Results of the film for several values of a parameter. A table of the results.

        Parameters
        ----------
        parameter : str or callable
            Key of a layout file with its table, such as ``"volume.step_mm"``; or a function of the
            film and a value that returns a film.
        values : iterable
            The values.
        result : callable, optional
            A function of a film that returns a result, such as ``Film.compare``, or a number, or a
            dictionary of numbers. Default: ``Film.decouple``.

        Examples
        --------
        >>> film.sweep("material.recoil_permeability", [1.0, 1.05, 1.1])  # doctest: +SKIP
        >>> def gap(film, gap_mm):
        ...     return film + film.rotated((180, 0, 0)).moved((0, 0, -gap_mm))
        >>> film.sweep(gap, [6, 7, 8], lambda pair: pair.b([0, 0, -3])[2])  # doctest: +SKIP
        """
        if callable(parameter):
            change, name = parameter, getattr(parameter, "__name__", "parameter")
        else:
            change, name = partial(_with_key, key=parameter), parameter
        of_film = Film.decouple if result is None else result
        return values_of(name, list(values), lambda value: change(self, value), of_film)

    def parts(self, kerf_mm: float | None = None) -> Parts:
        """Bill of materials: how many identical pieces of each part, as in ``magsplice tiles``.

        Parameters
        ----------
        kerf_mm : float, optional
            Width of material that a cut removes, from 0 to 100 mm; adds the area of sheet and the
            length of bar of each part.

        Raises
        ------
        ValueError
            If `kerf_mm` is out of range.
        """
        return Parts(_magsplice.parts(self, None if kerf_mm is None else float(kerf_mm)))

    def c_header(self, error_mm: float = 0.005) -> str:
        """Header of C99 for firmware: a function from a reading to the displacement of the sensor.

        As in ``magsplice export --to c-header``.

        Parameters
        ----------
        error_mm : float
            Largest length of the error of the displacement in the working volume, in millimetres.

        Raises
        ------
        ValueError
            If `error_mm` is not above 0.
        MagspliceError
            If the layout has no working volume, the sensor cannot read the field, or no polynomial
            has this error.
        """
        if not 0 < error_mm < np.inf:
            raise ValueError(f"error_mm = {error_mm}, must be above 0 and finite")
        return _magsplice.c_header(self, float(error_mm))

    def plot(self, figure: str = "layout") -> Figure:
        """A figure of the film as SVG and PNG, which a notebook shows. It needs no matplotlib.

        Parameters
        ----------
        figure : str
            ``"layout"``, the tiles from above; ``"ideal-polarization"`` or ``"ideal-vectors"``, the
            ideal film; or another name in ``film.report().figures``.

        Raises
        ------
        ValueError
            If the report of the film has no such figure.

        Examples
        --------
        >>> Path("film.png").write_bytes(film.plot().png)  # doctest: +SKIP
        """
        if figure == "layout":
            return Figure(*_magsplice.layout_figure(self))
        if figure.startswith("ideal-"):
            ideal = {drawn[0]: Figure(*drawn) for drawn in _magsplice.ideal_film_figures(self)}
            one_of("figure", figure, ideal)
            return ideal[figure]
        one_of("figure", figure, figures := self.report().figures)
        return figures[figure]

    def report(self, *, outlines: bool = False, within: float | str | None = None) -> Report:
        """Figures of the film and one HTML page, as in ``magsplice report``.

        Parameters
        ----------
        outlines : bool
            Whether text of SVG files becomes outlines, which look the same on every machine.
        within : float or str, optional
            Tolerance of the field of the working volume; see `b`.

        Returns
        -------
        Report
            ``report.save("folder")`` writes the files; a notebook shows the page.
        """
        numbers = "{}"
        if self.grid is not None and self.ideal is not None:
            comparison, decoupling = self.compare(within=within), self.decouple(within=within)
            numbers = json.dumps(
                {"comparison": comparison.to_dict(), "decoupling": decoupling.to_dict()}
            )
        accepted = tolerance_of(within)
        baseline = self._baseline()
        return Report(*_magsplice.report(self, numbers, outlines, accepted, baseline))

    def view(self, height_px: int = VIEW_PX) -> Page:
        """Rotatable view of the tiles, for a notebook.

        Parameters
        ----------
        height_px : int
            Height in pixels.
        """
        return Page(view_html(self), height_px)

    def show(
        self, height_px: int = LIVE_PX, *, engine: str | os.PathLike[str] | None = None
    ) -> Page:
        """Live page of the film, for a notebook: tiles are dragged, and every number follows.

        The page computes by itself, so that it works in a saved notebook without Python. It does
        not change this film: its button *Download TOML* saves the film of the page.

        Parameters
        ----------
        height_px : int
            Height in pixels.
        engine : str or path, optional
            WebAssembly module of the page, compressed by xz. Default: the module of the package.

        Raises
        ------
        MagspliceError
            If neither the package nor the argument has a module.
        """
        return Page(live_html(self, self._source[0], engine), height_px, live=True)

    def to_magpylib(self) -> Any:
        """Film as a `magpylib.Collection` of cuboids, in metres and tesla.

        Tiles with a recoil permeability become their cells, with the polarization consistent with
        the field, because magpylib has no recoil.

        Needs magpylib: ``pip install "magsplice[magpylib]"``.
        """
        return to_magpylib(self)


#: Keys of tables that stand for all other keys of the table.
_PRESETS = {"tolerance": "preset", "sensor": "part"}

#: Settings of a part, and the keys whose values follow from them.
_SETTINGS = ("gain_sel", "res", "full_scale_gauss")
_OF_SETTINGS = ("noise_ut", "count_ut", "range_mt")


def _merged(name: str, before: Mapping[str, Any], table: Any) -> Any:
    """Table with the keys of the table before that it does not have."""
    known = before.get(name)
    if isinstance(table, Head):
        table = dict.fromkeys(HEAD_KEYS) | table.to_dict()
    if isinstance(table, Mapping) and isinstance(known, dict) and _PRESETS.get(name) not in table:
        if name == "sensor" and any(key in table for key in _SETTINGS):
            known = {key: value for key, value in known.items() if key not in _OF_SETTINGS}
        return {**known, **table}
    return table


def _with_key(film: Film, value: Any, *, key: str) -> Film:
    """Film with another value of a key, such as ``volume.step_mm``."""
    table, _, inner = key.partition(".")
    return film.replace(**{table: {inner: value} if inner else value})


def _of_tables(layout: Mapping[str, Any], folder: str | os.PathLike[str] | None) -> Film:
    """Film of a layout file given as a dictionary."""
    tables = {"format": 1, **{key: table_of(part) for key, part in layout.items()}}
    origin = str(tables.get("name") or "layout")
    try:
        return _of_text_without_lines(_toml.text_of(tables), origin, folder)
    except LayoutError as error:
        # An error of the text, which the user does not see.
        faults = [] if error.faults else _toml.faults_of(str(error), tables)
        raise LayoutError.of_faults(origin, faults) if faults else error from None


def _of_text_without_lines(text: str, origin: str, folder: str | os.PathLike[str] | None) -> Film:
    """Film of a text that the user does not see. Errors do not have its lines."""
    try:
        return film_of_text(text, origin, folder)
    except LayoutError as error:
        faults = [(fault.place, fault.message) for fault in error.faults]
        raise LayoutError.of_faults(origin, faults) if faults else error from None


def film_of_text(text: str, origin: str, folder: str | os.PathLike[str] | None) -> Film:
    """Film from the text of a layout file."""
    film: Film = _magsplice.Film.__new__(Film, text, origin, folder)
    return film


class Assignment(OfFilm, Table):
    """A film with the tile of each place. A table of the plan, one row for each place.

    RMS displacement errors are over the working volume and its three axes, in millimetres.
    """

    film: Film = key(
        """The film with its measured tiles. Its ``[tolerance]`` has the placement errors and the
        measurement errors."""
    )
    measured_tiles: int = key("Number of measured tiles.")
    spares: int = key("Number of remaining tiles.")
    ordered_rms_mm: float = key("RMS displacement error of the film as ordered.")
    in_order_rms_mm: float = key("RMS displacement error of the tiles in the given order.")
    rms_mm: float = key("RMS displacement error of the tiles as assigned.")
    starts_rms_mm: list[float] = key("RMS by the linear model at the end of each search.")
    measurement_errors: dict[str, float | None] | None = key(
        "Standard deviations ``strength``, ``direction_rad`` and ``size_mm``, if given."
    )
    measured_rms_mm: Statistics | None = key(
        "The distribution of the RMS with the measurement errors, if given.",
        Statistics,
    )
    shims: list[Shim] = key("Tiles with adjustable strength.", Shim)
    plan: list[PlacedTile] = key(
        "The tile of each place, in the order of the places. The tile of a shim is ``shim``.",
        lambda row: PlacedTile(**row),
    )

    def columns(self) -> dict[str, Column]:
        """Columns place, tile, x_mm, y_mm, z_mm, up, mark, mark_deg, placed, as in a plan file."""
        centres = np.array([row.centre_mm for row in self.plan], dtype=float)
        return {
            "place": [row.place for row in self.plan],
            "tile": [row.tile for row in self.plan],
            **split(("x_mm", "y_mm", "z_mm"), centres),
            "up": [row.up for row in self.plan],
            "mark": [row.mark for row in self.plan],
            "mark_deg": np.array([row.mark_deg for row in self.plan]),
            "placed": ["yes" if row.is_placed else "no" for row in self.plan],
        }


class Design(Result):
    """The film found by a search, with the errors before and after."""

    film: Film = key('The film found; ``film.save("better.toml")`` writes it.')
    before: Metrics = key("Errors of the film before the search, over its working volume.", Metrics)
    after: Metrics = key("Errors of the film found, over the working volume.", Metrics)
    five_times_finer: Metrics = key(
        "Errors of the film found, over the design grid refined five times.", Metrics
    )
    made: MadeFilms | None = key(
        """Errors of films as made, from both; None unless the design minimizes them (``under =
        "tolerance"``).""",
        MadeFilms,
    )
    error: float = key(
        """The minimized error: the root of the weighted sum of squares of the three uniformity or
        displacement RMSE (in millimetres), by the goal of ``[design]``; 95th percentiles where the
        design minimizes errors of films as made; the scaled relative RMSE of B for the goal
        ``field``."""
    )
    stages: list[SearchStage] = key("Stages of the search.", SearchStage)
    parts: int = key("Number of distinct parts.")
    spacing_mm: float | None = key(
        "Spacing of the head, where the search varied it, in millimetres; None otherwise."
    )
    starts_that_agree: int = key("Number of starts with an error within a tenth of the best.")
    short_of: list[str] = key(
        """Demands that the film does not meet, among them an error of at most a tenth of the
        travel. Empty if it meets all."""
    )
    out_of_range: OutOfRange | None = key(
        "Readings beyond the range of the sensor; None if all are within it.", OutOfRange
    )
    interrupted: bool = key("Always False: an interrupted search raises its exception.")


def searched(
    pattern: Film, progress: Callable[[str, int, int, float | None], Any] | None
) -> Design:
    """The film found from a pattern."""
    numbers, text = _magsplice.design(pattern, None, True, progress)
    _findings.warn_of_search(numbers["short_of"])
    return Design(numbers, film=film_of_text(text, "the film found", None))


class Front(Table):
    """The films of a trade-off of error against amplitude, in ascending order of the amplitude.

    No other film found is as good in error and amplitude and better in one of them, and every film
    has its requested amplitude.

    Attributes
    ----------
    least_amplitudes : list[float]
        Requested amplitude of each film.
    designs : list[Design]
        The films.
    """

    def __init__(self, least_amplitudes: list[float], designs: list[Design]) -> None:
        self.least_amplitudes = least_amplitudes
        self.designs = designs

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

    def __str__(self) -> str:
        return _html.rows_text(self.columns())

    def __repr__(self) -> str:
        return f"<magsplice.Front: {len(self)} films>\n{self}"

    def _repr_html_(self) -> str:
        return _html.rows_table(self.columns())


def front_of(least_amplitudes: Iterable[float], designs: Iterable[Design]) -> Front:
    """Films that keep their amplitude and are not beaten by another film."""
    pairs = zip(least_amplitudes, designs, strict=True)
    kept = [pair for pair in pairs if not pair[1].short_of]
    kept.sort(key=lambda pair: (pair[1].after.amplitude, -pair[1].error))
    front: list[tuple[float, Design]] = []
    # From the largest amplitude on, each film must have a smaller error than all stronger ones.
    for least, design in reversed(kept):
        if not front or design.error < front[0][1].error:
            front.insert(0, (least, design))
    return Front([least for least, _ in front], [design for _, design in front])
