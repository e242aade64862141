"""Comparison, decoupling, tolerance, readings, design, report."""

import base64
import json
import lzma
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import LAYOUTS

import magsplice
from magsplice import Film
from magsplice._film import front_of


def test_comparison_is_that_of_numpy(published):
    b, ideal = published.b(published.grid), published.ideal_b(published.grid)
    found = published.compare()
    assert found.points == 405
    np.testing.assert_allclose(found.rmse_t, np.sqrt(((b - ideal) ** 2).sum(-1).mean()), rtol=1e-12)
    np.testing.assert_allclose(found.amplitude, (b * ideal).sum() / (ideal**2).sum(), rtol=1e-12)
    at_points = published.compare(published.grid.points_mm)
    np.testing.assert_allclose(at_points.amplitude, found.amplitude, rtol=1e-13)
    with pytest.raises(magsplice.MagspliceError, match="not below the film"):
        published.compare([[0, 0, 1.0]])
    json.dumps(found.to_dict())


def test_decoupling_is_that_of_the_equations(published):
    found = published.decouple()
    assert found.parameters.shape == (9, 9, 5, 3)
    bx, by, bz = np.moveaxis(found.field_t, -1, 0)
    c_x = (bz**2 + by**2 - bx**2) / (2 * bz)
    c_y = (bz**2 + bx**2 - by**2) / (2 * bz)
    inner = np.abs(found.points_mm[..., :2]).max(-1) < 1.9
    np.testing.assert_allclose(np.tan(found.r_x)[inner], (bx / c_x)[inner], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(found.s_z, np.log(np.hypot(c_y, by)), rtol=1e-12)
    deviation = found.r_x.std(axis=(1, 2)).mean()
    np.testing.assert_allclose(found.uniformity_rmse[0], deviation, rtol=1e-12)
    moved = found.points_mm - np.array(found.reference_mm)
    errors = np.sqrt(((found.displacement_mm - moved) ** 2).mean(axis=(0, 1, 2)))
    np.testing.assert_allclose(found.displacement_rmse_mm, errors, rtol=1e-12)
    at_points = published.decouple(published.grid.points_mm.reshape(-1, 3))
    assert at_points.uniformity_rmse is None
    assert np.array_equal(at_points.parameters, found.parameters.reshape(-1, 3))
    json.dumps(found.to_dict())


def test_samples_depend_on_seed_and_number_alone(published):
    whole = published.tolerance(40, preset="workshop")
    assert len(whole) == 40
    parts = [
        published.tolerance(count, preset="workshop", first=first, threads=threads)
        for first, count, threads in ((0, 7, 1), (7, 33, 2))
    ]
    for array in ("uniformity_rmse", "displacement_rmse_mm", "amplitude"):
        joined = np.concatenate([getattr(part, array) for part in parts])
        assert np.array_equal(joined, getattr(whole, array))
    other = published.tolerance(40, preset="workshop", seed=2)
    assert not np.array_equal(other.amplitude, whole.amplitude)
    with pytest.raises(magsplice.MagspliceError, match=r"no \[tolerance\]"):
        published.tolerance(1)
    with pytest.raises(ValueError, match='must be "by-hand"'):
        published.tolerance(1, preset="luck")


def test_samples_have_statistics(published):
    told = []
    made = published.tolerance(200, preset="jig", progress=lambda done, of: told.append((done, of)))
    assert told[-1] == (200, 200)
    x = made.displacement_mm("x")
    values = made.displacement_rmse_mm[:, 0]
    np.testing.assert_allclose(x.p95.value, np.percentile(values, 95), rtol=1e-12)
    assert x.p95.low < x.p95.value < x.p95.high
    assert x.count == 200
    nominal = [along.nominal for along in made.statistics.displacement_rmse_mm]
    np.testing.assert_allclose(nominal, published.decouple().displacement_rmse_mm)
    assert "p95" in str(made)
    json.dumps(made.to_dict())
    with pytest.raises(ValueError, match="no samples"):
        magsplice.statistics(np.zeros(0))


SQUARES = {
    "name": "four squares",
    "ideal": {"wavelength_mm": 10.0, "thickness_mm": 1.0, "amplitude_t": 0.12},
    "volume": {"x_mm": [-1, 1], "y_mm": [-1, 1], "z_mm": [-4, -3], "step_mm": 1.0},
    "design": {
        "vary": ["size", "position"],
        "symmetry": "four-fold",
        "outline_mm": {"x": [-6, 6], "y": [-6, 6]},
        "starts": 2,
    },
    "tile": [
        {
            "position_mm": [2.5, 2.5, 0.5],
            "size_mm": [3.3, 3.3, 1.0],
            "polarization_t": [0.085, 0.085, 0.0],
            "mirror": {"axes": ["x", "y"]},
        }
    ],
}


def test_designs_are_better_films():
    film = Film.from_dict(SQUARES)
    told = []
    found = film.design(progress=lambda *update: told.append(update))
    assert found.after.uniformity_rmse[0] < found.before.uniformity_rmse[0]
    assert len(found.film) == 4
    assert not found.short_of
    again = found.film.decouple().uniformity_rmse
    np.testing.assert_allclose(again, found.after.uniformity_rmse, rtol=1e-6)
    assert "magsplice" in found.film.history[-1]
    assert found.made is None
    assert film.design().film.to_toml() == found.film.to_toml()
    json.dumps(found.to_dict())


def test_fronts_hold_films_that_no_other_beats():
    film = Film.from_dict(SQUARES)
    front = film.front([0.3, 0.5, 0.4, 9.0])
    amplitudes = [design.after.amplitude for design in front.designs]
    errors = [design.error for design in front.designs]
    assert 1 <= len(front) <= 3
    assert amplitudes == sorted(amplitudes)
    assert errors == sorted(errors)
    for least, design in zip(front.least_amplitudes, front.designs, strict=True):
        assert design.after.amplitude >= least


def test_fronts_leave_out_films_that_are_beaten_or_too_weak():
    def film(amplitude, error, short_of=()):
        after = SimpleNamespace(amplitude=amplitude)
        return SimpleNamespace(after=after, error=error, short_of=short_of)

    films = [
        film(0.6, 0.2),
        film(0.7, 0.1),
        film(0.9, 0.3),
        film(0.8, 0.3),
        film(1.0, 0.0, ["weak"]),
    ]
    front = front_of([1, 2, 3, 4, 5], films)
    assert front.least_amplitudes == [2, 3]
    assert front.designs == [films[1], films[2]]


def test_patterns_are_films_to_begin_with():
    film = magsplice.pattern(10, (20, 20))
    assert len(film) == 56
    assert film.to_dict()["design"]["goal"] == "displacement"
    assert magsplice.pattern(10, (20, 20), distance_mm=(-5, -3)).volume.z_mm == (-5, -3)
    with pytest.raises(magsplice.MagspliceError, match="wavelength"):
        magsplice.splice(-1, (20, 20))


def test_reports_have_the_figures_of_the_program(published, tmp_path):
    report = published.report()
    assert {"layout"} < set(report.figures)
    assert len(report.figures) == 8
    page = report.save(tmp_path / "report")
    text = page.read_text(encoding="utf-8")
    assert "0.81873" in text
    assert "<script" in text
    for name in report.figures:
        assert (tmp_path / "report" / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    assert "iframe" in report._repr_html_()
    assert report.figures["layout"]._repr_svg_().startswith("<")
    bare = Film(published.tiles, name="bare").report()
    assert list(bare.figures) == ["layout"]
    assert len(bare.absent) == 2
    assert "iframe" in published.view()._repr_html_()


def test_live_page_holds_the_film_and_the_engine(published, tmp_path):
    engine = tmp_path / "engine.wasm.xz"
    engine.write_bytes(lzma.compress(b"\0asm"))
    page = published.show(engine=engine)
    assert all(name in page.html for name in published.tiles.names)
    assert base64.b64encode(engine.read_bytes()).decode() in page.html
    assert 'sandbox="allow-scripts allow-downloads"' in page._repr_html_()
    assert 'sandbox="allow-scripts" ' in published.view()._repr_html_()
    with pytest.raises(FileNotFoundError):
        published.show(engine=tmp_path / "none")


def test_reports_draw_films_that_are_made():
    film = magsplice.load(LAYOUTS / "robust-in-plane.toml")
    few = film.replace(tolerance={**film.to_dict()["tolerance"], "samples": 20})
    assert len(few.report().figures) > 8


def test_datasets_have_dimensions_and_units(published):
    pytest.importorskip("xarray")
    data = published.to_xarray()
    assert dict(data.sizes) == {"x": 9, "y": 9, "z": 5, "component": 3}
    assert data.b.attrs["units"] == "T"
    at = data.b.sel(x=0, y=0, z=-5).values
    assert np.array_equal(at, published.b([0, 0, -5]))
    decoupled = published.decouple().to_xarray()
    assert decoupled.r_x.dims == ("x", "y", "z")
    assert published.decouple([[0, 0, -4], [1, 0, -4]]).to_xarray().s_z.dims == ("point",)
    made = published.tolerance(5, preset="jig").to_xarray()
    assert made.displacement_rmse_mm.sel(axis="z").shape == (5,)


def address(array):
    """The memory address of an array's numbers."""
    return array.__array_interface__["data"][0]


def test_tables_are_taken_without_a_copy(published):
    pytest.importorskip("nanoarrow")
    pandas, polars, pyarrow = map(pytest.importorskip, ("pandas", "polars", "pyarrow"))
    made = published.tolerance(5, preset="jig")
    frame = polars.DataFrame(made)
    assert frame.columns[0] == "sample"
    assert address(frame["amplitude"].to_numpy()) == address(made.amplitude)
    table = pyarrow.table(made)
    assert table["amplitude"].chunk(0).buffers()[1].address == address(made.amplitude)
    data = table.to_pandas(types_mapper=pandas.ArrowDtype)
    kept = data["amplitude"].array.__arrow_array__().chunk(0)
    assert kept.buffers()[1].address == address(made.amplitude)
    # The tables outlive the results.
    expected = made.amplitude.tolist()
    del made, table
    assert frame["amplitude"].to_list() == data["amplitude"].tolist() == expected
    for result in (
        published.tiles,
        published.decouple(),
        published.read(published.b([[0, 0, -4]]), noise_t=1e-6),
    ):
        rows = polars.DataFrame(result)
        assert rows.columns == list(result.columns())
        assert rows.height == len(next(iter(result.columns().values())))


def test_results_print_names_and_units(published):
    lines = dict(line.split(maxsplit=1) for line in str(published.decouple()).splitlines())
    assert lines["displacement_rmse_mm"] == "x 0.242179, y 0.242179, z 0.315793 mm"
    assert lines["uniformity_rmse"] == "r_x 0.0628716, r_y 0.0628716, s_z 0.0398884"
    assert lines["reference_mm"] == "x 0, y 0, z -5 mm"
    # Few samples leave an end of the interval of a percentile open.
    made = published.tolerance(5, preset="jig")
    assert "inf" not in str(made.statistics)
    assert "inf" not in repr(made.displacement_mm("x").p99)
    figure = next(line for line in str(made.statistics).splitlines() if "rmse_mm.x" in line)
    assert figure.endswith(" mm")
    assert "nominal 0.242179, mean" in figure
    assert "mm2" in str(published.budget(20, preset="jig"))
    assert str(published.parts(0.2)).count("part ") == 3


def test_splice_searches_from_the_pattern():
    request = {"starts": 1, "goal": "field", "resolution_mm": 0.1}
    calls = []
    found = magsplice.splice(10, (10, 10), progress=lambda *call: calls.append(call), **request)
    start = magsplice.pattern(10, (10, 10), **request)
    assert found.after.displacement_rmse_mm.x < found.before.displacement_rmse_mm.x
    assert found.film.history[0].startswith(f"magsplice {magsplice.__version__} splice: from")
    assert len(found.film) == len(start)
    assert start.history == []
    with pytest.raises(
        TypeError, match=r"splice\(\) .* 'wavelength'; did you mean 'wavelength_mm'"
    ):
        magsplice.splice(10, (10, 10), wavelength=3)
    with pytest.raises(TypeError, match=r"film_mm = 20, must be two numbers"):
        magsplice.splice(10, 20)
    with pytest.raises(TypeError, match=r"distance_mm = 3, must be two numbers"):
        magsplice.pattern(10, (10, 10), distance_mm=3)


def test_one_sided_patterns_have_iron_among_their_errors():
    film = magsplice.pattern(10, (20, 20), one_sided=True, preset="jig")
    with pytest.raises(ValueError, match="one_sided needs preset"):
        magsplice.pattern(10, (20, 20), one_sided=True)
    assert "[tolerance.iron]" in film.to_toml()
    assert "[tolerance" not in magsplice.pattern(10, (20, 20)).to_toml()
