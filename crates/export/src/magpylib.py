"""A film of block magnets in magpylib 5 or 6, written by magsplice.

    python THIS_FILE [POINTS.csv]

prints B as CSV: at the reference point of the working volume, then at the points of
the columns x_mm, y_mm, z_mm of POINTS.csv. `film()` is the film, for other scripts.
"""

import csv
import sys

import magpylib as magpy
import numpy as np
from scipy.spatial.transform import Rotation

LAYOUT = "{layout}"
SHA256 = "{sha256}"
PROGRAM = "{version}"
REFERENCE_MM = "{reference}"

# Name; centre and full side lengths in mm; polarization J = mu0 M in T, in the frame
# of the tile; rotation from that frame to the film's, a quaternion x, y, z, w.
TILES = [
    "{tiles}",
]

MM_PER_M = 1000.0


def film():
    """The tiles as a collection: lengths in m, polarization in T."""
    return magpy.Collection(
        *(
            magpy.magnet.Cuboid(
                position=np.array(centre_mm) / MM_PER_M,
                dimension=np.array(size_mm) / MM_PER_M,
                polarization=polarization_t,
                orientation=Rotation.from_quat(quaternion),
                style_label=name,
            )
            for name, centre_mm, size_mm, polarization_t, quaternion in TILES
        ),
        style_label=LAYOUT,
    )


def flux_density_t(points_mm):
    """B in T at points in mm, one row each."""
    points_mm = np.asarray(points_mm, dtype=float).reshape(-1, 3)
    return film().getB(points_mm / MM_PER_M).reshape(-1, 3)


def main():
    points_mm = [] if REFERENCE_MM is None else [REFERENCE_MM]
    if len(sys.argv) > 1:
        with open(sys.argv[1], newline="", encoding="utf-8") as file:
            rows = csv.DictReader(file)
            rows.fieldnames = [name.strip() for name in rows.fieldnames]
            for row in rows:
                points_mm.append([float(row[name]) for name in ("x_mm", "y_mm", "z_mm")])
    print("x_mm,y_mm,z_mm,bx_t,by_t,bz_t")
    if points_mm:
        for point, field in zip(points_mm, flux_density_t(points_mm)):
            print(",".join(repr(float(value)) for value in (*point, *field)))


if __name__ == "__main__":
    main()
