"""What holds for every object type: it fills its box, its variants differ, it is lit from outside and can be simulated."""

import re
from collections import defaultdict
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from remqa_data.assets import TYPES, AssetSpec, build, registry, variant_count
from remqa_data.assets.core.sizes import typical_size
from remqa_data.assets.registry import KINDS, MODULES, merged_kinds
from remqa_data.catalog import catalog, object_type
from remqa_data.errors import AssetError
from remqa_data.floorplans.ithor.table import recorded_objects, scene_names
from remqa_data.generators.figures.asset_sheets import picture
from tests.helpers.typical_assets import typical

FILL_M = 1e-3
VISIBLE_CHANGE = 3.0
"""Mean change in colour, of 255, over the pixels that show either of two variants."""
HOLDERS = {"TowelHolder", "HandTowelHolder", "ToiletPaperHanger"}
"""What these hold hangs beside them."""
MAX_TRIANGLES = 3000
SIZES_PER_TYPE = 12
Sizes = dict[str, list[tuple[float, float, float]]]


@pytest.fixture(scope="module")
def sizes() -> tuple[Sizes, Sizes]:
    """Recorded sizes of each type: the extremes along each axis, and a spread in between."""
    recorded: dict[str, list[np.ndarray]] = defaultdict(list)
    for scene in scene_names():
        for o in recorded_objects(scene):
            if o.size.min() > 0.004 or o.pickupable:
                recorded[o.type].append(o.size)
    extreme, between = {}, {}
    for type_, found in recorded.items():
        array = np.array(found)
        rows = {int(f(array[:, axis])) for axis in range(3) for f in (np.argmin, np.argmax)}
        others = set(np.linspace(0, len(array) - 1, SIZES_PER_TYPE).astype(int).tolist()) - rows
        extreme[type_], between[type_] = ([tuple(map(float, array[row])) for row in sorted(r)] for r in (rows, others))
    # A laptop and a box are recorded open; closed they are flat, and as wide and deep as recorded.
    for chosen in (extreme, between):
        chosen["Laptop"] = [(w, d, 0.055 * w) for w, d, _ in chosen["Laptop"]]
    for type_ in set(TYPES) - set(extreme):  # no floor plan has one
        w, d, h = typical_size(type_)
        extreme[type_] = [(a * w, b * d, c * h) for a in (0.7, 1.4) for b in (0.7, 1.4) for c in (0.7, 1.4)]
        between[type_] = [(w, b * d, c * h) for b in (0.7, 1.4) for c in (0.7, 1.4)]
    return extreme, between


def test_every_recorded_type_is_drawn() -> None:
    assert set(TYPES) == set(catalog())


@pytest.mark.slow
@pytest.mark.parametrize("type_", TYPES)
def test_fills_its_box_in_extreme_sizes_and_all_variants(type_: str, sizes: tuple[Sizes, Sizes]) -> None:
    assert sizes[0][type_]
    check_that_it_fills(type_, sizes[0][type_])


@pytest.mark.slow
@pytest.mark.parametrize("type_", TYPES)
def test_fills_its_box_in_all_sizes_and_variants(type_: str, sizes: tuple[Sizes, Sizes]) -> None:
    check_that_it_fills(type_, sizes[1][type_])


def check_that_it_fills(type_: str, sizes: list[tuple[float, float, float]]) -> None:
    assert variant_count(type_) > 0
    for size in sizes:
        for variant in range(variant_count(type_)):
            asset = build(AssetSpec(type_, size, variant, seed=variant))
            low, high = asset.bounds()
            half = np.array(size) / 2
            assert np.abs(high - half).max() < FILL_M, (size, variant)
            assert np.abs(low + half).max() < FILL_M, (size, variant)


@pytest.mark.slow
@pytest.mark.parametrize("type_", TYPES)
def test_has_four_variants_that_look_different(type_: str) -> None:
    count = variant_count(type_)
    assert count >= 4
    pictures = [picture(typical(type_, variant, seed=variant), size_px=96).astype(float) for variant in range(count)]
    for i, first in enumerate(pictures):
        for second in pictures[:i]:
            shown = (first.min(axis=2) < 245) | (second.min(axis=2) < 245)
            assert np.abs(first - second).mean(axis=2)[shown].mean() > VISIBLE_CHANGE


