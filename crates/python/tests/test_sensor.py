"""Positions, forces and resolution below a film."""

import numpy as np
import pytest

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
