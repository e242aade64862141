"""Blocks of a magpylib collection as a table for magsplice; magpylib 5 and 6.

    python THIS_FILE MODULE:VARIABLE [BLOCKS.csv]
    magsplice import BLOCKS.csv -o film.toml

MODULE is the name of a module or the path of a script, and VARIABLE a magnet, a
collection, a list of these, or a function that returns one. Without BLOCKS.csv the table
goes to standard output. In Python: `write_blocks(collection, "BLOCKS.csv")`.

Only cuboids are written. Other sources are an error that names them; sensors are left out.
"""

import csv
import importlib
import importlib.util
import os
import sys

import magpylib as magpy
import numpy as np

PROGRAM = "{version}"

COLUMNS = (
    "x_m,y_m,z_m,size_x_m,size_y_m,size_z_m,jx_t,jy_t,jz_t,qx,qy,qz,qw,name".split(",")
)
# Largest number of objects that an error names.
NAMED = 20


def write_blocks(collection, path):
    """Writes the cuboids of a collection as CSV to a path or an open text file.

    Raises ValueError with every object that is no cuboid or lacks a property; nothing is
    written then.
    """
    rows = block_rows(collection)
    if hasattr(path, "write"):
        return write_rows(rows, path)
    with open(path, "w", newline="", encoding="utf-8") as file:
        write_rows(rows, file)


def write_rows(rows, file):
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(rows)


def block_rows(collection):
    """One row per cuboid: numbers with all their digits, in m and T, and the label."""
    faults, rows, labels = [], [], {}
    sources = list(flat(collection))
    if not sources:
        raise ValueError("there are no magnets in it")
    for index, source in enumerate(sources):
        label = getattr(source.style, "label", None) or ""
        what = f"{type(source).__name__} {label!r}" if label else repr(source)
        found = faults_of(source)
        if found:
            faults.append(f"{what} (number {index + 1}) {found}")
            continue
        # Names must be unique in a layout; the second "a" is "a-2".
        labels[label] = labels.get(label, 0) + 1
        name = label if not label or labels[label] == 1 else f"{label}-{labels[label]}"
        numbers = np.concatenate(
            [source.position, source.dimension, source.polarization, source.orientation.as_quat()]
        )
        rows.append([*(repr(float(number)) for number in numbers), name])
    if faults:
        more = [f"and {len(faults) - NAMED} more"] if len(faults) > NAMED else []
        raise ValueError("\n".join(faults[:NAMED] + more))
    return rows


def faults_of(source):
    """What keeps a source from being written, in words; None if nothing does."""
    if not isinstance(source, magpy.magnet.Cuboid):
        return "is no cuboid: magsplice knows cuboids only"
    if source.dimension is None:
        return "has no dimension"
    if source.polarization is None:
        return "has no polarization"
    steps = max(np.size(source.position) // 3, np.size(source.orientation.as_quat()) // 4)
    if steps != 1:
        return f"has a path of {steps} steps: choose one position and orientation"
    return None


def flat(objects):
    """All sources, also those of collections in collections."""
    if isinstance(objects, magpy.Collection):
        yield from objects.sources_all
    elif isinstance(objects, (list, tuple)):
        for item in objects:
            yield from flat(item)
    elif not isinstance(objects, magpy.Sensor):
        if not hasattr(objects, "getB"):
            raise ValueError(f"{objects!r} is no magnet, collection or list of these")
        yield objects


def load(name):
    """The object that MODULE:VARIABLE names."""
    module_name, _, variable = name.rpartition(":")
    if not module_name or not variable:
        raise ValueError(f"{name}: must be MODULE:VARIABLE, such as magnets.py:collection")
    if module_name.endswith(".py") or os.sep in module_name:
        spec = importlib.util.spec_from_file_location("magnets_for_magsplice", module_name)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    else:
        sys.path.insert(0, os.getcwd())
        module = importlib.import_module(module_name)
    found = getattr(module, variable)
    is_function = callable(found) and not hasattr(found, "getB")
    return found() if is_function else found


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    try:
        write_blocks(load(sys.argv[1]), sys.argv[2] if len(sys.argv) == 3 else sys.stdout)
    except (ValueError, AttributeError, ImportError, OSError) as error:
        sys.exit("\n".join(f"{sys.argv[1]}: {line}" for line in str(error).splitlines()))


if __name__ == "__main__":
    main()
