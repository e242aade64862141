"""Error budgets."""

import json

import numpy as np
import pytest
from conftest import LAYOUTS

import magsplice


def test_first_order_budgets_are_those_of_the_program():
    # magsplice budget layouts/robust-in-plane.toml --format json
    found = magsplice.load(LAYOUTS / "robust-in-plane.toml").budget()
    assert found.is_first_order
    assert (found.seed, found.samples) == (1, 200)
    assert [part.name for part in found.parts] == [
        "film as ordered",
        "tile positions, x and y",
        "tile positions, z",
        "tile rotations",
        "tile strengths",
    ]
    x = 9.364939577337841e-05
    np.testing.assert_allclose(found.parts[1].mean_square_mm2[0], x, rtol=1e-9)
    np.testing.assert_allclose(found.total_mm2[2], 8.578031742527313e-05, rtol=1e-9)
    np.testing.assert_allclose(found.sampled_mm2[1], 0.0002055867437692648, rtol=1e-9)
    np.testing.assert_allclose(found.endless_pattern_mm2[0], 0.005830566642696583, rtol=1e-9)
    ratio = found.mean_square_ratio.x
    interval = (0.9908513386354624, 1.0038531159065884)
    np.testing.assert_allclose(ratio.value, 0.9973522272710253, rtol=1e-9)
    np.testing.assert_allclose((ratio.low, ratio.high), interval, rtol=1e-9)
    assert found.worth_halving[0].name == "tile positions, x and y"
    assert found.tiles_worth_halving[0].name.startswith("film-x6-y6")
    np.testing.assert_allclose(sum(found.columns()["x_mm2"]), found.total_mm2[0], rtol=1e-12)
    json.dumps(found.to_dict())


def test_large_errors_are_divided_by_samples(published):
    # magsplice budget layouts/published-film.toml --preset by-hand --format json
    found = published.budget(preset="by-hand")
    assert not found.is_first_order
    assert found.parts[-1].name == "causes together"
    np.testing.assert_allclose(found.parts[-1].mean_square_mm2[2], 0.006958948126617265, rtol=1e-8)
    assert found.tiles_worth_halving == []
    other = published.budget(20, preset="by-hand", seed=3)
    assert other.samples == 20
    assert other.sampled_mm2 != found.sampled_mm2


def test_budgets_need_errors_and_enough_samples(published):
    with pytest.raises(magsplice.MagspliceError, match=r"no \[tolerance\]"):
        published.budget()
    with pytest.raises(ValueError, match="samples = 5, must be from 20"):
        published.budget(5, preset="jig")
