"""Arguments that break rules, and results at the ends of their ranges."""

import os
import pickle
import re
import subprocess
import sys
import warnings

import numpy as np
import polars
import pytest
from conftest import LAYOUTS

import magsplice
from magsplice import Film, Grid, Tile


def test_rotations_are_quaternions_or_matrices():
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    half = np.sqrt(0.5)
    by_matrix, by_quaternion = (
        Film([Tile((0, 0, 0), (1, 2, 3), (0.1, 0, 1), rotation=rotation)], name="one")
        for rotation in (turn, (0, 0, half, half))
    )
    points = [[0.2, 0.3, 3], [1, 2, -3]]
    np.testing.assert_allclose(by_matrix.b(points), by_quaternion.b(points), rtol=1e-12)
    for rotation in (np.eye(2), (1, 2, 3, 4, 5), np.zeros((2, 3))):
        with pytest.raises(magsplice.LayoutError):
            Film([Tile((0, 0, 0), (1, 2, 3), (0, 0, 1), rotation=rotation)], name="one")


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("position_mm", [0, 0, 0, 7]),
        ("position_mm", [[0, 0, 0], [5, 0, 0]]),
        ("size_mm", [1, 1, 1, 7]),
        ("polarization_t", [0, 0, 1, 7]),
    ],
)
def test_vectors_have_three_numbers(key, value):
    tile = Tile((0, 0, 0), (1, 1, 1), (0, 0, 1))._replace(**{key: value})
    with pytest.raises(
        magsplice.LayoutError, match=rf"{key} is (a list of three numbers|one number)"
    ):
        Film([tile], name="one")


def test_permeabilities_may_be_numbers_of_numpy():
    for stated in (np.float32(1.05), np.array(1.05), (1.05, 1.1), np.array([1.05, 1.1])):
        tile = Tile((0, 0, 0), (1, 1, 1), (0, 0, 1), recoil_permeability=stated)
        film = Film([tile], name="one")
        assert film.tiles.recoil_permeability[0, 0] == pytest.approx(1.05, rel=1e-6)
    with pytest.raises(ValueError, match="must be one number, or one along and one across"):
        Tile((0, 0, 0), (1, 1, 1), (0, 0, 1), recoil_permeability=(1, 2, 3)).to_dict()


def test_keys_of_layouts_are_known(published):
    with pytest.raises(TypeError, match="materal is no key of a layout"):
        published.replace(materal=None)
    assert published.replace(design=None, expect=None).name == published.name


def test_noise_is_above_zero(published):
    for noise_t in (-1, 0, np.nan, (1e-6, 1e-6, np.inf)):
        with pytest.raises(ValueError, match=r"noise_t = .* must be above 0 and finite"):
            published.read([[0, 0, 0]], noise_t=noise_t)
        with pytest.raises(ValueError, match=r"noise_t = .* must be above 0 and finite"):
            published.resolution([0, 0, -4], noise_t=noise_t)
    with pytest.raises(ValueError, match="zero has readings that are not finite"):
        published.read([[0, 0, 0]], zero=[np.nan] * 3)
    with pytest.raises(ValueError, match="constant_t"):
        published.read([[0, 0, 0]], constant_t=(np.nan, 0, 0))


def test_missing_readings_of_a_diagnosis_are_excluded(published):
    points = np.random.default_rng(1).uniform((-3, -3, -2), (3, 3, -1), (60, 3))
    readings = published.b(points)
    readings[3, 1] = np.nan
    found = published.diagnose(points, readings, noise_t=1e-6)
    assert found.excluded.incomplete == [3]
    assert found.faulty == []


def test_numbers_of_samples_are_whole_and_in_range(published):
    for samples in (0, -1, 10**12):
        with pytest.raises(ValueError, match=f"samples = {samples}, must be from 1 to 10000000"):
            published.tolerance(samples, preset="jig")
    for samples in (10.7, "10"):
        with pytest.raises(TypeError, match="must be a whole number"):
            published.tolerance(samples, preset="jig")
    with pytest.raises(ValueError, match="seed = -1, must be at least 0"):
        published.tolerance(1, preset="jig", seed=-1)
    with pytest.raises(ValueError, match="seed = -1, must be at least 0"):
        published.forces("least", seed=-1)


