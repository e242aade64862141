"""Parts of a layout: tiles, grids, working volume, ideal film."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from magsplice import _magsplice
from magsplice._arguments import whole
from magsplice._arrow import Column, Table, split
from magsplice._head import Head
from magsplice.errors import LayoutError

Floats = NDArray[np.float64]
Vector = tuple[float, float, float]

#: Optional keys of a layout file.
KEYS = (
    "description",
    "history",
    "overlap_mm",
    "ideal",
    "volume",
    "material",
    "expect",
    "design",
    "tolerance",
    "sensor",
    "elastomer",
    "kind",
    "tile",
    "lattice",
)


class Tile(NamedTuple):
    """A uniformly magnetized cuboid.

    Parameters
    ----------
    position_mm : (x, y, z)
        Centre, in millimetres.
    size_mm : (a, b, c)
        Full side lengths along the tile's own axes, in millimetres, each above 0.
    polarization_t : (x, y, z)
        Polarization J = mu0 M in the tile's own frame, in tesla.
    rotation : (x, y, z, w), optional
        Rotation from the tile's own frame to the frame of the film: a quaternion, a matrix of shape
        (3, 3), a rotation vector (x, y, z) in degrees, a mapping with the keys of ``rotation`` in
        layout files such as ``{"axis": [0, 0, 1], "angle_deg": 30}``, or any object with
        ``as_quat()``, such as `scipy.spatial.transform.Rotation`. Default: none.
    name : str, optional
        Unique name. Default: ``tile-1``, ``tile-2``, ...
    kind : str, optional
        Name of the kind in the layout file.
    recoil_permeability : float or (along, across), optional
        Relative recoil permeability: one number, or two numbers along the polarization and across
        it. Default: the value of ``[material]``.

    Examples
    --------
    >>> Tile((0, 0, 0.5), (3.3, 1.7, 1.0), (0.12, 0, 0)).size_mm
    (3.3, 1.7, 1.0)
    """

    position_mm: Sequence[float]
    size_mm: Sequence[float]
    polarization_t: Sequence[float]
    rotation: Any = None
    name: str | None = None
    kind: str | None = None
    recoil_permeability: float | Sequence[float] | None = None

    def to_dict(self) -> dict[str, Any]:
        """Tile as a table ``[[tile]]`` of a layout file."""
        return {
            "name": self.name,
            "position_mm": _numbers(self.position_mm),
            "size_mm": _numbers(self.size_mm),
            "polarization_t": _numbers(self.polarization_t),
            "rotation": None if self.rotation is None else rotation_table(self.rotation),
            "recoil_permeability": _permeability(self.recoil_permeability),
        }


def _numbers(values: ArrayLike) -> Any:
    """Numbers in the form of a layout file. The rules of the file apply to their shape."""
    return np.asarray(values, dtype=float).tolist()


def rotation_table(rotation: Any) -> dict[str, Any]:
    """Rotation of any form of `Tile` with the keys of a layout file."""
    if isinstance(rotation, Mapping):
        return {key: _listed(value) for key, value in rotation.items()}
    try:
        given = rotation.as_quat() if hasattr(rotation, "as_quat") else rotation
        numbers = np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        numbers = np.empty(0)
    if numbers.shape not in ((3,), (4,), (3, 3)):
        raise LayoutError(
            f"rotation = {rotation!r}, must be a quaternion x, y, z, w, a matrix of shape (3, 3), "
            "a rotation vector in degrees, a mapping such as "
            '{"axis": [0, 0, 1], "angle_deg": 30}, or have as_quat()'
        )
    if numbers.shape == (3,):
        angle_deg = float(np.linalg.norm(numbers))
        axis = numbers.tolist() if angle_deg else [0.0, 0.0, 1.0]
        return {"axis": axis, "angle_deg": angle_deg}
    return {"matrix" if numbers.ndim == 2 else "quaternion": numbers.tolist()}


def _listed(value: Any) -> Any:
    return np.asarray(value).tolist() if isinstance(value, (np.ndarray, tuple, list)) else value


def vector(name: str, value: ArrayLike) -> Vector:
    """Three finite numbers. ValueError for other values."""
    try:
        numbers = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        numbers = np.empty(0)
    if numbers.shape != (3,) or not np.isfinite(numbers).all():
        raise ValueError(f"{name} = {value!r}, must be three finite numbers")
    x, y, z = numbers.tolist()
    return (x, y, z)


def _permeability(stated: float | Sequence[float] | None) -> Any:
    if stated is None:
        return None
    numbers = np.asarray(stated, dtype=float)
    if numbers.ndim == 0:
        return float(numbers)
    if numbers.shape != (2,):
        raise ValueError(
            f"recoil_permeability = {stated!r}, must be one number, or one along and one across"
        )
    along, across = numbers.tolist()
    return {"along": along, "across": across}


class Lattice(NamedTuple):
    """A film cut along lines parallel to x and y: a tile in each cell with a pattern.

    A section of an axis is ``(widths_mm, pattern)`` or ``(widths_mm, pattern, times)``: the widths
    of consecutive intervals in millimetres, for each of them the component of the direction of J
    along this axis, and the number of repetitions.

    Parameters
    ----------
    start_mm : (x, y, z)
        Lower corner, in millimetres.
    height_mm : float
        Height along z, in millimetres.
    x : list of sections
        Intervals along x.
    y : list of sections, optional
        Intervals along y. Default: the intervals along x.
    strength_t : float, optional
        Magnitude of the polarization of every tile, in tesla. Give this or `component_t`.
    component_t : float, optional
        Factor of the pattern, in tesla: J is this times the pattern.
    name : str, optional
        First part of the names of its tiles. Default: ``lattice-1``, ``lattice-2``, ...
    recoil_permeability : float or (along, across), optional
        As of `Tile`.

    Examples
    --------
    >>> x = [([3.3, 1.7], [1, 0], 2)]
    >>> len(Film(lattice=[Lattice((-5, -5, 0), 1, x, strength_t=0.12)], name="cut"))
    12
    """

    start_mm: Sequence[float]
    height_mm: float
    x: Sequence[Any]
    y: Sequence[Any] | None = None
    strength_t: float | None = None
    component_t: float | None = None
    name: str | None = None
    recoil_permeability: float | Sequence[float] | None = None

    def to_dict(self) -> dict[str, Any]:
        """Lattice as a table ``[[lattice]]`` of a layout file."""
        return {
            **self._asdict(),
            "start_mm": _numbers(self.start_mm),
            "x": _sections(self.x),
            "y": None if self.y is None else _sections(self.y),
            "recoil_permeability": _permeability(self.recoil_permeability),
        }


def _sections(sections: Sequence[Any]) -> list[Any]:
    keys = ("widths_mm", "pattern", "times")
    return [
        section if isinstance(section, Mapping) else dict(zip(keys, section, strict=False))
        for section in sections
    ]


@dataclass(frozen=True, eq=False, repr=False)
class Tiles(Table):
    """Tiles of a film, as a sequence of `Tile` and as arrays with one row for each tile.

    Attributes
    ----------
    names : list[str]
        Names, unique within the film.
    kinds : list[str | None]
        Names of kinds; None for tiles without a kind.
    position_mm : ndarray
        Centres, in millimetres, shape (n, 3).
    size_mm : ndarray
        Full side lengths along the tiles' own axes, in millimetres, shape (n, 3).
    polarization_t : ndarray
        Polarizations J = mu0 M in the tiles' own frames, in tesla, shape (n, 3).
    rotation : ndarray
        Quaternions (x, y, z, w) from the tiles' frames to the frame of the film, shape (n, 4).
    recoil_permeability : ndarray
        Tiles' own relative recoil permeabilities, along the polarization and across it, shape (n,
        2); NaN for tiles with the value of ``[material]``.
    """

    names: list[str]
    kinds: list[str | None]
    position_mm: Floats
    size_mm: Floats
    polarization_t: Floats
    rotation: Floats
    recoil_permeability: Floats

    def __post_init__(self) -> None:
        for value in vars(self).values():
            if isinstance(value, np.ndarray):
                value.flags.writeable = False

    def __len__(self) -> int:
        return len(self.names)

    @overload
    def __getitem__(self, index: int) -> Tile: ...
    @overload
    def __getitem__(self, index: slice) -> list[Tile]: ...
    def __getitem__(self, index: int | slice) -> Tile | list[Tile]:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        rotation = tuple(self.rotation[index].tolist())
        along, across = self.recoil_permeability[index].tolist()
        own = None if np.isnan(along) else along if along == across else (along, across)
        return Tile(
            tuple(self.position_mm[index].tolist()),
            tuple(self.size_mm[index].tolist()),
            tuple(self.polarization_t[index].tolist()),
            None if rotation == (0.0, 0.0, 0.0, 1.0) else rotation,
            self.names[index],
            self.kinds[index],
            own,
        )

    def __iter__(self) -> Iterator[Tile]:
        return (self[index] for index in range(len(self)))

    def __repr__(self) -> str:
        return f"<Tiles: {len(self)}>"

    def columns(self) -> dict[str, Column]:
        """Columns name, kind, x_mm, ..., size_x_mm, ..., j_x_t, ..., q_x, q_y, q_z, q_w, ...

        The last two are recoil_permeability_along and recoil_permeability_across, NaN for tiles
        with the value of ``[material]``. A missing kind is null.
        """
        permeabilities = ("recoil_permeability_along", "recoil_permeability_across")
        return {
            "name": self.names,
            "kind": self.kinds,
            **split(("x_mm", "y_mm", "z_mm"), self.position_mm),
            **split(("size_x_mm", "size_y_mm", "size_z_mm"), self.size_mm),
            **split(("j_x_t", "j_y_t", "j_z_t"), self.polarization_t),
            **split(("q_x", "q_y", "q_z", "q_w"), self.rotation),
            **split(permeabilities, self.recoil_permeability),
        }


@dataclass(frozen=True)
class Grid:
    """A regular grid of points.

    Both ends are points; an axis with one point has it at the lower end. Within a tolerance, a grid
    takes much less time than the same points in an array.

    Parameters
    ----------
    lower_mm, upper_mm : (x, y, z)
        First and last point along each axis, in millimetres.
    counts : (nx, ny, nz)
        Number of points along each axis, at least 1.

    Examples
    --------
    >>> Grid((-2, -2, -5), (2, 2, -3), (9, 9, 5)).points_mm.shape
    (9, 9, 5, 3)
    """

    lower_mm: Vector
    upper_mm: Vector
    counts: tuple[int, int, int]

    def __post_init__(self) -> None:
        for name in ("lower_mm", "upper_mm"):
            x, y, z = getattr(self, name)
            object.__setattr__(self, name, (float(x), float(y), float(z)))
        nx, ny, nz = (whole("counts", count, 1) for count in self.counts)
        object.__setattr__(self, "counts", (nx, ny, nz))

    @cached_property
    def _axes(self) -> tuple[Floats, Floats, Floats]:
        return _magsplice.grid_axes(self.lower_mm, self.upper_mm, self.counts)

    @property
    def x_mm(self) -> Floats:
        """Coordinates along x, in millimetres, shape (nx,)."""
        return self._axes[0]

    @property
    def y_mm(self) -> Floats:
        """Coordinates along y, in millimetres, shape (ny,)."""
        return self._axes[1]

    @property
    def z_mm(self) -> Floats:
        """Coordinates along z, in millimetres, shape (nz,)."""
        return self._axes[2]

    @property
    def points_mm(self) -> Floats:
        """Points, in millimetres, shape (nx, ny, nz, 3)."""
        return np.stack(np.meshgrid(*self._axes, indexing="ij"), axis=-1)

    def __len__(self) -> int:
        nx, ny, nz = self.counts
        return nx * ny * nz


@dataclass(frozen=True)
class Ideal:
    """The ideal, sinusoidally magnetized film of Dai 2024, Eqs. 1 and 2.

    Its polarization is amplitude_t (sin kx, sin ky, 0) for 0 <= z <= thickness_mm, infinite along x
    and y, with k = 2 pi / wavelength_mm.

    Attributes
    ----------
    wavelength_mm : float
        Wavelength, in millimetres.
    thickness_mm : float
        Thickness, in millimetres.
    amplitude_t : float
        Amplitude of each component of the polarization, in tesla.
    """

    wavelength_mm: float
    thickness_mm: float
    amplitude_t: float

    @property
    def wavenumber_per_mm(self) -> float:
        """K = 2 pi over the wavelength, in radians per millimetre."""
        return float(2 * np.pi / self.wavelength_mm)


@dataclass(frozen=True)
class Volume:
    """The region below the film in which the sensor moves, sampled on a regular grid.

    The grid starts at the lower ends. It includes the upper ends where the step divides the range.

    Attributes
    ----------
    x_mm : tuple[float, float]
        Range along x, in millimetres.
    y_mm : tuple[float, float]
        Range along y, in millimetres.
    z_mm : tuple[float, float]
        Range along z, in millimetres. Negative: the film is above.
    step_mm : float | (float, float, float)
        Distance of neighbouring points, in millimetres: one number, or one for each axis.
    reference_mm : (float, float, float) | None
        Point from which displacements count, in millimetres. Default: the middle of x and y at
        the lowest z.
    """

    x_mm: tuple[float, float]
    y_mm: tuple[float, float]
    z_mm: tuple[float, float]
    step_mm: float | Vector
    reference_mm: Vector | None = None


def table_of(part: Any) -> Any:
    """Part of a layout as a table of a layout file."""
    if isinstance(part, (Ideal, Volume)):
        return dict(vars(part))
    if isinstance(part, (Tile, Lattice, Head)):
        return part.to_dict()
    if isinstance(part, Tiles):
        return [tile.to_dict() for tile in part]
    if isinstance(part, Mapping) or part is None or isinstance(part, (str, int, float)):
        return part
    return [table_of(item) for item in part]


def three_of(value: float | Sequence[float] | None) -> Vector | None:
    """Three numbers, or one number for all axes; None if not given."""
    if value is None:
        return None
    x, y, z = np.broadcast_to(np.asarray(value, dtype=float), 3).tolist()
    return (x, y, z)
