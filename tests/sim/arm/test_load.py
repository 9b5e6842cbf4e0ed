"""What the hand holds is in the arm's way, as balls."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from remqa_data.assets.core.model import AssetSpec
from remqa_data.geometry.rotations import quaternion_of, rotation_of
from remqa_data.scene import SceneObject
from remqa_data.sim.arm.arm import Arm, ArmBase
from remqa_data.sim.arm.load import BALL_M, MARGIN_M, NOTHING, Load, _balls_in, load_of
from remqa_data.sim.physics.world import World
from tests.helpers.bare_rooms import mug, room
from tests.sim.arm.test_arm import BASE

SIDE = st.floats(0.004, 0.4)


@given(st.tuples(SIDE, SIDE, SIDE), st.integers(0, 1000))
def test_balls_lie_in_their_box_and_are_everywhere_near_its_faces(size, seed: int) -> None:
    middles, radius = _balls_in(size)
    half = np.array(size) / 2
    assert (np.abs(middles) + max(radius - 1e-3, 0.0) <= half + 1e-9).all()
    rng = np.random.default_rng(seed)
    point, axis = rng.uniform(-half, half), rng.integers(3)
    point[axis] = rng.choice([-1, 1]) * half[axis]
    assert np.linalg.norm(middles - point, axis=1).min() - radius <= 0.75 * BALL_M + MARGIN_M


def test_a_load_is_where_the_thing_is_held_and_turned() -> None:
    with World(room(mug(position=(0.4, 0.5, 0.8), is_fixed=True))) as world:
        turned = quaternion_of(rotation_of((0.0, math.sin(0.4), 0.0, math.cos(0.4))))
        state = world.state("Mug|1").elsewhere((0.5, 0.1, 1.0), turned)
        load = load_of(world, {"Mug|1": state}, (0.5, 0.0, 1.0))
        world.move_alone("Mug|1", (0.5, 0.1, 1.0), turned)
        low, high = world.box("Mug|1")
        found = load.offsets + np.array([0.5, 0.0, 1.0])
        assert (found > low - 0.01).all()
        assert (found < high + 0.01).all()
        assert found.max(axis=0) == pytest.approx(high, abs=0.03)
        assert found.min(axis=0) == pytest.approx(low, abs=0.03)
    assert load_of(world, {}, (0.0, 0.0, 0.0)) == (pytest.approx(NOTHING.offsets), pytest.approx(NOTHING.radii))


def test_a_hand_that_holds_something_stops_earlier_before_a_wall_and_after_a_turn() -> None:
    ahead = Load(np.array([[0.2, 0.0, 0.0]]), np.array([0.02]))
    with World(room(walls=[(0.9, -3, 0, 1.0, 3, 2.5)])) as world:
        empty, loaded = Arm(world), Arm(world, load=lambda: ahead)
        for x, reaches in ((0.6, True), (0.75, False)):
            assert empty.move_hand(BASE, (x, 0.0, 0.9)).success
            moved = loaded.move_hand(BASE, (x, 0.0, 0.9))
            assert moved.success == reaches
            assert moved.blocked_by == (None if reaches else "structure")
        loaded.move_hand(BASE, (0.6, 0.0, 0.9))
        assert loaded.hand(BASE)[0] + 0.22 < 0.9
        loaded.state = empty.state
        assert not loaded.is_free(BASE)
        turned = [ArmBase(0.0, 0.0, yaw, 0.0) for yaw in range(60, -1, -2)]
        assert empty.blocker(turned) is None
        sideways = Arm(
            world, load=lambda: Load(np.array([[0.1, 0.17, 0.0]]), np.array([0.02]))
        )  # ahead, where it is turned
        sideways.state = empty.state
        assert sideways.blocker(turned) == "structure"


def test_what_can_be_picked_up_lets_a_load_pass_and_other_agents_stop_the_arm() -> None:
    box = SceneObject("Box|1", AssetSpec("Box", (0.2, 0.2, 0.2)), (0.8, 0.0, 0.9), (0.0, 0.0, 0.0, 1.0), is_fixed=True)
    ahead = Load(np.array([[0.2, 0.0, 0.0]]), np.array([0.02]))
    with World(room(box)) as world:
        assert Arm(world, load=lambda: ahead).move_hand(BASE, (0.55, 0.0, 0.9)).success
    with World(room()) as world:
        alone = Arm(world).move_hand(BASE, (0.6, 0.0, 0.9))
        assert alone.success
        beside_another = Arm(world, others=lambda: [ArmBase(0.6, 0.0, 90.0, 0.0)])
        assert beside_another.move_hand(BASE, (0.6, 0.0, 0.9)).blocked_by == "another Agent"
        beside_another.state = alone.state
        assert not beside_another.is_free(BASE)
