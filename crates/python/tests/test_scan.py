"""Measured scans, computed scans of films as made, and calibrations."""

import json

import numpy as np
import pytest
from test_keys import keys_of, rows, saved, told_by_program

import magsplice

#: A sensor that is turned and has an offset, below a film that is moved.
ERRORS = {
    "strength": 0.01,
    "seed": 5,
    "film": {"position_mm": [{"fixed": 0.1}, {"fixed": -0.2}, 0]},
    "sensor": {"offset_ut": 20, "rotation_deg": 1},
}


@pytest.fixture(scope="module")
def film(published):
    return published.replace(sensor={"part": "MLX90393"}, tolerance=ERRORS)


@pytest.fixture(scope="module")
def made(film):
    return film.sample(7)


def test_scan_finds_the_parameters_of_a_sample(film, made):
    assert (made.sample, made.seed, made.saturated) == (7, 5, 0)
    assert made.points_mm.shape == made.readings_t.shape == (9, 9, 5, 3)
    np.testing.assert_allclose(made.scan.start_mm, (-0.1, 0.2, 0), atol=1e-12)
    found = made.film.scan(made.points_mm, made.readings_t)
    for key in ("strength", "offset_t", "rotation_deg", "start_mm"):
        known, fitted, deviation = (
            np.array(getattr(of, key)) for of in (made.scan, found.fitted, found.deviation)
        )
        assert (np.abs(known - fitted) < 5.5 * deviation).all(), key
    assert found.grid == (9, 9, 5)
    assert found.b_t.shape == (9, 9, 5, 3)
    np.testing.assert_allclose(found.residual_b_t, found.b_t - found.simulated_b_t, atol=1e-15)
    uniformity = found.uniformity_rmse
    np.testing.assert_allclose(uniformity.simulated, uniformity.corrected, rtol=0.02)
    assert list(found.columns())[:5] == ["x_mm", "y_mm", "z_mm", "bx_t", "by_t"]
    fixed = made.film.scan(made.points_mm, made.readings_t, fit=["offset", "rotation", "start"])
    assert (fixed.fitted.strength, fixed.deviation.strength) == (1, 0)
    # The film as ordered leaves the errors of the tiles.
    assert film.scan(made.points_mm, made.readings_t).residual_t > 1.3 * found.residual_t
    json.dumps(found.to_dict())


def test_excluded_readings_are_index_arrays(made):
    readings = made.readings_t.reshape(-1, 3).copy()
    readings[3, 1] = np.nan
    readings[7, 2] = 1.0
    readings[11] += 1e-3
    with np.errstate(all="raise"):
        found = made.film.scan(made.points_mm.reshape(-1, 3), readings)
    assert found.excluded.incomplete.dtype == np.intp
    np.testing.assert_array_equal(found.excluded.incomplete, [3])
    np.testing.assert_array_equal(found.excluded.saturated, [7])
    np.testing.assert_array_equal(found.excluded.outliers, [11])
    assert found == made.film.scan(made.points_mm.reshape(-1, 3), readings)
    kept = np.delete(found.residual_b_t, found.excluded.outliers, axis=0)
    assert np.nanmax(np.abs(kept[12:])) < 5e-5


def test_samples_are_those_of_a_seed_and_an_index(film, published):
    points = [[0, 0, -4], [1, 0, -4]]
    one = film.sample(3, points)
    assert one == film.sample(3, points, seed=5)
    assert not np.array_equal(one.readings_t, film.sample(4, points).readings_t)
    assert not np.array_equal(one.readings_t, film.sample(3, points, seed=6).readings_t)
    workshop = published.sample(0, points, preset="workshop")
    np.testing.assert_allclose(workshop.readings_t, workshop.film.b(points), rtol=1e-12)
    with pytest.raises(ValueError, match=r"preset is missing and the layout has no \[tolerance\]"):
        published.sample()
    with pytest.raises(ValueError, match=r"points_mm\[1\] is not finite"):
        film.sample(0, [[0, 0, -4], [np.nan, 0, -4]])


def test_scans_that_are_hardly_of_the_film_warn(published):
    points = published.grid.points_mm
    with pytest.warns(magsplice.MeasurementWarning, match="the fitted strength is 3.000000 times"):
        published.scan(points, 3 * published.b(points))
    with pytest.raises(magsplice.MagspliceError, match=r"the readings times 0\.1 fit the film"):
        published.scan(points, 10 * published.b(points))
    with pytest.raises(ValueError, match="1 readings for 2 points"):
        published.scan([[0, 0, -4], [1, 0, -4]], [[0, 0, 0]])
    with pytest.raises(ValueError, match="fit = 'strength', must be \"all\" or a list of"):
        published.scan(points, points, fit="strength")
    with pytest.raises(magsplice.MagspliceError, match="readings"):
        published.scan([[0, 0, -4]], [[0, 0, 1e-3]])


