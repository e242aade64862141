"""Cuboids of magpylib: their fields in magpylib's units and shapes, and films from and to them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from decimal import Decimal
from itertools import product
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from magsplice import _magsplice
from magsplice._film import Film
from magsplice._layout import Floats, Tile

if TYPE_CHECKING:
    import pandas

__all__ = ["from_magpylib", "getB", "getH", "to_magpylib"]

#: Decimal places between metres and millimetres.
_MILLI = 3


def getB(
    sources: Any,
    observers: Any,
    sumup: bool = False,
    squeeze: bool = True,
    pixel_agg: str | None = None,
    output: Literal["ndarray", "dataframe"] = "ndarray",
    in_out: str = "auto",
    *,
    within: float | None = None,
) -> Floats | pandas.DataFrame:
    """Flux density in tesla of cuboids of magpylib, in place of ``magpylib.getB``.

    Takes what ``magpylib.getB`` takes and returns what it returns, in its units and shapes, exact
    to 2e-14 of the sum over cuboids. Films of magsplice may stand among the sources.

    Parameters
    ----------
    sources : Cuboid, Collection, Film, or list of these
        Sources, with paths if they have them. A collection is one source.
    observers : Sensor, Collection, list of these, or array_like of shape (o1, o2, ..., 3)
        Sensors, or positions in metres.
    sumup : bool
        Whether the fields of all sources are added.
    squeeze : bool
        Whether axes of length 1 are removed.
    pixel_agg : str, optional
        Name of a function of NumPy, such as ``"mean"``, that joins the pixels of each sensor.
    output : {"ndarray", "dataframe"}
        Kind of result.
    in_out : str
        Accepted as magpylib accepts it, and without effect for cuboids.
    within : float, optional
        Accepted length of the error as a fraction of |B|. Default: exact.

    Returns
    -------
    ndarray of shape (sources, path, sensors, o1, o2, ..., 3), squeezed, or DataFrame
        B in tesla, in the frame of each sensor.

    Raises
    ------
    TypeError
        If a source is not made of cuboids.
    ValueError
        If a cuboid has no dimension or polarization, or sensors have different pixels without
        `pixel_agg`.

    Notes
    -----
    On an edge of a cuboid that is not parallel to J, B is unbounded. magpylib counts 0 for this
    cuboid there, and so does this function; `Film.b` raises `PointsError`. magpylib counts 0 on
    edges parallel to J, too, where this function gives B. On a face B is that of the side of larger
    x, y or z.
    """
    return _field("b", sources, observers, sumup, squeeze, pixel_agg, output, within)


def getH(
    sources: Any,
    observers: Any,
    sumup: bool = False,
    squeeze: bool = True,
    pixel_agg: str | None = None,
    output: Literal["ndarray", "dataframe"] = "ndarray",
    in_out: str = "auto",
    *,
    within: float | None = None,
) -> Floats | pandas.DataFrame:
    """Field strength in ampere per metre of cuboids of magpylib, in place of ``magpylib.getH``.

    See `getB`, whose arguments it has.
    """
    return _field("h", sources, observers, sumup, squeeze, pixel_agg, output, within)


def from_magpylib(sources: Any, *, name: str | None = None, **tables: Any) -> Film:
    """Film of the cuboids of a magpylib collection.

    Parameters
    ----------
    sources : Collection, Cuboid, or list of these
        Cuboids without paths, in metres and tesla. They must not overlap.
    name : str, optional
        Name of the film. Default: the label of the collection, or ``"from magpylib"``.
    **tables
        Other tables of the layout, as of `Film`: ``ideal``, ``volume``, ``tolerance``, ...

    Returns
    -------
    Film
        In millimetres. The decimal point moves, so that lengths of up to 15 digits keep them all.

    Raises
    ------
    TypeError
        If a source is not a cuboid.
    ValueError
        If a cuboid moves along a path, or lacks dimension or polarization.
    LayoutError
        If the cuboids break rules of layouts.
    """
    entries = list(sources) if isinstance(sources, (list, tuple)) else [sources]
    cuboids = [cuboid for entry in entries for cuboid in _cuboids(entry)]
    labels = [cuboid.style.label for cuboid in cuboids]
    tiles = []
    for cuboid, label in zip(cuboids, labels, strict=True):
        track = _Track(cuboid)
        if track.length > 1:
            raise ValueError(
                f"{cuboid!r} has a path of {track.length} steps: a film does not move; give a copy "
                "with one position"
            )
        quaternion = track.rotation[0]
        tiles.append(
            Tile(
                _shifted(track.position[0], _MILLI),
                _shifted(track.size[0], _MILLI),
                track.polarization_t[0].tolist(),
                None if np.array_equal(quaternion, (0, 0, 0, 1)) else quaternion,
                # A label that several cuboids share names none of them.
                label if label and labels.count(label) == 1 else None,
            )
        )
    if name is None:
        label = getattr(getattr(sources, "style", None), "label", None)
        name = label or "from magpylib"
    return Film(tiles, name=name, **tables)


def to_magpylib(film: Film) -> Any:
    """Film as a `magpylib.Collection` of cuboids, in metres and tesla.

    Parameters
    ----------
    film : Film
        The film. Each cuboid has the name of its tile as its label.
    """
    magpylib = _magpylib()
    from scipy.spatial.transform import Rotation

    tiles = film.tiles
    collection = magpylib.Collection(style_label=film.name)
    collection.add(
        *(
            magpylib.magnet.Cuboid(
                position=_shifted(position, -_MILLI),
                dimension=_shifted(size, -_MILLI),
                polarization=polarization_t,
                orientation=Rotation.from_quat(rotation),
                style_label=name,
            )
            for name, position, size, polarization_t, rotation in zip(
                tiles.names,
                tiles.position_mm,
                tiles.size_mm,
                tiles.polarization_t,
                tiles.rotation,
                strict=True,
            )
        )
    )
    return collection


def _magpylib() -> Any:
    try:
        import magpylib
    except ImportError as error:
        raise ImportError(
            'this needs the package magpylib: pip install "magsplice[magpylib]"'
        ) from error
    return magpylib


def _shifted(values: Floats, places: int) -> list[float]:
    """Numbers whose decimal point is moved, digit by digit."""
    return [float(Decimal(repr(float(value))).scaleb(places)) for value in values]


class _Track:
    """A cuboid along its path, or the tiles of a film: arrays of shape (path, 3) or (path, 4)."""

    def __init__(self, cuboid: Any) -> None:
        for key in ("dimension", "polarization"):
            if getattr(cuboid, key) is None:
                raise ValueError(f"{cuboid!r} has no {key}: set it before its field is computed")
        self.position = np.atleast_2d(cuboid.position)
        self.size = np.abs(np.atleast_2d(cuboid.dimension))
        self.polarization_t = np.atleast_2d(cuboid.polarization)
        self.rotation = np.atleast_2d(cuboid.orientation.as_quat())

    @property
    def _arrays(self) -> tuple[Floats, ...]:
        return self.position, self.size, self.polarization_t, self.rotation

    @property
    def length(self) -> int:
        return max(len(array) for array in self._arrays)

    def at(self, step: int) -> tuple[Floats, ...]:
        """Position, size, polarization and rotation at a step; shorter paths stay at their end."""
        return tuple(array[min(step, len(array) - 1)] for array in self._arrays)


class _Source:
    """One entry of the sources: cuboids whose fields are added."""

    def __init__(self, entry: Any) -> None:
        self.label = _label(entry)
        self.film = entry if isinstance(entry, Film) else None
        self.tracks = [] if self.film is not None else [_Track(c) for c in _cuboids(entry)]
        self.length = max((track.length for track in self.tracks), default=1)

    def arrays(self, step: int) -> tuple[Floats, ...]:
        """Positions, sizes, polarizations and rotations of the cuboids at a step of the path."""
        if self.film is not None:
            tiles = self.film.tiles
            metres = [
                np.array([_shifted(row, -_MILLI) for row in rows])
                for rows in (tiles.position_mm, tiles.size_mm)
            ]
            return *metres, tiles.polarization_t, tiles.rotation
        rows = zip(*(track.at(step) for track in self.tracks), strict=True)
        return tuple(np.array(array, dtype=float) for array in rows)


class _Sensor:
    """Pixels along a path, in the frame in which the field is given."""

    def __init__(self, pixels: Floats, sensor: Any = None) -> None:
        self.shape = pixels.shape[:-1] or (1,)
        self.pixels = pixels.reshape(-1, 3)
        self.label = "positions" if sensor is None else _label(sensor)
        self.left_handed = sensor is not None and sensor.handedness == "left"
        self.position = np.zeros((1, 3)) if sensor is None else np.atleast_2d(sensor.position)
        self.rotation = None
        if sensor is not None:
            quaternions = np.atleast_2d(sensor.orientation.as_quat())
            if not np.all(quaternions == (0, 0, 0, 1)):
                self.rotation = quaternions
        self.length = max(len(self.position), 1 if self.rotation is None else len(self.rotation))

    def _matrices(self, steps: int) -> Floats | None:
        if self.rotation is None:
            return None
        from scipy.spatial.transform import Rotation

        matrices: Floats = Rotation.from_quat(self.rotation).as_matrix()
        return matrices[np.minimum(np.arange(steps), len(matrices) - 1)]

    def points(self, steps: int) -> Floats:
        """Positions of the pixels, shape (steps, pixels, 3)."""
        position = self.position[np.minimum(np.arange(steps), len(self.position) - 1)]
        matrices = self._matrices(steps)
        if matrices is None:
            return self.pixels + position[:, None]
        turned: Floats = np.matmul(matrices, self.pixels.T).transpose(0, 2, 1)
        return turned + position[:, None]

    def read(self, field: Floats) -> Floats:
        """Field of shape (sources, steps, pixels, 3) in the frame of the sensor."""
        matrices = self._matrices(field.shape[1])
        if matrices is not None:
            field = np.matmul(field, matrices)
        if self.left_handed:
            field = field * (-1.0, 1.0, 1.0)
        return field


def _label(entry: Any) -> str:
    if isinstance(entry, Film):
        return entry.name
    return entry.style.label or f"{entry}"


def _cuboids(entry: Any) -> Iterator[Any]:
    magpylib = _magpylib()
    found = entry.sources_all if isinstance(entry, magpylib.Collection) else [entry]
    if not found:
        raise ValueError(f"{entry!r} has no sources")
    for source in found:
        if not isinstance(source, magpylib.magnet.Cuboid):
            raise TypeError(
                f"{source!r} is no cuboid: magsplice computes magpylib.magnet.Cuboid and "
                "collections of them; use magpylib.getB for other sources, and add the fields"
            )
        yield source


def _sensors(observers: Any) -> list[_Sensor]:
    magpylib = _magpylib()

    def of(item: Any) -> list[_Sensor]:
        if isinstance(item, magpylib.Sensor):
            pixel = item.pixel
            return [_Sensor(np.zeros(3) if pixel is None else np.asarray(pixel, float), item)]
        if isinstance(item, magpylib.Collection):
            if not item.sensors_all:
                raise ValueError(f"{item!r} has no sensors")
            return [sensor for child in item.sensors_all for sensor in of(child)]
        return [_Sensor(_positions(item))]

    kinds = (magpylib.Sensor, magpylib.Collection)
    if isinstance(observers, kinds):
        return of(observers)
    if isinstance(observers, (list, tuple)) and any(isinstance(item, kinds) for item in observers):
        return [sensor for item in observers for sensor in of(item)]
    return [_Sensor(_positions(observers))]


def _positions(values: Any) -> Floats:
    points = np.asarray(values, dtype=float)
    if points.ndim == 0 or points.shape[-1] != 3 or points.size == 0:
        raise ValueError(
            f"observers have the shape {points.shape}, must have (o1, o2, ..., 3) with positions "
            "in metres, or be sensors"
        )
    return points


def _field(
    quantity: Literal["b", "h"],
    sources: Any,
    observers: Any,
    sumup: bool,
    squeeze: bool,
    pixel_agg: str | None,
    output: str,
    within: float | None,
) -> Floats | pandas.DataFrame:
    if output not in ("ndarray", "dataframe"):
        raise ValueError(f'output = {output!r}, must be "ndarray" or "dataframe"')
    entries = list(sources) if isinstance(sources, (list, tuple)) else [sources]
    if not entries:
        raise ValueError("there are no sources")
    all_sources = [_Source(entry) for entry in entries]
    sensors = _sensors(observers)
    if pixel_agg is None and len({sensor.shape for sensor in sensors}) > 1:
        raise ValueError(
            "sensors have pixels of different shapes: give pixel_agg, such as pixel_agg='mean'"
        )
    lengths = [item.length for item in all_sources] + [item.length for item in sensors]
    steps = max(lengths)
    points = np.concatenate([sensor.points(steps) for sensor in sensors], axis=1)
    still = max(sensor.length for sensor in sensors) == 1
    field = np.stack(
        [_along_path(quantity, source, points, still, within) for source in all_sources]
    )
    ends = np.cumsum([len(sensor.pixels) for sensor in sensors])[:-1]
    parts = [
        sensor.read(part).reshape(*field.shape[:2], 1, *sensor.shape, 3)
        for sensor, part in zip(sensors, np.split(field, ends, axis=2), strict=True)
    ]
    if pixel_agg is not None:
        join = getattr(np, pixel_agg)
        parts = [join(part, axis=tuple(range(3, part.ndim - 1))) for part in parts]
    result: Floats = np.concatenate(parts, axis=2)
    if sumup:
        result = result.sum(axis=0, keepdims=True)
    if output == "dataframe":
        return _data_frame(quantity, result, all_sources, sensors, sumup)
    if squeeze:
        return np.squeeze(result)
    return result if pixel_agg is None else np.expand_dims(result, axis=-2)


def _along_path(
    quantity: Literal["b", "h"],
    source: _Source,
    points: Floats,
    still: bool,
    within: float | None,
) -> Floats:
    """Field of one source at points of shape (steps, pixels, 3)."""
    steps = len(points)
    if source.length == 1:
        # One scene for all points, and each point once.
        at = points[:1] if still else points
        field = _of_cuboids(quantity, source.arrays(0), at.reshape(-1, 3), within)
        return np.broadcast_to(field.reshape(at.shape), points.shape)
    fields = [
        _of_cuboids(quantity, source.arrays(step), points[step], within) for step in range(steps)
    ]
    return np.stack(fields)


def _of_cuboids(
    quantity: Literal["b", "h"],
    arrays: Sequence[Floats],
    points: Floats,
    within: float | None,
) -> Floats:
    """Field of cuboids in which B of a cuboid counts 0 on its own edges."""
    tolerance = None if within is None else (True, float(within))
    points = np.ascontiguousarray(points)
    field, error = _magsplice.Scene(*arrays).field(quantity, points, tolerance)
    unknown = np.isnan(field[:, 0])
    if error is None:
        return field
    faults = getattr(error, "faults", [])
    if any(fault.tile is None for fault in faults):
        raise error
    at = np.ascontiguousarray(points[unknown])
    field[unknown] = 0.0
    for index in range(len(arrays[0])):
        one = [np.ascontiguousarray(array[index : index + 1]) for array in arrays]
        alone = _magsplice.Scene(*one).field(quantity, at)[0]
        alone[np.isnan(alone[:, 0])] = 0.0 if quantity == "b" else _minus_magnetization(*one[2:])
        field[unknown] += alone
    return field


def _minus_magnetization(polarization_t: Floats, rotation: Floats) -> Floats:
    """H where B is 0, in ampere per metre: on an edge, which counts as inside."""
    from scipy.constants import mu_0
    from scipy.spatial.transform import Rotation

    h: Floats = -Rotation.from_quat(rotation).apply(polarization_t) / mu_0
    return h


def _data_frame(
    quantity: str, field: Floats, sources: list[_Source], sensors: list[_Sensor], sumup: bool
) -> pandas.DataFrame:
    import pandas

    many = sumup and len(sources) > 1
    names = [f"sumup ({len(sources)})"] if many else [source.label for source in sources]
    pixels = field[0, 0, 0].size // 3
    rows = product(
        names, range(field.shape[1]), [sensor.label for sensor in sensors], range(pixels)
    )
    frame = pandas.DataFrame(rows, columns=["source", "path", "sensor", "pixel"])
    frame[[quantity.upper() + axis for axis in "xyz"]] = field.reshape(-1, 3)
    return frame
