"""Pillows, candles, switches, plants and statues: what is special to each."""

import numpy as np
import pytest

from remqa_data.assets import AssetSpec, build, variant_count
from remqa_data.assets.core.sizes import typical_size
from remqa_data.assets.looks.materials import SOIL
from tests.helpers.typical_assets import vertices


@pytest.mark.parametrize("size", [(0.12, 0.4, 0.4), (0.4, 0.12, 0.4), (0.4, 0.4, 0.12)])
@pytest.mark.parametrize("variant", range(4))
def test_a_pillow_is_thinnest_along_the_shortest_side_of_its_box(
    size: tuple[float, float, float], variant: int
) -> None:
    points = vertices(build(AssetSpec("Pillow", size, variant)))
    thin = int(np.argmin(size))
    others = [axis for axis in range(3) if axis != thin]
    seam = np.abs(points[:, others[0]]) > 0.47 * size[others[0]]
    assert np.abs(points[seam, thin]).max() < 0.6 * size[thin] / 2


@pytest.mark.parametrize("variant", range(4))
def test_a_lying_candle_has_its_wick_at_one_end(variant: int) -> None:
    asset = build(AssetSpec("Candle", (0.17, 0.018, 0.018), variant))
    wick = next(s for link in asset.links for s in link.surfaces if s.material.color == "black")
    assert np.abs(wick.vertices[:, 0]).min() > 0.06


@pytest.mark.parametrize("variant", range(4))
def test_a_light_switch_has_its_whole_plate_against_the_wall(variant: int) -> None:
    size = (0.12, 0.03, 0.15)
    points = vertices(build(AssetSpec("LightSwitch", size, variant)))
    back = points[points[:, 1] > size[1] / 2 - 1e-4]
    assert np.ptp(back[:, 0]) > 0.9 * size[0]
    assert np.ptp(back[:, 2]) > 0.9 * size[2]


@pytest.mark.parametrize("variant", range(4))
@pytest.mark.parametrize("seed", range(3))
def test_a_plant_grows_out_of_the_middle_of_its_pot(variant: int, seed: int) -> None:
    asset = build(AssetSpec("HousePlant", (0.4, 0.3, 0.7), variant, seed))
    organic = [s for link in asset.links for s in link.surfaces if s.material.substance == "organic"]
    soil = next(s for s in organic if s.material.rgb == SOIL.rgb)
    level = float(soil.vertices[:, 2].max())
    points = np.vstack([s.vertices for s in organic if s is not soil])
    stems = points[np.abs(points[:, 2] - level) < 0.03]
    assert np.abs(np.median(stems[:, :2], axis=0)).max() < 0.03


@pytest.mark.parametrize("size", [(0.38, 0.21, 0.15), (0.33, 0.32, 0.21), (0.15, 0.14, 0.59)])
@pytest.mark.parametrize("variant", range(4))
def test_a_statue_stands_on_a_plinth_that_fills_its_box(size: tuple[float, float, float], variant: int) -> None:
    points = vertices(build(AssetSpec("Statue", size, variant)))
    foot = points[points[:, 2] < -0.3 * size[2]]
    assert np.ptp(foot[:, 0]) == pytest.approx(size[0], abs=1e-3)
    assert np.ptp(foot[:, 1]) == pytest.approx(size[1], abs=1e-3)


@pytest.mark.parametrize("type_", ["DeskLamp", "FloorLamp"])
def test_every_lamp_has_a_part_that_shines(type_: str) -> None:
    assert variant_count(type_) > 0
    for variant in range(variant_count(type_)):
        asset = build(AssetSpec(type_, typical_size(type_), variant))
        assert max(s.material.glow for link in asset.links for s in link.surfaces) >= 0.3
