"""Write discs.csv: B of discs one radius away, by magpylib's closed form of the cylinder."""

from pathlib import Path

import magpylib

RADIUS_MM = 2.5


def points(height_mm: float) -> list[tuple[float, float, float]]:
    """Points above, beside and around the rim of a disc, one radius from its surface."""
    radius, top = RADIUS_MM, height_mm / 2
    return [
        (0, 0, top + radius),
        (radius, 0, top + radius),
        (0, radius, top + radius),
        (2 * radius, 0, 0),
        (0, 2 * radius, 0),
        (2 * radius / 2**0.5, 2 * radius / 2**0.5, top / 2),
        (radius + radius * 0.6, 0, top + radius * 0.8),
        (0, radius + radius * 0.6, top + radius * 0.8),
    ]


def main() -> None:
    """Write the table beside this file."""
    names = ["height_mm", "j_x_t", "j_y_t", "j_z_t", "x_mm", "y_mm", "z_mm", "bx_t", "by_t", "bz_t"]
    lines = [",".join(names)]
    for height_mm in (0.1, 1.0, 10.0):
        at = points(height_mm)
        for j_t in [(0, 0, 1), (1, 0, 0), (0, 1, 0)]:
            disc = magpylib.magnet.Cylinder(polarization=j_t, dimension=(2 * RADIUS_MM, height_mm))
            for point, b_t in zip(at, disc.getB(at), strict=True):
                row = (height_mm, *j_t, *point, *b_t)
                lines.append(",".join(repr(float(value)) for value in row))
    Path(__file__).with_name("discs.csv").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
