"""Keys of results: the same in Python and in JSON files of the program.

The program is that of the environment variable MAGSPLICE, or ``target/release/magsplice``.
"""

import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import LAYOUTS
from test_results import SQUARES

from magsplice import Film, MeasuredTile

PROGRAM = os.environ.get("MAGSPLICE", LAYOUTS.parent / "target" / "release" / "magsplice")
#: Keys of the columns of a result, which are arrays in Python.
COLUMNS = {"shape", "columns"}


def keys_of(value, place=""):
    """Keys at all depths. Keys of list entries have the key of the list."""
    if isinstance(value, dict):
        inner = [keys_of(item, f"{place}.{key}") for key, item in value.items()]
        return {f"{place}.{key}" for key in value}.union(*inner)
    if isinstance(value, (list, tuple)):
        return set().union(*(keys_of(item, place) for item in value))
    return set()


def told_by_program(verb, *arguments):
    """The JSON printed by a verb of the program."""
    command = [PROGRAM, verb, *arguments, "--format", "json", "--quiet"]
    found = subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout
    return {key: value for key, value in json.loads(found).items() if key not in COLUMNS}


def rows(path, header, values):
    """Path of a CSV file with these rows."""
    path.write_text("\n".join([header, *(",".join(map(str, row)) for row in values)]) + "\n")
    return path


def saved(film, folder) -> Path:
    """Path of the layout of a film."""
    film.save(folder / "film.toml")
    return folder / "film.toml"


@pytest.fixture(scope="module")
def film(published):
    """A film whose results have all keys: with recoil, errors, bounds and a sensor."""
    return published.replace(
        material={"recoil_permeability": 1.05, "recoil_error": 0.3},
        tolerance={"preset": "jig", "samples": 20},
        expect={
            "field": None,
            "uniformity_rmse": None,
            "clearance_mm": None,
            "amplitude": {"min": 0.8},
            "made": {"samples": 100, "amplitude": {"min": 0.1}},
        },
        sensor={"part": "MLX90393", "noise_ut": 5.0},
        design=None,
    )


@pytest.mark.parametrize("verb", ["compare", "check", "budget", "tolerance"])
def test_results_of_a_layout_have_the_keys_of_the_program(film, tmp_path, verb):
    found = getattr(film, verb)().to_dict()
    told = told_by_program(verb, saved(film, tmp_path))
    if verb == "check":
        (told,) = told["layouts"]
    assert keys_of(found) == keys_of(told)


@pytest.mark.parametrize("points", [None, [[0, 0, -4], [1, 0, -3]]])
def test_decouplings_have_the_keys_of_the_program(film, tmp_path, points):
    file = rows(tmp_path / "points.csv", "x_mm,y_mm,z_mm", points or [])
    given = [] if points is None else ["--points", file]
    told = told_by_program("decouple", saved(film, tmp_path), *given)
    told.pop("remark", None)
    # The program also compares the film, by another call in Python.
    own = ("layout", "sha256", "version", "tiles", "accuracy", "recoil", "remark")
    comparison = {
        key: value for key, value in film.compare(points).to_dict().items() if key not in own
    }
    found = {**film.decouple(points).to_dict(), "comparison": comparison}
    assert keys_of(found) == keys_of(told)


def test_forces_have_the_keys_of_the_program(tmp_path):
    film = Film.from_dict({**SQUARES, "design": None, "material": {"recoil_permeability": 1.05}})
    told = told_by_program("forces", saved(film, tmp_path), "--order", "least")
    assert keys_of(film.forces("least").to_dict()) == keys_of(told)


def test_readings_have_the_keys_of_the_program(film, tmp_path):
    readings = film.b([[0, 0, -4], [1, 0, -4]])
    told = told_by_program(
        "read",
        rows(tmp_path / "readings.csv", "bx_t,by_t,bz_t", readings),
        "--layout",
        saved(film, tmp_path),
    )
    assert keys_of(film.read(readings).to_dict()) == keys_of(told)


def test_diagnoses_have_the_keys_of_the_program(published, tmp_path):
    tiles = list(published.tiles)
    tiles[10] = tiles[10]._replace(polarization_t=[0.9 * j for j in tiles[10].polarization_t])
    x = np.linspace(-10, 10, 21)
    points = np.stack(np.meshgrid(x, x, [-1.0], indexing="ij"), axis=-1).reshape(-1, 3)
    readings = published.replace(tile=tiles, expect=None).b(points)
    scan = rows(
        tmp_path / "scan.csv", "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", np.hstack([points, readings])
    )
    film = published.replace(expect=None)
    told = told_by_program("diagnose", saved(film, tmp_path), "--scan", scan, "--noise", "5uT")
    found = film.diagnose(points, readings, noise_t=5e-6).to_dict()
    assert keys_of(found) == keys_of(told)


def test_assignments_have_the_keys_of_the_program(tmp_path):
    film = Film.from_dict({**SQUARES, "design": None})
    measured = [MeasuredTile(f"cut-{n}", 0.12 + 0.001 * n) for n in range(5)]
    box = rows(
        tmp_path / "box.csv",
        "tile,part,strength_t",
        [(of.tile, 1, of.polarization_t) for of in measured],
    )
    shim = film.tiles.names[0]
    told = told_by_program(
        "assign",
        saved(film, tmp_path),
        *("--measured", box, "--shim", shim, "--strength-error", "0.01"),
        *("-o", tmp_path / "assigned.toml"),
    )
    found = film.assign(measured, shims=[shim], strength_error=0.01).to_dict()
    assert keys_of(found) == keys_of(told)


def test_designs_have_the_keys_of_the_program(tmp_path):
    design = {**SQUARES["design"], "goal": "displacement", "under": "tolerance"}
    tolerance = {"preset": "jig", "samples": 20}
    film = Film.from_dict({**SQUARES, "design": design, "tolerance": tolerance})
    told = told_by_program("design", saved(film, tmp_path), "-o", tmp_path / "found.toml")
    assert keys_of(film.design().to_dict()) == keys_of(told)


def test_estimates_of_recoil_have_the_keys_of_the_program(published, tmp_path):
    told = told_by_program("plan", saved(published, tmp_path))["recoil_estimates"]
    assert keys_of(published.recoil_estimate().to_dict()) == keys_of(told)


def test_keys_at_all_depths_are_compared():
    known = {".a", ".a.b", ".c"}
    assert keys_of({"a": [{"b": 1}], "c": {}}) == known
    for other in ({"a": [{"d": 1}], "c": {}}, {"a": [{"b": 1}]}, {"a": [{"b": {"d": 1}}], "c": 2}):
        assert keys_of(other) != known
