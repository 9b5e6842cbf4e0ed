"""What is special to sinks, bathtubs, their basins, faucets, toilets and showers."""

import numpy as np
import pytest

from remqa_data.assets import Asset, AssetSpec, build
from remqa_data.geometry.types import Box, Vec3

SINKS: list[tuple[Vec3, Box]] = [
    ((0.85, 0.55, 0.25), (-0.345, -0.195, -0.035, 0.345, 0.195, 0.085)),
    ((0.61, 0.99, 0.25), (-0.205, -0.385, -0.115, 0.205, -0.065, 0.085)),
    ((0.73, 0.72, 1.05), (-0.155, -0.16, 0.305, 0.175, 0.16, 0.475)),
    ((0.65, 0.50, 0.14), (-0.335, -0.26, -0.07, 0.335, 0.26, 0.07)),
]
"""Sizes of sinks and the boxes of their basins in iTHOR floor plans 1, 7, 401 and 405."""
BATHTUBS: list[tuple[Vec3, Box]] = [
    ((1.37, 2.45, 0.59), (-0.325, -0.945, -0.285, 0.345, 0.885, 0.135)),
    ((2.53, 1.18, 0.54), (-0.505, -0.38, -0.27, 0.945, 0.36, 0.21)),
    ((0.87, 1.81, 0.83), (-0.225, -0.615, -0.235, 0.225, 0.405, 0.195)),
]
"""The same for the bathtubs of floor plans 401, 406 and 414."""
CASES = [("Sink", *case) for case in SINKS] + [("Bathtub", *case) for case in BATHTUBS]


def points_on(asset: Asset, link: int = 0, openness: float = 0.0) -> np.ndarray:
    """Points spread over the visible surface of a link."""
    rng = np.random.default_rng(0)
    pose = asset.link_poses(openness)[link]
    points = []
    for surface in asset.links[link].surfaces:
        weights = rng.dirichlet((0.7, 0.7, 0.7), (len(surface.faces), 20))
        points.append(np.einsum("fpk,fkd->fpd", weights, surface.vertices[surface.faces].astype(float)).reshape(-1, 3))
    return np.asarray(np.vstack(points) @ pose[:3, :3].T + pose[:3, 3])


def inside(points: np.ndarray, low: np.ndarray, high: np.ndarray) -> bool:
    """Whether any point lies strictly inside a box."""
    return bool(np.any(np.all((points > low) & (points < high), axis=1)))


@pytest.mark.parametrize(("type_", "size", "pocket"), CASES)
@pytest.mark.parametrize("variant", range(4))
def test_the_basin_has_its_place_to_itself(type_: str, size: Vec3, pocket: Box, variant: int) -> None:
    asset = build(AssetSpec(type_, size, variant, pockets=(pocket,)))
    half = np.array(size) / 2 - 0.009 - 0.006  # a basin as large as its sink leaves a rim of a few millimetres
    low = np.maximum(np.array(pocket[:3]) + 0.001, [-half[0], -half[1], -size[2] / 2 + 0.001])
    high = np.minimum(np.array(pocket[3:]) - 0.001, [half[0], half[1], size[2]])
    # Seen from above, the corners of basin and hole are rounded alike: look along the middle cross.
    for axis in (0, 1):
        near, far = low.copy(), high.copy()
        third = (high[axis] - low[axis]) / 2.1
        near[axis] += third
        far[axis] -= third
        assert not inside(points_on(asset), near, far)
    assert asset.links[0].boxes
    for box in asset.links[0].boxes:
        centre, reach = np.array(box.centre), np.array(box.size) / 2
        assert not np.all((centre - reach < high - 1e-3) & (centre + reach > low + 1e-3)), box


@pytest.mark.parametrize(("sink", "basin"), [("Sink", "SinkBasin"), ("Bathtub", "BathtubBasin")])
@pytest.mark.parametrize("seed", range(6))
def test_one_seed_gives_a_sink_and_its_basin_one_material(sink: str, basin: str, seed: int) -> None:
    outer = build(AssetSpec(sink, (0.85, 0.55, 0.25), 0, seed))
    inner = build(AssetSpec(basin, (0.6, 0.4, 0.2), 0, seed))
    assert (outer.color, outer.substance) == (inner.color, inner.substance)


@pytest.mark.parametrize(("type_", "size"), [("SinkBasin", (0.53, 0.35, 0.13)), ("BathtubBasin", (0.9, 1.8, 0.42))])
@pytest.mark.parametrize("level", [None, 0.02])
@pytest.mark.parametrize("variant", range(4))
def test_things_lie_on_the_floor_of_a_basin(type_: str, size: Vec3, level: float | None, variant: int) -> None:
    asset = build(AssetSpec(type_, size, variant, levels=() if level is None else (level,)))
    assert asset.spaces
    for space in asset.spaces:
        x, y, floor = (space.box[0] + space.box[3]) / 2, (space.box[1] + space.box[4]) / 2, space.box[2]
        if level is not None:
            assert floor + size[2] / 2 == pytest.approx(level, abs=1e-4)
        tops = [
            box.centre[2] + box.size[2] / 2
            for box in asset.links[0].boxes
            if abs(x - box.centre[0]) < box.size[0] / 2 and abs(y - box.centre[1]) < box.size[1] / 2
        ]
        assert max(tops) == pytest.approx(floor, abs=1e-3)


