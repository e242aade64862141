"""Coordinates of points in datasets of xarray."""

from __future__ import annotations

from typing import Any

from magsplice._layout import Grid


def coordinates(grid: Grid) -> dict[str, Any]:
    """Coordinates of a grid for xarray."""
    millimetres = {"units": "mm"}
    return {
        "x": ("x", grid.x_mm, millimetres),
        "y": ("y", grid.y_mm, millimetres),
        "z": ("z", grid.z_mm, millimetres),
        "component": ("component", ["x", "y", "z"]),
    }
