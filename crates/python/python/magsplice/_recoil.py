"""What recoil changes in a film: tiles that weaken and turn each other."""

from __future__ import annotations

from magsplice._arrow import Column, Table, split
from magsplice._figures import Figures
from magsplice._layout import Floats
from magsplice._results import Result, key
from magsplice._source import RecoilSummary


class Recoil(RecoilSummary, Table):
    """The polarization that agrees with the field, for tiles with a recoil permeability.

    A table of the tiles: ``polars.DataFrame(film.recoil)``.
    """

    share_beyond_knee: float | None = key(
        """Share of the volume of all tiles that is beyond the knee of the demagnetization curve and
        loses polarization for good; None if ``[material]`` states no ``knee_field_t``."""
    )
    names: list[str] = key("Names of the tiles.")
    weakening: Floats = key("Lost fraction of the polarization of each tile, shape (n,).")
    angle_deg: Floats = key("Angle by which its mean polarization turns, in degrees, shape (n,).")
    mean_polarization_t: Floats = key("Mean J of its cells in the film, in tesla, shape (n, 3).")

    def columns(self) -> dict[str, Column]:
        """Columns name, weakening, angle_deg, mean_j_x_t, mean_j_y_t, mean_j_z_t."""
        return {
            "name": self.names,
            "weakening": self.weakening,
            "angle_deg": self.angle_deg,
            **split(("mean_j_x_t", "mean_j_y_t", "mean_j_z_t"), self.mean_polarization_t),
        }


class RecoilEstimate(Result):
    """What recoil changes in the figures of a film, to first order.

    Each tile is one cell. The change of the amplitude is right to tens of percent. Where the fields
    of the tiles of a designed film cancel, the change of an error may be wrong by a factor.
    """

    recoil_permeability: float | None = key("That of all tiles; None if the layout states it.")
    without: Figures[float] = key("Figures without recoil.", Figures)
    with_recoil: Figures[float] = key("Figures with it.", Figures)
