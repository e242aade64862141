"""Recoil: how the field of the tiles of a film changes their polarization."""

from __future__ import annotations

from magsplice._arrow import Column, Table, split
from magsplice._figures import Figures
from magsplice._layout import Floats
from magsplice._results import Result, key
from magsplice._source import RecoilSummary


class Recoil(RecoilSummary, Table):
    """The polarization consistent with the field, for tiles with a recoil permeability.

    A table of the tiles: ``polars.DataFrame(film.recoil)``.
    """

    share_beyond_knee: float | None = key(
        """Share of the volume of all tiles beyond the knee of the demagnetization curve, which
        loses polarization permanently; None without ``knee_field_t`` in ``[material]``."""
    )
    names: list[str] = key("Names of the tiles.")
    weakening: Floats = key("Lost fraction of the polarization of each tile, shape (n,).")
    angle_deg: Floats = key("Turn of the mean polarization of each tile, in degrees, shape (n,).")
    mean_polarization_t: Floats = key("Mean J of each tile in the film, in tesla, shape (n, 3).")

    def columns(self) -> dict[str, Column]:
        """Columns name, weakening, angle_deg, mean_j_x_t, mean_j_y_t, mean_j_z_t."""
        return {
            "name": self.names,
            "weakening": self.weakening,
            "angle_deg": self.angle_deg,
            **split(("mean_j_x_t", "mean_j_y_t", "mean_j_z_t"), self.mean_polarization_t),
        }


class RecoilEstimate(Result):
    """The effect of recoil on the figures of a film, to first order.

    Each tile is one cell. The error of the change of the amplitude is tens of percent. Where the
    fields of the tiles of a designed film cancel, the change of an error may be wrong by a factor.
    """

    recoil_permeability: float | None = key("Permeability of all tiles, if not in the layout.")
    without: Figures[float] = key("Figures without recoil.", Figures)
    with_recoil: Figures[float] = key("Figures with it.", Figures)
