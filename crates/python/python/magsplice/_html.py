"""HTML tables, frames and pictures for notebooks."""

from __future__ import annotations

import base64
from collections.abc import Iterable
from html import escape
from typing import Any

import numpy as np

#: Largest number of rows of a table in a notebook.
_MOST_ROWS = 30


def digits(value: Any) -> str:
    """Value with six digits, vectors component by component."""
    if isinstance(value, (float, np.floating)):
        return f"{value:.6g}"
    if isinstance(value, (tuple, list)):
        return ", ".join(digits(item) for item in value) or "none"
    return "none" if value is None else str(value)


def number_table(rows: Iterable[tuple[str, Any]]) -> str:
    """Names and numbers as an HTML table."""
    cells = "".join(
        f"<tr><th style='text-align:left'>{escape(name)}</th>"
        f"<td style='text-align:left'>{escape(digits(value))}</td></tr>"
        for name, value in rows
    )
    return f"<table>{cells}</table>"


def rows_table(columns: dict[str, Any]) -> str:
    """The first rows of columns as an HTML table."""
    head = "".join(f"<th>{escape(name)}</th>" for name in columns)
    rows = list(zip(*columns.values(), strict=True))
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(digits(value))}</td>" for value in row) + "</tr>"
        for row in rows[:_MOST_ROWS]
    )
    more = f"<p>{len(rows)} rows</p>" if len(rows) > _MOST_ROWS else ""
    return f"<table><tr>{head}</tr>{body}</table>{more}"


def rows_text(columns: dict[str, Any]) -> str:
    """The first rows of columns as text, aligned."""
    rows = list(zip(*columns.values(), strict=True))
    cells = [list(columns), *([digits(value) for value in row] for row in rows[:_MOST_ROWS])]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    lines = ["  ".join(map(str.rjust, row, widths)) for row in cells]
    more = [f"{len(rows)} rows"] if len(rows) > _MOST_ROWS else []
    return "\n".join([*lines, *more])


def frame(page: str, height_px: int, *, downloads: bool = False) -> str:
    """Page in its own frame, isolated from the document around it."""
    allowed = "allow-scripts allow-downloads" if downloads else "allow-scripts"
    return (
        f'<iframe srcdoc="{escape(page)}" sandbox="{allowed}" '
        f'style="width:100%;height:{height_px}px;border:1px solid #ccc"></iframe>'
    )


def picture(svg: str) -> str:
    """Picture as wide as the page, at most its drawn width."""
    data = base64.b64encode(svg.encode()).decode()
    return f'<img alt="" style="max-width:100%" src="data:image/svg+xml;base64,{data}">'
