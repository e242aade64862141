"""Fields of cuboids of magpylib, in magpylib's units and shapes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from inspect import signature
from itertools import product
from typing import TYPE_CHECKING, Any, Concatenate, Literal, ParamSpec, TypeVar, get_args

import numpy as np

from magsplice import _magsplice
from magsplice._arguments import one_of
from magsplice._layout import Floats
from magsplice._magpylib.cuboids import Track, cuboids_of, in_metres, label_of
from magsplice._magpylib.observers import Sensor, sensors_of
from magsplice._points import tolerance_of

if TYPE_CHECKING:
    import pandas

Quantity = Literal["b", "h"]
Invalid = Literal["magpylib", "nan", "raise"]
P = ParamSpec("P")
R = TypeVar("R")


class _Source:
    """A source entry: cuboids whose fields are added."""

    def __init__(self, entry: Any) -> None:
        self.film = entry if isinstance(entry, _magsplice.Film) else None
        self.tracks = [] if self.film is not None else [Track(c) for c in cuboids_of(entry)]
        self.label = label_of(entry) if self.film is None else self.film.name
        self.length = max((track.length for track in self.tracks), default=1)

    def arrays(self, step: int) -> tuple[Floats, ...]:
        """Positions and sizes in metres, polarizations and rotations of the cuboids at a step."""
        if self.film is not None:
            _, position_mm, size_mm, polarization_t, rotation = self.film._blocks()
            return in_metres(position_mm), in_metres(size_mm), polarization_t, rotation
        rows = zip(*(track.at(step) for track in self.tracks), strict=True)
        return tuple(np.array(array, dtype=float) for array in rows)


def _field(
    quantity: Quantity,
    sources: Any,
    observers: Any,
    sumup: bool = False,
    squeeze: bool = True,
    pixel_agg: str | None = None,
    output: Literal["ndarray", "dataframe"] = "ndarray",
    in_out: str = "auto",
    *,
    within: float | str | None = None,
    invalid: Invalid = "magpylib",
) -> Floats | pandas.DataFrame:
    one_of("invalid", invalid, get_args(Invalid))
    if output not in ("ndarray", "dataframe"):
        raise ValueError(f'output = {output!r}, must be "ndarray" or "dataframe"')
    entries = list(sources) if isinstance(sources, (list, tuple)) else [sources]
    if not entries:
        raise ValueError("there are no sources")
    all_sources = [_Source(entry) for entry in entries]
    sensors = sensors_of(observers)
    if pixel_agg is None and len({sensor.shape for sensor in sensors}) > 1:
        raise ValueError(
            "sensors have pixels of different shapes: give pixel_agg, such as pixel_agg='mean'"
        )
    lengths = [item.length for item in all_sources] + [item.length for item in sensors]
    steps = max(lengths)
    points = np.concatenate([sensor.points(steps) for sensor in sensors], axis=1)
    still = max(sensor.length for sensor in sensors) == 1
    field = np.stack(
        [_along_path(quantity, source, points, still, within, invalid) for source in all_sources]
    )
    ends = np.cumsum([len(sensor.pixels) for sensor in sensors])[:-1]
    parts = [
        sensor.read(part).reshape(*field.shape[:2], 1, *sensor.shape, 3)
        for sensor, part in zip(sensors, np.split(field, ends, axis=2), strict=True)
    ]
    if pixel_agg is not None:
        join = getattr(np, pixel_agg, None)
        if join is None:
            raise ValueError(f"pixel_agg = {pixel_agg!r}, must be the name of a function of NumPy")
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
    quantity: Quantity,
    source: _Source,
    points: Floats,
    still: bool,
    within: float | str | None,
    invalid: Invalid,
) -> Floats:
    """Field of one source at points of shape (steps, pixels, 3)."""
    steps = len(points)
    if source.length == 1:
        # One scene for all points, and each point once.
        at = points[:1] if still else points
        field = _of_cuboids(quantity, source.arrays(0), at.reshape(-1, 3), within, invalid)
        return np.broadcast_to(field.reshape(at.shape), points.shape)
    fields = [
        _of_cuboids(quantity, source.arrays(step), points[step], within, invalid)
        for step in range(steps)
    ]
    return np.stack(fields)


def _of_cuboids(
    quantity: Quantity,
    arrays: Sequence[Floats],
    points: Floats,
    within: float | str | None,
    invalid: Invalid,
) -> Floats:
    """Field of cuboids. As in magpylib, B = 0 of each cuboid on its own edges."""
    points = np.ascontiguousarray(points)
    field, error = _magsplice.Scene(*arrays).field(quantity, points, tolerance_of(within))
    unknown = np.isnan(field[:, 0])
    if error is None or invalid == "nan":
        return field
    if invalid == "raise":
        raise error
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
    """H where B counts as 0, in ampere per metre: on an edge, which counts as inside."""
    from scipy.constants import mu_0
    from scipy.spatial.transform import Rotation

    h: Floats = -Rotation.from_quat(rotation).apply(polarization_t) / mu_0
    return h


def _data_frame(
    quantity: str, field: Floats, sources: list[_Source], sensors: list[Sensor], sumup: bool
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


def _of_quantity(
    field: Callable[Concatenate[Quantity, P], R], quantity: Quantity, name: str, doc: str
) -> Callable[P, R]:
    """Public function of one quantity, with the other parameters of `field`."""

    def get(*args: P.args, **kwargs: P.kwargs) -> R:
        return field(quantity, *args, **kwargs)

    get.__name__ = get.__qualname__ = name
    get.__doc__ = doc
    get.__dict__["__signature__"] = signature(partial(field, quantity))
    return get


getB = _of_quantity(
    _field,
    "b",
    "getB",
    """Flux density in tesla of cuboids of magpylib, in place of ``magpylib.getB``.

