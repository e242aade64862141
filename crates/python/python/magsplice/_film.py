"""Films: layouts with their field and everything that is computed from it."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from magsplice import _html, _magsplice, _toml
from magsplice._layout import Floats, Grid, Ideal, Tile, Tiles, Vector, Volume, table_of
from magsplice._results import (
    Comparison,
    Decoupling,
    Design,
    Front,
    Page,
    Readings,
    Report,
    Samples,
    front_of,
)
from magsplice.errors import LayoutError, MagspliceError

if TYPE_CHECKING:
    import xarray

__all__ = ["Film", "Invalid", "load", "loads", "splice"]

Invalid = Literal["raise", "nan"]
Preset = Literal["by-hand", "workshop", "jig"]

#: Number of samples and seed of layouts that state none.
_SAMPLING = (1000, 1)
#: Most tiles with which a notebook shows the view that can be turned, which it keeps in its file.
_MOST_TILES_IN_VIEW = 2000


def load(path: str | os.PathLike[str]) -> Film:
    """Film in a layout file.

    Parameters
    ----------
    path : str or path
        TOML file, as docs/layout-format.md describes it and ``magsplice init`` writes it.

    Returns
    -------
    Film
        Lengths in millimetres, flux density and polarization in tesla.

    Raises
    ------
    OSError
        If the file cannot be read, such as `FileNotFoundError`.
    LayoutError
        If it is no layout. All broken rules are in ``error.faults``.

    Examples
    --------
    >>> film = magsplice.load("layouts/published-film.toml")  # doctest: +SKIP
    >>> film.b([0.0, 0.0, -5.0])  # doctest: +SKIP
    """
    core = _magsplice.Film.read(path)
    # The text is kept, so that copies of the film in other processes have the same bits.
    data = Path(path).read_bytes()
    if hashlib.sha256(data).hexdigest() != core.sha256:
        raise LayoutError(f"{os.fspath(path)}: changed while it was read: load it again")
    return Film._made(core, data.decode(), os.fspath(path), str(Path(path).absolute().parent))


def loads(
    text: str, *, origin: str = "layout", folder: str | os.PathLike[str] | None = None
) -> Film:
    """Film in the text of a layout file.

    Parameters
    ----------
    text : str
        TOML, as in a layout file.
    origin : str
        Name of the text in error messages.
    folder : str or path, optional
        Folder of files that the text names, such as measured errors. Default: the working folder.

    Returns
    -------
    Film

    Raises
    ------
    LayoutError
        If the text is no layout. All broken rules are in ``error.faults``.
    """
    folder = None if folder is None else os.fspath(folder)
    return Film._made(_magsplice.Film.parse(text, origin, folder), text, origin, folder)


def splice(
    wavelength_mm: float,
    film_mm: tuple[float, float],
    *,
    thickness_mm: float | None = None,
    remanence_t: float = 0.12,
    range_mm: tuple[float, float] | None = None,
    distance_mm: tuple[float, float] | None = None,
    smallest_cut_mm: float | None = None,
    gap_mm: float = 0.0,
    resolution_mm: float = 0.001,
    resolution_deg: float = 0.01,
    least_amplitude: float = 0.65,
    parts: int | None = None,
    goal: Literal["uniformity", "displacement", "field"] = "displacement",
    starts: int = 8,
    seed: int = 1,
) -> Film:
    """Film to begin a design with, from a few numbers: the pattern of Dai 2024, Fig. 5.

    ``splice(10, (20, 20)).design()`` then searches, as ``magsplice splice`` does.

    Parameters
    ----------
    wavelength_mm : float
        Wavelength of the ideal film, in millimetres.
    film_mm : (float, float)
        Extent of the film along x and y, in millimetres, at least 5/6 of the wavelength.
    thickness_mm : float, optional
        Thickness of the film. Default: a tenth of the wavelength.
    remanence_t : float
        Magnitude of the polarization of every tile, in tesla.
    range_mm : (float, float), optional
        Extent of the working volume along x and y. Default: 0.4 wavelengths.
    distance_mm : (float, float), optional
        Least and largest distance of the sensor below the film. Default: 0.3 and 0.5 wavelengths.
    smallest_cut_mm : float, optional
        Shortest side of a tile. Default: 0.08 wavelengths.
    gap_mm : float
        Least distance of neighbouring tiles.
    resolution_mm, resolution_deg : float
        Sizes and directions are rounded to multiples of these.
    least_amplitude : float
        Least best-fit amplitude against the ideal film.
    parts : int, optional
        Largest number of distinct parts.
    goal : {"displacement", "uniformity", "field"}
        Error that the design minimizes.
    starts, seed : int
        Number of starts of the search, and the seed of the random numbers that vary them.

    Returns
    -------
    Film

    Raises
    ------
    MagspliceError
        If numbers are out of range; the message has all of them.
    """
    wave = wavelength_mm
    text = _magsplice.splice(
        wave,
        film_mm,
        0.1 * wave if thickness_mm is None else thickness_mm,
        remanence_t,
        (0.4 * wave, 0.4 * wave) if range_mm is None else range_mm,
        (0.3 * wave, 0.5 * wave) if distance_mm is None else distance_mm,
        0.08 * wave if smallest_cut_mm is None else smallest_cut_mm,
        gap_mm,
        resolution_mm,
        resolution_deg,
        least_amplitude,
        parts,
        goal,
        starts,
        seed,
    )
    return loads(text, origin="the pattern")


class Film:
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
    expect, design, tolerance, sensor, elastomer : mapping, optional
        Tables of the layout file of these names, such as
        ``tolerance={"preset": "workshop", "size_mm": 0.02}``; docs/layout-format.md has all keys.

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

    _core: _magsplice.Film
    _text: str
    _origin: str
    _folder: str | None

    def __init__(
        self,
        tiles: Iterable[Tile],
        *,
        name: str,
        description: str | None = None,
        ideal: Ideal | Mapping[str, Any] | None = None,
        volume: Volume | Mapping[str, Any] | None = None,
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
                "expect": expect,
                "design": design,
                "tolerance": tolerance,
                "sensor": sensor,
                "elastomer": elastomer,
                "tile": tiles,
            }
        )
        self.__dict__.update(made.__dict__)

    @classmethod
    def _made(cls, core: _magsplice.Film, text: str, origin: str, folder: str | None) -> Film:
        film = object.__new__(cls)
        film._core, film._text, film._origin, film._folder = core, text, origin, folder
        return film

    @classmethod
    def from_dict(
        cls, layout: Mapping[str, Any], *, folder: str | os.PathLike[str] | None = None
    ) -> Film:
        """Film of a layout file given as a dictionary; `to_dict` is the inverse.

        Parameters
        ----------
        layout : mapping
            The keys and tables of a layout file, such as ``{"name": "one", "tile": [...]}``. Tables
            may also be `Tile`, `Ideal` and `Volume`, and arrays stand for lists. ``format`` may be
            left out, and keys with the value None count as left out.
        folder : str or path, optional
            Folder of files that the layout names. Default: the working folder.

        Raises
        ------
        LayoutError
            If it is no layout.
        """
        tables = {"format": 1, **{key: table_of(part) for key, part in layout.items()}}
        name = tables.get("name")
        return loads(_toml.text_of(tables), origin=str(name or "layout"), folder=folder)

    def to_dict(self) -> dict[str, Any]:
        """Layout in the plain form: one entry of ``tile`` for each tile, all keys as in a file."""
        layout: dict[str, Any] = json.loads(self._core.to_json())
        return layout

    def replace(self, **tables: Any) -> Film:
        """Film with other tables or keys.

        Parameters
        ----------
        **tables
            Keys of a layout file with their new values: ``name``, ``description``, ``ideal``,
            ``volume``, ``tolerance``, ``design``, ``sensor``, ``elastomer``, ``expect``, and
            ``tile`` with the tiles. None removes a table.

        Examples
        --------
        >>> volume = film.to_dict()["volume"]  # doctest: +SKIP
        >>> finer = film.replace(volume={**volume, "step_mm": 0.25})  # doctest: +SKIP
        """
        return Film.from_dict({**self.to_dict(), **tables}, folder=self._folder)

    def to_toml(self, *, compact: bool = True) -> str:
        """Layout as TOML, which the program and `loads` read.

        Parameters
        ----------
        compact : bool
            Whether tiles that are mirror images of others are left out. Otherwise there is one
            ``[[tile]]`` for each tile.
        """
        return self._core.to_toml(compact)

    def save(self, path: str | os.PathLike[str], *, compact: bool = True) -> None:
        """Writes the layout as TOML; see `to_toml`. An existing file is replaced."""
        Path(path).write_text(self.to_toml(compact=compact), encoding="utf-8")

    def __reduce__(self) -> tuple[Callable[..., Film], tuple[str, str, str | None]]:
        # The text makes the same film bit for bit. Files that it names must be in reach.
        return _unpickled, (self._text, self._origin, self._folder)

    def __len__(self) -> int:
        return len(self._core)

    def __repr__(self) -> str:
        return f"<magsplice.Film {self.name!r}: {len(self)} tiles, sha256 {self.sha256[:12]}>"

    # Parts ------------------------------------------------------------------------------------

    @property
    def name(self) -> str:
        """Name of the layout."""
        return self._core.name

    @property
    def description(self) -> str | None:
        """Text of the author about the layout."""
        return self._core.description

    @property
    def history(self) -> list[str]:
        """Steps that led to the layout, one text each."""
        return self._core.history

    @property
    def sha256(self) -> str:
        """SHA-256 of the text of the layout, in hexadecimal."""
        return self._core.sha256

    @property
    def findings(self) -> list[str]:
        """Properties that are allowed but usually a mistake, one sentence each."""
        return self._core.findings

    @cached_property
    def tiles(self) -> Tiles:
        """All tiles, repetitions written out."""
        return Tiles(*self._core.tiles())

    @property
    def ideal(self) -> Ideal | None:
        """The ideal film; None if the layout has none."""
        ideal = self._core.ideal
        return None if ideal is None else Ideal(*ideal)

    @property
    def volume(self) -> Volume | None:
        """The working volume; None if the layout has none."""
        volume = self._core.volume
        if volume is None:
            return None
        *_, lower, upper, step, reference = volume
        x, y, z = zip(lower, upper, strict=True)
        return Volume(x, y, z, step[0] if len(set(step)) == 1 else step, reference)

    @property
    def grid(self) -> Grid | None:
        """The grid of the working volume; None if the layout has none."""
        volume = self._core.volume
        return None if volume is None else Grid(*volume[:3])

    @property
    def reference_mm(self) -> Vector | None:
        """Point of the working volume from which displacements count, in millimetres."""
        volume = self._core.volume
        return None if volume is None else volume[-1]

    # Field ------------------------------------------------------------------------------------

    def b(
        self,
        points: ArrayLike | Grid,
        *,
        within: float | None = None,
        within_t: float | None = None,
        invalid: Invalid = "raise",
    ) -> Floats:
        """Flux density B in tesla.

        Parameters
        ----------
        points : array_like of shape (..., 3), or Grid
            Points in millimetres. An array of contiguous doubles is not copied.
        within : float, optional
            Accepted length of the error as a fraction of |B| at each point, such as 1e-6. Default:
            exact.
        within_t : float, optional
            Accepted length of the error in tesla. Excludes `within`.
        invalid : {"raise", "nan"}
            What happens at points without a field, such as those on exposed edges.

        Returns
        -------
        ndarray of shape (..., 3)
            B at each point; for a grid of shape (nx, ny, nz, 3). Exact values depend on no other
            point and on no number of threads.

        Raises
        ------
        PointsError
            If points have no field, or a tolerance cannot be kept there.
        ValueError
            If the points have another shape.

        Notes
        -----
        Error of the exact field: at most 2e-14 of the sum over tiles (see `error_bound`). On a face
        B is that of the side of larger x, y or z. A tolerance saves time on grids and with many
        tiles: docs/accuracy-and-speed.md.
        """
        return field(self._core.scene, "b", points, within, within_t, invalid)

    def h(
        self,
        points: ArrayLike | Grid,
        *,
        within: float | None = None,
        within_t: float | None = None,
        invalid: Invalid = "raise",
    ) -> Floats:
        """Field strength H in ampere per metre: (B - J) / mu0.

        See `b` for the parameters. A tolerance is that of B.
        """
        return field(self._core.scene, "h", points, within, within_t, invalid)

    def j(self, points: ArrayLike | Grid) -> Floats:
        """Polarization J in tesla of the tile at each point; 0 outside tiles.

        Parameters
        ----------
        points : array_like of shape (..., 3), or Grid
            Points in millimetres.

        Returns
        -------
        ndarray of shape (..., 3)
        """
        return field(self._core.scene, "j", points, None, None, "raise")

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
            Which field is differentiated.
        invalid : {"raise", "nan"}
            What happens at points without a gradient, such as those on edges.

        Returns
        -------
        ndarray of shape (..., 3, 3)
            Element (..., i, j) is the derivative of component i along coordinate j. The gradient of
            B is mu0 times that of H inside a tile too, so it is symmetric and has no trace.

        Raises
        ------
        PointsError
            If points have no gradient.
        """
        flat, shape = flattened(points.points_mm if isinstance(points, Grid) else points)
        values, error = self._core.scene.gradient(quantity, flat)
        if error is not None and invalid == "raise":
            raise error
        return values.reshape(*shape, 3, 3)

    def error_bound(self, points: ArrayLike | Grid) -> Floats:
        """Upper bound in tesla of the error of the exact B, shape (...).

        It is 2e-14 of an upper bound of the sum over tiles of the fields that the three components
        of J make alone. A component of B below it may be rounding alone.
        """
        flat, shape = flattened(points.points_mm if isinstance(points, Grid) else points)
        return self._core.scene.error_bounds_t(flat).reshape(shape)

    def ideal_b(self, points: ArrayLike | Grid) -> Floats:
        """Flux density of the ideal film in tesla (Dai 2024, Eq. 2), shape (..., 3).

        NaN at points that are not below the film, at z >= 0.

        Raises
        ------
        MagspliceError
            If the layout has no ideal film.
        """
        flat, shape = flattened(points.points_mm if isinstance(points, Grid) else points)
        return self._core.ideal_b(flat).reshape(*shape, 3)

    # Comparison and decoupling ----------------------------------------------------------------

    def compare(
        self,
        points: ArrayLike | None = None,
        *,
        within: float | None = None,
        within_t: float | None = None,
    ) -> Comparison:
        """Comparison of B with that of the ideal film (Dai 2024, Eq. 2).

        Parameters
        ----------
        points : array_like of shape (..., 3), optional
            Points below the film, in millimetres. Default: the grid of the working volume.
        within, within_t : float, optional
            Tolerance of the field; see `b`.

        Returns
        -------
        Comparison

        Raises
        ------
        MagspliceError
            If the layout has no ideal film, or points are not below the film.
        """
        field_t, flat, _ = self._evaluated(points, within, within_t)
        return Comparison(**_magsplice.compare(self._core, field_t, flat))

    def decouple(
        self,
        points: ArrayLike | None = None,
        *,
        within: float | None = None,
        within_t: float | None = None,
    ) -> Decoupling:
        """Decoupling parameters R_x, R_y, S_z and their errors (Dai 2024, Eqs. 13 to 15).

        Parameters
        ----------
        points : array_like of shape (..., 3), optional
            Points in millimetres. Default: the grid of the working volume, of which alone there is
            a uniformity RMSE.
        within, within_t : float, optional
            Tolerance of the field; see `b`.

        Returns
        -------
        Decoupling

        Raises
        ------
        MagspliceError
            If the layout has no ideal film or no working volume, or the parameters do not exist.
        """
        field_t, flat, shape = self._evaluated(points, within, within_t)
        numbers = _magsplice.decouple(self._core, field_t, flat)
        where = self.grid if flat is None else flat.reshape(*shape, 3)
        assert where is not None
        return Decoupling(
            where=where,
            field_t=field_t.reshape(*shape, 3),
            parameters=numbers["parameters"].reshape(*shape, 3),
            at_reference=numbers["at_reference"],
            reference_mm=self._required_reference(),
            singular_mm=numbers["singular_mm"],
            uniformity_rmse=numbers["uniformity_rmse"],
            ideal_rmse=numbers["ideal_rmse"],
            displacement_rmse_mm=numbers["displacement_rmse_mm"],
            wavenumber_per_mm=numbers["wavenumber_per_mm"],
        )

    def to_xarray(
        self,
        grid: Grid | None = None,
        *,
        within: float | None = None,
        within_t: float | None = None,
    ) -> xarray.Dataset:
        """B on a grid as an xarray dataset with the dimensions x, y, z and component.

        The variable ``b`` is B in tesla, and ``ideal_b`` that of the ideal film, if there is one.

        Parameters
        ----------
        grid : Grid, optional
            Default: the grid of the working volume.
        within, within_t : float, optional
            Tolerance of the field; see `b`.
        """
        import xarray

        grid = self._required_grid() if grid is None else grid
        dims = ("x", "y", "z", "component")
        tesla = {"units": "T"}
        fields = {"b": (dims, self.b(grid, within=within, within_t=within_t), tesla)}
        if self.ideal is not None:
            fields["ideal_b"] = (dims, self.ideal_b(grid), tesla)
        return xarray.Dataset(fields, coordinates(grid), {"film": self.name, "sha256": self.sha256})

    # Films that are made ----------------------------------------------------------------------

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
            Number of films. Default: that of the layout, 1000 if it states none.
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
        count = stated[0] if samples is None else int(samples)
        seed = stated[1] if seed is None else int(seed)
        if client is not None:
            from magsplice import _cluster

            arrays = _cluster.samples(
                client, self, preset, seed, first, count, threads or 1, partition, progress
            )
        else:
            arrays = _magsplice.samples(self._core, preset, seed, first, count, threads, progress)
        return Samples(self.name, preset, seed, first, *arrays, _magsplice.nominal(self._core))

    # Sensor -----------------------------------------------------------------------------------

    def read(
        self,
        readings_t: ArrayLike,
        *,
        noise_t: float | Sequence[float] | None = None,
        constant_t: Sequence[float] = (0.0, 0.0, 0.0),
    ) -> Readings:
        """Displacements, and forces, from what a Hall sensor reads below the film.

        Positions are found by the exact field and its gradient. Errors of the positions are those
        of the field, 2e-14 of the sum over tiles, over its gradient.

        Parameters
        ----------
        readings_t : array_like of shape (..., 3)
            Readings in tesla, as the sensor of ``[sensor]`` gives them; without this table it is a
            point that reads B.
        noise_t : float or sequence of 3 floats, optional
            Standard deviation of a reading along each axis, in tesla. Default: that of
            ``[sensor]``.
        constant_t : sequence of 3 floats
            What every reading contains besides the film's field, in tesla, such as a stray field.

        Returns
        -------
        Readings
            Displacements from the reference point, with standard deviations if there is noise, and
            forces if the layout has an ``[elastomer]``.

        Raises
        ------
        MagspliceError
            If the layout has no working volume, or the sensor cannot read the field.
        """
        flat, shape = flattened(readings_t)
        x, y, z = (float(value) for value in constant_t)
        numbers = _magsplice.read(self._core, flat, _vector(noise_t), (x, y, z))

        def shaped(array: Floats | None) -> Floats | None:
            return None if array is None else array.reshape(*shape, 3)

        return Readings(
            displacement_mm=numbers["displacement_mm"].reshape(*shape, 3),
            deviation_mm=shaped(numbers["deviation_mm"]),
            force_n=shaped(numbers["force_n"]),
            closed_form_mm=shaped(numbers["closed_form_mm"]),
            status=numbers["status"].reshape(shape),
            messages=numbers["messages"],
        )

    def resolution(
        self,
        points: ArrayLike | Grid | None = None,
        *,
        noise_t: float | Sequence[float] | None = None,
    ) -> Floats:
        """Standard deviations of the position that one reading gives, in millimetres.

        The shape is (..., 3). No unbiased estimate from one reading has smaller ones (the bound of
        Cramér and Rao).

        Parameters
        ----------
        points : array_like of shape (..., 3), or Grid, optional
            Points in millimetres. Default: the grid of the working volume.
        noise_t : float or sequence of 3 floats, optional
            Standard deviation of a reading along each axis, in tesla. Default: that of
            ``[sensor]``.

        Raises
        ------
        ValueError
            If neither `noise_t` nor the layout states a noise.
        MagspliceError
            If the layout has no working volume, or the sensor cannot read the field.
        """
        points = self._required_grid() if points is None else points
        flat, shape = flattened(points.points_mm if isinstance(points, Grid) else points)
        found = _magsplice.resolution(self._core, flat, _vector(noise_t))
        if found is None:
            raise ValueError(
                "noise_t is missing and the layout has no [sensor] with noise: "
                "give noise_t in tesla, such as 5e-6"
            )
        return found.reshape(*shape, 3)

    # Design -----------------------------------------------------------------------------------

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
        MagspliceError
            If the layout has no ``[design]``, or there is no film that keeps its rules.

        Examples
        --------
        >>> better = film.replace(
        ...     design={"vary": ["size", "position", "direction"], "symmetry": "four-fold"}
        ... ).design()  # doctest: +SKIP
        """
        numbers = _magsplice.design(self._core, least_amplitude, progress)
        film = loads(numbers["text"], origin="the film found", folder=self._folder)
        return Design.from_numbers(film, numbers, self.to_dict()["design"])

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
            from magsplice import _cluster

            designs = _cluster.designs(client, self, least_amplitudes)
        else:
            designs = [self.design(least_amplitude=least) for least in least_amplitudes]
        return front_of(list(least_amplitudes), designs)

    # Pictures ---------------------------------------------------------------------------------

    def report(self, *, outlines: bool = False, within: float | None = None) -> Report:
        """Figures of the film and one HTML page, as ``magsplice report`` draws them.

        Parameters
        ----------
        outlines : bool
            Whether text of SVG files becomes outlines, which look the same on every machine.
        within : float, optional
            Tolerance of the field of the working volume; see `b`.

        Returns
        -------
        Report
            ``report.save("folder")`` writes the files; a notebook shows the page.
        """
        field_t = None
        text, numbers = "", "{}"
        if self.grid is not None:
            field_t = self.b(self.grid, within=within).reshape(-1, 3)
            if self.ideal is not None:
                comparison, decoupling = self.compare(within=within), self.decouple(within=within)
                text = f"{comparison}\n\n{decoupling}\n"
                numbers = json.dumps(
                    {"comparison": comparison.to_dict(), "decoupling": decoupling.to_dict()}
                )
        figures, html, absent = _magsplice.report(self._core, field_t, text, numbers, outlines)
        return Report(figures, html, absent)

    def view(self, height_px: int = _html.VIEW_PX) -> Page:
        """View of the tiles that can be turned, for a notebook.

        Parameters
        ----------
        height_px : int
            Height in pixels.
        """
        return Page(_html.view_of(self), height_px)

    def to_magpylib(self) -> Any:
        """Film as a `magpylib.Collection` of cuboids, in metres and tesla.

        Needs magpylib: ``pip install "magsplice[magpylib]"``.
        """
        from magsplice._magpylib import to_magpylib

        return to_magpylib(self)

    def _repr_html_(self) -> str:
        return _html.film_html(self, with_view=len(self) <= _MOST_TILES_IN_VIEW)

    # Helpers ----------------------------------------------------------------------------------

    def _required_grid(self) -> Grid:
        if self.grid is None:
            raise MagspliceError(
                "the layout has no [volume] table, which this needs: add one, such as "
                'film.replace(volume={"x_mm": [-2, 2], "y_mm": [-2, 2], "z_mm": [-5, -3], '
                '"step_mm": 0.5})'
            )
        return self.grid

    def _required_reference(self) -> Vector:
        reference = self.reference_mm
        assert reference is not None
        return reference

    def _evaluated(
        self, points: ArrayLike | None, within: float | None, within_t: float | None
    ) -> tuple[Floats, Floats | None, tuple[int, ...]]:
        """B as rows, the points as rows unless they are the grid's, and the shape of the points."""
        if points is None:
            grid = self._required_grid()
            return self.b(grid, within=within, within_t=within_t).reshape(-1, 3), None, grid.counts
        flat, shape = flattened(points)
        return self.b(flat, within=within, within_t=within_t), flat, shape


