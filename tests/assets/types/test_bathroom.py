"""What is special to towels, paper and other small things of a bathroom."""

from __future__ import annotations

import numpy as np
import pytest

from remqa_data.assets import AssetSpec, build

VARIANTS = range(4)


@pytest.mark.parametrize("variant", VARIANTS)
def test_a_towel_has_room_for_the_bar_of_its_holder(variant: int) -> None:
    # Offsets of a recorded towel to its recorded holder in iTHOR: 6 mm higher, 3 mm behind the holder's front.
    holder = build(AssetSpec("TowelHolder", (0.659, 0.112, 0.042), variant))
    towel = build(AssetSpec("Towel", (0.408, 0.043, 0.592), variant))
    bar = np.vstack([s.vertices for s in holder.links[0].surfaces])
    bar = bar[(np.abs(bar[:, 0]) > 0.3) & (bar[:, 1] < -0.056 + 0.012)]
    assert bar[:, 2].max() == pytest.approx(0.021, abs=2e-3)
    cloth = np.vstack([s.vertices for s in towel.links[0].surfaces])
    cloth += np.array([0.0, -0.053, 0.021 + 0.006 - 0.296], dtype=np.float32)
    above = cloth[(np.abs(cloth[:, 1] + 0.053) < 0.006) & (cloth[:, 2] > 0)]
    assert above[:, 2].min() > 0.006


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("size", [(0.105, 0.105, 0.12), (0.119, 0.104, 0.104), (0.104, 0.119, 0.104)])
def test_a_roll_is_hollow_along_its_longest_side(variant: int, size: tuple[float, float, float]) -> None:
    asset = build(AssetSpec("ToiletPaper", size, variant))
    points = np.vstack([s.vertices for s in asset.links[0].surfaces])
    across = [axis for axis in range(3) if axis != int(np.argmax(size))]
    assert np.hypot(points[:, across[0]], points[:, across[1]]).min() > 0.012


def test_a_thin_roll_is_the_tube_of_one_that_is_used_up() -> None:
    assert build(AssetSpec("ToiletPaper", (0.039, 0.039, 0.122))).substance == "cardboard"
    assert build(AssetSpec("ToiletPaper", (0.105, 0.105, 0.12))).substance == "paper"


@pytest.mark.parametrize("variant", VARIANTS)
def test_the_nozzle_of_a_spray_bottle_is_at_its_front_near_the_top(variant: int) -> None:
    asset = build(AssetSpec("SprayBottle", (0.033, 0.112, 0.245), variant))
    points = np.vstack([s.vertices for s in asset.links[0].surfaces])
    front = points[points[:, 1] < -0.055]
    assert front[:, 2].min() > 0.07


@pytest.mark.parametrize(
    "type_", ["SoapBar", "SprayBottle", "ScrubBrush", "Plunger", "TissueBox", "ToiletPaper", "Cloth"]
)
@pytest.mark.parametrize("variant", VARIANTS)
def test_small_things_rest_on_a_wide_flat_base_inside_their_box(type_: str, variant: int) -> None:
    size = (0.12, 0.12, 0.25) if type_ != "Cloth" else (0.2, 0.18, 0.03)
    boxes = build(AssetSpec(type_, size, variant)).links[0].boxes
    low = np.array([np.array(box.centre) - np.array(box.size) / 2 for box in boxes])
    high = np.array([np.array(box.centre) + np.array(box.size) / 2 for box in boxes])
    assert np.all(low >= -np.array(size) / 2 - 1e-3)
    assert np.all(high <= np.array(size) / 2 + 1e-3)
    base = [box for box, bottom in zip(boxes, low[:, 2], strict=True) if bottom < -size[2] / 2 + 1e-3]
    assert max(min(box.size[0] / size[0], box.size[1] / size[1]) for box in base) > 0.55
