"""Cuboids of magpylib: the same fields, shapes and errors."""

import numpy as np
import pytest

import magsplice
from magsplice import Film, Tile, from_magpylib, getB, getH

magpylib = pytest.importorskip("magpylib")
Rotation = pytest.importorskip("scipy.spatial.transform").Rotation
Cuboid, Sensor, Collection = magpylib.magnet.Cuboid, magpylib.Sensor, magpylib.Collection

#: magpylib loses some digits a few sizes away, because corner terms cancel. Values are over the
#: largest value.
CLOSE = {"rtol": 1e-9, "atol": 1e-12}


def cuboid(rng, path=1):
    """A random cuboid of a few millimetres, along a path."""
    made = Cuboid(
        dimension=rng.uniform(1e-3, 5e-3, 3),
        polarization=rng.normal(0, 0.5, 3),
        position=rng.uniform(-0.01, 0.01, 3),
        orientation=Rotation.random(random_state=int(rng.integers(1 << 30))),
    )
    if path > 1:
        made.move(rng.uniform(-1e-3, 1e-3, (path - 1, 3)), start=1)
        made.rotate_from_angax(np.linspace(0, 40, path), (1, 2, 3), anchor=0, start=0)
    return made


def same(sources, observers, **options):
    """Checks B and H of both packages, values and shapes."""
    for ours, theirs in ((getB, magpylib.getB), (getH, magpylib.getH)):
        expected = theirs(sources, observers, **options)
        found = ours(sources, observers, **options)
        assert found.shape == expected.shape
        scale = np.abs(expected).max()
        np.testing.assert_allclose(found / scale, expected / scale, **CLOSE)


@pytest.mark.parametrize("seed", range(20))
def test_random_scenes_agree(seed):
    rng = np.random.default_rng(seed)
    sources = [cuboid(rng) for _ in range(4)]
    sources.append(Collection(cuboid(rng), Collection(cuboid(rng), cuboid(rng))))
    # Outside the cuboids, so that neither is on a face.
    points = rng.normal(0, 1, (3, 5, 3))
    points *= 0.02 / np.linalg.norm(points, axis=-1, keepdims=True)
    for options in ({}, {"sumup": True}, {"squeeze": False}, {"sumup": True, "squeeze": False}):
        same(sources, points, **options)
    same(sources[0], points)
    same(sources[4], points[0, 0])
    same(sources[4], points[0, 0].tolist(), squeeze=False)


@pytest.mark.parametrize("seed", range(5))
def test_points_inside_agree(seed):
    rng = np.random.default_rng(seed)
    source = cuboid(rng)
    inside = rng.uniform(-0.49, 0.49, (20, 3)) * source.dimension
    points = source.orientation.apply(inside) + source.position
    same(source, points)


@pytest.mark.parametrize("seed", range(5))
def test_paths_sensors_and_pixels_agree(seed):
    rng = np.random.default_rng(seed)
    still, moved = cuboid(rng), cuboid(rng, path=6)
    turned = Cuboid(
        dimension=(1e-3, 2e-3, 3e-3), polarization=rng.normal(0, 1, (3, 3)), position=(0.01, 0, 0)
    )
    pixels = rng.uniform(-1e-3, 1e-3, (2, 3, 3))
    sensors = [
        Sensor(pixel=pixels, position=(0, 0, -0.02)),
        Sensor(
            pixel=pixels,
            position=np.linspace((0.02, 0, 0), (0.03, 0, 0.01), 4),
            orientation=Rotation.from_euler("x", np.linspace(0, 90, 4)[:, None], degrees=True),
            handedness="left",
        ),
        Sensor(pixel=pixels, position=(0, 0.02, 0.02), orientation=Rotation.from_euler("z", 0.3)),
    ]
    both, pair = Collection(still, moved), Collection(sensors[0], sensors[2])
    for sources in (still, [still, moved], [both, turned]):
        for observers in (sensors, sensors[1], pair):
            same(sources, observers)
            same(sources, observers, squeeze=False)
            same(sources, observers, pixel_agg="mean")
            same(sources, observers, pixel_agg="max", squeeze=False, sumup=True)
    bare = Sensor(position=(0, 0, 0.02))
    same(still, bare, squeeze=False)
    same([still, moved], [bare, bare])
    # Different pixels are joined, or refused by both.
    same([still, moved], [bare, *sensors], pixel_agg="mean")
    same([still], [bare, (0.03, 0, 0)])
    with pytest.raises(ValueError, match="give pixel_agg"):
        getB(still, [bare, *sensors])


