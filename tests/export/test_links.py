import numpy as np
import pytest

from remqa_data.assets.core.model import CollisionBox, Joint
from remqa_data.catalog import object_type
from remqa_data.export.links import holding_friction, inertia_of, inertias, joint_range, link_origins, relative_poses
from tests.helpers.typical_assets import typical

HALF = np.sqrt(0.5)


def test_a_box_has_the_moments_of_the_textbook() -> None:
    """m / 12 (b^2 + c^2), and so on."""
    found = inertia_of((CollisionBox((1.0, 0.0, 0.0), (1.0, 2.0, 3.0)),), density=2.0)
    assert found.mass_kg == pytest.approx(12.0)
    assert found.centre == pytest.approx([1.0, 0.0, 0.0])
    assert found.about_centre == pytest.approx(np.diag([13.0, 10.0, 5.0]))


def test_a_turned_box_has_its_moments_turned() -> None:
    upright = CollisionBox((0.0, 0.0, 0.0), (1.0, 2.0, 3.0), (0.0, 0.0, HALF, HALF))  # a quarter about z
    assert inertia_of((upright,), density=2.0).about_centre == pytest.approx(np.diag([10.0, 13.0, 5.0]))


def test_two_boxes_have_the_moments_that_steiner_gives() -> None:
    """Two cubes of 1 kg and 1 m, 2 m apart: each adds 1/6, and 1 kg at 1 m about the axes across."""
    cubes = tuple(CollisionBox((x, 0.0, 0.0), (1.0, 1.0, 1.0)) for x in (-1.0, 1.0))
    assert inertia_of(cubes, density=1.0).about_centre == pytest.approx(np.diag([1 / 3, 1 / 3 + 2, 1 / 3 + 2]))


@pytest.mark.parametrize("type_", ["Mug", "Box", "Laptop", "Chair"])
def test_the_links_together_weigh_what_the_catalog_says(type_) -> None:
    assert sum(part.mass_kg for part in inertias(typical(type_))) == pytest.approx(object_type(type_).mass_kg)


@pytest.mark.parametrize("type_", ["Fridge", "Drawer", "Cabinet", "ShowerCurtain", "Blinds"])
def test_what_is_built_in_has_masses_and_moments_that_physics_takes(type_) -> None:
    parts = inertias(typical(type_))
    assert parts
    for part in parts:
        moments = np.linalg.eigvalsh(part.about_centre)
        assert 0 < part.mass_kg < 200
        assert moments[0] > 0
        assert moments[2] <= moments[0] + moments[1] + 1e-12  # of any rigid body


@pytest.mark.parametrize("type_", ["Fridge", "Drawer", "Laptop"])
@pytest.mark.parametrize("openness", [0.0, 0.4, 1.0])
def test_frames_on_the_joints_put_every_point_where_the_asset_does(type_, openness) -> None:
    thing = typical(type_)
    frames: list[np.ndarray] = []
    for link, pose in zip(thing.links, relative_poses(thing, openness), strict=True):
        frames.append(pose if link.joint is None else frames[link.parent] @ pose)
    assert len(frames) > 1
    for frame, pose, origin in zip(frames, thing.link_poses(openness), link_origins(thing), strict=True):
        x, y, z = origin
        assert frame @ [0.1, 0.2, 0.3, 1.0] == pytest.approx(pose @ [x + 0.1, y + 0.2, z + 0.3, 1.0])


def test_a_joint_goes_as_far_as_the_object_opens_where_it_stands() -> None:
    slide = Joint("prismatic", (0.0, -1.0, 0.0), (0.0, 0.0, 0.0), 0.4)
    assert joint_range(slide, 0.5) == (0.0, 0.2)
    assert joint_range(Joint("revolute", (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), -1.5), 1.0) == (-1.5, 0.0)


def test_a_lid_needs_more_than_its_weight_times_its_lever_to_stay_up_and_a_door_less() -> None:
    lid = inertia_of((CollisionBox((0.5, 0.0, 0.0), (1.0, 1.0, 0.01)),), density=100.0)  # 1 kg, half a metre out
    hinge = Joint("revolute", (0.0, 1.0, 0.0), (0.0, 0.0, 0.0), 1.5)
    needed = 1.0 * 9.81 * 0.5
    assert holding_friction(hinge, lid, np.eye(3)) > needed
    on_its_side = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # the hinge stands upright
    assert 0 < holding_friction(hinge, lid, on_its_side) < needed / 2
