"""Doors, lids and flaps must clear what they belong to, at every openness, in sizes from the floor plans."""

import numpy as np
import pytest

from remqa_data.assets import Asset, AssetSpec, build
from remqa_data.assets.core.model import CollisionBox
from remqa_data.geometry.rotations import rotation_of
from remqa_data.geometry.types import F64, Vec3

SIZES: dict[str, tuple[Vec3, ...]] = {
    "Cabinet": ((0.38, 0.40, 0.66), (0.26, 0.28, 0.36), (1.2, 0.5, 2.2), (0.7, 0.05, 0.6)),
    "Box": ((0.43, 0.42, 0.29), (0.69, 0.26, 0.17), (0.28, 0.55, 0.47)),
    "Safe": ((0.50, 0.56, 0.51), (0.30, 0.34, 0.30)),
    "LaundryHamper": ((0.45, 0.35, 0.60), (0.68, 0.51, 0.90)),
    "Fridge": ((1.0, 0.72, 1.87), (0.77, 0.65, 1.55)),
    "Microwave": ((0.61, 0.36, 0.35), (0.70, 0.40, 0.40)),
    "Toilet": ((0.53, 0.97, 1.04),),
    "ShowerDoor": ((0.81, 0.07, 1.96),),
}
CASES = [(type_, size, variant) for type_, sizes in SIZES.items() for size in sizes for variant in range(4)]
HOLLOW = ("Cabinet", "Box", "Safe", "LaundryHamper")
"""Types of which most is inside."""
TOLERANCE_M = 0.0012
"""Parts may touch; the thinnest collision box, a cardboard flap, is 4 mm thick, so 2 mm is as deep as one can get."""
PER_TRIANGLE = 60


def surface_points(asset: Asset, link: int) -> F64:
    """Points spread over the visible surface of a link."""
    rng = np.random.default_rng(0)
    points = []
    for surface in asset.links[link].surfaces:
        corners = surface.vertices[surface.faces].astype(float)
        weights = rng.dirichlet((0.6, 0.6, 0.6), (len(corners), PER_TRIANGLE))
        points.append(np.einsum("fpk,fkd->fpd", weights, corners).reshape(-1, 3))
    return np.vstack(points)


def deepest(points: F64, boxes: tuple[CollisionBox, ...]) -> float:
    """How deep the deepest of some points is inside one of some boxes, metres."""
    depth = 0.0
    for box in boxes:
        local = (points - box.centre) @ rotation_of(box.quaternion)
        inside = (np.asarray(box.size) / 2 - np.abs(local)).min(axis=1)
        depth = max(depth, float(inside.max()))
    return depth


@pytest.mark.slow
@pytest.mark.parametrize(("type_", "size", "variant"), CASES)
@pytest.mark.parametrize("openness", np.linspace(0.0, 1.0, 8))
def test_moving_parts_cut_neither_the_body_nor_each_other(
    type_: str, size: Vec3, variant: int, openness: float
) -> None:
    asset = build(AssetSpec(type_, size, variant))
    poses = asset.link_poses(openness)
    assert len(asset.links) > 1
    for i in range(1, len(asset.links)):
        points = surface_points(asset, i) @ poses[i, :3, :3].T + poses[i, :3, 3]
        for j, other in enumerate(asset.links):
            if j != i:
                local = (points - poses[j, :3, 3]) @ poses[j, :3, :3]
                assert deepest(local, other.boxes) < TOLERANCE_M, (asset.links[i].name, other.name)


@pytest.mark.parametrize(("size", "variant"), [(size, v) for size in SIZES["Cabinet"] for v in range(4)])
def test_a_cabinet_door_opened_at_a_right_angle_stays_in_front_of_its_own_cabinet(size: Vec3, variant: int) -> None:
    asset = build(AssetSpec("Cabinet", size, variant))
    for openness in np.linspace(0.0, 90.0 / 105.0, 9):
        low, high = asset.bounds(float(openness))
        assert low[0] > -size[0] / 2 - 0.001 - handle_slack(size, openness)
        assert high[0] < size[0] / 2 + 0.001 + handle_slack(size, openness)


def handle_slack(size: Vec3, openness: float) -> float:
    """A handle stands out sideways from a door that is open."""
    return 0.03 if openness > 0.1 else 0.0


@pytest.mark.parametrize(("type_", "size", "variant"), [case for case in CASES if case[0] in HOLLOW])
def test_the_inside_is_hollow_for_physics(type_: str, size: Vec3, variant: int) -> None:
    asset = build(AssetSpec(type_, size, variant))
    assert asset.spaces
    for space in asset.spaces:
        box = np.reshape(space.box, (2, 3))
        assert space.enclosed
        steps = [np.linspace(0.05, 0.95, 6)] * 3
        grid = np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1).reshape(-1, 3)
        assert deepest(box[0] + grid * (box[1] - box[0]), asset.links[0].boxes) < TOLERANCE_M


@pytest.mark.parametrize("variant", range(4))
def test_an_open_drawer_has_moved_out_by_most_of_its_depth_and_carries_its_floor(variant: int) -> None:
    asset = build(AssetSpec("Drawer", (0.4, 0.35, 0.15), variant, levels=(0.03,)))
    assert asset.bounds(1.0)[0, 1] < asset.bounds(0.0)[0, 1] - 0.7 * 0.35
    (space,) = asset.spaces
    assert asset.links[space.link].name == "tray"
    assert space.box[2] == pytest.approx(0.03 - 0.15 / 2, abs=1e-6)
