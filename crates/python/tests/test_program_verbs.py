"""What the verbs `experiment`, `tiles`, `export` and `report` give, and figures."""

import numpy as np
import polars
import pytest

import magsplice

#: 1 N/mm in shear and 2 N/mm normal to the film.
LAYER = {"area_mm2": 1, "thickness_mm": 1, "youngs_modulus_mpa": 2, "poisson_ratio": 0}


def test_experiments_find_the_displacement(published):
    found = published.replace(elastomer=LAYER).experiment()
    assert found.film_mm.shape == (found.readings, 3)
    np.testing.assert_allclose(found.found_mm, found.film_mm, atol=1e-6)
    np.testing.assert_allclose(found.force_n, found.film_mm * (1, 1, 2), atol=1e-12)
    assert not found.saturated.any()
    table = polars.DataFrame(found)
    assert table.columns[:4] == ["step", "film_dx_mm", "film_dy_mm", "film_dz_mm"]
    assert table["bx_t"].to_list() == found.readings_t[:, 0].tolist()
    bare = published.experiment(1.0)
    assert bare.force_n is None
    assert bare.readings < found.readings
    turned = published.experiment(1.0, rotation_deg=(0, 1, 0), bend_radius_mm=100)
    assert not np.allclose(turned.readings_t, bare.readings_t, rtol=1e-3)
    flat = published.experiment(1.0, heights_mm=[[x, y, 0] for x in (-20, 20) for y in (-20, 20)])
    np.testing.assert_allclose(flat.readings_t, bare.readings_t, rtol=1e-9)


def test_experiments_refuse_impossible_films(published):
    with pytest.raises(magsplice.MagspliceError, match="no noise"):
        published.experiment(seed=1)
    noisy = published.replace(sensor={"noise_ut": 5.0})
    one, again = (noisy.experiment(seed=1) for _ in range(2))
    assert one == again
    assert one != noisy.experiment(seed=2)
    with pytest.raises(ValueError, match="impossible"):
        published.experiment(bend_radius_mm=0.1)
    with pytest.raises(ValueError, match="both given"):
        published.experiment(bend_radius_mm=100, heights_mm=[[0, 0, 0]])
    with pytest.raises(ValueError, match="bend_along = 'z', must be one of"):
        published.experiment(bend_radius_mm=100, bend_along="z")
    with pytest.raises(magsplice.MagspliceError, match="each must be above 0"):
        published.experiment(0.0)


def test_bills_of_materials_count_pieces(published):
    bill = published.parts()
    assert [part.count for part in bill.parts] == [16, 24, 16]
    assert bill.parts[0].size_mm == (3.3, 3.3, 1.0)
    assert bill.parts[0].sheet_area_mm2 is None
    assert sum(len(part.tiles) for part in bill.parts) == len(published)
    with_kerf = published.parts(kerf_mm=0.2)
    assert with_kerf.parts[0].sheet_area_mm2 == pytest.approx(16 * 3.5**2)
    assert "sheet_area_mm2" in with_kerf.columns()
    assert polars.DataFrame(bill)["count"].to_list() == [16, 24, 16]
    with pytest.raises(ValueError, match="kerf_mm = -1, must be a number of mm from 0 to 100"):
        published.parts(kerf_mm=-1)


def test_headers_are_for_firmware(published):
    header = published.c_header()
    assert published.sha256 in header
    assert "#include <math.h>" in header
    with pytest.raises(ValueError, match="error_mm = 0, must be above 0"):
        published.c_header(0)
    with pytest.raises(magsplice.MagspliceError, match=r"no \[volume\]"):
        published.replace(volume=None, design=None, expect=None).c_header()


def test_figures_need_no_matplotlib(published):
    layout = published.plot()
    assert layout._repr_svg_().startswith("<")
    assert layout._repr_png_() == layout.png
    assert layout.png.startswith(b"\x89PNG")
    assert layout.name == "layout"
    bare = magsplice.Film(published.tiles, name="bare")
    with pytest.raises(ValueError, match="figure = 'picture', must be one of \"layout\""):
        bare.plot("picture")