def test_scans_have_the_keys_of_the_program(film, made, tmp_path):
    flat = np.hstack([made.points_mm.reshape(-1, 3), made.readings_t.reshape(-1, 3)])
    scan = rows(tmp_path / "scan.csv", "x_mm,y_mm,z_mm,bx_t,by_t,bz_t", flat)
    told = told_by_program("scan", scan, "--layout", saved(film, tmp_path))
    found = film.scan(made.points_mm, made.readings_t)
    assert keys_of(found.to_dict()) == keys_of(told)
    assert found.fitted.strength == pytest.approx(told["fitted"]["strength"], rel=1e-12)
    told = told_by_program("tolerance", "sample", saved(film, tmp_path), "--index", "7")
    assert keys_of(made.to_dict()) == keys_of(told)
    assert made.scan.offset_t == pytest.approx(told["scan"]["offset_t"], rel=1e-12)


LAYER = {"area_mm2": 1, "thickness_mm": 1, "youngs_modulus_mpa": 2, "poisson_ratio": 0}


@pytest.fixture(scope="module")
def forces(published):
    """A film with 1 N/mm in shear and 2 N/mm normal to it, forces and readings."""
    moved = published.replace(elastomer=LAYER).experiment()
    return published.replace(elastomer=LAYER), np.add(moved.force_n, (0.1, 0, 0)), moved.readings_t


def test_calibrations_find_the_stiffness(forces):
    film, force_n, reading_t = forces
    found = film.calibrate(force_n, reading_t)
    for of, stiffness in zip(found.by_field, (1, 1, 2), strict=True):
        assert of.stiffness_n_per_mm == pytest.approx(stiffness, rel=1e-6)
    assert found.by_field.x.force_at_rest_n == pytest.approx(0.1, abs=1e-6)
    assert found.hooke_n_per_mm == (1, 1, 2)
    np.testing.assert_allclose(found.film_mm, force_n / (1, 1, 2) - (0.1, 0, 0), atol=1e-6)
    wild, lost = force_n.copy(), force_n.copy()
    wild[4] += 5
    lost[2, 0] = np.nan
    np.testing.assert_array_equal(film.calibrate(wild, reading_t).excluded.outliers, [4])
    np.testing.assert_array_equal(film.calibrate(lost, reading_t).excluded.incomplete, [2])
    assert film.calibrate(force_n, reading_t + 1e-4, constant_t=(1e-4,) * 3).by_field.x.forces > 20


def test_calibrations_of_wrong_signs_and_few_forces_warn(forces):
    film, force_n, reading_t = forces
    with pytest.warns(magsplice.MeasurementWarning, match="the stiffness along x is negative"):
        film.calibrate(-force_n, reading_t)
    found = film.calibrate(force_n * (1, np.nan, 1), reading_t)
    assert found.by_field.y is None
    assert found.without_stiffness.y == "no force along this axis"
    two = np.where(np.arange(len(force_n))[:, None] < 2, force_n, force_n * (1, np.nan, 1))
    with pytest.warns(magsplice.MeasurementWarning, match="no stiffness along y: too few"):
        film.calibrate(two, reading_t)
    with pytest.raises(ValueError, match="must be as many"):
        film.calibrate(force_n[1:], reading_t)
    with pytest.raises(ValueError, match="more than one of constant_t, zero and rest"):
        film.calibrate(force_n, reading_t, zero=reading_t, rest=reading_t)


def test_calibrations_have_the_keys_of_the_program(forces, tmp_path):
    film, force_n, reading_t = forces
    header = "fx_n,fy_n,fz_n,bx_t,by_t,bz_t"
    file = rows(tmp_path / "forces.csv", header, np.hstack([force_n, reading_t]))
    told = told_by_program("calibrate", file, "--layout", saved(film, tmp_path))
    assert keys_of(film.calibrate(force_n, reading_t).to_dict()) == keys_of(told)


def test_setting_of_a_part_changes_its_range(published):
    film = published.replace(sensor={"part": "MLX90393"})
    coarse = film.replace(sensor={"gain_sel": 0, "res": 3})
    near = [[x, y, -1] for x in range(-3, 4) for y in range(-3, 4)]
    assert film.sample(points_mm=near, preset="jig").saturated > 0
    assert coarse.sample(points_mm=near, preset="jig").saturated == 0
    kept = film.replace(sensor={"gain_sel": 0, "res": 3, "noise_ut": 7.0})
    assert kept.to_dict()["sensor"]["noise_ut"] == pytest.approx(7.0)


def test_readings_print_their_first_displacements(published):
    points = [[0, 0, -4], [1, 1, -4], [0.5, 0, -3.5], [-1, 0, -4.5]]
    text = str(published.read(published.b(points)))
    shown = [line.split() for line in text.splitlines() if line.startswith("displacement_mm")]
    assert [line[0] for line in shown] == [
        *(f"displacement_mm[{n}]" for n in range(3)),
        "displacement_mm",
    ]
    assert shown[0][-1] == "mm"
    assert shown[-1][1:] == ["1", "more"]


def test_outliers_at_a_limit_are_a_plateau(published):
    # The upper end of b_z cut, as by a sensor whose range is smaller than stated.
    grid = published.grid
    readings = np.asarray(published.b(grid)).reshape(-1, 3)
    limit = 0.97 * readings[:, 2].max()
    readings[:, 2] = np.minimum(readings[:, 2], limit)
    plateau = published.scan(grid.points_mm.reshape(-1, 3), readings).excluded.plateau
    assert (plateau.axis, plateau.reading_t) == ("z", limit)
    assert plateau.outliers > 1
