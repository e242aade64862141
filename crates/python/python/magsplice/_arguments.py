"""Rules of arguments: whole numbers, and choices."""

from __future__ import annotations

from collections.abc import Iterable
from operator import index
from typing import Any

#: Largest seed.
LARGEST_SEED = 2**64 - 1


def whole(name: str, value: Any, least: int, most: int = LARGEST_SEED) -> int:
    """A whole number in a range. TypeError for other values, ValueError out of the range."""
    try:
        number = index(value)
    except TypeError:
        raise TypeError(f"{name} = {value!r}, must be a whole number") from None
    if not least <= number <= most:
        bounds = f"at least {least}" if most == LARGEST_SEED else f"from {least} to {most}"
        raise ValueError(f"{name} = {number}, must be {bounds}")
    return number


def pair(name: str, value: Any) -> tuple[float, float]:
    """Two numbers. TypeError for other values."""
    try:
        first, second = (float(number) for number in value)
    except (TypeError, ValueError):
        raise TypeError(f"{name} = {value!r}, must be two numbers") from None
    return first, second


def one_of(name: str, value: Any, choices: Iterable[str]) -> str:
    """One of some words. ValueError for other values."""
    known = list(choices)
    if not isinstance(value, str) or value not in known:
        shown = ", ".join(f'"{choice}"' for choice in known)
        raise ValueError(f"{name} = {value!r}, must be one of {shown}")
    return value