It has the arguments, results, units and shapes of ``magpylib.getB``, exact to 1e-13 of the sum over
cuboids. Sources may include films of magsplice.

Parameters
----------
sources : Cuboid, Collection, Film, or list of these
    Sources, with paths if they have them. A collection is one source.
observers : Sensor, Collection, list of these, or array_like of shape (o1, o2, ..., 3)
    Sensors, or positions in metres.
sumup : bool
    Whether to add the fields of all sources.
squeeze : bool
    Whether to remove axes of length 1.
pixel_agg : str, optional
    Name of a NumPy function, such as ``"mean"``, that combines the pixels of each sensor.
output : {"ndarray", "dataframe"}
    Kind of result.
in_out : str
    Accepted as in magpylib, without effect for cuboids.
within : float or str, optional
    Accepted length of the error: a fraction of |B| below 0.1, or a flux density with a unit, such
    as ``"10nT"``. Default: exact.
invalid : {"magpylib", "nan", "raise"}
    Handling of points without a field. ``"magpylib"``: a cuboid counts 0 on its own edges, and
    other such points raise an exception. ``"nan"``: the result is NaN at all of them. ``"raise"``:
    all of them raise an exception.

Returns
-------
ndarray of shape (sources, path, sensors, o1, o2, ..., 3), squeezed, or DataFrame
    B in tesla, in the frame of each sensor.

Raises
------
TypeError
    If a source is not made of cuboids.
PointsError
    If points have no field, see `invalid`.
ValueError
    If a cuboid has no dimension or polarization, or sensors have different pixels without
    `pixel_agg`.

Notes
-----
On an edge of a cuboid that is not parallel to J, B is unbounded. magpylib and this function count 0
for this cuboid there; `Film.b` raises `PointsError`. On edges parallel to J, magpylib also counts
0, and this function gives B. On a face B is the limit from the side of larger x, y or z.

Positions and dimensions are evaluated in millimetres, where the decimal point is moved, so edges
and faces at multiples of 1 mm or 0.01 mm are exactly there, as in `from_magpylib`.
""",
)

getH = _of_quantity(
    _field,
    "h",
    "getH",
    """Field strength in ampere per metre of cuboids of magpylib, in place of ``magpylib.getH``.

It has the arguments of `getB`.
""",
)
