"""Warnings about properties of layouts and measurements that are usually a mistake."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Collection

from magsplice._magsplice import Film
from magsplice.errors import LayoutWarning, MeasurementWarning

#: Largest number of findings of a warning.
_MOST_SHOWN = 5


def warn(film: Film, known: Collection[str] = ()) -> None:
    """One warning with the findings of a new film that are not known, at the user's call."""
    found = [finding for finding in film.findings if finding not in known]
    if not found:
        return
    shown = [f"{film.name}: {finding}" for finding in found[:_MOST_SHOWN]]
    if len(found) > _MOST_SHOWN:
        shown.append(f"and {len(found) - _MOST_SHOWN} more, listed by film.findings")
    warnings.warn("\n".join(shown), LayoutWarning, stacklevel=_frames_of_package())


def warn_of_search(short_of: Collection[str]) -> None:
    """One warning with the demands that a film found does not meet, at the user's call."""
    if short_of:
        text = "the film found does not meet its demands: " + "; ".join(short_of)
        warnings.warn(text, LayoutWarning, stacklevel=_frames_of_package())


def warn_of_measurement(film: Film, remarks: Collection[str]) -> None:
    """One warning with remarks about a measurement of a film, at the user's call."""
    if remarks:
        text = "\n".join(f"{film.name}: {remark}" for remark in remarks)
        warnings.warn(text, MeasurementWarning, stacklevel=_frames_of_package())


def _frames_of_package() -> int:
    """Number of frames from the caller to the first one outside of this package."""
    package, level = __name__.partition(".")[0], 1
    while sys._getframe(level).f_globals.get("__name__", "").partition(".")[0] == package:
        level += 1
    return level
