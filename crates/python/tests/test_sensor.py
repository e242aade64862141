"""Positions, forces and resolution below a film."""

import numpy as np
import pytest
from conftest import LAYOUTS

import magsplice


def test_readings_give_positions_and_forces(published):
    film = published.replace(
        sensor={"part": "MLX90393", "noise_ut": 5.0},
        elastomer={
            "area_mm2": 400.0,
            "thickness_mm": 7.0,
            "youngs_modulus_mpa": 0.1,
            "poisson_ratio": 0.49,
        },
    )
    rng = np.random.default_rng(6)
    points = rng.uniform((-1.5, -1.5, -4.8), (1.5, 1.5, -3.2), (4, 5, 3))
    exact = published.read(published.b(points))
    moved = points - np.array(published.reference_mm)
    assert exact.status.shape == (4, 5)
    assert (exact.status == 0).all()
    np.testing.assert_allclose(exact.displacement_mm, moved, atol=1e-9)
    assert exact.deviation_mm is None
    assert exact.force_n is None
    read = film.read(film.b(points))
    # The sensor rounds, so positions are as good as its counts.
    assert np.abs(read.displacement_mm - moved).max() < 0.1
    assert read.deviation_mm.shape == (4, 5, 3)
    shear = 400 * 0.1 / 7 / (2 * 1.49)
    np.testing.assert_allclose(read.force_n[..., 0], -shear * read.displacement_mm[..., 0])
    lost = published.read([[1.0, 1.0, 1.0], [np.nan, 0, 0]])
    assert lost.status.tolist() == [3, 5]
    assert all(lost.messages)
    assert np.isnan(lost.displacement_mm).all()
    stray = published.read(published.b(points) + 1e-4, constant_t=(1e-4, 1e-4, 1e-4))
    np.testing.assert_allclose(stray.displacement_mm, moved, atol=1e-9)


def test_resolution_is_noise_over_the_gradient(published):
    point = np.array([0.3, 0.2, -4.0])
    inverse = np.linalg.inv(published.gradient(point))
    expected = 5e-6 * np.sqrt((inverse**2).sum(axis=1))
    np.testing.assert_allclose(published.resolution(point, noise_t=5e-6), expected, rtol=1e-9)
    assert published.resolution(noise_t=(5e-6, 5e-6, 1e-5)).shape == (9, 9, 5, 3)
    with pytest.raises(ValueError, match="give noise_t in tesla"):
        published.resolution()


def test_all_sensors_of_a_head_give_positions_and_stray_fields(published):
    head = magsplice.load(LAYOUTS / "heads" / "published-cross.toml")
    places = np.array([[0, 0, 0], [-5, -5, 0], [5, -5, 0], [-5, 5, 0], [5, 5, 0]])
    rng = np.random.default_rng(7)
    points = rng.uniform((-1.5, -1.5, -4.8), (1.5, 1.5, -3.2), (4, 2, 3))
    stray_t = np.array([3e-5, -2e-5, 4e-5])
    readings_t = published.b(points[..., None, :] + places) + stray_t
    read = head.read(readings_t, fit="stray-field")
    moved = points - np.array(published.reference_mm)
    np.testing.assert_allclose(read.displacement_mm, moved, atol=1e-9)
    np.testing.assert_allclose(read.stray_t, np.broadcast_to(stray_t, (4, 2, 3)), atol=1e-12)
    assert read.status.tolist() == [[0, 0]] * 4
    assert read.chi_squared_over_freedom.shape == (4, 2)
    assert read.rotation_deg is None
    assert (read.deviation_mm > 0).all()
    assert "stray_x_t" in read.columns()
    pose = head.read(readings_t[0, 0], fit="pose")
    np.testing.assert_allclose(pose.rotation_deg, 0, atol=1e-7)
    assert pose.status.shape == ()
    # The weighted sums reject the stray field.
    weights = np.array([0.5, -0.125, -0.125, -0.125, -0.125])
    sums = head.read((weights[:, None] * readings_t).sum(axis=-2))
    np.testing.assert_allclose(sums.displacement_mm, moved, atol=1e-9)
    assert sums.stray_t is None
    with pytest.raises(magsplice.MagspliceError, match="the head has 5 sensors, and there are 4"):
        head.read(readings_t[..., :4, :], fit="pose")
    with pytest.raises(magsplice.MagspliceError, match="need head or"):
        published.read(readings_t, fit="position")
    with pytest.raises(ValueError, match="must be position, stray-field or pose"):
        head.read(readings_t, fit="all")
    readings_t[..., 3, 0] += 3e-4
    with pytest.warns(magsplice.MeasurementWarning, match="without sensor 4"):
        assert (head.read(readings_t, fit="stray-field").status == 6).all()


#: Readings in tesla: two of a sensor at rest, one in the volume, one 0.05 mm outside it.
READINGS_T = [
    [3.0e-6, -2.0e-6, 1664.18e-6],
    [5.0e-6, -2.0e-6, 1660.0e-6],
    [-459.95e-6, 232.12e-6, 2375.79e-6],
    [1986.26e-6, -2.0e-6, 2067.23e-6],
]


def test_readings_at_rest_give_the_numbers_of_the_program(published):
    # magsplice read --layout layouts/published-film.toml readings.csv --zero 2 or --rest 2
    zero = published.read(READINGS_T, zero=READINGS_T[:2])
    expected = (0.5007011171619072, -0.24979880327790083, 0.50124671379705)
    np.testing.assert_allclose(zero.displacement_mm[2], expected, rtol=1e-9)
    closed = (0.6090392474209945, -0.30169280843706137, 0.6429082953213806)
    np.testing.assert_allclose(zero.closed_form_mm[2], closed, rtol=1e-9)
    assert zero.status.tolist() == [0, 1, 0, 1]
    rest = published.read(READINGS_T, rest=READINGS_T[:2])
    expected = (0.5018736246676594, -0.2504633244181914, 0.4997588547143579)
    np.testing.assert_allclose(rest.displacement_mm[2], expected, rtol=1e-9)
    closed = (0.6109551661019698, -0.302807391316948, 0.6406746272878487)
    np.testing.assert_allclose(rest.closed_form_mm[2], closed, rtol=1e-9)
    # --noise 20uT: noise may have moved these positions out of the volume.
    noisy = published.read(READINGS_T, zero=READINGS_T[:2], noise_t=20e-6)
    assert noisy.status.tolist() == [0, 0, 0, 0]
    expected = (0.02147093959333985, 0.021318535107643078, 0.010943188419425673)
    np.testing.assert_allclose(noisy.deviation_mm[2], expected, rtol=1e-9)


def test_contradictory_readings_at_rest_are_refused(published):
    with pytest.raises(ValueError, match="more than one of constant_t, zero and rest"):
        published.read(READINGS_T, zero=READINGS_T[:2], rest=READINGS_T[:2])
    with pytest.raises(ValueError, match="zero has no readings"):
        published.read(READINGS_T, zero=np.zeros((0, 3)))
    with pytest.raises(magsplice.MagspliceError, match="the mean of the readings at rest"):
        published.read(READINGS_T, rest=[1.0, 1.0, 1.0])