def test_words_are_known(published):
    made = published.tolerance(4, preset="jig")
    with pytest.raises(ValueError, match="axis = 'yz', must be one of"):
        made.displacement_mm("yz")
    with pytest.raises(ValueError, match="parameter = 'x', must be one of"):
        made.uniformity("x")
    with pytest.raises(ValueError, match='quantity = \'j\', must be one of "b", "h"'):
        published.gradient([0, 0, -3], quantity="j")
    with pytest.raises(ValueError, match="component = 'hx', must be one of"):
        magsplice.plot.field_map(published, "hx")
    with pytest.raises(ValueError, match="parameter = 'rx', must be one of"):
        magsplice.plot.parameter_map(published, "rx")
    with pytest.raises(KeyError, match="nothing: must be one of"):
        published.check()["nothing"]


def test_amplitudes_are_checked_before_a_search():
    film = magsplice.load(LAYOUTS / "designed-stock.toml")
    for least in (-1, 0, np.nan):
        with pytest.raises(ValueError, match="least_amplitude"):
            film.design(least_amplitude=least)


def test_orders_have_each_tile_once(published):
    names = published.tiles.names
    order = published.forces(name for name in names).order
    assert order.names == names
    with pytest.raises(ValueError, match=f"order: '{names[0]}' is placed twice"):
        published.forces([*names, names[0]])
    with pytest.raises(ValueError, match="order: has 55 tiles, must have all 56"):
        published.forces(names[1:])


def test_empty_results_are_tables(published):
    read = published.read(np.empty((0, 3)))
    table = polars.DataFrame(read)
    assert table.height == 0
    assert table.columns == list(read.columns())


def test_fields_for_magpylib_are_those_of_the_cells(published):
    film = published.replace(material={"recoil_permeability": 1.1, "recoil_error": 0.3})
    points = np.array([[0, 0, -3], [1, 2, -4]])
    expected = film.b(points)
    assert not np.allclose(expected, published.b(points), rtol=1e-3)
    np.testing.assert_allclose(magsplice.getB(film, 1e-3 * points), expected, atol=1e-16)
    collection = film.to_magpylib()
    # Those of the last two levels.
    assert len(collection.children) > film.recoil.cells
    np.testing.assert_allclose(collection.getB(1e-3 * points), expected, atol=1e-12)


def test_results_that_are_kept_do_not_change(published):
    film = published.replace(material={"recoil_permeability": 1.05, "recoil_error": 0.3})
    with pytest.raises(ValueError, match="read-only"):
        film.recoil.weakening[0] = 9
    forces = film.forces().to_dict()
    assert forces["recoil"]["error_n"] > 0


def test_grids_have_whole_numbers_of_points():
    with pytest.raises(TypeError, match="must be a whole number"):
        Grid((0, 0, -3), (1, 1, -2), (2.7, 1, 1))


def test_sources_that_are_no_cuboids_are_named():
    for source in (None, "Cuboid"):
        with pytest.raises(TypeError, match="is no cuboid"):
            magsplice.getB(source, (0, 0, 0.1))
    for call in (magsplice.splice, magsplice.pattern):
        with pytest.raises(ValueError, match="starts = -1, must be from 1 to 10000"):
            call(10, (20, 20), starts=-1)


