"""Several Hall sensors on one board, read as one weighted sum."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

Vector = tuple[float, float, float]

#: Keys of a head in the table ``sensor`` of a layout file.
HEAD_KEYS = ("head", "spacing_mm", "element")


@dataclass(frozen=True)
class Head:
    """Several Hall sensors on one rigid board, read as one weighted sum.

    ``Head("cross", 5.0)`` names a board, and ``Head(positions_mm=..., weights=...)`` states the
    sensors of another one. Weights that are not given have the least noise among those that reject
    uniform fields and keep the form of Dai 2024, Eq. 2. ``film.replace(sensor=head)`` puts the head
    below a film, with the part and the noise of the sensor that the film has, and ``film.head`` has
    all its numbers.

    Attributes
    ----------
    board : str | None
        ``"pair-z"``, ``"pair-xy"``, ``"cross"`` or ``"reskin"``; None for another board.
    spacing_mm : float | None
        Distance of the sensors of a board, in millimetres. Default: half a wavelength of the ideal
        film.
    positions_mm : tuple of (float, float, float) | None
        Place of each sensor on the board, which has the axes of the film, in millimetres.
    weights : tuple of (float, float, float) | None
        Factors of the readings of each sensor along x, y, z in the sum.
    """

    board: str | None = None
    spacing_mm: float | None = None
    positions_mm: tuple[Vector, ...] | None = None
    weights: tuple[Vector, ...] | None = None

    def sum_t(self, readings_t: ArrayLike) -> NDArray[np.float64]:
        """Weighted sum of the fields at the sensors, shape (..., 3), in tesla.

        Parameters
        ----------
        readings_t : array_like, shape (..., N, 3)
            Field at each of the N sensors in tesla, along the axes of the film.

        Raises ValueError if the head has no weights, as before a film computes them, or if the
        readings have another number of sensors.
        """
        if self.weights is None:
            raise ValueError("the head has no weights: take film.head, whose weights are computed")
        readings, weights = np.asarray(readings_t, dtype=float), np.array(self.weights)
        if readings.shape[-2:] != weights.shape:
            wanted = f"(..., {len(weights)}, 3)"
            raise ValueError(f"readings_t has the shape {readings.shape}, must be {wanted}")
        total: NDArray[np.float64] = (readings * weights).sum(axis=-2)
        return total

    def to_dict(self) -> dict[str, Any]:
        """Head as keys of the table ``[sensor]`` of a layout file."""
        if self.board is not None:
            return {"head": self.board, "spacing_mm": self.spacing_mm}
        stated = () if self.positions_mm is None else self.positions_mm
        places = [np.asarray(place, dtype=float).tolist() for place in stated]
        if self.weights is None:
            return {"element": [{"position_mm": place} for place in places]}
        weights = [np.asarray(weight, dtype=float).tolist() for weight in self.weights]
        if len(weights) != len(places):
            raise ValueError(f"weights has {len(weights)} sensors, positions_mm has {len(places)}")
        pairs = zip(places, weights, strict=True)
        return {"element": [{"position_mm": place, "weight": weight} for place, weight in pairs]}
