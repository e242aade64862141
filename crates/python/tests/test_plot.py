"""Figures with matplotlib."""

import numpy as np
import pytest
from test_results import SQUARES

import magsplice
from magsplice import Film

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("agg")
from matplotlib import pyplot

from magsplice import plot


@pytest.fixture
def ax():
    """Axes of a figure that is closed after the test."""
    figure, axes = pyplot.subplots()
    yield axes
    figure.canvas.draw()
    pyplot.close(figure)


def test_layout_has_an_outline_for_each_tile(published, ax):
    assert plot.layout(published, ax=ax, names=True) is ax
    # Plus the frame of the working volume.
    assert len(ax.patches) == 57
    corners = ax.patches[0].get_xy()[:-1]
    spans = np.ptp(corners, axis=0)
    assert any(np.allclose(spans, size[:2]) for size in published.tiles.size_mm)


@pytest.mark.parametrize("of", ["film", "ideal", "difference"])
@pytest.mark.parametrize("component", ["bx", "bz", "magnitude"])
def test_field_maps_show_the_field(published, ax, component, of):
    plot.field_map(published, component, ax=ax, of=of, z_mm=-4)
    values = ax.collections[0].get_array()
    if (component, of) == ("bz", "film"):
        x, y = -2, -2
        # The first cell is the corner of the volume; rows of the mesh are along y.
        assert np.isclose(values.ravel()[0], 1e3 * published.b([x, y, -4])[2])
    assert ax.get_title() == "z = -4 mm"


def test_maps_follow_the_rules_of_reports(published, ax):
    plot.field_map(published, "bz", ax=ax)
    film = ax.collections[0]
    plot.field_map(published, "bz", ax=ax, of="ideal")
    ideal = ax.collections[1]
    # Compared maps share a scale; values of one sign begin at zero; the map ends with the volume.
    assert film.get_clim() == ideal.get_clim()
    assert film.get_clim()[0] == 0
    assert film.get_cmap().name == "viridis"
    assert np.allclose(film.get_datalim(ax.transData).bounds, [-2, -2, 4, 4])
    plot.field_map(published, "bx", ax=ax)
    assert ax.collections[2].get_cmap().name == "RdBu_r"
    # B_x is 0 where x = 0, but for round-off.
    middle = np.asarray(ax.collections[2].get_array()).reshape(81, 81)[:, 40]
    assert (middle == 0).all()


def test_parameter_maps_have_rows_along_y(published, ax):
    plot.parameter_map(published, "r_x", ax=ax)
    values = np.asarray(ax.collections[0].get_array()).reshape(81, 81)
    # R_x changes along x, which are the columns.
    assert np.ptp(values, axis=1).mean() > 5 * np.ptp(values, axis=0).mean()


def test_curves_show_film_and_ideal_film(published, ax):
    plot.parameters(published, ax=ax)
    assert len(ax.lines) == 6
    for film, ideal in zip(ax.lines[::2], ax.lines[1::2], strict=True):
        assert np.corrcoef(film.get_ydata(), ideal.get_ydata())[0, 1] > 0.95


def test_other_figures_are_drawn_on_the_axes_given(published, ax):
    plot.samples(published.tolerance(50, preset="jig"), "z", ax=ax)
    assert sum(patch.get_height() for patch in ax.patches[:50]) == 50
    for draw in (
        lambda: plot.arrows(published, ax=ax, normal="z", at_mm=-4),
        lambda: plot.resolution_map(published, "z", ax=ax, noise_t=5e-6),
        lambda: plot.front(Film.from_dict(SQUARES).front([0.3, 0.4]), ax=ax),
    ):
        assert draw() is ax


def test_new_axes_are_made_without_any(published):
    axes = plot.layout(published)
    assert axes.get_title() == "published film"
    pyplot.close(axes.figure)


@pytest.mark.parametrize("quantity", ["weakening", "turn"])
def test_recoil_maps_have_a_value_for_each_tile(published, ax, quantity):
    film = published.replace(material={"recoil_permeability": 1.05})
    plot.recoil(film, quantity, ax=ax)
    values = ax.collections[0].get_array()
    found = film.recoil
    expected = 100 * found.weakening if quantity == "weakening" else found.angle_deg
    assert np.allclose(np.sort(values), np.sort(expected))
    assert len(ax.collections[0].get_paths()) == 56
    with pytest.raises(magsplice.MagspliceError, match="no tile has a recoil permeability"):
        plot.recoil(published, ax=ax)
