"""Faulty tiles of a film as made."""

import json

import numpy as np
import pytest

import magsplice


@pytest.fixture(scope="module")
def scan(published):
    """Points and readings 1 mm below a film with a weak and a displaced tile."""
    tiles = list(published.tiles)
    tiles[10] = tiles[10]._replace(polarization_t=[0.9 * j for j in tiles[10].polarization_t])
    x, y, z = tiles[30].position_mm
    tiles[30] = tiles[30]._replace(position_mm=(x + 0.2, y, z))
    made = published.replace(tile=tiles, expect=None)
    x = np.linspace(-10, 10, 21)
    points = np.stack(np.meshgrid(x, x, [-1.0], indexing="ij"), axis=-1).reshape(-1, 3)
    b = made.b(points) + np.array([2e-5, 0, 0])
    # Noise that needs no generator.
    return points, b + 5e-6 * np.sin(np.arange(b.size) ** 2).reshape(b.shape)


def test_faulty_tiles_are_those_of_the_program(published, scan):
    # magsplice diagnose layouts/published-film.toml --scan scan.csv --noise 5uT --fit=offset
    found = published.diagnose(*scan, noise_t=5e-6, fit=["offset"])
    weak, displaced = found.faulty
    assert (weak.tile, weak.kind) == ("film-x2-y7", "strength")
    assert weak.magnitude == pytest.approx(-9.994561293204043, rel=1e-6)
    percent, deviation = weak.components["strength_percent"]
    assert percent == weak.magnitude
    assert deviation == pytest.approx(0.022930707713539663, rel=1e-6)
    assert (displaced.tile, displaced.kind) == ("film-x6-y1", "displacement")
    moved = (0.19977536976448923, -0.0008291549997181556, 0.0002874744556107673)
    components = [displaced.components[f"position_{axis}_mm"][0] for axis in "xyz"]
    np.testing.assert_allclose(components, moved, rtol=1e-4)
    assert displaced.chi_squared == pytest.approx(120725.42759350337, rel=1e-6)
    assert found.is_complete
    assert not found.is_residual_too_large
    assert found.residual_t == pytest.approx(3.538336916363658e-06, rel=1e-6)
    assert found.degrees_of_freedom == 1316
    assert found.scan.offset_t[0] == pytest.approx(2.00492711802867e-05, rel=1e-6)
    assert found.errors["strength_percent"][10] == pytest.approx(-10, abs=0.1)
    assert np.flatnonzero(found.position_mm[:, 0]).tolist() == [30]
    assert found.columns()["name"] == published.tiles.names
    json.dumps(found.to_dict())


def test_turns_are_in_degrees():
    tile = magsplice.Tile((0, 0, 0.5), (3, 2, 1), (0.12, 0, 0))
    x = np.linspace(-4, 4, 17)
    points = np.stack(np.meshgrid(x, x, [-1.0], indexing="ij"), axis=-1)
    angle = np.radians(2.0)
    turned = tile._replace(rotation=(0, 0, np.sin(angle / 2), np.cos(angle / 2)))
    readings = magsplice.Film([turned], name="made").b(points)
    (faulty,) = (
        magsplice.Film([tile], name="ordered").diagnose(points, readings, noise_t=1e-6).faulty
    )
    assert faulty.kind == "turn"
    assert faulty.components["rotation_z_deg"][0] == pytest.approx(2.0, abs=0.01)


def test_expected_errors_are_not_named(published, scan):
    points, readings = scan
    found = published.diagnose(points, readings, noise_t=2e-5, preset="by-hand", fit=["offset"])
    assert len(found.faulty) < 2
    film = published.replace(tolerance={"preset": "by-hand"})
    as_ordered = film.diagnose(points, readings, noise_t=2e-5, as_ordered=True)
    assert [tile.tile for tile in as_ordered.faulty[:2]] == ["film-x2-y7", "film-x6-y1"]


def test_weak_tile_among_tiles_with_recoil_is_found_alone(published):
    ordered = published.replace(material={"recoil_permeability": 1.05}, expect=None)
    tiles = list(published.tiles)
    tiles[10] = tiles[10]._replace(polarization_t=[0.95 * j for j in tiles[10].polarization_t])
    x = np.linspace(-10, 10, 21)
    points = np.stack(np.meshgrid(x, x, [-2.0], indexing="ij"), axis=-1)
    readings = ordered.replace(tile=tiles).b(points)
    (weak,) = ordered.diagnose(points, readings, noise_t=1e-5).faulty
    assert (weak.tile, weak.kind) == ("film-x2-y7", "strength")
    # Errors of rigid tiles do not explain the same scan.
    rigid = published.diagnose(points, readings, noise_t=1e-5)
    assert rigid.is_rejected
    assert rigid.faulty == []


def test_scans_that_cannot_be_diagnosed_are_refused(published, scan):
    points, readings = scan
    with pytest.raises(magsplice.MagspliceError, match="the layout has no noise"):
        published.diagnose(points, readings)
    with pytest.raises(
        magsplice.MagspliceError,
        match=r"noise\[0\] = -1e0 T, must be a finite number of at least 1e-30 T",
    ):
        published.diagnose(points, readings, noise_t=-1)
    with pytest.raises(ValueError, match="440 readings for 441 points"):
        published.diagnose(points, readings[1:], noise_t=1e-6)
    with pytest.raises(ValueError, match='must be one of "strength", "offset"'):
        published.diagnose(points, readings, noise_t=1e-6, fit=["everything"])
    with pytest.raises(ValueError, match="preset and as_ordered are both given"):
        published.diagnose(points, readings, noise_t=1e-6, preset="jig", as_ordered=True)
    with pytest.raises(magsplice.MagspliceError, match="probability of a false alarm = 2"):
        published.diagnose(points, readings, noise_t=1e-6, false_alarm=2.0)
