"""Films from files, texts, a few numbers, and collections of magpylib."""

from __future__ import annotations

import difflib
import inspect
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

import numpy as np

from magsplice import _findings, _magsplice
from magsplice._arguments import pair, whole
from magsplice._assignment import MOST_STARTS
from magsplice._film import Design, Film, film_of_text, searched
from magsplice._layout import Tile
from magsplice._magpylib.cuboids import Track, cuboids_of, in_mm
from magsplice._samples import Preset


def load(path: str | os.PathLike[str]) -> Film:
    """Film from a layout file.

    Parameters
    ----------
    path : str or path
        TOML file in the format of docs/layout-format.md, as written by ``magsplice init``.

    Raises
    ------
    OSError
        If the file cannot be read, such as `FileNotFoundError`.
    LayoutError
        If the file is no layout. All broken rules are in ``error.faults``.

    Examples
    --------
    >>> film = magsplice.load("layouts/published-film.toml")  # doctest: +SKIP
    """
    path = Path(path)
    return _warned(film_of_text(_magsplice.layout_text(path), str(path), path.absolute().parent))


def loads(
    text: str, *, origin: str = "layout", folder: str | os.PathLike[str] | None = None
) -> Film:
    """Film from the text of a layout file.

    Parameters
    ----------
    text : str
        TOML, as in a layout file.
    origin : str
        Name of the text in error messages.
    folder : str or path, optional
        Folder of files referenced by the text, such as measured errors. Default: the working
        folder.

    Raises
    ------
    LayoutError
        If the text is no layout. All broken rules are in ``error.faults``.
    """
    return _warned(film_of_text(text, origin, folder))


def _warned(film: Film) -> Film:
    _findings.warn(film)
    return film


def pattern(
    wavelength_mm: float,
    film_mm: tuple[float, float],
    *,
    thickness_mm: float | None = None,
    remanence_t: float = 0.12,
    range_mm: tuple[float, float] | None = None,
    distance_mm: tuple[float, float] | None = None,
    smallest_cut_mm: float | None = None,
    gap_mm: float = 0.0,
    resolution_mm: float = 0.001,
    resolution_deg: float = 0.01,
    least_amplitude: float = 0.65,
    parts: int | None = None,
    goal: Literal["uniformity", "displacement", "field"] = "displacement",
    starts: int = 8,
    seed: int = 1,
    preset: Preset | None = None,
    under: Literal["nominal", "tolerance"] = "nominal",
    one_sided: bool = False,
    sensor: str | None = None,
    name: str | None = None,
) -> Film:
    """Start film of a design, from a few numbers: the pattern of Dai 2024, Fig. 5.

    `splice` searches from this film.

    Parameters
    ----------
    wavelength_mm : float
        Wavelength of the ideal film, in millimetres.
    film_mm : (float, float)
        Extent of the film along x and y, in millimetres, at least 5/6 of the wavelength.
    thickness_mm : float, optional
        Thickness of the film. Default: a tenth of the wavelength.
    remanence_t : float
        Magnitude of the polarization of every tile, in tesla.
    range_mm : (float, float), optional
        Extent of the working volume along x and y. Default: 0.4 wavelengths.
    distance_mm : (float, float), optional
        Smallest and largest distance of the sensor below the film, or its range along z, where both
        are negative. Default: 0.3 and 0.5 wavelengths.
    smallest_cut_mm : float, optional
        Shortest side of a tile. Default: 0.08 wavelengths.
    gap_mm : float
        Smallest distance of neighbouring tiles.
    resolution_mm, resolution_deg : float
        Units of rounding of sizes and directions.
    least_amplitude : float
        Smallest best-fit amplitude against the ideal film.
    parts : int, optional
        Largest number of distinct parts.
    goal : {"displacement", "uniformity", "field"}
        Error to minimize.
    starts, seed : int
        Number of starts of the search, and the seed of their random variations.
    preset : {"by-hand", "workshop", "jig"}, optional
        Usual errors of the tiles, for the table ``[tolerance]`` of the film.
    under : {"nominal", "tolerance"}
        Films whose error the search minimizes: as ordered, or as made with the errors of `preset`.
    one_sided : bool
        Keep errors small when flat iron comes near the upper face, at a tenth of the wavelength:
        with tiles magnetized out of the plane too, for the errors of `preset` and of this iron.
    sensor : str, optional
        Part with known noise, counts and range, such as "MLX90393", for the table ``[sensor]``.
    name : str, optional
        Name of the film. Default: its extent and the wavelength.

    Raises
    ------
    ValueError
        If `starts` is not from 1 to 10 000, `parts` below 1, or `seed` below 0, if no preset or
        part has this name, or if `under` is "tolerance" or
        `one_sided` is set without `preset`.
    MagspliceError
        If other numbers are out of range; the message lists all of them.
    """
    film_mm = pair("film_mm", film_mm)
    range_mm = None if range_mm is None else pair("range_mm", range_mm)
    distance_mm = None if distance_mm is None else pair("distance_mm", distance_mm)
    starts, seed = whole("starts", starts, 1, MOST_STARTS), whole("seed", seed, 0)
    parts = None if parts is None else whole("parts", parts, 1)
    if under == "tolerance" and preset is None:
        raise ValueError("under = 'tolerance' needs preset, the errors of films as made")
    if one_sided and preset is None:
        raise ValueError("one_sided needs preset, the errors of films as made")
    text = _magsplice.pattern(
        wavelength_mm,
        film_mm,
        thickness_mm,
        remanence_t,
        range_mm,
        distance_mm,
        smallest_cut_mm,
        gap_mm,
        resolution_mm,
        resolution_deg,
        least_amplitude,
        parts,
        goal,
        starts,
        seed,
        preset,
        under,
        one_sided,
        sensor,
        name,
    )
    return film_of_text(text, "the pattern", None)


