"""Exceptions of magsplice, with the messages of the program and the Rust library."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

__all__ = [
    "LayoutError",
    "LayoutFault",
    "LayoutWarning",
    "MagspliceError",
    "MeasurementWarning",
    "PointFault",
    "PointsError",
]


class MagspliceError(Exception):
    """A film that cannot be evaluated, sampled, designed or drawn. The message has the reason."""


class LayoutFault(NamedTuple):
    """One broken rule of a layout.

    Attributes
    ----------
    line : int | None
        Line of the text, from 1, if the rule belongs to a line.
    place : str
        Table or tile, such as ``tile "rim-3"``.
    message : str
        The value and the rule, such as ``size_mm[1] = -1, must be greater than 0``.
    """

    line: int | None
    place: str
    message: str


class LayoutError(MagspliceError, ValueError):
    """A layout that is not TOML, has unknown keys, or breaks rules.

    A file that cannot be read raises `OSError` instead, such as `FileNotFoundError`.

    Attributes
    ----------
    faults : list[LayoutFault]
        All broken rules. Empty for an error of syntax, which the message describes.
    """

    faults: list[LayoutFault]

    def __init__(self, message: str, faults: Sequence[tuple[int | None, str, str]] = ()) -> None:
        super().__init__(message, faults)
        self.faults = [LayoutFault(*fault) for fault in faults]

    def __str__(self) -> str:
        return str(self.args[0])

    @classmethod
    def of_faults(cls, origin: str, faults: Sequence[tuple[str, str]]) -> LayoutError:
        """The error of a layout that is no text, from places and messages."""
        lines = [f"{origin}: {place}: {message}" for place, message in faults]
        return cls("\n".join(lines), [(None, *fault) for fault in faults])


class LayoutWarning(UserWarning):
    """Properties of a layout that are allowed but usually a mistake, such as lengths in metres.

    The program prints them as warnings. ``film.findings`` lists all of them.
    ``warnings.simplefilter("error", magsplice.LayoutWarning)`` turns them into exceptions.
    """


class MeasurementWarning(UserWarning):
    """A measurement that is hardly of this film: its signs, units or positions may be wrong."""


@dataclass(frozen=True)
class PointFault:
    """A point without a field.

    Attributes
    ----------
    index : int
        Index of the point, with the leading axes of the points flattened.
    point : tuple[float, float, float]
        The point, in the unit of length of the call.
    tile : int | None
        Index of a tile with the point on its edge, if this is the reason.
    message : str
        The reason.
    """

    index: int
    point: tuple[float, float, float]
    tile: int | None
    message: str


class PointsError(MagspliceError, ValueError):
    """Points without a field.

    On an exposed edge that is not parallel to the polarization B is unbounded. Coordinates must be
    finite. A tolerance may be too small for the exact field. With the argument ``invalid="nan"``
    the result is NaN at such points, without this exception.

    Attributes
    ----------
    faults : list[PointFault]
        All points without a field, in their order.
    """

    faults: list[PointFault]

    def __init__(
        self,
        message: str,
        faults: Sequence[tuple[int, Sequence[float], int | None, str]] = (),
    ) -> None:
        super().__init__(message, faults)
        self.faults = [
            PointFault(index, (float(point[0]), float(point[1]), float(point[2])), tile, reason)
            for index, point, tile, reason in faults
        ]

    def __str__(self) -> str:
        return str(self.args[0])
