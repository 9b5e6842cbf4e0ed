import numpy as np
import pytest

from remqa_data.assets import variant_count
from remqa_data.generators.figures import asset_sheets
from remqa_data.generators.figures.asset_sheets import BAND_PX, GROUND, TILE_PX, sheet


@pytest.fixture(autouse=True)
def black_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Instead of drawn ones."""
    monkeypatch.setattr(asset_sheets, "picture", lambda *asked: np.zeros((TILE_PX, TILE_PX, 3), np.uint8))


@pytest.mark.parametrize("columns", [1, 3, 4, 6])
def test_variants_that_have_no_column_go_below(columns: int) -> None:
    pictures = max(columns, variant_count("Mug"))
    lines = -(-pictures // columns)
    made = sheet("Mug", columns)
    assert made.shape == (BAND_PX + lines * (BAND_PX + TILE_PX), columns * TILE_PX, 3)
    middles = made[2 * BAND_PX + TILE_PX // 2 :: BAND_PX + TILE_PX, TILE_PX // 2 :: TILE_PX, 0]
    shown = [0] * pictures + [GROUND] * (lines * columns - pictures)
    assert middles.ravel().tolist() == shown


def test_what_opens_is_shown_three_times_below_each_other() -> None:
    assert sheet("Laptop", 2).shape[0] == BAND_PX + -(-variant_count("Laptop") // 2) * (BAND_PX + 3 * TILE_PX)
