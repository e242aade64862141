"""Faulty tiles of a film as made, from a scan of its field."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from magsplice._arrow import Column, Table
from magsplice._layout import Floats, Vector
from magsplice._results import Result, key
from magsplice._samples import Preset
from magsplice._scan import ExcludedReadings, FittedScan, SensorPlacement
from magsplice._source import OfFilm

Kind = Literal["strength", "turn", "direction", "displacement"]


class Suspect(Result):
    """A tile with a possible error."""

    tile: str = key("Name of the tile.")
    kind: Kind = key("The possible fault.")


class FaultyTile(Result):
    """An error of a tile that neither noise nor expected errors explain.

    Changes of the strength are in percent, turns in degrees, and displacements in millimetres.
    """

    tile: str = key("Name of the tile.")
    kind: Kind = key(
        "The fault: |J|, the rotation of the tile with its J, J within the tile, or the position."
    )
    magnitude: float = key(
        """Change of the strength, or the length of the vector of all significant components."""
    )
    components: dict[str, tuple[float, float]] = key("Value and deviation by error.")
    chi_squared: float = key("Rise of chi squared without this error.")
    ln_probability: float = key(
        "Logarithm of the probability of this rise by chance, for one error."
    )
    alternatives: list[Suspect] = key(
        "Tiles and kinds that in its place explain the readings nearly as well, the best first.",
        Suspect,
    )


class Diagnosis(OfFilm, Table):
    """The diagnosis of a film. A table of the errors of tiles, one row for each tile."""

    readings: int = key("Number of readings.")
    excluded: ExcludedReadings = key("Readings that the fit does not use.", ExcludedReadings)
    noise_t: Vector = key("Noise of a reading along x, y, z, in tesla.")
    false_alarm: float = key("Probability that a tile of a film without faulty tiles is reported.")
    has_expected_errors: bool = key(
        "Whether other tiles have the errors of ``[tolerance]``; otherwise they count as ordered."
    )
    faulty: list[FaultyTile] = key(
        "Identified errors, the most certain first. Empty if `is_rejected`.", FaultyTile
    )
    is_complete: bool = key("Whether `faulty` has all significant errors.")
    scan: FittedScan = key("Fitted parameters of the scan.", FittedScan)
    scan_deviation: FittedScan = key(
        "Standard deviations of the fitted parameters; 0 for parameters that are not fitted.",
        FittedScan,
    )
    residual_t: float = key("Root mean square of the residual of a component, in tesla.")
    chi_squared: float = key(
        """Sum of the squares of residuals over noise, and of expected errors over their
        deviations."""
    )
    degrees_of_freedom: int = key("Expectation of `chi_squared`.")
    is_residual_too_large: bool = key("Whether the residual exceeds noise and errors of tiles.")
    is_rejected: bool = key(
        """Whether errors of tiles do not explain the scan: the residual is too large, or an error
        is larger than a tile can have, or the strength than the film. `scan` is then that of a
        wrong model."""
    )
    made_as: Preset | None = key(
        """Preset whose typical errors of every tile explain the scan with less than half as many
        errors of single tiles."""
    )
    explained_by: FittedScan | None = key(
        """Parameters of the scan with which less than half as many errors of tiles, or few, explain
        it, if not all were fitted.""",
        FittedScan,
    )
    placement: SensorPlacement | None = key(
        """Another placement of the sensor, which explains a rejected scan better than errors of
        tiles.""",
        SensorPlacement,
    )
    unresolved: list[dict[str, Any]] = key(
        """Errors hardly narrowed by the scan: ``tile``, ``error`` and its standard deviations
        ``before`` and ``after`` the scan."""
    )
    similar: list[dict[str, Any]] = key(
        """Pairs of errors with similar effects on the readings: ``tiles``, ``errors`` and
        ``correlation``, the most similar first."""
    )
    names: list[str] = key("Names of the tiles.")
    errors: dict[str, Floats] = key(
        """Errors of the tiles in the film that explains the readings, by their keys, such as
        ``position_x_mm``, ``rotation_x_deg``, ``strength_percent``: arrays of shape (n,)."""
    )

    def _three(self, kind: str, unit: str) -> Floats:
        return np.stack([self.errors[f"{kind}_{axis}_{unit}"] for axis in "xyz"], axis=-1)

    @property
    def position_mm(self) -> Floats:
        """Displacements of the tiles in millimetres, shape (n, 3)."""
        return self._three("position", "mm")

    @property
    def rotation_deg(self) -> Floats:
        """Turns of the tiles in degrees, shape (n, 3)."""
        return self._three("rotation", "deg")

    @property
    def size_mm(self) -> Floats:
        """Errors of the sides in millimetres, shape (n, 3)."""
        return self._three("size", "mm")

    def columns(self) -> dict[str, Column]:
        """Columns name, position_x_mm, ..., rotation_x_deg, ..., strength_percent, ..."""
        return {"name": self.names, **self.errors}