def test_data_frames_agree():
    rng = np.random.default_rng(3)
    sources = [cuboid(rng, path=3), Collection(cuboid(rng), style_label="both")]
    sensor = Sensor(pixel=[(0, 0, 0.02), (0, 0.02, 0.03)], style_label="sensor")
    for options in ({}, {"sumup": True}, {"pixel_agg": "mean"}):
        expected = magpylib.getB(sources, sensor, output="dataframe", **options)
        found = getB(sources, sensor, output="dataframe", **options)
        assert list(found.columns) == list(expected.columns)
        keys = ["source", "path", "sensor", "pixel"]
        assert (found[keys].to_numpy() == expected[keys].to_numpy()).all()
        fields = ["Bx", "By", "Bz"]
        np.testing.assert_allclose(found[fields], expected[fields], **CLOSE)


#: Values that magpylib's tests publish for its cuboid, with 8 digits: dimension, polarization,
#: observer, B in tesla.
PUBLISHED = [
    ((1, 2, 3), (0, 0, 0), (1, 2, 3), (0, 0, 0)),
    ((1, 2, 2), (1, 2, 3), (1, -1, 0), (-0.14174376, -0.16976459, -0.20427478)),
    ((1, 2, 3), (1, 2, 3), (1, 2, 3), (0.02596336, 0.04530334, 0.05840059)),
    ((3, 3, 3), (1, 2, 3), (0, 0, 0), (0.66666667, 1.33333333, 2.0)),
    ((1, 1, 1), (0, 0, 1), (1, 1, 1), (1.56103722e-02, 1.56103722e-02, 0)),
    ((1, 2, 3), (0.5, 0.5, 0), (2, 2, 2), (7.73243250e-03, 6.54431406e-03, 1.04789520e-02)),
    # On a corner, and on the extension of an edge.
    ((2, 2, 2), (2, 2, 2), (1, 1, 1), (0, 0, 0)),
    ((2, 2, 2), (1, 1, 1), (1, -1, 2), (-0.0009913, -0.08747071, 0.04890262)),
    ((2, 2, 2), (1, 1, 1), (1 + 1e-14, -1, 2), (-0.0009913, -0.08747071, 0.04890262)),
]


@pytest.mark.parametrize(("dimension", "polarization", "observer", "expected"), PUBLISHED)
def test_published_values_of_magpylib_pass(dimension, polarization, observer, expected):
    source = Cuboid(dimension=dimension, polarization=polarization)
    np.testing.assert_allclose(getB(source, observer), expected, rtol=1e-5, atol=1e-15)


def test_published_values_of_h_pass():
    values = [
        ((1, 2, 2), (1, -1, 0), (-112796.09804171, -135094.37189185, -162556.70519527)),
        ((1, 2, 3), (1, 2, 3), (20660.98851314, 36051.25202256, 46473.71425434)),
        ((3, 3, 3), (0, 0, 0), (-265258.23848649, -530516.47697298, -795774.71545948)),
    ]
    for dimension, observer, expected in values:
        source = Cuboid(dimension=dimension, polarization=(1, 2, 3))
        np.testing.assert_allclose(getH(source, observer), expected, rtol=1e-5)


def test_published_values_along_a_path_pass():
    source = Cuboid(
        dimension=(1, 2, 3),
        polarization=(1, 2, 3),
        position=[(0, 0, 0), (0, 0, 1), (0, 1, 0), (1, 0, 0), (0, 0, 0)],
    )
    expected = [
        (0.02596336, 0.04530334, 0.05840059),
        (0.0670977, 0.11136226, 0.06586208),
        (0.04866612, 0.02393485, 0.10462079),
        (-0.0127271, 0.05444677, 0.06974074),
        (0.02596336, 0.04530334, 0.05840059),
    ]
    np.testing.assert_allclose(getB(source, (1, 2, 3)), expected, rtol=1e-5, atol=1e-7)


def test_a_cuboid_counts_nothing_on_its_own_edges():
    sources = Collection(
        Cuboid(dimension=(2, 2, 2), polarization=(1, 2, 3)),
        Cuboid(dimension=(1, 1, 1), polarization=(3, 2, 1), position=(0, 0, 3)),
    )
    same(sources, [(1, 1, 0), (1, 1, 1), (0.5, 0.5, 3), (1, 0.3, -1), (5, 5, 5)])
    with pytest.raises(magsplice.PointsError, match="must be finite"):
        getB(sources, [(np.nan, 0, 0)])


def cubes_in_a_row():
    """Cubes at multiples of 0.01 m, their edges parallel to z, and their upper faces."""
    for index in range(-20, 21):
        cube = Cuboid(
            dimension=(0.01,) * 3, polarization=(0.1, 0.2, 0.3), position=(0.01 * index, 0, 0)
        )
        film = from_magpylib(cube)
        x_mm = film.tiles.position_mm[0, 0]
        heights_mm = np.array([-4.0, -2.0, 0.0, 1.0, 3.0])
        edges_mm = np.stack(np.broadcast_arrays(x_mm + 5, 5, heights_mm), axis=-1)
        yield cube, film, edges_mm, edges_mm - (0, 2, 0)


