"""Expectations of films."""

import json

import pytest
from conftest import LAYOUTS

import magsplice
from magsplice import Film, Tile


def test_expectations_have_the_values_of_the_program(published):
    # magsplice check layouts/published-film.toml --format json
    found = published.check()
    assert found.status == "ok"
    assert [outcome.expectation for outcome in found.expectations] == [
        "uniformity_rmse.r_x",
        "uniformity_rmse.r_y",
        "uniformity_rmse.s_z",
        "amplitude",
        "field",
        "clearance_mm",
    ]
    assert found["uniformity_rmse.s_z"].value == pytest.approx(0.03988837784034794, rel=1e-12)
    assert found["uniformity_rmse.s_z"].at_most == 0.0399
    assert found["amplitude"].margin == pytest.approx(2.954882010153259e-05, rel=1e-9)
    assert found["amplitude"].at_least == 0.8187
    assert found["field"].value < 1e-14
    assert len(found["field"].at_mm) == 3
    assert found["clearance_mm"].tile == "film-x4-y4"
    json.dumps(found.to_dict())


def test_films_that_are_made_are_checked_at_a_percentile():
    # magsplice check layouts/robust-in-plane.toml --format json
    found = magsplice.load(LAYOUTS / "robust-in-plane.toml").check()["made.displacement_rmse_mm.y"]
    assert found.value == pytest.approx(0.021271302761534765, rel=1e-9)
    assert (found.percentile.per_cent, found.percentile.samples) == (95.0, 1000)
    assert found.percentile.value == pytest.approx(0.022089754644505778, rel=1e-9)


def test_broken_expectations_and_those_that_cannot_be_checked_are_told(published):
    strict = published.replace(expect={"amplitude": {"min": 0.9}})
    assert strict.check().status == "failed"
    assert strict.check()["amplitude"].margin == pytest.approx(0.8187295 - 0.9, abs=1e-6)
    bare = Film([Tile((0, 0, 0.5), (1, 1, 1), (0, 0, 1))], name="bare")
    assert bare.check().status == "ok"
    assert bare.check().expectations == []


def test_baselines_that_cannot_be_read_leave_the_other_expectations(published, tmp_path):
    text = published.to_toml()
    found = magsplice.loads(text, folder=tmp_path).check()
    assert found.status == "error"
    assert "published.field.csv" in found["field"].error
    assert found["amplitude"].status == "ok"
    lines = (LAYOUTS / "published.field.csv").read_text().splitlines()
    baseline = tmp_path / "published.field.csv"
    baseline.write_text("\n".join(["x_mm,y_mm", *lines[1:]]))
    assert "no column z_mm, bx_t" in magsplice.loads(text, folder=tmp_path).check()["field"].error
    x, y, z, bx, by, bz = lines[7].split(",")
    lines[7] = ",".join((x, y, z, bx, by, str(1.01 * float(bz))))
    baseline.write_text("\n".join(lines))
    moved = magsplice.loads(text, folder=tmp_path).check()["field"]
    assert moved.status == "failed"
    assert moved.at_mm == (float(x), float(y), float(z))
    assert baseline.read_text() == "\n".join(lines)