@pytest.mark.slow
@pytest.mark.parametrize("type_", TYPES)
def test_meshes_are_sound(type_: str) -> None:
    assert variant_count(type_) > 0
    for variant in range(variant_count(type_)):
        asset = typical(type_, variant)
        assert asset.triangle_count <= MAX_TRIANGLES
        assert any(link.surfaces for link in asset.links)
        for link in asset.links:
            for surface in link.surfaces:
                assert np.isfinite(surface.vertices).all()
                assert np.isfinite(surface.uv).all()
                lengths = np.linalg.norm(surface.normals, axis=1)
                assert np.abs(lengths - 1).max() < 1e-3, surface.material
                assert surface.faces.min() >= 0
                assert surface.faces.max() < len(surface.vertices)


@pytest.mark.slow
@pytest.mark.parametrize("type_", TYPES)
def test_joints_follow_the_catalog(type_: str) -> None:
    assert variant_count(type_) > 0
    for variant in range(variant_count(type_)):
        asset = typical(type_, variant)
        assert asset.is_openable == object_type(type_).openable
        if asset.is_openable:
            moved = np.abs(asset.link_poses(1.0) - asset.link_poses(0.0)).max()
            assert moved > 0.01
            assert np.array_equal(asset.link_poses(0.0), np.tile(np.eye(4), (len(asset.links), 1, 1)))


@pytest.mark.parametrize("type_", [t for t in TYPES if object_type(t).receptacle and t not in HOLDERS])
def test_receptacles_have_room_inside_their_box(type_: str) -> None:
    assert variant_count(type_) > 0
    for variant in range(variant_count(type_)):
        asset = typical(type_, variant)
        assert asset.spaces, variant
        half = np.array(asset.spec.size) / 2 + 1e-6
        for space in asset.spaces:
            assert np.all(np.array(space.box[:2]) >= -half[:2] - 0.01), space
            assert np.all(np.array(space.box[3:5]) <= half[:2] + 0.01), space
            assert space.box[2] >= -half[2] - 1e-3, space
            assert np.all(np.array(space.box[3:]) > np.array(space.box[:3])), space


@pytest.mark.parametrize("type_", [t for t in TYPES if object_type(t).pickupable])
def test_collision_boxes_stay_in_the_box_and_reach_the_ground(type_: str) -> None:
    assert variant_count(type_) > 0
    for variant in range(variant_count(type_)):
        asset = typical(type_, variant)
        half = np.array(asset.spec.size) / 2
        lowest = np.inf
        for link in asset.links:
            for box in link.boxes:
                reach = np.array(box.size) / 2
                if box.quaternion == (0.0, 0.0, 0.0, 1.0):
                    assert np.all(np.abs(box.centre) + reach <= half * 1.02 + 2e-3), (variant, box)
                    lowest = min(lowest, box.centre[2] - reach[2])
        assert lowest < np.inf, f"variant {variant} has no box that stands upright and collides: draw one with b.solid"
        assert lowest == pytest.approx(-half[2], abs=2e-3), variant


def test_words_come_with_every_asset() -> None:
    for type_ in TYPES:
        asset = typical(type_, 0)
        assert asset.color
        assert asset.substance


def test_the_same_spec_gives_the_same_mesh() -> None:
    for type_ in ("Sofa", "HousePlant", "Drawer"):
        spec = AssetSpec(type_, typical_size(type_), 1, 7)
        first, again = build(spec), build.__wrapped__(spec)
        assert any(link.surfaces for link in first.links)
        for a, b in zip(first.links, again.links, strict=True):
            for s, t in zip(a.surfaces, b.surfaces, strict=True):
                assert np.array_equal(s.vertices, t.vertices)
                assert s.material == t.material


def test_a_type_that_two_modules_draw_is_an_error() -> None:
    first, second = ModuleType("shelves"), ModuleType("cupboards")
    first.KINDS = {"Shelf": KINDS["Shelf"]}  # type: ignore[attr-defined]
    second.KINDS = {"Cabinet": KINDS["Cabinet"], "Shelf": KINDS["Shelf"]}  # type: ignore[attr-defined]
    with pytest.raises(AssetError, match="Shelf is drawn by shelves and by cupboards"):
        merged_kinds([first, second])


def test_every_module_of_object_types_is_registered() -> None:
    types = Path(registry.__file__).with_name("types")
    announcing = {path for path in types.rglob("*.py") if re.search(r"^KINDS\b", path.read_text(), re.MULTILINE)}
    assert announcing == {Path(str(module.__file__)) for module in MODULES}
