"""Seats, mattresses and cushions lie where the recorded contents rest, and there is room above them."""

import numpy as np
import pytest

from remqa_data.assets import Asset, AssetSpec, build, variant_count
from remqa_data.assets.core.sizes import typical_size
from remqa_data.geometry.rotations import rotation_of

SEATS = {"ArmChair": 0.45, "Bed": 0.55, "Chair": 0.44, "DogBed": 0.09, "Sofa": 0.46}
"""Heights above the floor in metres, chosen inside what the floor plans record."""
DEEP_SOFA = (2.7, 1.7, 0.9)


def variants(*types: str) -> list[tuple[str, int]]:
    return [(type_, variant) for type_ in types for variant in range(variant_count(type_))]


def seen_height(asset: Asset, x: float, y: float) -> float:
    """Height of the topmost visible point of an asset above its bottom at a place."""
    highest = -np.inf
    for link in asset.links:
        for surface in link.surfaces:
            a, b, c = (surface.vertices[surface.faces[:, i]].astype(float) for i in range(3))
            area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (c[:, 0] - a[:, 0]) * (b[:, 1] - a[:, 1])
            with np.errstate(divide="ignore", invalid="ignore"):
                u = ((b[:, 0] - x) * (c[:, 1] - y) - (c[:, 0] - x) * (b[:, 1] - y)) / area
                v = ((c[:, 0] - x) * (a[:, 1] - y) - (a[:, 0] - x) * (c[:, 1] - y)) / area
                w = 1 - u - v
                hit = (u >= 0) & (v >= 0) & (w >= 0) & (np.abs(area) > 1e-12)
                z = u * a[:, 2] + v * b[:, 2] + w * c[:, 2]
            if hit.any():
                highest = max(highest, float(z[hit].max()))
    return highest + asset.spec.size[2] / 2


def resting_height(asset: Asset, x: float, y: float) -> float:
    """Height of the topmost collision box above the bottom at a place."""
    tops = [
        box.centre[2] + box.size[2] / 2
        for link in asset.links
        for box in link.boxes
        if box.quaternion == (0.0, 0.0, 0.0, 1.0)
        and abs(box.centre[0] - x) < box.size[0] / 2
        and abs(box.centre[1] - y) < box.size[1] / 2
    ]
    return max(tops) + asset.spec.size[2] / 2


FLAT = {("DogBed", 2)}
"""A mat has no hollow: its level is its top."""


@pytest.mark.parametrize(("type_", "variant"), [pair for pair in variants(*SEATS) if pair not in FLAT])
def test_a_seat_is_drawn_and_solid_at_its_recorded_level(type_: str, variant: int) -> None:
    level = SEATS[type_]
    asset = build(AssetSpec(type_, typical_size(type_), variant, levels=(level,)))
    space = asset.spaces[0]
    bottom = space.box[2] + asset.spec.size[2] / 2
    assert bottom == pytest.approx(level, abs=0.012)
    x, y = (space.box[0] + space.box[3]) / 2, (space.box[1] + space.box[4]) / 2
    assert resting_height(asset, x, y) == pytest.approx(level, abs=0.012)
    assert seen_height(asset, x, y) == pytest.approx(level, abs=0.03)


@pytest.mark.parametrize(("type_", "variant"), variants("Footstool", "Ottoman", "Stool"))
def test_stools_are_sat_on_at_their_top(type_: str, variant: int) -> None:
    asset = build(AssetSpec(type_, typical_size(type_), variant))
    height = asset.spec.size[2]
    assert asset.spaces[0].box[2] == pytest.approx(height / 2, abs=2e-3)
    assert resting_height(asset, 0.0, 0.0) == pytest.approx(height, abs=2e-3)
    assert seen_height(asset, 0.0, 0.0) == pytest.approx(height, abs=5e-3)


@pytest.mark.parametrize(("type_", "variant"), variants("ArmChair", "Bed", "Sofa"))
def test_no_part_stands_in_the_room_above_a_seat(type_: str, variant: int) -> None:
    asset = build(AssetSpec(type_, typical_size(type_), variant))
    assert asset.spaces
    assert any(link.boxes for link in asset.links)
    for space in asset.spaces:
        low, high = np.array(space.box[:3]), np.array(space.box[3:])
        low[2] += 0.03
        for link in asset.links:
            for box in link.boxes:
                centre, half = np.array(box.centre), np.abs(rotation_of(box.quaternion)) @ np.array(box.size) / 2
                overlap = np.minimum(high, centre + half) - np.maximum(low, centre - half)
                assert overlap.min() < 0.03, (space.name, box)


@pytest.mark.parametrize("variant", range(4))
def test_a_deep_sofa_is_l_shaped_and_leaves_its_corner_free(variant: int) -> None:
    asset = build(AssetSpec("Sofa", DEEP_SOFA, variant))
    names = {space.name for space in asset.spaces}
    assert names == {"seat", "chaise"}
    chaise = next(space for space in asset.spaces if space.name == "chaise")
    free_x = -0.35 * DEEP_SOFA[0] * np.sign(chaise.box[0] + chaise.box[3])
    assert seen_height(asset, free_x, -0.45 * DEEP_SOFA[1]) == -np.inf


@pytest.mark.parametrize("variant", range(4))
def test_a_loft_bed_stands_on_posts_with_room_beneath(variant: int) -> None:
    asset = build(AssetSpec("Bed", (1.2, 2.0, 1.9), variant, levels=(1.6,)))
    assert any(link.boxes for link in asset.links)
    for link in asset.links:
        for box in link.boxes:
            inside = abs(box.centre[0]) + box.size[0] / 2 < 0.5 and abs(box.centre[1]) + box.size[1] / 2 < 0.9
            assert not inside or box.centre[2] > 0, box


@pytest.mark.parametrize("variant", range(4))
def test_a_canopy_bed_keeps_its_headboard_low(variant: int) -> None:
    asset = build(AssetSpec("Bed", (1.9, 2.2, 2.3), variant, levels=(0.86,)))
    wide = [b for link in asset.links for b in link.boxes if b.size[0] > 1.5 and b.size[2] > 0.1]
    assert max(b.centre[2] + b.size[2] / 2 for b in wide) + 1.15 < 1.6
