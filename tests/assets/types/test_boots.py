"""Boots come in pairs."""

import numpy as np
import pytest

from remqa_data.assets import AssetSpec, build


def test_boots_are_a_pair_with_a_gap_between_the_shafts() -> None:
    for variant in range(4):
        asset = build(AssetSpec("Boots", (0.277, 0.220, 0.517), variant))
        points = np.vstack([surface.vertices for surface in asset.links[0].surfaces])
        shafts = points[np.abs(points[:, 2]) < 0.15]
        assert np.abs(shafts[:, 0]).min() > 0.01
        assert (shafts[:, 0] > 0).sum() == pytest.approx((shafts[:, 0] < 0).sum(), abs=4)
