"""Films with other tiles, sweeps, and replaced keys."""

import numpy as np
import pytest

import magsplice
from magsplice import Film, Tile

Rotation = pytest.importorskip("scipy.spatial.transform").Rotation
PAD = Film(
    [
        Tile((-1.5, 0.2, 0.5), (2, 1, 0.5), (0.1, 0.02, 0.03), name="left"),
        Tile((1.3, 0, 0.5), (2, 1, 0.5), (0.1, 0, 0), (10, 20, 30), "right"),
    ],
    name="pad",
)
POINTS = np.random.default_rng(2).uniform((-3, -3, -4), (3, 3, -2), (20, 3))


@pytest.mark.parametrize("turn", [(180, 0, 0), (0, 0, 90), (10, -20, 30)])
def test_fields_move_and_turn_with_the_tiles(turn):
    rotation, about, shift = Rotation.from_rotvec(turn, degrees=True), (1, -2, 3), (0.1, 0.2, -8)
    film = PAD.rotated(turn, about_mm=about).moved(shift)
    moved = rotation.apply(POINTS - about) + about + shift
    np.testing.assert_allclose(film.b(moved), rotation.apply(PAD.b(POINTS)), atol=1e-12)
    assert film.tiles.names == PAD.tiles.names
    back = film.moved(np.negative(shift)).rotated(np.negative(turn), about_mm=about)
    np.testing.assert_allclose(back.tiles.position_mm, PAD.tiles.position_mm, atol=1e-9)


def test_tiles_keep_their_recoil():
    soft = PAD.replace(material={"recoil_permeability": 1.05})
    both = PAD + soft.moved((0, 0, 4))
    assert np.isnan(both.tiles.recoil_permeability[:2]).all()
    assert both.tiles.recoil_permeability[2:].tolist() == [[1.05, 1.05]] * 2
    turned = both.rotated((10, 0, 0))
    assert np.array_equal(
        turned.tiles.recoil_permeability, both.tiles.recoil_permeability, equal_nan=True
    )


def test_rotations_of_all_forms_are_the_same():
    rotation = Rotation.from_rotvec((10, -20, 30), degrees=True)
    angle = float(np.linalg.norm((10, -20, 30)))
    forms = [
        (10, -20, 30),
        np.array([10.0, -20.0, 30.0]),
        {"axis": (10, -20, 30), "angle_deg": angle},
        {"quaternion": rotation.as_quat()},
        rotation,
        rotation.as_matrix(),
        {"matrix": rotation.as_matrix()},
        {"euler_deg": rotation.as_euler("xyz", degrees=True), "order": "xyz"},
    ]
    expected = PAD.rotated(rotation).b(POINTS)
    for form in forms:
        np.testing.assert_allclose(PAD.rotated(form).b(POINTS), expected, atol=1e-13)
        tile = Tile((0, 0, 0), (1, 2, 3), (0, 0, 1), rotation=form)
        found = Film([tile], name="one").tiles.rotation[0]
        np.testing.assert_allclose(found, rotation.as_quat(), atol=1e-14)
    assert Film([Tile((0, 0, 0), (1, 2, 3), (0, 0, 1), (0, 0, 0))], name="one").tiles.rotation[0, 3]
    for wrong in ((1, 2), "x", {"axis": [0, 0, 1]}, {"angle": 3}, (np.nan, 0, 0), np.eye(2)):
        with pytest.raises(ValueError, match="rotation"):
            PAD.rotated(wrong)
    with pytest.raises(ValueError, match=r"about_mm = .* must be three finite numbers"):
        PAD.rotated((0, 0, 90), about_mm=(0, 0))
    with pytest.raises(ValueError, match=r"shift_mm = .* must be three finite numbers"):
        PAD.moved((0, 0, np.inf))


def test_two_pads_that_face_each_other(published):
    pair = published + published.rotated((180, 0, 0)).moved((0, 0, -8))
    assert len(pair) == 2 * len(published)
    assert pair.volume == published.volume
    turned = Rotation.from_rotvec((180, 0, 0), degrees=True)
    points = published.grid.points_mm.reshape(-1, 3)
    other = turned.apply(published.b(turned.apply(points + np.array((0, 0, 8)))))
    np.testing.assert_allclose(pair.b(points), published.b(points) + other, atol=1e-12)
    assert set(published.tiles.names) < set(pair.tiles.names)
    assert f"{published.tiles.names[0]}-2" in pair.tiles.names
    # Parallel edges have exact forces.
    assert np.array_equal(np.unique(np.abs(pair.tiles.rotation)), [0, 1])
    assert sum([PAD, PAD.moved((0, 0, 4)), PAD.moved((0, 0, 8))]) == PAD + PAD.moved(
        (0, 0, 4)
    ) + PAD.moved((0, 0, 8))
    with pytest.raises(TypeError):
        PAD + 1
    with pytest.raises(magsplice.LayoutError, match="overlap") as caught:
        PAD + PAD
    assert "line" not in str(caught.value)


