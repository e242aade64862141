"""Films: layouts, fields, shapes, errors."""

import copy
import pickle

import numpy as np
import polars
import pytest
from conftest import LAYOUTS

import magsplice
from magsplice import Film, Grid, Ideal, Tile, Volume
from magsplice._points import flattened

MU_0 = 1.25663706127e-6
ONE = Tile((0, 0, 0.5), (3, 2, 1), (0.05, 0.0, 0.12))


def test_five_lines_give_the_numbers_of_the_published_film():
    film = magsplice.load(LAYOUTS / "published-film.toml")
    # B at a point, computed by an independent script.
    expected = (-1.0284893492777e-3, 6.272861417527e-4, 6.766460587771e-4)
    np.testing.assert_allclose(film.b([2.0, -1.0, -5.0]), expected, rtol=1e-12)
    assert round(film.compare().amplitude, 6) == 0.818730
    assert np.round(film.decouple().uniformity_rmse, 6).tolist() == [0.062872, 0.062872, 0.039888]
    assert np.round(film.decouple().displacement_rmse_mm, 6).tolist() == [
        0.242179,
        0.242179,
        0.315793,
    ]


def test_points_of_any_leading_shape_give_fields_of_that_shape(published):
    rng = np.random.default_rng(1)
    points = rng.uniform((-2, -2, -5), (2, 2, -3), (2, 3, 4, 3))
    b = published.b(points)
    assert b.shape == points.shape
    assert published.gradient(points).shape == (2, 3, 4, 3, 3)
    assert published.error_bound(points).shape == (2, 3, 4)
    assert published.b(np.zeros((0, 3))).shape == (0, 3)
    # No digit depends on the other points, on the order in memory, or on the kind of sequence.
    assert np.array_equal(b[1, 2, 3], published.b(points[1, 2, 3].tolist()))
    assert np.array_equal(b, published.b(np.asfortranarray(points)))
    assert np.array_equal(b[:, ::2], published.b(points[:, ::2]))
    whole = np.array([[1, 0, -4]])
    assert np.array_equal(published.b(whole), published.b(whole.astype(float)))


def test_contiguous_points_are_not_copied():
    points = np.zeros((4, 5, 3))
    rows, shape = flattened(points)
    assert np.shares_memory(rows, points)
    assert shape == (4, 5)


@pytest.mark.parametrize("points", [0.0, [1.0, 2.0], np.zeros((3, 2))])
def test_points_of_another_shape_are_refused(published, points):
    with pytest.raises(ValueError, match=r"must have \(\.\.\., 3\)"):
        published.b(points)


def test_b_is_mu0_h_plus_j():
    film = Film([ONE], name="one")
    points = [[0.1, 0.2, 0.4], [5, 0, 0]]
    j = film.j(points)
    assert j.tolist() == [[0.05, 0, 0.12], [0, 0, 0]]
    np.testing.assert_allclose(MU_0 * film.h(points) + j, film.b(points), rtol=1e-9)


def test_gradient_is_that_of_differences(published):
    point, step = np.array([0.7, -1.2, -3.9]), 1e-4
    steps = step * np.eye(3)
    differences = (published.b(point + steps) - published.b(point - steps)).T / (2 * step)
    gradient = published.gradient(point)
    np.testing.assert_allclose(gradient, differences, atol=1e-10)
    assert np.array_equal(gradient, gradient.T)
    np.testing.assert_allclose(published.gradient(point, quantity="h") * MU_0, gradient, rtol=1e-9)


def test_grids_give_the_field_at_their_points(published):
    grid = published.grid
    assert grid.counts == (9, 9, 5)
    assert len(grid) == 405
    assert np.array_equal(published.b(grid), published.b(grid.points_mm))
    assert 0.0 in grid.x_mm
    odd = Grid((0.1, 0, -5), (1.1, 0, -3), (4, 1, 3))
    assert np.array_equal(published.b(odd), published.b(odd.points_mm))
    # Three thirds of 0.1 are more than 0.1.
    assert odd.x_mm[0] == 0.1
    with pytest.raises(ValueError, match="must be at least 1"):
        published.b(Grid((0, 0, 0), (1, 1, 1), (2, 0, 2)))


def test_tolerances_are_kept(published):
    grid = Grid((-2, -2, -5), (2, 2, -3), (41, 41, 21))
    exact = published.b(grid)
    length = np.linalg.norm(exact, axis=-1)
    for within in (1e-3, 1e-9):
        error = np.linalg.norm(published.b(grid, within=within) - exact, axis=-1)
        assert (error <= within * length).all()
    error = np.linalg.norm(published.b(grid.points_mm, within_t=1e-8) - exact, axis=-1)
    assert (error <= 1e-8).all()
    with pytest.raises(ValueError, match="both given"):
        published.b(grid, within=1e-3, within_t=1e-8)
    with pytest.raises(ValueError, match="must be a finite number above zero"):
        published.b(grid, within=-1.0)
    with pytest.raises(magsplice.PointsError, match="the tolerance cannot be kept"):
        published.b(grid, within=1e-300)


