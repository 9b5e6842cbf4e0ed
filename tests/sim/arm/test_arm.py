import math

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from remqa_data.assets.core.model import AssetSpec
from remqa_data.errors import ActionError, UnknownNameError
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.geometry.rotations import quaternion_of, rotation_of
from remqa_data.geometry.types import F64
from remqa_data.scene import SceneObject
from remqa_data.sim.arm import jaco
from remqa_data.sim.arm.arm import HOME, Arm, ArmBase, ArmState
from remqa_data.sim.arm.obstacles import Boxes, Obstacles, depth, first_push
from remqa_data.sim.arm.postures import BALL_RADII_M, balls, link_poses
from remqa_data.sim.arm.targets import best_shoulders
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.navigation.grid import reach_distance
from remqa_data.sim.physics.bullet import BulletClient, pybullet
from remqa_data.sim.physics.world import Snapshot, World
from tests.helpers.bare_rooms import first_of, mug, room

BASE = ArmBase(0.0, 0.0, 0.0, 0.0)


def drawer(x: float) -> SceneObject:
    return SceneObject("Drawer|1", AssetSpec("Drawer", (0.5, 0.4, 0.2)), (x, 0.0, 0.7), _turned(-90))


def _turned(degrees: float) -> tuple[float, float, float, float]:
    half = math.radians(degrees) / 2
    return 0.0, 0.0, math.sin(half), math.cos(half)


def placed_balls(arm: Arm, base: ArmBase = BASE) -> F64:
    return balls(link_poses(base, arm.state.posture()[None]))[0]


def gap(world: World, points: F64, radii: F64, structure: bool = True) -> float:
    """Least distance of balls from everything in a world, by PyBullet, in a client of its own."""
    client = BulletClient()
    try:
        for part in world.scene.structure if structure else ():
            low, high = np.array(part.box[:3]), np.array(part.box[3:])
            _bullet_box(client, (low + high) / 2, np.eye(3), (high - low) / 2)
        for object_id in world.ids:
            for link, pose in zip(world.assets[object_id].links, world.link_poses(object_id), strict=True):
                for box in link.boxes:
                    rotation = pose[:3, :3] @ rotation_of(box.quaternion)
                    centre = pose[:3, :3] @ np.array(box.centre) + pose[:3, 3]
                    _bullet_box(client, centre, rotation, np.array(box.size) / 2)
        others = range(client.getNumBodies())
        return min(
            _bullet_gap(client, point, r, other) for point, r in zip(points, radii, strict=True) for other in others
        )
    finally:
        client.close()


def _bullet_box(client: BulletClient, centre: F64, rotation: F64, half: F64) -> int:
    shape = client.createCollisionShape(pybullet.GEOM_BOX, halfExtents=half.tolist())
    orientation = quaternion_of(rotation)
    return client.createMultiBody(0, shape, -1, centre.tolist(), orientation)


def _bullet_gap(client: BulletClient, point: F64, radius: float, body: int) -> float:
    ball = client.createCollisionShape(pybullet.GEOM_SPHERE, radius=radius)
    found = client.getClosestPoints(-1, body, 10.0, collisionShapeA=ball, collisionShapePositionA=point.tolist())
    return min(float(contact[8]) for contact in found)


# ---- how it is held


@pytest.mark.parametrize("height_m", [0.45, 0.75, 1.8])
def test_the_folded_arm_stays_above_the_agents_base(height_m: float) -> None:
    at = balls(link_poses(BASE, ArmState(height_m, HOME.joints).posture()[None]))[0]
    assert (np.hypot(at[:, 0], at[:, 1]) + BALL_RADII_M).max() < AGENT.radius_m


def test_the_shoulder_is_ahead_of_the_agent_at_the_height_of_the_state() -> None:
    with World(room()) as world:
        arm = Arm(world)
        assert arm.shoulder(ArmBase(1.0, 2.0, 90.0, -0.01)) == pytest.approx((1.0, 2.15, 0.74))
        arm.state = ArmState(1.2, HOME.joints, turn_deg=90.0)
        assert arm.shoulder(ArmBase(1.0, 2.0, 90.0, -0.01)) == pytest.approx((0.85, 2.0, 1.19))