def test_edges_and_faces_in_metres_are_where_they_are_in_millimetres():
    for cube, film, edges_mm, faces_mm in cubes_in_a_row():
        edges = [[float(f"{x}e-3") for x in point] for point in edges_mm]
        assert not getB(cube, edges).any()
        assert np.isnan(getB(cube, edges, invalid="nan")).all()
        with pytest.raises(magsplice.PointsError, match="exposed edge") as caught:
            getB(cube, edges, invalid="raise")
        assert caught.value.faults[0].point == tuple(edges[0])
        faces = [[float(f"{x}e-3") for x in point] for point in faces_mm]
        assert np.array_equal(getB(cube, faces), film.b(faces_mm))
        # Sums in metres differ from these numbers in their last digits.
        center = cube.position[0]
        sums = [(center + 0.005, 0.005, 1e-3 * z) for z in (-4, -2, 0, 1, 3)]
        assert not getB(cube, sums).any()
        sensor = Sensor(pixel=faces)
        assert np.array_equal(getB(cube, sensor), film.b(faces_mm))
        assert np.array_equal(getB(film, faces), film.b(faces_mm))


def test_points_without_a_field_may_be_nan():
    cube = Cuboid(dimension=(1, 1, 1), polarization=(1, 2, 3))
    points = [(0, 0, 2), (np.nan, 0, 0), (0.5, 0.5, 0)]
    found = getB(cube, points, invalid="nan")
    assert np.isnan(found[1:]).all()
    assert np.array_equal(found[0], getB(cube, points[0]))
    with pytest.raises(magsplice.PointsError, match="must be finite"):
        getB(cube, points)
    with pytest.raises(ValueError, match="invalid = 'zero', must be one of"):
        getB(cube, points, invalid="zero")


def test_other_sources_are_refused():
    sphere = magpylib.magnet.Sphere(diameter=1, polarization=(1, 2, 3))
    for call in (lambda: getB(sphere, (0, 0, 1)), lambda: from_magpylib(Collection(sphere))):
        with pytest.raises(TypeError, match=r"Sphere.* is no cuboid.*magpylib\.getB"):
            call()
    with pytest.raises(ValueError, match="no polarization"):
        getB(Cuboid(dimension=(1, 1, 1)), (0, 0, 1))
    with pytest.raises(ValueError, match="no dimension"):
        getB(Cuboid(polarization=(1, 1, 1)), (0, 0, 1))
    with pytest.raises(ValueError, match="there are no sources"):
        getB([], (0, 0, 1))
    with pytest.raises(ValueError, match="observers have the shape"):
        getB(Cuboid(dimension=(1, 1, 1), polarization=(1, 1, 1)), [(0, 1)])


def test_films_return_from_magpylib_bit_for_bit(published):
    rng = np.random.default_rng(4)
    tilted = Film(
        [
            Tile(
                (0.1 * i, round(5.3 * i, 9), -0.7),
                (3.3, 1.7, 0.9),
                (0.1, 0.2, 0),
                Rotation.random(random_state=i),
            )
            for i in range(5)
        ],
        name="tilted",
    )
    for film in (published, tilted):
        collection = film.to_magpylib()
        assert len(collection.sources_all) == len(film)
        again = from_magpylib(collection)
        assert again.name == film.name
        assert again.tiles.names == film.tiles.names
        for array in ("position_mm", "size_mm", "polarization_t"):
            assert np.array_equal(getattr(again.tiles, array), getattr(film.tiles, array))
        np.testing.assert_allclose(again.tiles.rotation, film.tiles.rotation, atol=1e-15)
        # Metres and millimetres have the same field.
        points_mm = rng.uniform((-2, -2, -5), (2, 2, -3), (10, 3))
        b = film.b(points_mm)
        np.testing.assert_allclose(getB(collection, points_mm / 1000), b, rtol=1e-11)
        np.testing.assert_allclose(getB(film, points_mm / 1000), b, rtol=1e-11)
        np.testing.assert_allclose(collection.getB(points_mm / 1000), b, rtol=1e-8)


def test_films_of_cuboids_have_tables_and_no_paths():
    moving = Cuboid(dimension=(1e-3,) * 3, polarization=(0, 0, 1), position=np.zeros((2, 3)))
    with pytest.raises(ValueError, match="a path of 2 steps"):
        from_magpylib(moving)
    one = Cuboid(dimension=(1e-3,) * 3, polarization=(0, 0, 1))
    film = from_magpylib([one], name="one", tolerance={"preset": "jig"})
    assert film.to_dict()["tolerance"]["position_mm"]
    assert film.tiles[0].size_mm == (1.0, 1.0, 1.0)


def test_tolerances_hold_in_metres_too(published):
    collection = published.to_magpylib()
    points = np.random.default_rng(5).uniform((-2, -2, -5), (2, 2, -3), (500, 3)) / 1000
    exact = getB(collection, points)
    error = np.linalg.norm(getB(collection, points, within=1e-6) - exact, axis=1)
    assert (error <= 1e-6 * np.linalg.norm(exact, axis=1)).all()