def test_points_without_a_field_are_named():
    film = Film([ONE], name="one")
    points = [[0, 0, -1], [1.5, 0.3, 1.0], [np.nan, 0, 0]]
    with pytest.raises(magsplice.PointsError, match="exposed edge of tile 0") as caught:
        film.b(points)
    assert isinstance(caught.value, ValueError)
    assert [fault.index for fault in caught.value.faults] == [1, 2]
    assert caught.value.faults[0].tile == 0
    assert caught.value.faults[0].point == (1.5, 0.3, 1.0)
    again = pickle.loads(pickle.dumps(caught.value))
    assert str(again) == str(caught.value)
    assert again.faults[0] == caught.value.faults[0]
    b = film.b(points, invalid="nan")
    assert np.isfinite(b[0]).all()
    assert np.isnan(b[1:]).all()


def test_broken_layouts_name_every_rule():
    tile = "[[tile]]\nposition_mm = [0, 0, 0]\nsize_mm = [1, -1, 0]\npolarization_t = [0, 0, 1]\n"
    with pytest.raises(magsplice.LayoutError, match=r"bad\.toml: line 3") as caught:
        magsplice.loads(f'format = 1\nname = "bad"\n{tile}', origin="bad.toml")
    faults = caught.value.faults
    assert [fault.message[:10] for fault in faults] == ["size_mm[1]", "size_mm[2]"]
    assert faults[0].line == 3
    assert pickle.loads(pickle.dumps(caught.value)).faults == faults
    with pytest.raises(magsplice.LayoutError, match="TOML"):
        magsplice.loads("format = ")


def test_absent_files_raise_errors_of_the_system(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"No such file .*absent\.toml"):
        magsplice.load(tmp_path / "absent.toml")


def test_missing_tables_are_named():
    film = Film([ONE], name="one")
    with pytest.raises(magsplice.MagspliceError, match=r"no \[volume\]"):
        film.compare()
    with pytest.raises(magsplice.MagspliceError, match=r"no \[ideal\]"):
        film.compare([[0, 0, -4]])
    with pytest.raises(magsplice.MagspliceError, match=r"no \[design\]"):
        film.design()


def test_films_pickle_bit_for_bit(published):
    for film in (published, Film([ONE], name="one", tolerance={"position_mm": 0.05})):
        again = pickle.loads(pickle.dumps(film))
        assert again.sha256 == film.sha256
        assert np.array_equal(again.b([1, 1, -4]), film.b([1, 1, -4]))
        assert again.to_toml() == film.to_toml()
    assert copy.deepcopy(published).sha256 == published.sha256


def test_films_are_built_saved_and_loaded(tmp_path):
    film = Film(
        [
            ONE._replace(name="first"),
            Tile((5, 0, 0.5), np.array([1, 1, 1]), (0, 0.1, 0), rotation=(0, 0, 1, 1)),
        ],
        name='a "film" of ü',
        description="two\nlines",
        ideal=Ideal(10, 1, 0.12),
        volume=Volume((-1, 1), (-1, 1), (-4, -3), 0.5),
        tolerance={"preset": "workshop", "direction_deg": 1.0},
    )
    assert film.name == 'a "film" of ü'
    assert film.description == "two\nlines"
    assert film.ideal == Ideal(10, 1, 0.12)
    assert film.volume == Volume((-1, 1), (-1, 1), (-4, -3), 0.5, (0, 0, -4))
    assert film.reference_mm == (0, 0, -4)
    film.save(tmp_path / "film.toml")
    again = magsplice.load(tmp_path / "film.toml")
    assert np.array_equal(again.b([1, 1, -3]), film.b([1, 1, -3]))
    assert again.name == film.name
    assert Film.from_dict(film.to_dict()).to_toml(compact=False) == film.to_toml(compact=False)
    film.save(tmp_path / "plain.toml", compact=False)
    for same in (Film.from_dict(film.to_dict()), magsplice.load(tmp_path / "plain.toml")):
        assert same == film
        assert hash(same) == hash(film)


def test_arguments_without_numbers_are_named(published):
    with pytest.raises(ValueError, match=r"points must be numbers of the shape \(..., 3\): could"):
        published.b("abc")
    with pytest.raises(ValueError, match="readings must be numbers"):
        published.scan([[0, 0, -4]], [[1, 2, 3], [1, 2]])


def test_replaced_tables_leave_the_others(published):
    finer = published.replace(volume={**published.to_dict()["volume"], "step_mm": 0.25})
    assert len(finer.grid) == 17 * 17 * 9
    assert np.array_equal(finer.b([1, 1, -4]), published.b([1, 1, -4]))
    assert published.replace(ideal=None, expect=None, design=None).ideal is None
    with pytest.raises(magsplice.LayoutError, match="unknown"):
        published.replace(volum={})
    with pytest.raises(magsplice.LayoutError, match=r"volume\.step_mm = .*not object"):
        published.replace(volume={"step_mm": object()})


