"""What is special to fridges, microwaves, toasters, coffee machines and stoves."""

import numpy as np
import pytest

from remqa_data.assets import Asset, AssetSpec, build
from remqa_data.assets.core.model import Space
from remqa_data.assets.types.kitchen.stoves import _knob_tilt

LEVELS = ((0.793,), (0.587,), (1.037, 1.258), (0.286,), (0.787, 1.127), (1.575, 1.084), (0.734, 0.898, 1.047))
"""Heights in metres at which things lie in the fridges of some iTHOR kitchens."""


def overlaps(asset: Asset, low: np.ndarray, high: np.ndarray) -> bool:
    """Whether a collision box of the base reaches into a box."""
    for box in asset.links[0].boxes:
        centre, half = np.array(box.centre), np.array(box.size) / 2
        if np.all(centre - half < high - 1e-6) and np.all(centre + half > low + 1e-6):
            return True
    return False


def middle_of(space: Space, size: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Corners of a thing of a size that stands in the middle of a space."""
    low, high = np.array(space.box[:3]), np.array(space.box[3:])
    centre = (low + high) / 2
    half = np.array(size) / 2
    centre[2] = low[2] + half[2] + 0.001
    return centre - half, centre + half


@pytest.mark.parametrize("levels", LEVELS)
@pytest.mark.parametrize("variant", range(4))
def test_a_fridge_has_a_shelf_where_its_recorded_contents_lie(levels: tuple[float, ...], variant: int) -> None:
    asset = build(AssetSpec("Fridge", (1.0, 0.72, 1.9), variant, levels=levels))
    for level in levels:
        above = [other for other in levels if other > level]
        room = min([0.25, *(other - level - 0.02 for other in above)])
        shelves = [s for s in asset.spaces if s.link == 0 and abs(s.box[2] + 0.95 - level) < 0.008]
        assert shelves, level
        assert shelves[0].enclosed
        assert shelves[0].box[5] - shelves[0].box[2] >= room - 0.005, level
        assert not overlaps(asset, *middle_of(shelves[0], (0.2, 0.2, room - 0.01)))


@pytest.mark.parametrize("variant", range(4))
def test_nothing_is_left_out_of_the_fridge_when_its_doors_open(variant: int) -> None:
    asset = build(AssetSpec("Fridge", (1.0, 0.72, 1.9), variant))
    poses = asset.link_poses(1.0)
    assert any("drawer" not in link.name for link in asset.links[1:])
    for link, pose in zip(asset.links[1:], poses[1:], strict=True):
        points = np.vstack([s.vertices for s in link.surfaces]) @ pose[:3, :3].T + pose[:3, 3]
        in_the_opening = (np.abs(points[:, 0]) < 0.4) & (points[:, 1] > -0.24) & (points[:, 1] < 0.3)
        if "drawer" not in link.name:
            assert not in_the_opening.any(), link.name


@pytest.mark.parametrize(("type_", "size"), [("Microwave", (0.61, 0.36, 0.35)), ("Microwave", (0.7, 0.43, 0.4))])
@pytest.mark.parametrize("variant", range(4))
def test_a_plate_and_a_mug_fit_into_a_microwave(type_: str, size: tuple[float, float, float], variant: int) -> None:
    asset = build(AssetSpec(type_, size, variant))
    inside = next(s for s in asset.spaces if s.name == "inside")
    assert inside.enclosed
    assert not overlaps(asset, *middle_of(inside, (0.2, 0.2, 0.15)))


@pytest.mark.parametrize("size", [(0.19, 0.34, 0.2), (0.235, 0.467, 0.248), (0.316, 0.357, 0.172)])
@pytest.mark.parametrize("variant", range(4))
def test_toaster_slots_are_hollow(size: tuple[float, float, float], variant: int) -> None:
    asset = build(AssetSpec("Toaster", size, variant))
    assert len(asset.spaces) == (4 if size[0] > 0.27 else 2)
    for slot in asset.spaces:
        bread = (slot.box[3] - slot.box[0] - 0.002, slot.box[4] - slot.box[1] - 0.002, 0.1)
        assert bread[0] > 0.015
        assert not overlaps(asset, *middle_of(slot, bread))


@pytest.mark.parametrize("size", [(0.295, 0.49, 0.442), (0.44, 0.44, 0.44), (0.54, 0.43, 0.42)])
@pytest.mark.parametrize("level", [0.042, 0.066])
@pytest.mark.parametrize("variant", range(4))
def test_a_mug_stands_under_the_spout_at_the_recorded_height(
    size: tuple[float, float, float], level: float, variant: int
) -> None:
    asset = build(AssetSpec("CoffeeMachine", size, variant, levels=(level,)))
    tray = next(s for s in asset.spaces if s.name == "tray")
    assert tray.box[2] + size[2] / 2 == pytest.approx(level, abs=0.003)
    assert not overlaps(asset, *middle_of(tray, (0.09, 0.09, 0.1)))


@pytest.mark.parametrize("height", [0.004, 0.013, 0.032])
@pytest.mark.parametrize("variant", range(4))
def test_pots_stand_on_top_of_a_burner(height: float, variant: int) -> None:
    asset = build(AssetSpec("StoveBurner", (0.22, 0.22, height), variant))
    top = max(box.centre[2] + box.size[2] / 2 for box in asset.links[0].boxes)
    assert top == pytest.approx(height / 2, abs=1e-6)
    assert asset.spaces[0].box[2] == pytest.approx(height / 2, abs=1e-6)


def test_the_tilt_of_a_knob_is_read_from_its_box() -> None:
    # By hand: a disc 75 mm wide and L long, tilted by 45 degrees, is (0.075 + L) / sqrt(2) deep and high.
    tilt, length = _knob_tilt(0.075, 0.075, 0.075)
    assert tilt == pytest.approx(45, abs=6)
    assert length == pytest.approx(0.031, abs=0.008)
    assert _knob_tilt(0.056, 0.056, 0.026)[0] > 80
    assert _knob_tilt(0.056, 0.026, 0.056)[0] < 10


def fridge_doors(width: float, variant: int, seed: int = 0) -> list[tuple[float, str]]:
    """Where the hinges of a fridge's doors are, and how they turn as seen from above."""
    asset = build(AssetSpec("Fridge", (width, 0.8, 1.8), variant, seed))
    joints = [link.joint for link in asset.links if link.joint is not None and link.joint.kind == "revolute"]
    return sorted((round(joint.origin[0], 2), "left" if joint.axis[2] < 0 else "right") for joint in joints)


@pytest.mark.parametrize("variant", range(4))
def test_a_fridge_of_a_metre_has_two_doors_that_open_away_from_each_other(variant: int) -> None:
    doors = set(fridge_doors(1.0, variant))
    assert {side for _, side in doors} == {"left", "right"}
    assert {x < 0 for x, side in doors if side == "left"} == {True}
    assert max(abs(x) for x, _ in doors) == min(abs(x) for x, _ in doors)


@pytest.mark.parametrize("variant", [0, 1, 3])
def test_the_seed_says_on_which_side_a_single_door_has_its_hinge(variant: int) -> None:
    assert {side for _, side in fridge_doors(0.8, variant, 4)} == {"left"}
    assert {side for _, side in fridge_doors(0.8, variant, 5)} == {"right"}
