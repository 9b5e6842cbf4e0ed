import numpy as np
import pytest

from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.generators.seen_anywhere import MOST_PIXELS, most_pixels_anywhere
from remqa_data.sim.navigation.grid import reachable_grid
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.view import WorldView
from tests.helpers.bare_rooms import first_of


@pytest.mark.slow
def test_what_is_in_a_closed_fridge_is_seen_from_nowhere_and_what_is_before_it_is() -> None:
    """FloorPlan1's fridge has two doors side by side."""
    with World(load_scene("FloorPlan1")) as world:
        world.settle()
        (fridge,) = (object_id for object_id in world.ids if world.type_of(object_id) == "Fridge")
        world.open(fridge, 0.0)
        view, grid = WorldView(world), reachable_grid(world)
        thing = first_of(world, "Mug")
        low, high = world.box(fridge)
        x, y, z = (float(v) for v in (low + high) / 2)
        for across in np.linspace(low[1] + 0.1, high[1] - 0.1, 9):
            world.move_alone(thing, (x, float(across), z + 0.2))
            assert most_pixels_anywhere(view, grid, [thing]) == 0
            assert most_pixels_anywhere(view, grid, [thing], [fridge]) == 0
        most = []
        for ahead in (low[0] - 0.1, high[0] + 0.1):
            world.move_alone(thing, (float(ahead), y, z))
            most.append(most_pixels_anywhere(view, grid, [thing]))
            assert most_pixels_anywhere(view, grid, [thing], [fridge]) == most[-1]
        assert max(most) > MOST_PIXELS