def test_tiles_are_a_sequence_and_arrays(published):
    tiles = published.tiles
    assert len(tiles) == len(published) == 56
    assert tiles[-1].name == tiles.names[55]
    assert len(tiles[:3]) == 3
    assert tiles.position_mm.shape == (56, 3)
    assert tiles.rotation.shape == (56, 4)
    np.testing.assert_allclose(np.linalg.norm(tiles.polarization_t, axis=1), 0.12)
    with pytest.raises(IndexError):
        tiles[56]
    with pytest.raises(ValueError, match="read-only"):
        tiles.position_mm[0, 0] = 1.0
    copied = Film(tiles, name="copied")
    assert np.array_equal(copied.b([1, 1, -4]), published.b([1, 1, -4]))


def test_films_of_the_same_numbers_are_equal(published):
    text = published.to_toml()
    for same in (copy.deepcopy(published), pickle.loads(pickle.dumps(published))):
        assert same == published
        assert hash(same) == hash(published)
    assert magsplice.loads(text) == magsplice.loads(text)
    assert magsplice.loads(text) == magsplice.loads("# A remark.\n" + text, folder="elsewhere")
    assert published != published.replace(description="other")
    assert published != published.sha256


def test_table_of_tiles_has_kinds_and_permeabilities():
    layout = {
        "name": "kinds",
        "kind": {
            "square": {"size_mm": [1, 1, 1], "recoil_permeability": {"along": 1.05, "across": 1.1}}
        },
        "tile": [
            {"name": "a", "kind": "square", "position_mm": [0, 0, 0], "polarization_t": [0, 0, 1]},
            Tile((3, 0, 0), (1, 1, 1), (0, 0, 1), name="b"),
        ],
    }
    tiles = Film.from_dict(layout).tiles
    assert tiles.columns()["kind"] == ["square", None]
    table = polars.DataFrame(tiles)
    assert table["kind"].to_list() == ["square", None]
    assert table["recoil_permeability_along"].is_nan().to_list() == [False, True]
    assert table["recoil_permeability_across"].to_list()[0] == 1.1
    assert table["size_x_mm"].to_list() == [1.0, 1.0]


def test_ideal_field_is_that_of_equation_2(published):
    x, y, z = point = (0.7, -1.2, -3.9)
    k, surface = 2 * np.pi / 10, 0.12 * (1 - np.exp(-2 * np.pi / 10)) / 2
    down = surface * np.exp(k * z)
    expected = (
        -down * np.sin(k * x),
        -down * np.sin(k * y),
        down * (np.cos(k * x) + np.cos(k * y)),
    )
    np.testing.assert_allclose(published.ideal_b(point), expected, rtol=1e-13)
    assert np.isnan(published.ideal_b([0, 0, 1])).all()


def test_representations_tell_what_a_thing_is(published):
    assert repr(published).startswith("<magsplice.Film 'published film': 56 tiles, sha256 ")
    assert repr(published.tiles) == "<Tiles: 56>"
    assert "amplitude" in repr(published.compare())
    html = published._repr_html_()
    assert "data:image/svg+xml" in html
    assert "iframe" in html
    assert "x -2 .. 2" in html


def test_findings_are_sentences():
    film = Film([ONE._replace(polarization_t=(0, 0, 0))], name="weak")
    assert any("polarization" in finding for finding in film.findings)


def ring(count, decimals=None):
    """Tiles of a ring that touch at their inner edges, with positions of so many decimals."""
    angles = 2 * np.pi * np.arange(count) / count
    radius = 5 / np.tan(np.pi / count) + 5
    places = np.stack([radius * np.cos(angles), radius * np.sin(angles), 0 * angles], axis=-1)
    if decimals is not None:
        places = np.round(places, decimals)
    rotations = np.stack([0 * angles, 0 * angles, np.sin(angles / 2), np.cos(angles / 2)], axis=-1)
    blocks = zip(places, rotations, strict=True)
    return [Tile(place, (10, 10, 10), (1.3, 0, 0), rotation) for place, rotation in blocks]


def test_blocks_of_a_ring_touch():
    for count in (3, 22, 36, 100, 255):
        assert len(Film(ring(count), name="ring")) == count


def test_overlaps_by_rounded_positions_are_allowed_on_request():
    with pytest.raises(magsplice.LayoutError, match=r"overlap_mm = [0-9.e-]+ allows it"):
        Film(ring(22, decimals=6), name="ring")
    film = Film(ring(22, decimals=6), name="ring", overlap_mm=1e-6)
    assert film.to_dict()["overlap_mm"] == 1e-6
    assert film.replace(overlap_mm=2e-6).to_dict()["overlap_mm"] == 2e-6


def test_volumes_may_be_planes(published):
    plane = published.replace(volume={**published.to_dict()["volume"], "z_mm": [-4, -4]})
    assert plane.grid.points_mm.shape == (9, 9, 1, 3)
    found = plane.decouple()
    deep = published.decouple()
    assert found.uniformity_rmse.s_z == pytest.approx(deep.s_z[:, :, 2].std(), rel=1e-9)