@pytest.mark.parametrize("state", [(0.75, (0.0,) * 5), (math.nan, (0.0,) * 6), (0.75, (math.inf, *(0.0,) * 5))])
def test_a_state_that_no_arm_can_have_is_refused(state) -> None:
    with pytest.raises(ActionError, match="6 joints"):
        ArmState(*state)


def test_parts_are_drawn_where_the_links_are() -> None:
    with World(room()) as world:
        arm = Arm(world)
        base = ArmBase(0.5, -0.25, 90.0, 0.0)
        poses = arm.poses(base)
        assert len(arm.parts()) == len(poses)
        assert np.allclose(poses[-jaco.JOINTS :], arm.link_poses(base)[1 : jaco.HAND])
        assert np.allclose(poses[:, :3, :3] @ np.swapaxes(poses[:, :3, :3], 1, 2), np.eye(3))
        fingers = np.vstack([surface.vertices for surface in arm.parts()[-1]]) @ poses[-1, :3, :3].T + poses[-1, :3, 3]
        assert np.linalg.norm(fingers - arm.hand(base), axis=1).min() < 0.05


# ---- bumping into things


@pytest.mark.slow
@given(st.integers(0, 10_000))
def test_depth_is_what_pybullet_measures(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rotation = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    rotation *= np.linalg.det(rotation)
    half, point, radius = rng.uniform(0.02, 0.5, 3), rng.uniform(-0.7, 0.7, 3), rng.uniform(0.03, 0.2)
    around = np.abs(rotation) @ half
    boxes = Boxes(np.zeros((1, 3)), rotation.T[None], half[None], -around[None], around[None])
    client = BulletClient()
    distance = _bullet_gap(client, point, radius, _bullet_box(client, np.zeros(3), rotation, half))
    client.close()
    found = depth(point[None, None], np.array([radius]), boxes, np.zeros((1, 1), dtype=np.bool_))
    assert found[0] == pytest.approx(max(-distance, 0.0), abs=1e-3)  # PyBullet rounds a box a little


@pytest.mark.slow
@settings(max_examples=30)
@given(st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(0.1, 1.5)), st.floats(0.0, 1.0))
def test_what_the_hand_touches_is_what_pybullet_says(point, openness: float) -> None:
    with World(room(mug(position=(0.4, 0.5, 0.8), is_fixed=True), drawer(0.6))) as world:
        world.open("Drawer|1", openness)
        arm = Arm(world)
        gaps = {}
        for object_id in world.ids:
            alone = World(room(*(o for o in world.scene.objects if o.id == object_id)))
            alone.restore(Snapshot({object_id: world.state(object_id)}, {}))
            gaps[object_id] = gap(alone, np.array([point]), np.array([1e-3]), structure=False) + 1e-3
            alone.close()
        assume(min(gaps.values()) > 0.01)  # PyBullet has other depths than distances
        expected = sorted(gaps, key=gaps.__getitem__)
        found = arm._obstacles.gaps(point)
        assert found == pytest.approx([gaps[name] for name in world.ids], abs=1e-3)
        arm.hand_radius_m = max(gaps.values()) + 0.01
        if abs(gaps[expected[0]] - gaps[expected[1]]) > 2e-3:
            assert arm.touched(point) == expected
        world.pick_up("Mug|1")
        assert arm.touched(point) == ["Drawer|1"]


def test_a_push_is_a_step_into_a_box_and_a_step_out_is_none() -> None:
    one = np.ones((1, 3))
    boxes = Boxes(0 * one, np.eye(3)[None], one, -one, one)
    spared = np.zeros((1, 1), dtype=np.bool_)
    radius = np.array([0.1])
    xs = np.array([1.3, 1.2, 1.05, 1.0])  # the box ends at 1, the ball touches it at 1.1
    inwards = np.column_stack([xs, 0 * xs, 0 * xs])[:, None]
    assert first_push(inwards, radius, boxes, spared) == (2, 0)
    assert first_push(inwards[::-1], radius, boxes, spared) == (4, -1)
    assert first_push(np.vstack([inwards[::-1], inwards]), radius, boxes, spared) == (6, 0)
    assert first_push(inwards, radius, boxes, ~spared) == (4, -1)


