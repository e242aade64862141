"""What notebooks show."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from magsplice import _magsplice

if TYPE_CHECKING:
    from magsplice._film import Film

#: Most rows of a table that a notebook shows.
_MOST_ROWS = 30


def digits(value: Any) -> str:
    """Value with six digits, vectors component by component."""
    if isinstance(value, (float, np.floating)):
        return f"{value:.6g}"
    if isinstance(value, (tuple, list)):
        return ", ".join(digits(item) for item in value) or "none"
    return "none" if value is None else str(value)


def number_table(rows: Iterable[tuple[str, Any]]) -> str:
    """Names and numbers as a table of HTML."""
    cells = "".join(
        f"<tr><th style='text-align:left'>{escape(name.replace('_', ' '))}</th>"
        f"<td style='text-align:left'>{escape(digits(value))}</td></tr>"
        for name, value in rows
    )
    return f"<table>{cells}</table>"


def rows_table(columns: dict[str, Any]) -> str:
    """Columns as a table of HTML, of which the first rows are shown."""
    head = "".join(f"<th>{escape(name)}</th>" for name in columns)
    rows = list(zip(*columns.values(), strict=True))
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(digits(value))}</td>" for value in row) + "</tr>"
        for row in rows[:_MOST_ROWS]
    )
    more = f"<p>{len(rows)} rows</p>" if len(rows) > _MOST_ROWS else ""
    return f"<table><tr>{head}</tr>{body}</table>{more}"


def frame(page: str, height_px: int) -> str:
    """Page in a frame of its own, whose scripts reach nothing outside it."""
    return (
        f'<iframe srcdoc="{escape(page)}" sandbox="allow-scripts" '
        f'style="width:100%;height:{height_px}px;border:1px solid #ccc"></iframe>'
    )


def film_html(film: Film, *, with_view: bool) -> str:
    """Film with its numbers, its picture, and the view that can be turned."""
    rows: list[tuple[str, Any]] = [("tiles", len(film)), ("sha256", film.sha256[:12])]
    if film.ideal is not None:
        ideal = film.ideal
        rows.append(
            (
                "ideal film",
                f"wavelength {ideal.wavelength_mm:g} mm, thickness {ideal.thickness_mm:g} mm, "
                f"amplitude {ideal.amplitude_t:g} T",
            )
        )
    if film.volume is not None and film.grid is not None:
        x, y, z = (
            f"{axis} {low:g} .. {high:g}"
            for axis, (low, high) in zip(
                "xyz", (film.volume.x_mm, film.volume.y_mm, film.volume.z_mm), strict=True
            )
        )
        rows.append(("working volume", f"{x}, {y}, {z} mm, {len(film.grid)} points"))
    rows += [("finding", finding) for finding in film.findings]
    picture = _magsplice.layout_svg(film._core)
    view = ""
    if with_view:
        turned = frame(_magsplice.view(film._core), 520)
        view = f"<details><summary>Turn the tiles</summary>{turned}</details>"
    return (
        f"<h4>{escape(film.name)}</h4>{number_table(rows)}"
        f"<div style='max-width:640px'>{picture}</div>{view}"
    )
