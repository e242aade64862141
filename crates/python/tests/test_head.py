"""Heads of several sensors as objects."""

import numpy as np
import pytest
from conftest import LAYOUTS

import magsplice
from magsplice import Head


@pytest.fixture(scope="module")
def cross() -> magsplice.Film:
    return magsplice.load(LAYOUTS / "heads" / "published-cross.toml")


def test_a_film_has_the_places_and_weights_of_its_head(cross, published):
    head = cross.head
    assert (head.board, head.spacing_mm) == ("cross", 5.0)
    assert head.positions_mm[4] == (5.0, 5.0, 0.0)
    assert np.allclose(
        head.weights, np.outer([0.5, -0.125, -0.125, -0.125, -0.125], np.ones(3)), atol=1e-15
    )
    assert published.head is None


def test_a_head_is_put_below_a_film(cross, published):
    head = Head("pair-z", 1.0)
    film = cross.replace(sensor=head)
    assert film.head.spacing_mm == 1.0
    assert film.to_dict()["sensor"]["part"] == cross.to_dict()["sensor"]["part"]
    weight = 1 / (1 - np.exp(-2 * np.pi / 10))
    assert np.allclose(film.head.weights, [[weight] * 3, [-weight] * 3], rtol=1e-12)
    # All numbers of a head make the same head.
    assert film.replace(sensor=film.head).head == film.head
    own = Head(positions_mm=[(0, 0, 0), (0, 0, -1)], weights=[(1, 1, 1), (-1, -1, -1)])
    assert published.replace(sensor=own).head.weights == ((1, 1, 1), (-1, -1, -1))
    computed = published.replace(sensor=Head(positions_mm=np.array([[0, 0, 0], [0, 0, -1.0]])))
    assert np.allclose(computed.head.weights, film.head.weights, rtol=1e-12)


def test_sums_of_fields_are_what_the_head_reads(cross):
    """Round-off of five terms of 0.02 T is below 1e-17 T."""
    points = np.array([[0.3, -0.4, -4.0], [1.0, 2.0, -3.0]])
    places = points[:, None] + np.array(cross.head.positions_mm)
    readings = cross.b(places)
    total = cross.head.sum_t(readings)
    weighted = np.einsum("pni,ni->pi", readings, np.array(cross.head.weights))
    assert np.allclose(total, weighted, rtol=0, atol=1e-17)
    assert np.array_equal(cross.head.sum_t(readings + 1e-3).shape, (2, 3))
    assert np.allclose(cross.head.sum_t(readings + 1e-3), total, rtol=0, atol=1e-18)
    with pytest.raises(ValueError, match=r"shape \(2, 3\), must be \(..., 5, 3\)"):
        cross.head.sum_t(points)
    with pytest.raises(ValueError, match="the head has no weights"):
        Head("cross", 5.0).sum_t(readings)
    with pytest.raises(ValueError, match="weights has 1 sensors, positions_mm has 2"):
        cross.replace(sensor=Head(positions_mm=[(0, 0, 0), (0, 0, -1)], weights=[(1, 1, 1)]))
