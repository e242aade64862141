"""Forces of tiles on each other, and placement orders."""

import json

import numpy as np
import pytest

from magsplice import Film, Tile


def test_loads_and_the_least_holding_are_those_of_the_program(published):
    # magsplice forces layouts/published-film.toml --order least --format json
    found = published.forces("least")
    assert found.names[0] == "film-x1-y2"
    first = (-0.0024991363343070845, 0.0001633199017550407, 0.0)
    np.testing.assert_allclose(found.force_n[0], first, rtol=1e-9, atol=1e-16)
    np.testing.assert_allclose(found.torque_n_mm[0, 2], -0.005573876024713494, rtol=1e-9)
    np.testing.assert_allclose((*found.sum.force_n, *found.sum.torque_n_mm), 0.0, atol=1e-12)
    order = found.order
    assert order.holding_n == pytest.approx(0.0017690123946005971, rel=1e-9)
    assert order.bound_n == pytest.approx(0.0012480038998126655, rel=1e-9)
    assert order.greedy_holding_n == pytest.approx(0.00455128217891365, rel=1e-9)
    assert order.hardest_step == 5
    assert order.names[-1] == "film-x8-y5"
    again = published.forces(order.names).order
    assert again.holding_n == order.holding_n
    assert again.bound_n is None
    given = published.forces("given").order
    assert given.holding_n == order.given_holding_n == pytest.approx(0.010574628451101757, rel=1e-9)
    assert given.names == published.tiles.names
    assert published.forces().order is None
    json.dumps(found.to_dict())


def test_two_tiles_pull_each_other():
    tiles = [Tile((x, 0, 0), (1, 1, 1), (1, 0, 0), name=name) for x, name in ((0, "a"), (5, "b"))]
    found = Film(tiles, name="pair").forces()
    # Far away both are dipoles: 3 mu0 m^2 / (2 pi r^4) with m = J V / mu0.
    dipoles = 3 / (2 * np.pi * 1.25663706e-6) * 1e-6 / 5**4
    np.testing.assert_allclose(found.force_n[:, 0], (dipoles, -dipoles), rtol=0.01)
    oblique = Film([tiles[0], tiles[1]._replace(position_mm=(2, 1, 0.5))], name="pair").forces()
    assert np.linalg.norm(oblique.torque_n_mm.sum(axis=0)) > 1e-4
    np.testing.assert_allclose(oblique.sum.torque_n_mm, 0.0, atol=1e-12)


def test_recoil_weakens_forces():
    # magsplice forces of these tiles, with and without [material] recoil_permeability = 1.2
    tiles = [Tile((x, 0, 0), (1, 1, 1), (1, 0, 0), name=name) for x, name in ((0, "a"), (1.5, "b"))]
    rigid = Film(tiles, name="pair")
    recoil = rigid.replace(material={"recoil_permeability": 1.2})
    before, after = rigid.forces(), recoil.forces()
    assert before.force_n[0, 0] == pytest.approx(0.06568293225624168, rel=1e-9)
    assert before.recoil is None
    assert after.force_n[0, 0] == pytest.approx(0.05809935474174895, rel=1e-9)
    change_n = before.force_n[0, 0] - after.force_n[0, 0]
    assert after.recoil["change_n"] == pytest.approx(change_n, rel=1e-9)
    assert 0 < after.recoil["error_n"] < change_n


def test_orders_name_each_tile_once(published):
    names = published.tiles.names
    for order in ("gven", ["nobody", *names[1:]]):
        with pytest.raises(ValueError, match='must be "given", "least" or the names of all tiles'):
            published.forces(order)
    for order in (names[1:], [*names[1:], names[1]]):
        with pytest.raises(ValueError, match=r"must have all 56|is placed twice"):
            published.forces(order)
    with pytest.raises(ValueError, match="turned_error = 1, must be from"):
        published.forces(turned_error=1)
