"""Times magsplice and magpylib on the published film, on one thread, and prints the ratios.

Run with the package and magpylib installed::

    python crates/python/benches/beside_magpylib.py

Both get the same points in metres or millimetres and one thread. Times are processor times, which
other programs hardly affect. The smallest time of several runs counts. The core function of
magpylib is called for one tile after the other, the fastest way.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable
from pathlib import Path

# Read when the first field is computed.
os.environ["RAYON_NUM_THREADS"] = "1"
for library in ("OMP", "OPENBLAS", "MKL"):
    os.environ[f"{library}_NUM_THREADS"] = "1"

import magpylib
import numpy as np

import magsplice

FILM = Path(__file__).parents[3] / "layouts" / "published-film.toml"
#: Points of the fine grid of the working volume: a step of 0.05 mm.
FINE = (81, 81, 41)
#: Tolerance of the fields on the grid, as a fraction of |B|.
WITHIN = 1e-9
#: Number of turns. All calls run in each turn.
TURNS = 7
#: Number of runs in each turn, for calls that take milliseconds.
IN_A_ROW = 20


def least_times(
    calls: dict[str, Callable[[], object]], turns: int, in_a_row: int = 1
) -> dict[str, float]:
    """Smallest time of each call in seconds, over the runs of all turns."""
    least = dict.fromkeys(calls, float("inf"))
    for _ in range(turns):
        for name, call in calls.items():
            for _ in range(in_a_row):
                begin = time.process_time()
                call()
                least[name] = min(least[name], time.process_time() - begin)
    return least


def core_field(film: magsplice.Film, points: np.ndarray) -> np.ndarray:
    """B of unrotated tiles by the core function of magpylib."""
    tiles, field = film.tiles, np.zeros_like(points)
    for position, size, polarization_t in zip(
        tiles.position_mm, tiles.size_mm, tiles.polarization_t, strict=True
    ):
        field += magpylib.core.magnet_cuboid_Bfield(
            observers=points - position,
            dimensions=np.broadcast_to(size, points.shape),
            polarizations=np.broadcast_to(polarization_t, points.shape),
        )
    return field


def main() -> None:
    """Prints times and ratios."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--turns", type=int, default=TURNS, help="runs of each call")
    turns = parser.parse_args().turns
    magpylib.defaults.threads = 1
    film = magsplice.load(FILM)
    collection = film.to_magpylib()
    print(f"magsplice {magsplice.__version__}, magpylib {magpylib.__version__}, one thread each")

    grid = film.grid
    assert grid is not None
    points = grid.points_mm.reshape(-1, 3)
    metres = points / 1000
    # Many points at a time, so the overhead of a call is negligible.
    many = magsplice.Grid(grid.lower_mm, grid.upper_mm, (41, 41, 11))
    many_points = many.points_mm.reshape(-1, 3)
    exact = least_times(
        {
            "getB": lambda: collection.getB(many_points / 1000),
            "core": lambda: core_field(film, many_points),
            "film.b": lambda: film.b(many_points),
        },
        turns,
    )
    few = least_times(
        {"getB": lambda: collection.getB(metres), "film.b": lambda: film.b(points)},
        turns,
        IN_A_ROW,
    )
    fine = magsplice.Grid(grid.lower_mm, grid.upper_mm, FINE)
    # The time of getB is proportional to the number of points, so a part of them is enough.
    part = fine.points_mm.reshape(-1, 3)[:: len(fine) // 20_000] / 1000
    on_grid = least_times(
        {
            "getB": lambda: collection.getB(part),
            "film.b": lambda: film.b(fine, within=WITHIN),
            "exact": lambda: film.b(fine),
        },
        turns,
    )
    on_grid["getB"] *= len(fine) / len(part)

    error = np.linalg.norm(collection.getB(metres) - film.b(points), axis=1)
    print(f"largest difference on 405 points: {error.max():.1e} T")
    for name, count, times in (
        ("exact", len(many), exact),
        ("exact, 405 points", len(grid), few),
        (f"within {WITHIN:g}, grid", len(fine), on_grid),
    ):
        per_point = {key: 1e9 * value / count for key, value in times.items()}
        told = ", ".join(f"{key} {value:.1f}" for key, value in per_point.items())
        print(f"{name}: ns for a point: {told}")
    print(f"ratio: exact-beside-getB = {exact['getB'] / exact['film.b']:.0f}")
    print(f"ratio: exact-beside-getB-405-points = {few['getB'] / few['film.b']:.0f}")
    print(f"ratio: exact-beside-core = {exact['core'] / exact['film.b']:.0f}")
    print(f"ratio: within-beside-getB = {on_grid['getB'] / on_grid['film.b']:.0f}")


if __name__ == "__main__":
    main()
