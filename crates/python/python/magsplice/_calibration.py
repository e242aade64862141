"""The stiffness of the elastic layer, from forces and readings."""

from __future__ import annotations

from typing import Any

from magsplice._arrow import Column, Table, split
from magsplice._layout import Floats, Vector
from magsplice._results import PerAxis, Result, key
from magsplice._scan import ExcludedReadings
from magsplice._source import OfFilm


class Stiffness(Result):
    """A fitted line: force = stiffness x displacement of the film + force at rest."""

    stiffness_n_per_mm: float = key("Force per displacement, in N/mm.")
    stiffness_n_per_mm_95: float = key("Half the width of its interval of 95 % confidence.")
    force_at_rest_n: float = key("Force without displacement, in newton.")
    force_at_rest_n_95: float = key("Half the width of its interval of 95 % confidence.")
    residual_n: float = key("Standard deviation of the residuals, in newton.")
    forces: int = key("Number of forces that the line was fitted to.")


class Calibration(OfFilm, Table):
    """The stiffness of the elastic layer along x, y, z. A table of displacements and forces."""

    readings: int = key("Number of readings.")
    hooke_n_per_mm: Vector | None = key(
        "Stiffness of ``[elastomer]`` by Hooke's law, in N/mm. None without this table."
    )
    by_field: PerAxis[Stiffness | None] = key(
        "By displacements from the field of the layout; None along axes without a stiffness.",
        Stiffness,
    )
    by_closed_form: PerAxis[Stiffness | None] | None = key(
        "By displacements of the closed form. None without an ideal film.", Stiffness
    )
    without_stiffness: PerAxis[str | None] = key("The reasons why axes have no stiffness.")
    excluded: ExcludedReadings = key(
        "Readings that the fit of an axis does not use, though it has other forces.",
        ExcludedReadings,
    )
    film_mm: Floats = key(
        "Displacement of the film by the field of the layout, in millimetres, shape (..., 3)."
    )
    closed_form_mm: Floats | None = key(
        """Displacement of the film by the closed form, in millimetres, shape (..., 3). None without
        an ideal film."""
    )
    force_n: Floats = key("The given forces, in newton, shape (..., 3).")

    def columns(self) -> dict[str, Column]:
        """Columns film_dx_mm, ..., closed_form_dx_mm, ..., fx_n, fy_n, fz_n."""
        arrays: dict[str, Any] = {"film": self.film_mm, "closed_form": self.closed_form_mm}
        columns: dict[str, Column] = {}
        for name, array in arrays.items():
            if array is not None:
                columns |= split(tuple(f"{name}_d{axis}_mm" for axis in "xyz"), array)
        return {**columns, **split(("fx_n", "fy_n", "fz_n"), self.force_n)}
