"""What notebooks show."""

from __future__ import annotations

import base64
import re
from collections.abc import Iterable
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from magsplice import _magsplice

if TYPE_CHECKING:
    from magsplice._film import Film

#: Most rows of a table that a notebook shows.
_MOST_ROWS = 30
#: Height of the view of the tiles, in pixels.
VIEW_PX = 720
#: Style that hides all of a report but the view of the tiles.
_ONLY_VIEW = "header, main > section:not(:first-child) { display: none }"


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


def view_of(film: Film) -> str:
    """Page with the view of the tiles alone."""
    page = re.sub("<figure.*?</figure>", "", _magsplice.view(film._core), flags=re.DOTALL)
    return page.replace("</head>", f"<style>{_ONLY_VIEW}</style></head>", 1)


def picture(svg: str) -> str:
    """Picture that is as wide as the page, and at most as wide as it was drawn."""
    data = base64.b64encode(svg.encode()).decode()
    return f'<img alt="" style="max-width:100%" src="data:image/svg+xml;base64,{data}">'


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
    view = ""
    if with_view:
        turned = frame(view_of(film), VIEW_PX)
        view = f"<details><summary>Turn the tiles</summary>{turned}</details>"
    return (
        f"<h4>{escape(film.name)}</h4>{number_table(rows)}"
        f"{picture(_magsplice.layout_svg(film._core))}{view}"
    )