def splice(
    wavelength_mm: float,
    film_mm: tuple[float, float],
    *,
    progress: Callable[[str, int, int, float | None], Any] | None = None,
    **request: Any,
) -> Design:
    """Film designed without a layout to start from, as ``magsplice splice`` does.

    The search starts from the `pattern`, with sizes, positions and directions of the tiles free.
    It takes from seconds to minutes.

    Parameters
    ----------
    wavelength_mm : float
        Wavelength of the ideal film, in millimetres.
    film_mm : (float, float)
        Extent of the film along x and y, in millimetres, at least 5/6 of the wavelength.
    progress : callable, optional
        As in `Film.design`.
    **request
        Other arguments of `pattern`: ``thickness_mm``, ``range_mm``, ``distance_mm``,
        ``smallest_cut_mm``, ``gap_mm``, ``resolution_mm``, ``parts``, ``preset``, ``under``,
        ``one_sided``, ``sensor``, ``name``, ...

    Returns
    -------
    Design
        ``splice(10, (20, 20)).film`` is the film.

    Raises
    ------
    ValueError
        As `pattern`.
    MagspliceError
        As `pattern`, or if the search finds no film.

    Warns
    -----
    LayoutWarning
        If the film found does not meet its demands, `Design.short_of`.
    """
    known = list(inspect.signature(pattern).parameters)
    for name in request:
        if name not in known:
            near = difflib.get_close_matches(name, known, 1, 0.5)
            meant = f"; did you mean {near[0]!r}?" if near else ""
            raise TypeError(f"splice() got an unexpected keyword argument {name!r}{meant}")
    return searched(pattern(wavelength_mm, film_mm, **request), progress)


def from_magpylib(sources: Any, *, name: str | None = None, **tables: Any) -> Film:
    """Film from the cuboids of a magpylib collection.

    Parameters
    ----------
    sources : Collection, Cuboid, or list of these
        Cuboids without paths, in metres and tesla. They must not overlap by more than
        ``overlap_mm``.
    name : str, optional
        Name of the film. Default: the label of the collection, or ``"from magpylib"``.
    **tables
        Other keys of the layout, as of `Film`: ``overlap_mm``, ``ideal``, ``volume``, ...

    Returns
    -------
    Film
        In millimetres. Only the decimal point moves, so lengths of up to 15 digits keep all digits.

    Raises
    ------
    TypeError
        If a source is not a cuboid.
    ValueError
        If a cuboid moves along a path, or lacks dimension or polarization.
    LayoutError
        If the cuboids break rules of layouts.
    """
    entries = list(sources) if isinstance(sources, (list, tuple)) else [sources]
    cuboids = [cuboid for entry in entries for cuboid in cuboids_of(entry)]
    labels = [cuboid.style.label for cuboid in cuboids]
    tiles = []
    for cuboid, label in zip(cuboids, labels, strict=True):
        track = Track(cuboid)
        if track.length > 1:
            raise ValueError(
                f"{cuboid!r} has a path of {track.length} steps, but a film is fixed; give a copy "
                "with one position"
            )
        quaternion = track.rotation[0]
        tiles.append(
            Tile(
                in_mm(track.position[0]).tolist(),
                in_mm(track.size[0]).tolist(),
                track.polarization_t[0].tolist(),
                None if np.array_equal(quaternion, (0, 0, 0, 1)) else quaternion,
                # A label shared by several cuboids is not a name.
                label if label and labels.count(label) == 1 else None,
            )
        )
    if name is None:
        label = getattr(getattr(sources, "style", None), "label", None)
        name = label or "from magpylib"
    return Film(tiles, name=name, **tables)