def _unpickled(text: str, origin: str, folder: str | None) -> Film:
    return loads(text, origin=origin, folder=folder)


def _vector(value: float | Sequence[float] | None) -> Vector | None:
    if value is None:
        return None
    x, y, z = np.broadcast_to(np.asarray(value, dtype=float), 3).tolist()
    return (x, y, z)


def flattened(points: ArrayLike) -> tuple[Floats, tuple[int, ...]]:
    """Points as contiguous rows, and the leading shape. Contiguous doubles are not copied."""
    array: NDArray[np.float64] = np.ascontiguousarray(points, dtype=np.float64)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ValueError(
            f"points have the shape {array.shape}, must have (..., 3): x, y, z along the last axis"
        )
    return array.reshape(-1, 3), array.shape[:-1]


def field(
    scene: _magsplice.Scene,
    quantity: Literal["b", "h", "j"],
    points: ArrayLike | Grid,
    within: float | None,
    within_t: float | None,
    invalid: Invalid,
) -> Floats:
    """Field of a scene at points or on a grid."""
    if within is not None and within_t is not None:
        raise ValueError("within and within_t are both given: give one of them")
    if invalid not in ("raise", "nan"):
        raise ValueError(f'invalid = {invalid!r}, must be "raise" or "nan"')
    tolerance = None
    if within is not None:
        tolerance = (True, float(within))
    elif within_t is not None:
        tolerance = (False, float(within_t))
    if isinstance(points, Grid):
        shape: tuple[int, ...] = points.counts
        values, error = scene.field_on_grid(
            quantity, points.lower_mm, points.upper_mm, points.counts, tolerance
        )
    else:
        flat, shape = flattened(points)
        values, error = scene.field(quantity, flat, tolerance)
    if error is not None and invalid == "raise":
        raise error
    return values.reshape(*shape, 3)


def coordinates(grid: Grid) -> dict[str, Any]:
    """Coordinates of a grid for xarray."""
    millimetres = {"units": "mm"}
    return {
        "x": ("x", grid.x_mm, millimetres),
        "y": ("y", grid.y_mm, millimetres),
        "z": ("z", grid.z_mm, millimetres),
        "component": ("component", ["x", "y", "z"]),
    }
