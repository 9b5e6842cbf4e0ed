"""Furniture around other assets: pockets stay free, recorded levels are kept, footprints are followed."""

import numpy as np
import pytest

from remqa_data.assets import AssetSpec, build
from remqa_data.assets.core.model import Asset
from remqa_data.assets.looks.seen_colors import MIXED
from remqa_data.assets.parts.carcass import clusters
from remqa_data.geometry.types import Box, Rect, Vec3


def drawers(size: Vec3, rows: int, columns: int) -> tuple[Box, ...]:
    """Drawer boxes as they lie in real furniture: in the front half, a few centimetres from its sides, asset frame."""
    w, d, h = size
    left, low = -w / 2 + 0.04, -h / 2 + 0.05
    width, height = (w - 0.08) / columns, (h - 0.09) / rows
    return tuple(
        (
            left + i * width,
            -d / 2 - 0.01,
            low + j * height,
            left + (i + 1) * width - 0.005,
            0.1 * d,
            low + (j + 1) * height - 0.005,
        )
        for i in range(columns)
        for j in range(rows)
    )


def intrusion(asset: Asset, pocket: Box) -> float:
    """How deep a collision box of the base reaches into a pocket, metres."""
    low, high = np.asarray(pocket[:3]), np.asarray(pocket[3:])
    deepest = 0.0
    for box in asset.links[0].boxes:
        if box.quaternion == (0.0, 0.0, 0.0, 1.0):
            half = np.asarray(box.size) / 2
            overlap = np.minimum(high, box.centre + half) - np.maximum(low, box.centre - half)
            deepest = max(deepest, float(overlap.min()))
    return deepest


@pytest.mark.parametrize("variant", range(4))
@pytest.mark.parametrize("type_", ["Dresser", "SideTable", "TVStand", "CoffeeTable", "Desk"])
def test_drawer_pockets_stay_free(type_: str, variant: int) -> None:
    size = (1.2, 0.5, 0.8)
    pockets = drawers(size, 3, 2)
    asset = build(AssetSpec(type_, size, variant, pockets=pockets))
    assert max(intrusion(asset, pocket) for pocket in pockets) < 0.001


@pytest.mark.parametrize("variant", range(4))
def test_drawers_built_with_the_seed_of_their_dresser_match_it(variant: int) -> None:
    size = (1.2, 0.5, 0.8)
    for seed in range(12):
        dresser = build(AssetSpec("Dresser", size, 0, seed, pockets=drawers(size, 3, 2)))
        drawer = build(AssetSpec("Drawer", (0.5, 0.3, 0.2), variant, seed))
        assert dresser.substance == drawer.substance
        assert drawer.color in {dresser.color, MIXED}  # most of a drawer may be its pale inside


@pytest.mark.parametrize("variant", range(4))
def test_compartments_of_a_shelving_unit_stay_free(variant: int) -> None:
    size = (0.9, 0.3, 1.6)
    pockets = tuple((-0.42, -0.14, z, 0.42, 0.14, z + 0.45) for z in (-0.75, -0.25, 0.25))
    asset = build(AssetSpec("ShelvingUnit", size, variant, pockets=pockets))
    assert max(intrusion(asset, pocket) for pocket in pockets) < 0.006


@pytest.mark.parametrize("variant", range(4))
def test_a_desk_with_a_hutch_keeps_its_surface_at_the_recorded_level(variant: int) -> None:
    asset = build(AssetSpec("Desk", (1.5, 0.6, 1.7), variant, levels=(0.79,)))
    top = next(space for space in asset.spaces if space.name == "top")
    assert top.box[2] == pytest.approx(0.79 - 0.85, abs=0.002)
    assert top.box[5] <= 0.85 + 1e-6


@pytest.mark.parametrize("variant", range(4))
def test_a_shelf_and_a_cabinet_hold_things_at_the_recorded_levels(variant: int) -> None:
    shelf = build(AssetSpec("Shelf", (0.6, 0.3, 0.3), variant, levels=(0.05,)))
    assert shelf.spaces[0].box[2] == pytest.approx(0.05 - 0.15, abs=1e-6)
    cabinet = build(AssetSpec("Cabinet", (0.5, 0.4, 1.0), variant, levels=(0.3, 0.6)))
    bottoms = sorted(space.box[2] + 0.5 for space in cabinet.spaces)
    assert bottoms[1:] == pytest.approx([0.3, 0.6], abs=1e-6)
    assert bottoms[0] < 0.03


L_SHAPE: tuple[Rect, ...] = ((-1.0, -1.0, -0.4, 1.0), (-0.4, 0.4, 1.0, 1.0))
SINK: Box = (0.0, 0.5, -0.2, 0.5, 0.9, 0.05)


@pytest.mark.parametrize("variant", range(4))
def test_a_counter_follows_its_footprint_and_leaves_the_sink_free(variant: int) -> None:
    spec = AssetSpec("CounterTop", (2.0, 2.0, 0.03), variant, footprint=L_SHAPE, pockets=(SINK,))
    asset = build(spec)
    covered = area_from_below(asset)
    legs = 0.6 * 2.0 + 1.4 * 0.6
    assert covered == pytest.approx(legs - 0.5 * 0.4, rel=1e-3)
    assert intrusion(asset, SINK) < 1e-6
    assert asset.spaces
    for space in asset.spaces:
        x, y = (space.box[0] + space.box[3]) / 2, (space.box[1] + space.box[4]) / 2
        assert any(x0 <= x <= x1 and y0 <= y <= y1 for x0, y0, x1, y1 in L_SHAPE)


def area_from_below(asset: Asset) -> float:
    """Area of the faces on the underside, square metres."""
    total = 0.0
    for surface in asset.links[0].surfaces:
        a, b, c = (surface.vertices[surface.faces[:, i]].astype(float) for i in range(3))
        normal = np.cross(b - a, c - a)
        lowest = np.stack([a, b, c])[..., 2].max(axis=0) < -asset.spec.size[2] / 2 + 1e-4
        total -= float(normal[lowest & (normal[:, 2] < 0), 2].sum()) / 2
    return total


@pytest.mark.parametrize("variant", range(4))
# By hand: a floor that was recorded lower lies above the hollow on whose rim the bin stands.
@pytest.mark.parametrize(("recorded", "floor"), [(0.08, 0.08), (0.03, 0.055)])
def test_a_bin_is_empty_down_to_its_floor(variant: int, recorded: float, floor: float) -> None:
    asset = build(AssetSpec("GarbageCan", (0.42, 0.36, 0.54), variant, levels=(recorded,)))
    (space,) = asset.spaces
    assert space.box[2] == pytest.approx(floor - 0.27, abs=0.002)
    assert intrusion(asset, space.box) < 0.001


def test_pockets_are_grouped_into_pedestals_by_the_gaps_between_them() -> None:
    left, right = (-0.7, 0.0, 0.0, -0.4, 0.3, 0.2), (0.4, 0.0, 0.0, 0.7, 0.3, 0.2)
    above_left = (-0.72, 0.0, 0.3, -0.42, 0.3, 0.5)
    assert [len(group) for group in clusters([left, right, above_left])] == [2, 1]
