"""B of cuboids by magpylib, called through its public objects.

Reads lines `index, size x 3, polarization x 3 (T), position x 3, point x 3` and prints
`index,bx,by,bz` in tesla for each.

    python3 magpylib_fields.py cases.csv
"""

import sys
import warnings

import magpylib

warnings.simplefilter("ignore")  # divisions by zero on edges; only the returned number counts
for line in open(sys.argv[1]):
    index, *numbers = line.split(",")
    n = [float(x) for x in numbers]
    tile = magpylib.magnet.Cuboid(dimension=n[0:3], polarization=n[3:6], position=n[6:9])
    print(index, *(repr(float(b)) for b in tile.getB(n[9:12])), sep=",")