def test_boxes_follow_what_moves_and_leave_out_what_is_held() -> None:
    with World(room(mug(position=(0.5, 0.0, 0.05), is_fixed=True), drawer(0.6))) as world:
        obstacles = Obstacles(world)
        before = dict(zip(*map(tuple, _owned(obstacles)), strict=True))
        world.open("Drawer|1")
        after = dict(zip(*map(tuple, _owned(obstacles)), strict=True))
        assert after[1] < before[1] - 0.2  # the drawer comes towards the agent
        world.pick_up("Mug|1")
        assert 0 not in _owned(obstacles)[0]


def _owned(obstacles: Obstacles) -> tuple[list[int], list[float]]:
    boxes, owners = obstacles.near(BASE)
    found = sorted(set(owners.tolist()))
    return found, [float(boxes.low[owners == owner, 0].min()) for owner in found]


# ---- being carried


@pytest.mark.slow
@settings(max_examples=30)
@given(st.integers(0, 10_000))
def test_a_carried_arm_is_stopped_where_pybullet_says_it_touches(seed: int) -> None:
    rng = np.random.default_rng(seed)
    with World(
        room(mug(position=(0.6, 0.5, 0.8), is_fixed=True), drawer(1.2), walls=[(-3, 0.9, 0, 3, 1, 2.5)])
    ) as world:
        arm = Arm(world)
        arm.move_hand(BASE, tuple(np.add(arm.shoulder(BASE), rng.uniform((0.2, -0.3, -0.2), (0.6, 0.3, 0.3)))))
        turn, ahead = rng.uniform(-90, 90), rng.uniform(0.0, 0.4)
        bases = [ArmBase(share * ahead, 0.0, share * turn, 0.0) for share in np.linspace(0.0, 1.0, 9)]
        gaps = [gap(world, placed_balls(arm, base), BALL_RADII_M) for base in bases]
        assume(gaps[0] > 0.0 and all(abs(g) > 2e-3 for g in gaps))
        stopped = [arm.blocker(bases[: count + 1]) is not None for count in range(len(bases))]
        assert stopped == np.logical_or.accumulate(np.array(gaps) < 0.0).tolist()
        assert [arm.is_free(base) for base in bases] == [g > 0.0 for g in gaps]


def test_a_carried_arm_comes_out_of_what_it_is_in_and_not_back() -> None:
    with World(room(walls=[(0.3, -3, 0, 0.4, 3, 2.5)])) as world:
        arm = Arm(world)
        with World(room()) as empty:
            arm.state = Arm(empty).move_hand(BASE, (0.6, 0.0, 0.9)).state
        back = [ArmBase(-share, 0.0, 0.0, 0.0) for share in np.linspace(0.0, 0.5, 20)]
        assert not arm.is_free(BASE)
        assert arm.blocker(back) is None
        assert arm.blocker([*back, *back[::-1]]) == "structure"
        assert arm.blocker([BASE]) is None


def test_a_folded_arm_passes_wherever_its_agent_does() -> None:
    with World(room(walls=[(0.2, -3, 0, 0.4, 3, 2.5)])) as world:
        arm = Arm(world)
        assert arm.is_folded
        assert arm.is_free(BASE)
        assert arm.blocker([BASE, ArmBase(0.0, 0.0, 90.0, 0.0)]) is None


# ---- moving the hand


@pytest.mark.slow
@settings(max_examples=25)
@given(st.floats(0.3, 0.6), st.floats(-50, 50), st.floats(-0.3, 0.3))
@example(0.5625, -28.0, -0.125)  # here and below the ways to the first postures lead through the agent's own column
@example(0.45, -50.0, 0.2)
@example(0.525, -26.0, -0.05)
def test_the_hand_goes_where_it_should_in_an_empty_room(distance: float, turn_deg: float, rise: float) -> None:
    with World(room()) as world:
        arm = Arm(world)
        x, y, z = arm.shoulder(BASE)
        flat = math.sqrt(max(distance**2 - rise**2, 0.0))
        target = (x + flat * math.cos(math.radians(turn_deg)), y + flat * math.sin(math.radians(turn_deg)), z + rise)
        move = arm.move_hand(BASE, target)
        assert move.success
        assert move.error == ""
        assert move.state == arm.state
        assert arm.hand(BASE) == pytest.approx(target, abs=1e-6)
        assert (arm.state.base_height_m, arm.state.turn_deg) == (HOME.base_height_m, HOME.turn_deg)


