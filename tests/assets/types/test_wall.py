"""What is special to windows, pictures, blinds and curtains; that every type fills its box is tested for all types."""

from __future__ import annotations

import numpy as np
import pytest

from remqa_data.assets import AssetSpec, build
from remqa_data.assets.core.model import Asset
from remqa_data.geometry.arithmetic import LENGTH_STEP_M

VARIANTS = range(4)


def slat_heights(asset: Asset, openness: float) -> tuple[float, float]:
    """Lowest and highest point of the moving slats and their bottom rail."""
    poses = asset.link_poses(openness)
    z = np.hstack([s.vertices[:, 2] + poses[i, 2, 3] for i in range(1, len(poses)) for s in asset.links[i].surfaces])
    return float(z.min()), float(z.max())


@pytest.mark.parametrize("variant", VARIANTS)
def test_tall_blinds_open_by_rising_into_a_bundle_below_the_head_rail(variant: int) -> None:
    asset = build(AssetSpec("Blinds", (0.9, 0.03, 1.23), variant))
    assert slat_heights(asset, 0.0)[0] == pytest.approx(-0.615, abs=1e-4)
    low, high = slat_heights(asset, 1.0)
    assert 0.615 - 0.25 < low < high < 0.615


@pytest.mark.parametrize("variant", VARIANTS)
def test_short_blinds_open_by_coming_down_to_about_a_metre(variant: int) -> None:
    asset = build(AssetSpec("Blinds", (1.1, 0.03, 0.196), variant))
    assert slat_heights(asset, 0.0)[0] == pytest.approx(-0.098, abs=1e-4)
    low, high = slat_heights(asset, 1.0)
    assert high < 0.098
    assert 0.8 < high - low < 1.2


@pytest.mark.parametrize("size", [(0.9, 0.03, 1.23), (1.1, 0.03, 0.196)])
@pytest.mark.parametrize("openness", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("variant", VARIANTS)
def test_slats_stay_in_order_and_below_each_other(
    size: tuple[float, float, float], openness: float, variant: int
) -> None:
    asset = build(AssetSpec("Blinds", size, variant))
    poses = asset.link_poses(openness)
    centres = [asset.links[i].boxes[0].centre[2] + poses[i, 2, 3] for i in range(1, len(asset.links))]
    assert len(centres) > 1
    assert np.all(np.diff(centres) < 0)


def surface_of(asset: Asset, texture: str) -> np.ndarray:
    return np.vstack([s.vertices for s in asset.links[0].surfaces if (s.material.texture or "").startswith(texture)])


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("size", [(1.0, 0.11, 1.43), (2.8, 0.04, 0.44), (0.5, 0.07, 2.1), (0.4, 0.28, 0.79)])
def test_the_sky_fills_most_of_a_window_and_lies_behind_its_frame(
    variant: int, size: tuple[float, float, float]
) -> None:
    asset = build(AssetSpec("Window", size, variant))
    sky = surface_of(asset, "sky")
    width, _, height = np.ptp(sky, axis=0)
    assert width * height > 0.6 * size[0] * size[2]
    assert -size[1] / 2 < sky[:, 1].min() < sky[:, 1].max() + 1e-6 < size[1] / 2


def test_a_window_as_deep_as_wide_shows_the_sky_on_three_sides() -> None:
    asset = build(AssetSpec("Window", (2.7, 2.7, 1.2)))
    sky = next(s for s in asset.links[0].surfaces if s.material.texture == "sky")
    facing = {tuple(np.round(normal).astype(int)) for normal in sky.normals}
    assert facing == {(0, -1, 0), (1, 0, 0), (-1, 0, 0)}


@pytest.mark.parametrize("variant", VARIANTS)
def test_wide_curtains_leave_the_window_behind_their_middle_free(variant: int) -> None:
    asset = build(AssetSpec("Curtains", (3.0, 0.15, 2.3), variant))
    cloth = np.vstack([s.vertices for s in asset.links[0].surfaces])
    middle = np.abs(cloth[:, 0]) < 0.5
    assert not np.any(middle & (cloth[:, 2] < 0.8))


@pytest.mark.parametrize("type_", ["Painting", "Poster", "Mirror", "Window"])
def test_a_thin_box_along_y_is_turned_so_that_its_picture_still_faces_the_room(type_: str) -> None:
    texture = {"Painting": "picture", "Poster": "poster", "Mirror": "mirror", "Window": "sky"}[type_]
    picture = np.ptp(surface_of(build(AssetSpec(type_, (0.05, 1.2, 0.9))), texture), axis=0)
    assert picture[1] > 0.7 > picture[0]


def test_a_deep_painting_leans_with_its_top_towards_the_wall() -> None:
    picture = surface_of(build(AssetSpec("Painting", (0.83, 0.23, 0.77), 2)), "picture")
    top, bottom = picture[:, 2].argmax(), picture[:, 2].argmin()
    assert picture[top, 1] - picture[bottom, 1] > 0.15


def test_the_floor_covers_each_rectangle_of_its_footprint_and_gives_space_on_it() -> None:
    footprint = ((-2.0, -2.0, 2.0, 0.0), (-2.0, 0.0, 0.0, 2.0))
    asset = build(AssetSpec("Floor", (4.0, 4.0, 0.05), footprint=footprint))
    assert [space.box[:2] + space.box[3:5] for space in asset.spaces] == [pytest.approx(r) for r in footprint]
    assert all(space.box[2] == pytest.approx(0.025, abs=LENGTH_STEP_M) for space in asset.spaces)
