"""What the verbs of the program give."""

import polars
import pytest


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