@pytest.mark.parametrize("target", [(0.9, 0.0, 0.75), (0.4, 0.0, 1.5), (math.nan, 0.0, 0.75)])
def test_a_point_out_of_reach_leaves_the_arm_as_it_is(target) -> None:
    with World(room()) as world:
        arm = Arm(world)
        move = arm.move_hand(BASE, target)
        assert (move.success, move.error, arm.state) == (False, "not within reach", HOME)


def test_a_column_that_is_free_to_slide_and_turn_reaches_higher_and_farther_round() -> None:
    with World(room()) as world:
        arm = Arm(world)
        for target in ((0.4, 0.0, 1.7), (-0.5, 0.3, 0.9), (0.3, -0.4, 0.2)):
            assert not arm.move_hand(BASE, target).success
            assert arm.move_hand(BASE, target, free_height=True).success
            assert arm.hand(BASE) == pytest.approx(target, abs=1e-6)
            arm.state = HOME


def test_the_arm_stops_before_a_wall_and_says_so() -> None:
    with World(room(walls=[(0.45, -3.0, 0.0, 0.5, 3.0, 2.5)])) as world:
        arm = Arm(world)
        move = arm.move_hand(BASE, (0.65, 0.0, 0.75), free_height=True)
        assert (move.success, move.error, move.blocked_by) == (False, "structure is blocking", "structure")
        assert move.state != HOME
        assert gap(world, placed_balls(arm), BALL_RADII_M) > -1e-3


def test_the_error_names_the_object_in_the_way() -> None:
    fridge = SceneObject("Fridge|1", AssetSpec("Fridge", (0.9, 0.8, 1.8)), (0.75, 0.0, 0.9), _turned(-90))
    with World(room(fridge)) as world:
        move = Arm(world).move_hand(BASE, (0.6, 0.0, 1.0), free_height=True)
        assert (move.error, move.blocked_by) == ("Fridge|1 is blocking", "Fridge|1")


def test_only_the_hand_may_touch_what_is_to_be_ignored() -> None:
    with World(room(drawer(0.6))) as world:
        arm = Arm(world)
        target = (float(world.box("Drawer|1")[0, 0]) + 0.05, 0.0, 0.7)
        assert not arm.move_hand(BASE, target, free_height=True).success
        arm.state = HOME
        assert arm.move_hand(BASE, target, free_height=True, ignore=["Drawer|1"]).success
        is_hand = np.linalg.norm(placed_balls(arm) - arm.hand(BASE), axis=1) < 0.17
        assert gap(world, placed_balls(arm)[~is_hand], BALL_RADII_M[~is_hand]) > -1e-3


def test_an_arm_in_an_opened_drawer_can_be_drawn_out() -> None:
    with World(room(drawer(0.6))) as world:
        arm = Arm(world)
        assert arm.reach_object(BASE, "Drawer|1").success
        world.open("Drawer|1", 0.3)
        assert gap(world, placed_balls(arm), BALL_RADII_M) < -0.01
        assert arm.move_hand(BASE, (0.2, -0.3, 0.9), free_height=True).success


def test_the_shoulder_slides_until_something_is_in_the_way() -> None:
    with World(room(walls=[(0.3, -1.0, 1.1, 1.0, 1.0, 1.15)])) as world:
        arm = Arm(world)
        assert arm.move_hand(BASE, (0.6, 0.0, 0.7)).success
        move = arm.set_base_height(BASE, 1.5)
        assert (move.success, move.error) == (False, "structure is blocking")
        assert 0.75 < arm.state.base_height_m < 1.5
        assert gap(world, placed_balls(arm), BALL_RADII_M) > -1e-3
        assert arm.set_base_height(BASE, 0.75).success


