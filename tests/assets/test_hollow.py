"""What lies under a thing with a hollow is covered by it, and does not hold it up."""

import numpy as np
import pytest

from remqa_data.assets import Asset, AssetSpec, variant_count
from remqa_data.assets.core.hollow import with_hollow
from remqa_data.assets.core.model import CollisionBox, Link
from remqa_data.catalog import catalog
from remqa_data.geometry.rotations import rotation_of
from remqa_data.geometry.types import F64, Vec3
from tests.helpers.typical_assets import typical

TYPES = tuple(name for name, kind in catalog().items() if kind.hollow_m is not None)
CASES = [(name, variant) for name in TYPES for variant in range(variant_count(name))]


def is_in(points: F64, boxes: tuple[CollisionBox, ...]) -> F64:
    """Which points lie inside one of some boxes, by more than 0.1 mm."""
    inside = np.zeros(len(points), dtype=bool)
    for box in boxes:
        local = (points - box.centre) @ rotation_of(box.quaternion)
        inside |= (np.asarray(box.size) / 2 - np.abs(local)).min(axis=1) > 1e-4
    return inside


def corners(boxes: tuple[CollisionBox, ...]) -> F64:
    signs = np.stack(np.meshgrid([-1, 1], [-1, 1], [-1, 1]), axis=-1).reshape(-1, 3)
    return np.vstack([signs * np.array(b.size) / 2 @ rotation_of(b.quaternion).T + b.centre for b in boxes])


@pytest.mark.parametrize(("name", "variant"), CASES)
def test_nothing_solid_reaches_into_the_hollow_and_something_is_above_it(name: str, variant: int) -> None:
    asset = typical(name, variant)
    assert asset.hollow is not None
    low, high = np.array(asset.hollow[:3]), np.array(asset.hollow[3:])
    points = low + (high - low) * np.random.default_rng(0).uniform(0, 1, (4000, 3))
    assert not is_in(points, asset.links[0].boxes).any()
    middle = np.array([*(low + high)[:2] / 2 + (0.011, 0.007), high[2] + 0.002])
    assert is_in(middle[None], asset.links[0].boxes).all()


@pytest.mark.parametrize(("name", "variant"), CASES)
def test_it_stands_on_a_rim_all_around(name: str, variant: int) -> None:
    asset = typical(name, variant)
    assert asset.hollow is not None
    points = corners(asset.links[0].boxes)
    ground = points[points[:, 2] < points[:, 2].min() + 0.003, :2]
    assert (ground.min(axis=0) <= np.array(asset.hollow[:2]) - 0.01).all()
    assert (ground.max(axis=0) >= np.array(asset.hollow[3:5]) + 0.01).all()


@pytest.mark.parametrize(("name", "variant"), CASES)
def test_the_hollow_is_as_deep_as_the_table_says_but_not_deeper_than_a_third_of_it(name: str, variant: int) -> None:
    asset = typical(name, variant)
    depth = catalog()[name].hollow_m
    assert asset.hollow is not None
    assert depth is not None
    assert asset.hollow[5] - asset.hollow[2] == pytest.approx(min(depth, 0.35 * asset.spec.size[2]), abs=1e-4)


def block(size: Vec3, *more: CollisionBox) -> Asset:
    boxes = (CollisionBox((0.0, 0.0, 0.0), size), *more)
    return Asset(AssetSpec("Pillow", size), (Link("base", 0, None, (), boxes),), (), "white", "fabric")


def test_what_is_too_narrow_has_none() -> None:
    asset = block((0.08, 0.3, 0.2))
    assert with_hollow(asset, 0.03) is asset
    assert with_hollow(block((0.3, 0.3, 0.2)), None).hollow is None


def test_a_block_keeps_all_but_the_hollow_by_hand() -> None:
    hollowed = with_hollow(block((0.2, 0.3, 0.2)), 0.05)
    assert hollowed.hollow == pytest.approx((-0.085, -0.135, -0.1, 0.085, 0.135, -0.05))
    left = sum(float(np.prod(box.size)) for box in hollowed.links[0].boxes)
    assert left == pytest.approx(0.2 * 0.3 * 0.2 - 0.17 * 0.27 * 0.05)


def test_the_hollow_stays_clear_of_a_wall_that_stands_askew() -> None:
    sine, cosine = np.sin(np.pi / 8), np.cos(np.pi / 8)
    wall = CollisionBox((0.12, 0.12, 0.0), (0.01, 0.2, 0.2), (0.0, 0.0, float(sine), float(cosine)))
    plain, walled = with_hollow(block((0.3, 0.3, 0.2)), 0.05), with_hollow(block((0.3, 0.3, 0.2), wall), 0.05)
    assert plain.hollow is not None
    assert walled.hollow is not None
    assert walled.hollow[3] < plain.hollow[3]
    assert corners((wall,))[:, 0].min() < plain.hollow[3], "else the wall would not have been in the way"
