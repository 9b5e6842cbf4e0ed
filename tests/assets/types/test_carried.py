"""Small flat things also stand on edge or lie across, as recorded."""

import numpy as np
import pytest

from remqa_data.assets import AssetSpec, build


@pytest.mark.parametrize(
    ("size", "axis"), [((0.105, 0.105, 0.004), 2), ((0.004, 0.105, 0.105), 0), ((0.105, 0.004, 0.105), 1)]
)
def test_disc_lies_in_the_plane_of_its_box(size: tuple[float, float, float], axis: int) -> None:
    asset = build(AssetSpec("CD", size, 0))
    picture = next(s for s in asset.links[0].surfaces if s.material.texture == "cd")
    assert np.abs(picture.normals[:, axis]).min() > 0.99


@pytest.mark.parametrize("type_", ["CreditCard", "KeyChain"])
def test_quarter_turn_swaps_width_and_depth_only(type_: str) -> None:
    width, depth, height = {"CreditCard": (0.086, 0.054, 0.005), "KeyChain": (0.131, 0.073, 0.008)}[type_]
    for variant in range(4):
        along_x = build(AssetSpec(type_, (width, depth, height), variant))
        along_y = build(AssetSpec(type_, (depth, width, height), variant))
        assert along_x.triangle_count == along_y.triangle_count > 0
        for a, b in zip(along_x.links[0].surfaces, along_y.links[0].surfaces, strict=True):
            assert np.stack([-a.vertices[:, 1], a.vertices[:, 0]], 1) == pytest.approx(b.vertices[:, :2], abs=1e-6)