def test_films_are_indexed(published):
    assert PAD[0] == PAD.tiles[0]
    assert PAD[-1] == PAD["right"]
    assert list(PAD) == list(PAD.tiles)
    assert PAD[:1].tiles.names == ["left"]
    assert PAD[[1, 0]].tiles.names == ["right", "left"]
    assert PAD[PAD.tiles.position_mm[:, 0] > 0].tiles.names == ["right"]
    assert PAD["l*"].tiles.names == ["left"]
    tile = {"kind": "square", "polarization_t": [0, 0, 1]}
    kinds = Film.from_dict(
        {
            "name": "kinds",
            "kind": {"square": {"size_mm": [1, 1, 1]}},
            "tile": [
                {**tile, "position_mm": [0, 0, 0]},
                {**tile, "position_mm": [3, 0, 0]},
                *PAD[:1].moved((0, 0, 5)),
            ],
        }
    )
    assert len(kinds["square"]) == 2
    assert len(kinds["square"].moved((0, 0, 1)) + kinds["square"]) == 4
    halves = published[:28].b([0, 0, -4]) + published[28:].b([0, 0, -4])
    np.testing.assert_allclose(halves, published.b([0, 0, -4]), atol=1e-15)
    with pytest.raises(IndexError):
        PAD[2]
    with pytest.raises(KeyError, match="'square' is no tile and no kind of pad, which has left"):
        PAD["square"]


def test_lattices_are_cut_films():
    x = [([3.3, 1.7], [1, 0], 2)]
    film = Film(lattice=[magsplice.Lattice((-5, -5, 0), 1, x, strength_t=0.12)], name="cut")
    table = {"widths_mm": [3.3, 1.7], "pattern": [1, 0], "times": 2}
    written = {"start_mm": [-5, -5, 0], "height_mm": 1, "x": [table], "strength_t": 0.12}
    assert len(film) == len(Film.from_dict({"name": "cut", "lattice": [written]})) == 12
    assert film[0].size_mm == (3.3, 3.3, 1)
    mixed = Film([Tile((0, 0, 5), (1, 1, 1), (0, 0, 1))], lattice=[written], name="mixed")
    assert len(mixed) == 13


def test_replaced_keys_leave_the_others_of_a_table(published):
    lower = published.replace(volume={"z_mm": [-7, -6]})
    assert lower.volume.x_mm == published.volume.x_mm
    assert lower.volume.z_mm == (-7, -6)
    assert lower.volume.step_mm == published.volume.step_mm
    # The default reference point follows the volume, and a given one stays.
    assert lower.reference_mm == (0, 0, -7)
    given = published.replace(volume={"reference_mm": [0.5, 0, -4]})
    assert given.replace(volume={"x_mm": [-1, 1]}).reference_mm == (0.5, 0, -4)
    assert given.replace(volume={"reference_mm": None}).reference_mm == published.reference_mm
    assert published.replace(ideal={"amplitude_t": 0.1}).ideal.wavelength_mm == 10
    workshop = published.replace(tolerance={"preset": "workshop"})
    again = workshop.replace(tolerance={"size_mm": 0.5}).replace(tolerance={"preset": "workshop"})
    assert again.to_dict()["tolerance"] == workshop.to_dict()["tolerance"]


def test_sweeps_are_tables(published):
    sweep = published.sweep("volume.step_mm", [1.0, 0.5])
    columns = sweep.columns()
    assert columns["volume.step_mm"].tolist() == [1.0, 0.5]
    expected = [published.replace(volume={"step_mm": s}).decouple() for s in (1.0, 0.5)]
    assert columns["displacement_rmse_mm.x"].tolist() == [
        found.displacement_rmse_mm.x for found in expected
    ]
    assert "volume.step_mm" in str(sweep).splitlines()[0]

    def gap(film, gap_mm):
        return film + film.rotated((180, 0, 0)).moved((0, 0, -gap_mm))

    sweep = PAD.sweep(gap, [6, 7], lambda film: film.b([0, 0, -3])[2])
    assert list(sweep.columns()) == ["gap", "result"]
    assert sweep.results == [gap(PAD, 6).b([0, 0, -3])[2], gap(PAD, 7).b([0, 0, -3])[2]]
    assert len(sweep.films[0]) == 4
    assert "<table>" in sweep._repr_html_()
    with pytest.raises(magsplice.LayoutError, match="volum"):
        published.sweep("volum.step_mm", [1])
