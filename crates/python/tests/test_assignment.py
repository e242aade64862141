"""Measured tiles and their places."""

import json

import numpy as np
import pytest
from conftest import LAYOUTS

import magsplice
from magsplice import MeasuredTile, PlacedTile


@pytest.fixture(scope="module")
def film():
    """A film that decouples within 1e-4 mm as ordered: 56 tiles of three parts."""
    return magsplice.load(LAYOUTS / "designed-stock.toml")


def scatter(number):
    """A number from -1 to 1 that needs no generator."""
    return np.sin(1.7 * number**2 + number)


@pytest.fixture(scope="module")
def measured(film):
    """Tiles of all parts with 3 % and a degree, and two spares of each kind of tile."""
    tiles = []
    for index, tile in enumerate(film.tiles):
        strength = np.linalg.norm(tile.polarization_t)
        # Any tile of the part identifies it; J is along the first side, up to its errors.
        off = strength * (1 + 0.03 * scatter(index))
        tiles.append(MeasuredTile(f"cut-{index}", off, film.tiles.names[index]))
    return tiles


def rms_mm(film):
    """RMS over the volume and its axes of the displacement error."""
    return np.sqrt(np.mean(np.square(film.decouple().displacement_rmse_mm)))


def test_assigned_film_has_the_stated_error(film, measured):
    found = film.assign(measured, strength_error=0.005)
    assert found.rms_mm < 0.1 * found.in_order_rms_mm
    assert rms_mm(found.film) == pytest.approx(found.rms_mm, rel=1e-6)
    assert rms_mm(film) == pytest.approx(found.ordered_rms_mm, rel=1e-6)
    assert found.measured_rms_mm.p95.value > found.rms_mm
    assert found.spares == 0
    assert found.starts_rms_mm == sorted(found.starts_rms_mm)
    # Each tile has the strength of its cut in the plan.
    strengths = {tile.tile: tile.polarization_t for tile in measured}
    for placed, tile in zip(found.plan, found.film.tiles, strict=True):
        assert np.linalg.norm(tile.polarization_t) == pytest.approx(strengths[placed.tile])
    assert found.columns()["place"] == film.tiles.names
    assert sorted(found.columns()["tile"]) == sorted(strengths)
    json.dumps(found.to_dict())
    assert film.assign(measured, strength_error=0.005).plan == found.plan


def test_tiles_that_lie_stay(film, measured):
    first = film.assign(measured)
    placed = [first.plan[7], first.plan[20]]
    x, y, z = placed[0].centre_mm
    placed[0] = placed[0]._replace(centre_mm=(x + 0.05, y, z), mark_deg=placed[0].mark_deg + 1)
    found = film.assign(measured, placed=placed, starts=4)
    assert [found.plan[place].tile for place in (7, 20)] == [tile.tile for tile in placed]
    assert np.flatnonzero([row.is_placed for row in found.plan]).tolist() == [7, 20]
    assert found.film.tiles[7].position_mm[0] == pytest.approx(x + 0.05)
    # The others compensate: the error is of the size of the one without misplaced tiles.
    assert found.rms_mm == pytest.approx(first.rms_mm, rel=0.5)


def test_shims_are_chosen(film, measured):
    shim = film.tiles.names[3]
    found = film.assign(measured, shims=[shim])
    assert found.plan[3].tile == "shim"
    assert found.spares == 1
    j_t = np.linalg.norm(found.film.tiles[3].polarization_t)
    assert found.shims[0].place == shim
    assert abs(found.shims[0].strength_t) == pytest.approx(j_t)


def test_tiles_that_break_rules_are_named(film, measured):
    with pytest.raises(ValueError, match="starts = 0, must be from 1 to 10000"):
        film.assign(measured, starts=0)
    with pytest.raises(ValueError, match=r"strength_error = 2, must be from 0 to 0\.5"):
        film.assign(measured, strength_error=2)
    wrong = [*measured, MeasuredTile("cut-0", 0.1, 1), MeasuredTile("x", 0.1, "moon")]
    with pytest.raises(magsplice.MagspliceError) as error:
        film.assign(wrong)
    twice, unknown = str(error.value).splitlines()
    assert twice == f'measured[{len(measured)}]: tile "cut-0" is already in the box'
    assert unknown.startswith(f'measured[{len(measured) + 1}]: part = "moon", must be a number')
    with pytest.raises(magsplice.MagspliceError, match="has 2 components"):
        film.assign([MeasuredTile("x", (0.1, 0.0), 1)])
    with pytest.raises(magsplice.MagspliceError, match="of the measured tiles: measure more"):
        film.assign(measured[1:])
    with pytest.raises(magsplice.MagspliceError, match=r'placed\[0\]: place = "x"'):
        film.assign(measured, placed=[PlacedTile("x", "cut-0", "+z", 0)])
    with pytest.raises(magsplice.MagspliceError, match=r'shims\[1\]: "nowhere", must be'):
        film.assign(measured, shims=[film.tiles.names[0], "nowhere"])
    bare = film.replace(ideal=None, volume=None, expect=None, design=None)
    with pytest.raises(magsplice.MagspliceError, match="has no \\[ideal\\] table"):
        bare.assign(measured)
