"""Bats and rackets follow the box they are given, whether they stand or lie."""

import itertools

import numpy as np
import pytest

from remqa_data.assets import AssetSpec, build
from tests.helpers.typical_assets import vertices


@pytest.mark.parametrize("type_", ["BaseballBat", "Dumbbell", "TennisRacket"])
@pytest.mark.parametrize("order", list(itertools.permutations(range(3))))
def test_long_things_lie_along_the_longest_side_of_their_box(type_: str, order: tuple[int, ...]) -> None:
    upright = {
        "BaseballBat": (0.081, 0.089, 0.959),
        "Dumbbell": (0.132, 0.132, 0.331),
        "TennisRacket": (0.256, 0.044, 0.653),
    }
    size = tuple(upright[type_][i] for i in order)
    for variant in range(4):
        asset = build(AssetSpec(type_, size, variant))
        low, high = asset.bounds()
        assert high - low == pytest.approx(size, abs=1e-4)


def test_standing_bat_has_its_thick_end_below() -> None:
    for variant in range(4):
        points = vertices(build(AssetSpec("BaseballBat", (0.081, 0.089, 0.959), variant)))
        lower = points[points[:, 2] < -0.15]
        upper = points[(points[:, 2] > 0.2) & (points[:, 2] < 0.42)]
        assert np.ptp(lower[:, 0]) > 2 * np.ptp(upper[:, 0])
