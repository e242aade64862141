#!/usr/bin/env python3
"""Writes recoil_fields.csv: B of magnets with a recoil permeability, by magpylib-material-response.

    pip install magpylib==6.2.0 magpylib-material-response==0.6.0
    python3 recoil_fields.py

The program solves the dense equations of cells (`solver="direct"`) whose interaction is averaged over
the receiving cell (`interaction="newell"`). On standard error it prints the largest difference of B
with the interaction at the centre of the cell (`interaction="point"`), over the largest |B|.
"""

import csv
import sys
from pathlib import Path

import magpylib
import numpy
from magpylib_material_response.demag import apply_demag

PERMEABILITIES = [1.05, 1.2]
# Intervals of the published film along x and y in mm: lower end, length, sign of the polarization.
INTERVALS = [
    (-10.0, 0.85, 0), (-9.15, 3.3, 1), (-5.85, 1.7, 0), (-4.15, 3.3, -1), (-0.85, 1.7, 0),
    (0.85, 3.3, 1), (4.15, 1.7, 0), (5.85, 3.3, -1), (9.15, 0.85, 0),
]  # fmt: skip
STRENGTH_T = 0.12
CELLS_PER_TILE = 3
POINTS = [(x, y, z) for x in (-2.0, -0.7, 0.4, 2.0) for y in (-2.0, -0.7, 0.4, 2.0) for z in (-5.0, -4.0, -3.0)]

# Four boxes: size, position, J_r, mu_r along the axes of the box. The easy axis of the last is z.
BOXES = [
    ((1.0, 1.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.2), (1.05, 1.05, 1.05)),
    ((1.0, 2.0, 1.0), (1.0, 0.5, 0.0), (0.7, 0.0, -0.7), (1.3, 1.3, 1.3)),
    ((0.5, 1.0, 0.75), (-0.75, 0.25, 0.125), (0.0, -1.0, 0.2), (2.0, 2.0, 2.0)),
    ((2.0, 1.5, 0.5), (0.25, 0.25, 0.75), (0.0, 0.0, -0.9), (1.15, 1.15, 1.04)),
]
NEAR_POINTS = [(0.1, 0.2, -1.5), (1.5, -1.0, 0.3), (-1.5, 1.0, -0.75), (0.5, 0.5, 2.0), (4.0, -3.0, 2.0)]


def film():
    """The tiles of layouts/published-film.toml: size, position, polarization."""
    tiles = []
    for x, length, sign_x in INTERVALS:
        for y, width, sign_y in INTERVALS:
            if sign_x or sign_y:
                j = STRENGTH_T / numpy.hypot(sign_x, sign_y) * numpy.array([sign_x, sign_y, 0.0])
                tiles.append(((length, width, 1.0), (x + 0.5 * length, y + 0.5 * width, 0.5), j))
    return tiles


def divided(tile, count):
    """Equal cells along the longest side, along x where two are the longest."""
    size, position, j = (numpy.array(part) for part in tile)
    axis = int(numpy.argmax(size))
    cell = size.copy()
    cell[axis] /= count
    steps = (numpy.arange(count) + 0.5) / count - 0.5
    return [(cell, position + step * size[axis] * numpy.eye(3)[axis], j) for step in steps]


def flux_densities_t(cells, susceptibility, points, interaction):
    """B at the points: of n cells, a number or n triples for the susceptibility."""
    collection = magpylib.Collection(
        *(magpylib.magnet.Cuboid(dimension=size, position=position, polarization=j) for size, position, j in cells)
    )
    apply_demag(collection, susceptibility, inplace=True, solver="direct", interaction=interaction)
    return collection.getB(points)


def both(cells, susceptibility, points):
    """B by the averaged interaction, and its difference from B by the interaction at centres."""
    averaged, matched = (flux_densities_t(cells, susceptibility, points, rule) for rule in ("newell", "point"))
    largest = numpy.linalg.norm(averaged, axis=1).max()
    return averaged, numpy.linalg.norm(matched - averaged, axis=1).max() / largest


def main():
    sets = []
    cells = [cell for tile in film() for cell in divided(tile, CELLS_PER_TILE)]
    for mu_r in PERMEABILITIES:
        fields, matched = both(cells, mu_r - 1.0, POINTS)
        print(f"film, mu_r = {mu_r}: interaction at centres is off by {matched:.1e} of max |B|", file=sys.stderr)
        sets.append((f"film-{mu_r:.2f}", POINTS, fields))
    susceptibilities = [tuple(value - 1.0 for value in mu_r) for *_, mu_r in BOXES]
    fields, matched = both([box[:3] for box in BOXES], susceptibilities, NEAR_POINTS)
    print(f"boxes: interaction at centres is off by {matched:.1e} of max |B|", file=sys.stderr)
    sets.append(("boxes", NEAR_POINTS, fields))
    with open(Path(__file__).with_suffix(".csv"), "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["set", "x", "y", "z", "b_x_t", "b_y_t", "b_z_t"])
        for name, points, fields in sets:
            for point, field in zip(points, fields):
                writer.writerow([name, *[repr(float(value)) for value in (*point, *field)]])


if __name__ == "__main__":
    main()
