"""Figures, pages and notebooks."""

from __future__ import annotations

import re
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from magsplice import _html, _magsplice
from magsplice.errors import MagspliceError

if TYPE_CHECKING:
    import os

#: Height of the view of the tiles, in pixels.
VIEW_PX = 720
#: Height of the live page, in pixels.
LIVE_PX = 1100
#: Largest number of tiles for a rotatable view in a notebook, which is stored in its file.
_MOST_TILES_IN_VIEW = 2000
#: Style that hides a report except the view of the tiles.
_ONLY_VIEW = "header, nav, main > section:not([data-film]) { display: none }"


class Figure(NamedTuple):
    """A figure of a film. A notebook shows it.

    Attributes
    ----------
    name : str
        Name of its files, without extension.
    caption : str
        Description of the figure.
    svg : str
        The figure as SVG.
    png : bytes
        The figure as PNG, 300 dots per inch.
    csv : str
        The numbers of the figure, with one header line.
    """

    name: str
    caption: str
    svg: str
    png: bytes
    csv: str

    def _repr_svg_(self) -> str:
        return self.svg

    def _repr_png_(self) -> bytes:
        return self.png

    def __repr__(self) -> str:
        return f"<magsplice.Figure {self.name!r}: {self.caption}>"


class Page:
    """A self-contained HTML page. A notebook shows it in a frame.

    Attributes
    ----------
    html : str
        The page.
    """

    html: str

    def __init__(self, html: str, height_px: int = 600, *, live: bool = False) -> None:
        self.html = html
        self._height_px = height_px
        self._live = live

    def _repr_html_(self) -> str:
        return _html.frame(self.html, self._height_px, downloads=self._live)

    def __repr__(self) -> str:
        return f"<magsplice.{type(self).__name__}: {len(self.html)} characters of HTML>"


class Report(Page):
    """Figures of a film, and the page that shows them.

    Attributes
    ----------
    figures : dict[str, Figure]
        Figures by name.
    absent : list[str]
        Missing parts of the report, and the reasons.
    """

    figures: dict[str, Figure]
    absent: list[str]

    def __init__(
        self, figures: list[tuple[str, str, str, bytes, str]], pages: list[str], absent: list[str]
    ) -> None:
        html, self._html_in_folder = pages
        super().__init__(html, 900)
        self.figures = {figure[0]: Figure(*figure) for figure in figures}
        self.absent = absent

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Writes report.html and SVG, PNG and CSV of each figure; returns the path of the page.

        Parameters
        ----------
        folder : str or path
            Folder, created if missing. Existing files of these names are replaced.
        """
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        for figure in self.figures.values():
            (folder / f"{figure.name}.svg").write_text(figure.svg, encoding="utf-8")
            (folder / f"{figure.name}.png").write_bytes(figure.png)
            (folder / f"{figure.name}.csv").write_text(figure.csv, encoding="utf-8")
        page = folder / "report.html"
        page.write_text(self._html_in_folder, encoding="utf-8")
        return page


def film_html(film: _magsplice.Film, rows: list[tuple[str, Any]]) -> str:
    """Numbers of a film, its findings, its picture, and for few tiles a rotatable view."""
    rows = [("tiles", len(film)), ("sha256", film.sha256[:12]), *rows]
    rows += [("finding", finding) for finding in film.findings]
    view = ""
    if len(film) <= _MOST_TILES_IN_VIEW:
        turned = _html.frame(view_html(film), VIEW_PX)
        view = f"<details><summary>Turn the tiles</summary>{turned}</details>"
    picture = _html.picture(_magsplice.layout_svg(film))
    return f"<h4>{escape(film.name)}</h4>{_html.number_table(rows)}{picture}{view}"


def live_html(film: _magsplice.Film, text: str, engine: str | os.PathLike[str] | None) -> str:
    """Page on which the film is changed and evaluated."""
    module = None if engine is None else Path(engine).read_bytes()
    page = _magsplice.live_page(film, text, module)
    if page is None:
        raise MagspliceError(
            "this build of magsplice has no engine of the live page: give the module as "
            "engine=FILE, or use `magsplice studio FILE`"
        )
    return page


def view_html(film: _magsplice.Film) -> str:
    """Page with the view of the tiles alone."""
    page = re.sub("<figure.*?</figure>", "", _magsplice.view(film), flags=re.DOTALL)
    return page.replace("</head>", f"<style>{_ONLY_VIEW}</style></head>", 1)