@pytest.mark.parametrize("height_m", [0.2, 2.0, math.nan])
def test_a_height_beyond_the_column_is_not_within_reach(height_m: float) -> None:
    with World(room()) as world:
        assert Arm(world).set_base_height(BASE, height_m).error == "not within reach"


# ---- reaching objects


@given(
    st.floats(-1, 1),
    st.floats(-1, 1),
    st.floats(0, 2),
)
def test_best_shoulders_agree_with_the_reach_of_the_planner(x: float, y: float, z: float) -> None:
    point = np.array([[x, y, z]])
    base = ArmBase(0.1, -0.2, 30.0, -0.01)
    assume(math.dist((base.x, base.y), (x, y)) > 0.15)
    distance = float(np.linalg.norm(point - best_shoulders(base, point)))
    assert distance == pytest.approx(reach_distance((base.x, base.y), base.floor_z, point[0]))


def test_the_hands_ball_touches_what_it_reaches_and_nothing_else_does() -> None:
    table = (0.3, -1.0, 0.7, 1.0, 1.0, 0.75)
    with World(room(mug(position=(0.55, 0.1, 0.8), is_fixed=True), walls=[table])) as world:
        arm = Arm(world)
        assert arm.reach_object(BASE, "Mug|1").success
        assert np.linalg.norm(np.array(arm.hand(BASE)) - arm.shoulder(BASE)) <= AGENT.reach_m
        low, high = world.box("Mug|1")
        outside = np.maximum(np.maximum(low - arm.hand(BASE), arm.hand(BASE) - high), 0.0)
        assert np.linalg.norm(outside) < arm.hand_radius_m
        table_box = np.array(table).reshape(2, 3)
        gaps = np.maximum(np.maximum(table_box[0] - placed_balls(arm), placed_balls(arm) - table_box[1]), 0.0)
        assert (np.linalg.norm(gaps, axis=1) - BALL_RADII_M).min() > 0


@pytest.mark.slow
def test_a_mug_behind_a_pane_is_blocked() -> None:
    pane = (0.4, -3.0, 0.0, 0.42, 3.0, 2.5)
    with World(room(mug(position=(0.5, 0.0, 0.9), is_fixed=True), walls=[pane])) as world:
        move = Arm(world).reach_object(BASE, "Mug|1")
        assert (move.success, move.error) == (False, "structure is blocking")


def test_what_is_too_far_away_is_not_within_reach() -> None:
    with World(room(mug(position=(1.5, 0.0, 0.9), is_fixed=True))) as world:
        assert Arm(world).reach_object(BASE, "Mug|1").error == "not within reach"


def test_an_unknown_object_is_an_error() -> None:
    with World(room()) as world:
        with pytest.raises(UnknownNameError, match="Mug"):
            Arm(world).reach_object(BASE, "Mug|2")
        with pytest.raises(UnknownNameError, match="Mug"):
            Arm(world).move_hand(BASE, (0.5, 0.0, 0.75), ignore=["Mug|2"])


@pytest.mark.slow
def test_a_movement_depends_on_the_room_and_the_arm_only_and_leaves_the_room_alone() -> None:
    scene = load_scene("FloorPlan402")
    with World(scene) as one, World(scene) as other:
        one.settle()
        other.settle()
        used, fresh = Arm(one), Arm(other)
        base = ArmBase(*_near(one, "Toilet"), 0.0, scene.floor_z)
        for object_id in one.ids[:12]:
            used.reach_object(base, object_id)
        used.state = HOME
        toilet = first_of(one, "Toilet")
        assert used.reach_object(base, toilet) == fresh.reach_object(base, toilet)
        assert one.save() == other.save()
        one.settle()
        other.settle()
        assert one.save() == other.save()


def _near(world: World, type_: str) -> tuple[float, float]:
    box = world.box(first_of(world, type_))
    x, y = (box[0, :2] + box[1, :2]) / 2
    return float(x) + 0.6, float(y)
