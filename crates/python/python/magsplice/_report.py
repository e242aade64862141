"""Figures, pages and notebooks."""

from __future__ import annotations

import json
import re
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from magsplice import _html, _magsplice
from magsplice._comparison import ComparedFilm
from magsplice._field import tolerance

if TYPE_CHECKING:
    import os

#: Height of the view of the tiles, in pixels.
_VIEW_PX = 720
#: Most tiles with which a notebook shows the view that can be turned, which it keeps in its file.
_MOST_TILES_IN_VIEW = 2000
#: Style that hides all of a report but the view of the tiles.
_ONLY_VIEW = "header, main > section:not(:first-child) { display: none }"


class Figure(NamedTuple):
    """A figure of a report. A notebook shows its SVG.

    Attributes
    ----------
    name : str
        Name of its files, without extension.
    caption : str
        What the figure shows.
    svg : str
        The figure as SVG.
    png : bytes
        The figure as PNG, 300 dots per inch.
    csv : str
        The numbers that the figure shows, with one header line.
    """

    name: str
    caption: str
    svg: str
    png: bytes
    csv: str

    def _repr_svg_(self) -> str:
        return self.svg

    def __repr__(self) -> str:
        return f"<magsplice.Figure {self.name!r}: {self.caption}>"


class Page:
    """An HTML page that loads no other file. A notebook shows it in a frame.

    Attributes
    ----------
    html : str
        The page.
    """

    html: str

    def __init__(self, html: str, height_px: int = 600) -> None:
        self.html = html
        self._height_px = height_px

    def _repr_html_(self) -> str:
        return _html.frame(self.html, self._height_px)

    def __repr__(self) -> str:
        return f"<magsplice.{type(self).__name__}: {len(self.html)} characters of HTML>"


class Report(Page):
    """Figures of a film, and the page that shows them.

    Attributes
    ----------
    figures : dict[str, Figure]
        Figures by name.
    absent : list[str]
        What the report lacks, and why.
    """

    figures: dict[str, Figure]
    absent: list[str]

    def __init__(
        self, figures: list[tuple[str, str, str, bytes, str]], html: str, absent: list[str]
    ) -> None:
        super().__init__(html, 900)
        self.figures = {figure[0]: Figure(*figure) for figure in figures}
        self.absent = absent

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Writes report.html and SVG, PNG and CSV of each figure; returns the path of the page.

        Parameters
        ----------
        folder : str or path
            Folder, which is made if it is not there. Files of these names are replaced.
        """
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        for figure in self.figures.values():
            (folder / f"{figure.name}.svg").write_text(figure.svg, encoding="utf-8")
            (folder / f"{figure.name}.png").write_bytes(figure.png)
            (folder / f"{figure.name}.csv").write_text(figure.csv, encoding="utf-8")
        page = folder / "report.html"
        page.write_text(self.html, encoding="utf-8")
        return page


class DrawnFilm(ComparedFilm):
    """A film with its pictures."""

    def report(self, *, outlines: bool = False, within: float | None = None) -> Report:
        """Figures of the film and one HTML page, as ``magsplice report`` draws them.

        Parameters
        ----------
        outlines : bool
            Whether text of SVG files becomes outlines, which look the same on every machine.
        within : float, optional
            Tolerance of the field of the working volume; see `b`.

        Returns
        -------
        Report
            ``report.save("folder")`` writes the files; a notebook shows the page.
        """
        text, numbers = "", "{}"
        if self.grid is not None and self.ideal is not None:
            comparison, decoupling = self.compare(within=within), self.decouple(within=within)
            text = f"{comparison}\n\n{decoupling}\n"
            numbers = json.dumps(
                {"comparison": comparison.to_dict(), "decoupling": decoupling.to_dict()}
            )
        figures, html, absent = _magsplice.report(
            self._core, text, numbers, outlines, tolerance(within, None)
        )
        return Report(figures, html, absent)

    def view(self, height_px: int = _VIEW_PX) -> Page:
        """View of the tiles that can be turned, for a notebook.

        Parameters
        ----------
        height_px : int
            Height in pixels.
        """
        return Page(self._view(), height_px)

    def _repr_html_(self) -> str:
        rows: list[tuple[str, Any]] = [("tiles", len(self)), ("sha256", self.sha256[:12])]
        if self.ideal is not None:
            ideal = self.ideal
            rows.append(
                (
                    "ideal film",
                    f"wavelength {ideal.wavelength_mm:g} mm, thickness {ideal.thickness_mm:g} mm, "
                    f"amplitude {ideal.amplitude_t:g} T",
                )
            )
        if self.volume is not None and self.grid is not None:
            x, y, z = (
                f"{axis} {low:g} .. {high:g}"
                for axis, (low, high) in zip(
                    "xyz", (self.volume.x_mm, self.volume.y_mm, self.volume.z_mm), strict=True
                )
            )
            rows.append(("working volume", f"{x}, {y}, {z} mm, {len(self.grid)} points"))
        rows += [("finding", finding) for finding in self.findings]
        view = ""
        if len(self) <= _MOST_TILES_IN_VIEW:
            turned = _html.frame(self._view(), _VIEW_PX)
            view = f"<details><summary>Turn the tiles</summary>{turned}</details>"
        return (
            f"<h4>{escape(self.name)}</h4>{_html.number_table(rows)}"
            f"{_html.picture(_magsplice.layout_svg(self._core))}{view}"
        )

    def _view(self) -> str:
        """Page with the view of the tiles alone."""
        page = re.sub("<figure.*?</figure>", "", _magsplice.view(self._core), flags=re.DOTALL)
        return page.replace("</head>", f"<style>{_ONLY_VIEW}</style></head>", 1)
