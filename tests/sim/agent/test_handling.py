"""What hands do is done, or the world is as it was."""

from collections.abc import Iterator

import pytest

from remqa_data.assets.core.model import AssetSpec
from remqa_data.scene import SceneObject
from remqa_data.sim.agent.handling import blocker_at, drop_at
from remqa_data.sim.physics.world import World
from tests.helpers.bare_rooms import mug, room

MUG, FRIDGE = "Mug|1", "Fridge|1"
IN_ITS_SIDE = (0.72, 1.0, 0.6)


@pytest.fixture
def world() -> Iterator[World]:
    """A mug on the floor, and a fridge that hangs 1 cm above it."""
    fridge = SceneObject(FRIDGE, AssetSpec("Fridge", (0.6, 0.6, 1.2)), (1.0, 1.0, 0.61))
    with World(room(mug(MUG, (0.0, 0.0, 0.05)), fridge)) as made:
        yield made


def test_what_finds_no_room_is_held_where_it_was(world: World) -> None:
    world.pick_up(MUG)
    before, box = world.save(), world.box(MUG)
    done = drop_at(world, MUG, [(1.0, 1.0, 0.05), (1.0, 1.3, 0.05)])
    assert (done.object_id, done.error) == (None, f"no room to drop {MUG}")
    assert world.is_as(before)
    assert (world.box(MUG) == box).all()


@pytest.mark.parametrize(("position", "blocker"), [(IN_ITS_SIDE, FRIDGE), ((-1.0, 0.0, 0.05), None)])
def test_to_ask_what_is_in_the_way_moves_nothing(world: World, position, blocker: str | None) -> None:
    before = world.save()
    assert blocker_at(world, MUG, position) == blocker
    assert world.is_as(before)
