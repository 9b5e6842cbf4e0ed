"""What is special to tableware, cookware, bottles, utensils, food and kitchen supplies."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import numpy.typing as npt
import pytest

from remqa_data.assets import Asset, AssetSpec, build
from remqa_data.assets.core.sizes import typical_size
from remqa_data.geometry.rotations import rotation_of

VARIANTS = range(4)
SEEDS = range(6)
VESSELS = ("Mug", "Cup", "Bowl", "Pot", "Pan", "Plate", "Kettle")
FLAT = ("ButterKnife", "Knife", "Fork", "Spoon", "Ladle", "Spatula", "DishSponge")


def vertices(asset: Asset, link: int = 0) -> npt.NDArray[np.float64]:
    return np.vstack([surface.vertices for surface in asset.links[link].surfaces]).astype(np.float64)


def surface_points(asset: Asset) -> npt.NDArray[np.float64]:
    """Points on the base's triangles, a few millimetres apart."""
    weights = np.array([(i, j, 6 - i - j) for i in range(7) for j in range(7 - i)]) / 6
    corners = [surface.vertices[surface.faces] for surface in asset.links[0].surfaces]
    points: npt.NDArray[np.float64] = np.einsum("wc,fcx->fwx", weights, np.vstack(corners)).reshape(-1, 3)
    return points


def is_solid(asset: Asset, point: npt.NDArray[np.float64]) -> bool:
    boxes = [box for link in asset.links for box in link.boxes]
    local = [rotation_of(box.quaternion).T @ (point - box.centre) for box in boxes]
    return any(np.all(np.abs(p) < np.array(box.size) / 2) for p, box in zip(local, boxes, strict=True))


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("type_", VESSELS)
def test_the_space_of_a_vessel_is_free_and_has_a_floor(type_: str, variant: int) -> None:
    asset = build(AssetSpec(type_, typical_size(type_), variant))
    (space,) = asset.spaces
    low, high = np.array(space.box[:3]), np.array(space.box[3:])
    middle = (low + high) / 2
    for height in np.linspace(low[2] + 2e-3, min(high[2], asset.spec.size[2] / 2) - 0.02, 5):
        if height > low[2]:
            assert not is_solid(asset, np.array([middle[0], middle[1], height]))
    assert is_solid(asset, np.array([middle[0], middle[1], low[2] - 1e-3]))


@pytest.mark.parametrize("type_", ["Mug", "Bowl", "Pot"])
def test_a_recorded_level_is_the_floor_of_a_vessel(type_: str) -> None:
    size = typical_size(type_)
    level = 0.3 * size[2]
    asset = build(AssetSpec(type_, size, levels=(level,)))
    assert asset.spaces[0].box[2] + size[2] / 2 == pytest.approx(level, abs=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("variant", VARIANTS)
def test_the_lid_of_a_kettle_clears_bow_handle_and_spout_while_it_opens(variant: int) -> None:
    asset = build(AssetSpec("Kettle", typical_size("Kettle"), variant))
    lid, body = vertices(asset, 1), surface_points(asset)
    axis = (lid[:, :2].min(axis=0) + lid[:, :2].max(axis=0)) / 2
    radius = np.linalg.norm(lid[:, :2] - axis, axis=1)
    body = body[body[:, 2] > lid[:, 2].min() + 2e-3]  # what stands above the mouth
    assert len(body) or variant == 3  # nothing of which stands above its mouth
    for openness in np.linspace(0, 1, 21):
        pose = asset.link_poses(float(openness))[1]
        seen = (body - pose[:3, 3]) @ pose[:3, :3]  # from the lid's own frame
        away = np.linalg.norm(seen[:, :2] - axis, axis=1)
        for distance, height in zip(away, seen[:, 2], strict=True):
            above = lid[radius > distance - 2e-3, 2]
            assert not (len(above) and lid[:, 2].min() - 2e-3 < height < above.max() + 2e-3), openness


@pytest.mark.parametrize("variant", VARIANTS)
def test_an_open_kettle_shows_its_mouth(variant: int) -> None:
    asset = build(AssetSpec("Kettle", typical_size("Kettle"), variant))
    closed, pose = vertices(asset, 1), asset.link_poses(1.0)[1]
    opened = closed @ pose[:3, :3].T + pose[:3, 3]
    (space,) = asset.spaces
    assert space.enclosed
    assert opened[:, 1].min() > (space.box[1] + space.box[4]) / 2 + 0.01


@pytest.mark.parametrize("variant", VARIANTS)
def test_salt_is_light_and_pepper_is_dark(variant: int) -> None:
    for seed in SEEDS:
        salt, pepper = (
            build(AssetSpec(type_, typical_size(type_), variant, seed)) for type_ in ("SaltShaker", "PepperShaker")
        )
        assert salt.color in ("white", "beige")
        assert pepper.color in ("black", "gray", "brown")


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("type_", FLAT)
def test_flat_things_keep_their_shape_however_they_lie(type_: str, variant: int) -> None:
    size = typical_size(type_)
    usual = build(AssetSpec(type_, size, variant))
    for order in permutations(range(3)):
        turned = build(AssetSpec(type_, tuple(size[i] for i in order), variant))  # type: ignore[arg-type]
        spread = vertices(turned).std(axis=0)
        assert spread == pytest.approx(vertices(usual).std(axis=0)[list(order)], rel=0.02)


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("size", [(0.28, 0.43, 0.049), (0.312, 0.261, 0.049), (0.241, 0.269, 0.041)])
def test_a_pan_has_a_long_handle_even_in_a_square_box(variant: int, size: tuple[float, float, float]) -> None:
    asset = build(AssetSpec("Pan", size, variant))
    (space,) = asset.spaces
    centre = (np.array(space.box[:2]) + np.array(space.box[3:5])) / 2
    reach = np.linalg.norm(vertices(asset)[:, :2] - centre, axis=1)
    rim = vertices(asset)[:, :2] - centre
    opposite = reach[rim @ (vertices(asset)[reach.argmax(), :2] - centre) < 0].max()
    assert reach.max() - opposite > 0.10


@pytest.mark.parametrize("size", [(0.314, 0.314, 0.16), (0.40, 0.313, 0.143), (0.313, 0.40, 0.143)])
def test_a_pot_has_two_equal_handles(size: tuple[float, float, float]) -> None:
    for variant in VARIANTS:
        plan = vertices(build(AssetSpec("Pot", size, variant)))[:, :2]
        rim = 0.97 * min(size[:2]) / 2
        handles = plan[np.linalg.norm(plan, axis=1) > rim + 0.015]
        assert len(handles) > 10
        assert np.abs(handles.mean(axis=0)).max() < 5e-3


def test_an_egg_lies_along_its_longest_side() -> None:
    for axis in range(3):
        size = [0.05, 0.05, 0.05]
        size[axis] = 0.07
        points = vertices(build(AssetSpec("Egg", (size[0], size[1], size[2]))))
        ends = [
            np.linalg.norm(np.delete(points[side * points[:, axis] > 0.02], axis, axis=1), axis=1).mean()
            for side in (-1, 1)
        ]
        assert abs(ends[0] - ends[1]) > 5e-4  # one end is blunt


def test_a_tomato_stands_even_when_it_is_higher_than_wide() -> None:
    asset = build(AssetSpec("Tomato", (0.12, 0.12, 0.145)))
    green = [s for s in asset.links[0].surfaces if s.material.color == "green"]
    assert min(s.vertices[:, 2].min() for s in green) > 0.03