@pytest.mark.parametrize("size", [(0.18, 0.2, 0.34), (0.58, 0.26, 0.2), (0.06, 0.34, 0.21), (0.27, 0.37, 0.12)])
@pytest.mark.parametrize("variant", range(4))
def test_a_spout_hangs_free_over_the_front(size: Vec3, variant: int) -> None:
    points = points_on(build(AssetSpec("Faucet", size, variant)))
    front = points[points[:, 1] < -0.4 * size[1]]
    assert len(front)
    assert front[:, 2].min() > -0.35 * size[2]


@pytest.mark.parametrize("size", [(0.53, 0.973, 1.038), (1.12, 1.165, 0.945)])
@pytest.mark.parametrize("variant", range(4))
def test_a_toilet_lid_uncovers_the_bowl_and_leaves_the_cistern_alone(size: Vec3, variant: int) -> None:
    asset = build(AssetSpec("Toilet", size, variant))
    bowl = next(s for s in asset.spaces if s.name == "bowl")
    over_the_bowl = np.array([*bowl.box[:3]]), np.array([*bowl.box[3:5], size[2]])
    assert inside(points_on(asset, 1, 0.0), *over_the_bowl)
    assert not inside(points_on(asset, 1, 1.0), *over_the_bowl)
    assert not inside(points_on(asset, 0), np.array(bowl.box[:3]), np.array(bowl.box[3:]))
    shelf = next(s for s in asset.spaces if s.name in ("cistern", "ledge"))
    for openness in np.linspace(0, 1, 6):
        assert points_on(asset, 1, openness)[:, 1].max() < shelf.box[1] + 0.005


@pytest.mark.parametrize("size", [(0.43, 0.37, 1.94), (0.28, 0.43, 1.75)])
@pytest.mark.parametrize("variant", range(4))
def test_an_open_curtain_is_pushed_aside(size: Vec3, variant: int) -> None:
    asset = build(AssetSpec("ShowerCurtain", size, variant))
    rail = 1 if size[1] > 1.25 * size[0] else 0
    for openness, widest, narrowest in ((0.0, 1.01, 0.9), (1.0, 0.45, 0.2)):
        along = np.concatenate([points_on(asset, i, openness)[:, rail] for i in range(1, len(asset.links))])
        assert narrowest * size[rail] < np.ptp(along) < widest * size[rail]
        assert np.abs(along).max() < size[rail] / 2 + 0.01


@pytest.mark.parametrize("size", [(0.07, 0.81, 1.96), (0.99, 0.05, 2.0)])
@pytest.mark.parametrize("variant", range(4))
def test_a_shower_door_swings_out_of_its_doorway(size: Vec3, variant: int) -> None:
    asset = build(AssetSpec("ShowerDoor", size, variant))
    opened = asset.bounds(1.0)
    wide = 0 if size[0] > size[1] else 1
    assert np.ptp(opened[:, wide]) < 0.25 * size[wide]
    assert np.ptp(opened[:, 1 - wide]) > 0.9 * size[wide]


@pytest.mark.parametrize("variant", range(4))
def test_a_corner_of_shower_glass_encloses_free_room(variant: int) -> None:
    asset = build(AssetSpec("ShowerGlass", (1.2, 1.8, 2.0), variant))
    low, high = np.array([-0.6, -0.8, -1.0]), np.array([0.5, 0.9, 1.0])
    assert not inside(points_on(asset), low, high)
    assert asset.links[0].boxes
    for box in asset.links[0].boxes:
        size = np.abs(np.array(box.size))
        assert min(size[0], size[1]) < 0.06


@pytest.mark.parametrize("size", [(0.53, 0.973, 1.038), (1.12, 1.165, 0.945)])
@pytest.mark.parametrize("variant", range(4))
def test_what_is_in_a_toilet_rests_on_the_bottom_of_its_bowl(size: Vec3, variant: int) -> None:
    """The collision boxes under the space "bowl" end where the space begins, and none reaches into it."""
    asset = build(AssetSpec("Toilet", size, variant))
    bowl = np.array(next(s for s in asset.spaces if s.name == "bowl").box)
    tops = []
    for box in asset.links[0].boxes:
        low, high = np.array(box.centre) - np.array(box.size) / 2, np.array(box.centre) + np.array(box.size) / 2
        if np.all(low[:2] < bowl[3:5]) and np.all(high[:2] > bowl[:2]) and low[2] < bowl[5]:
            tops.append(float(high[2]))
    assert max(tops) == pytest.approx(bowl[2], abs=0.001)
    assert min(bowl[3:5] - bowl[:2]) > 0.14
