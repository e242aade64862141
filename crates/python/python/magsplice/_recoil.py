"""What recoil changes in a film: tiles that weaken and turn each other."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

from magsplice import _magsplice
from magsplice._arrow import Column, Table, split
from magsplice._layout import Floats, PerParameter, Vector
from magsplice._layout_film import LayoutFilm
from magsplice._numbers import Numbers


class FilmFigures(NamedTuple):
    """Figures of a film over at most 2000 points of its working volume.

    Attributes
    ----------
    amplitude : float
        Best-fit amplitude against the ideal film.
    uniformity_rmse : (float | None, float | None, float | None)
        Uniformity RMSE of R_x, R_y, S_z; None where planes have one point each.
    displacement_rmse_mm : (float, float, float)
        RMSE of the displacement along x, y, z, in millimetres.
    """

    amplitude: float
    uniformity_rmse: PerParameter
    displacement_rmse_mm: Vector


@dataclass(frozen=True, eq=False, repr=False)
class Recoil(Numbers, Table):
    """The polarization that agrees with the field, for tiles with a recoil permeability.

    Tiles are divided into cells, and the division is refined until B is known to the share of its
    change that ``recoil_error`` of ``[material]`` states. docs/recoil.md describes it. A table of
    the tiles: ``polars.DataFrame(film.recoil)``.

    Attributes
    ----------
    cells : int
        Number of cells.
    level : int
        Level of division.
    change_t : float
        Largest change of B by recoil, in tesla, at points of the working volume. Without one at
        points of a box around all tiles, away from them by the shortest side of the tiles
        together; nearer to them B changes more.
    error_t : float
        Estimate of the largest error of B at the same points, in tesla.
    without : FilmFigures | None
        Figures without recoil; None without an ideal film and a working volume.
    with_recoil : FilmFigures | None
        Figures with recoil.
    errors : FilmFigures | None
        Estimates of the errors of `with_recoil`.
    share_beyond_knee : float | None
        Share of the volume of all tiles that is beyond the knee of the demagnetization curve and
        loses polarization for good; None if ``[material]`` states no ``knee_field_t``.
    names : list[str]
        Names of the tiles.
    weakening : ndarray
        Lost fraction of the magnitude of the polarization of each tile, shape (n,).
    angle_deg : ndarray
        Angle by which its mean polarization turns, in degrees, shape (n,).
    mean_polarization_t : ndarray
        Mean polarization of its cells in the frame of the film, in tesla, shape (n, 3).
    """

    cells: int
    level: int
    change_t: float
    error_t: float
    without: FilmFigures | None
    with_recoil: FilmFigures | None
    errors: FilmFigures | None
    share_beyond_knee: float | None
    names: list[str]
    weakening: Floats
    angle_deg: Floats
    mean_polarization_t: Floats

    def to_dict(self) -> dict[str, Any]:
        """Numbers by name; for JSON."""
        return {
            "cells": self.cells,
            "level": self.level,
            "change_t": self.change_t,
            "error_t": self.error_t,
            "without": self.without,
            "with_recoil": self.with_recoil,
            "errors": self.errors,
            "share_beyond_knee": self.share_beyond_knee,
            "largest_weakening": float(self.weakening.max()),
            "largest_turn_deg": float(self.angle_deg.max()),
        }

    def columns(self) -> dict[str, Column]:
        """Columns name, weakening, angle_deg, mean_j_x_t, mean_j_y_t, mean_j_z_t."""
        return {
            "name": self.names,
            "weakening": self.weakening,
            "angle_deg": self.angle_deg,
            **split(("mean_j_x_t", "mean_j_y_t", "mean_j_z_t"), self.mean_polarization_t),
        }


@dataclass(frozen=True, repr=False)
class RecoilEstimate(Numbers):
    """What recoil changes in the figures of a film, to first order.

    Each tile is one cell. The change of the amplitude is right to tens of percent. Where the fields
    of the tiles of a designed film cancel, the change of an error may be wrong by a factor.

    Attributes
    ----------
    recoil_permeability : float | None
        Relative permeability of all tiles; None for those that the layout states.
    without : FilmFigures
        Figures without recoil.
    with_recoil : FilmFigures
        Figures with it.
    """

    recoil_permeability: float | None
    without: FilmFigures
    with_recoil: FilmFigures

    def to_dict(self) -> dict[str, Any]:
        """Numbers by name; for JSON."""
        return dict(vars(self))


class RecoilFilm(LayoutFilm):
    """A film whose tiles weaken and turn each other."""

    @cached_property
    def recoil(self) -> Recoil | None:
        """What recoil changes; None if no tile has a recoil permeability above 1.

        It is solved when the film is first evaluated, and once. Every field and result of the film
        is that of the cells.

        Raises
        ------
        MagspliceError
            If tiles overlap, or B is not known to the stated error with 120 000 cells.
        """
        numbers = _magsplice.recoil(self._core)
        if numbers is None:
            return None
        for key in ("weakening", "angle_deg", "mean_polarization_t"):
            # The result is kept.
            numbers[key].flags.writeable = False
        figures = numbers.get("figures", {})
        return Recoil(
            cells=numbers["cells"],
            level=numbers["level"],
            change_t=numbers["change_t"],
            error_t=numbers["error_t"],
            without=_figures(figures.get("without")),
            with_recoil=_figures(figures.get("with_recoil")),
            errors=_figures(figures.get("errors")),
            share_beyond_knee=numbers["share_beyond_knee"],
            names=self.tiles.names,
            weakening=numbers["weakening"],
            angle_deg=numbers["angle_deg"],
            mean_polarization_t=numbers["mean_polarization_t"],
        )

    def recoil_estimate(self, mu_r: float = 1.05) -> RecoilEstimate | None:
        """What recoil would change, to first order, as ``magsplice plan`` and ``check`` print it.

        Parameters
        ----------
        mu_r : float
            Relative recoil permeability of all tiles. Without effect if the layout states its own.

        Returns
        -------
        RecoilEstimate | None
            None if the layout has no ideal film, no working volume or more than 1000 tiles, or its
            figures do not exist.

        Raises
        ------
        ValueError
            If `mu_r` is not a permeability.
        MagspliceError
            If tiles overlap.
        """
        found = _magsplice.recoil_estimate(self._core, mu_r)
        if found is None:
            return None
        without, with_recoil = _figures(found["without"]), _figures(found["with_recoil"])
        assert without is not None
        assert with_recoil is not None
        return RecoilEstimate(found["recoil_permeability"], without, with_recoil)


def _figures(numbers: dict[str, Any] | None) -> FilmFigures | None:
    if numbers is None:
        return None
    uniformity, displacement = (
        tuple(numbers[key].values()) for key in ("uniformity_rmse", "displacement_rmse_mm")
    )
    return FilmFigures(numbers["amplitude"], uniformity, displacement)
