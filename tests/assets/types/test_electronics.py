"""Laptops open without cutting through themselves, and come out as large as a recorded open one."""

import numpy as np
import pytest

from remqa_data.assets import Asset, AssetSpec, build
from remqa_data.assets.types.small.electronics import closed_laptop_size

SIZES = ((0.325, 0.25, 0.018), (0.40, 0.283, 0.022), (0.505, 0.37, 0.030))


def link_points(asset: Asset, link: int, openness: float) -> np.ndarray:
    pose = asset.link_poses(openness)[link]
    points = np.vstack([surface.vertices for surface in asset.links[link].surfaces])
    return points @ pose[:3, :3].T + pose[:3, 3]


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("variant", range(4))
def test_lid_of_a_laptop_never_cuts_the_base_or_the_table(size: tuple[float, float, float], variant: int) -> None:
    asset = build(AssetSpec("Laptop", size, variant))
    base = max(asset.links[0].boxes, key=lambda box: box.size[0] * box.size[1])
    for openness in np.linspace(0, 1, 11):
        points = link_points(asset, 1, float(openness))
        inside = np.abs(points - base.centre) < np.array(base.size) / 2 - 2e-4
        assert not inside.all(axis=1).any(), openness
        assert points[:, 2].min() > -size[2] / 2


# Width, depth and height of open laptops as recorded in iTHOR: a small, a median and a large one.
@pytest.mark.parametrize("opened", [(0.325, 0.271, 0.281), (0.399, 0.298, 0.298), (0.505, 0.363, 0.372)])
def test_laptop_open_is_as_large_as_recorded(opened: tuple[float, float, float]) -> None:
    asset = build(AssetSpec("Laptop", closed_laptop_size(opened), 0))
    low, high = asset.bounds(1.0)
    assert high - low == pytest.approx(opened, abs=0.012)


def test_screen_of_a_laptop_faces_the_front_when_open() -> None:
    asset = build(AssetSpec("Laptop", (0.40, 0.283, 0.022), 0))
    pose = asset.link_poses(1.0)[1]
    screen = max(
        (s for s in asset.links[1].surfaces if len(s.faces) == 2),
        key=lambda s: float(np.ptp(s.vertices, axis=0).prod()),
    )
    normal = pose[:3, :3] @ screen.normals[0]
    assert normal[1] < -0.99


def test_thin_television_has_no_foot() -> None:
    for variant in range(4):
        asset = build(AssetSpec("Television", (1.28, 0.08, 0.80), variant))
        points = link_points(asset, 0, 0.0)
        bottom = points[points[:, 2] < -0.38]
        assert np.ptp(bottom[:, 0]) > 1.2, variant