def test_tolerances_are_those_of_the_program(published):
    grid = Grid((-1, -1, -4), (1, 1, -3), (5, 5, 3))
    exact = published.b(grid)
    for within in ("10nT", "0.01 uT", "1e-5mT"):
        assert np.array_equal(published.b(grid, within=within), published.b(grid, within_t=1e-8))
    assert np.array_equal(published.b(grid, within="1e-6"), published.b(grid, within=1e-6))
    assert (np.linalg.norm(published.b(grid, within="10nT") - exact, axis=-1) <= 1e-8).all()
    rules = {
        5: "5 is 500 % of |B|, must be a fraction below 0.1; a field has a unit, as in 5nT",
        0.1: "0.1 is 10 % of |B|",
        "5%": "a fraction of |B| is written without a unit: 0.05",
        "1mm": "has the unit mm, must be a flux density in T, mT",
        "x": "must be a number",
        0: "must be a finite number above zero",
        np.inf: "must be a finite number above zero",
        np.nan: "must be a finite number above zero",
    }
    calls = [
        lambda within: published.b(grid, within=within),
        lambda within: published.h([0, 0, -4], within=within),
        lambda within: published.compare(within=within),
        lambda within: published.decouple(within=within),
        lambda within: published.report(within=within),
        lambda within: magsplice.getB(published, (0, 0, -0.004), within=within),
    ]
    for within, rule in rules.items():
        for call in calls:
            with pytest.raises(ValueError, match=rf"within: .*{re.escape(rule)}"):
                call(within)
    with pytest.raises(ValueError, match=r"within_t: .* must be a finite number above zero"):
        published.b(grid, within_t=-1)


def test_films_in_metres_warn_once(tmp_path):
    size = 0.003
    layout = {
        "name": "metres",
        "ideal": {"wavelength_mm": 10, "thickness_mm": 1, "amplitude_t": 0.12},
        "tile": [Tile((0, 0, size / 6), (size, size, size / 3), (0, 0, 0.12))],
    }
    with pytest.warns(magsplice.LayoutWarning, match="are its tiles in m, not mm") as caught:
        film = Film.from_dict(layout)
    assert len(caught) == 1
    assert caught[0].filename == __file__
    film.save(tmp_path / "film.toml")
    calls = [
        lambda: magsplice.load(tmp_path / "film.toml"),
        lambda: magsplice.loads(film.to_toml()),
        lambda: Film(layout["tile"], name="again", ideal=layout["ideal"]),
    ]
    for call in calls:
        with pytest.warns(magsplice.LayoutWarning, match="in m, not mm") as caught:
            call()
        assert caught[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # Copies and changed films repeat no finding.
        pickle.loads(pickle.dumps(film))
        film.replace(name="renamed").b([0, 0, -4])


def test_errors_of_films_made_in_python_name_no_text():
    with pytest.raises(magsplice.LayoutError) as caught:
        Film([Tile((0, 0, 0), (1, -1, 1), (0, 0, 1), name="first")], name="bad")
    assert str(caught.value) == 'bad: tile "first": size_mm[1] = -1, must be greater than 0'
    assert caught.value.faults[0].line is None
    for layout in (
        {"name": "bad", "volum": {}},
        {"name": "bad", "volume": {"x_m": [0, 1]}},
        {"name": "bad", "tile": [{"position_mm": "here"}]},
        {"name": "bad", "tile": 5},
        {"name": 5},
    ):
        with pytest.raises(magsplice.LayoutError) as caught:
            Film.from_dict(layout)
        text = str(caught.value)
        assert "line" not in text, text
        assert "TOML" not in text, text
        assert "|" not in text, text


def test_spliced_films_have_a_preset_and_a_sensor():
    film = magsplice.pattern(8, (7, 7), preset="jig", sensor="MLX90393")
    assert "[tolerance]" in film.to_toml()
    assert 'part = "MLX90393"' in film.to_toml()
    with pytest.raises(ValueError, match='preset = "desk", must be'):
        magsplice.pattern(8, (7, 7), preset="desk")
    with pytest.raises(ValueError, match='sensor = "MLX", must be one of: LIS3MDL, '):
        magsplice.pattern(8, (7, 7), sensor="MLX")


@pytest.mark.skipif(not os.path.exists("/proc/self/task"), reason="the system lists no threads")
def test_threads_of_the_environment_are_bounded():
    code = """
import os
import magsplice
tile = magsplice.Tile((0, 0, 0), (1, 1, 1), (0, 0, 1))
before = len(os.listdir("/proc/self/task"))
magsplice.Film([tile], name="tile").b([(0, 0, 1)] * 100_000)
print(len(os.listdir("/proc/self/task")) - before)
"""
    environment = {**os.environ, "RAYON_NUM_THREADS": "100000"}
    command = [sys.executable, "-c", code]
    found = subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE).stdout
    # One more watches for Ctrl-C.
    assert 1 <= int(found) <= 4 * os.cpu_count() + 1
