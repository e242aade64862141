"""Times magpylib's core function on a scene, once for every line `run` on standard input.

Usage: magpylib_scene.py TILES.csv POINTS.csv
TILES.csv holds size, polarization, position and rotation (quaternion x, y, z, w) of each tile,
POINTS.csv the points, in metres and tesla. Prints the seconds of each run on a separate line.
After a line `field` on standard input it prints B of the last run, three lines for each point.
The tiles are summed in a loop over the core function, the fastest way with magpylib.
"""

import sys
import time

import numpy as np
from magpylib.core import magnet_cuboid_Bfield
from scipy.spatial.transform import Rotation


def field(tiles, points):
    """Sum over tiles of B at all points."""
    total = np.zeros_like(points)
    for row in tiles:
        size, polarization, position, turn = row[0:3], row[3:6], row[6:9], row[9:13]
        local = points - position
        rotated = not np.array_equal(turn, [0, 0, 0, 1])
        if rotated:
            rotation = Rotation.from_quat(turn)
            local = rotation.inv().apply(local)
        own = magnet_cuboid_Bfield(
            observers=local,
            dimensions=np.broadcast_to(size, points.shape),
            polarizations=np.broadcast_to(polarization, points.shape),
        )
        total += rotation.apply(own) if rotated else own
    return total


def main():
    tiles = np.loadtxt(sys.argv[1], delimiter=",", ndmin=2)
    points = np.loadtxt(sys.argv[2], delimiter=",", ndmin=2)
    for line in sys.stdin:
        if line.strip() == "field":
            print("\n".join(repr(float(b)) for b in found.flat), flush=True)
            continue
        start = time.perf_counter()
        found = field(tiles, points)
        print(time.perf_counter() - start, flush=True)


if __name__ == "__main__":
    main()
