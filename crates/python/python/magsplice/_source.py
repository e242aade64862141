"""The source of results: the layout, the accuracy of the field, and recoil."""

from __future__ import annotations

from typing import Any

from magsplice._figures import Figures
from magsplice._results import Result, key


class RecoilFigures(Result):
    """Figures of a film without and with recoil, over at most 2000 points of its volume."""

    without: Figures[float] = key("Figures without recoil.", Figures)
    with_recoil: Figures[float] = key("Figures with recoil.", Figures)
    errors: Figures[float] = key("Estimates of the errors of `with_recoil`.", Figures)


class RecoilSummary(Result):
    """The effect of recoil in a film.

    Tiles are divided into cells, and the division is refined until the error of B, as a share of
    its change, is below ``recoil_error`` of ``[material]``. docs/recoil.md describes it.
    """

    cells: int = key("Number of cells.")
    level: int = key("Level of division.")
    change_t: float = key(
        """Largest change of B by recoil, in tesla, at points of the working volume. Without a
        working volume, at points of a box around all tiles, at a distance of the shortest side of
        all tiles together; nearer to the tiles B changes more."""
    )
    error_t: float = key("Estimate of the largest error of B at the same points, in tesla.")
    figures: RecoilFigures | None = key("Figures, if defined.", RecoilFigures)
    largest_weakening: float = key("Largest lost fraction of the polarization of a tile.")
    largest_turn_deg: float = key("Largest turn of the mean polarization of a tile, in degrees.")


class OfLayout(Result):
    """A result of a layout."""

    layout: str = key("Name of the layout.")
    sha256: str = key("SHA-256 of the text of the layout.")
    version: str = key("Version of the library.")
    shape_error: float | None = key(
        """Largest error of the field one radius away from a disc, as a fraction of the largest
        field there; None without discs."""
    )
    slice_error: float | None = key(
        """Largest error of the field of an endless wave in slices where the working volume is
        nearest to it, as a fraction of the field there; None without waves."""
    )


class OfFilm(OfLayout):
    """A result that depends on the field of a film."""

    tiles: int = key("Number of tiles.")
    accuracy: Any = key("``exact``, or the tolerance of the field.")
    recoil: RecoilSummary | None = key("The effect of recoil; None without recoil.", RecoilSummary)
