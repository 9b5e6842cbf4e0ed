"""The rasteriser against Embree in real rooms, from where the agent stands."""

import numpy as np
import pytest

from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.sim.navigation.grid import reachable_grid
from remqa_data.sim.navigation.viewpoints import HEADINGS_DEG, HORIZONS_DEG, AgentPose
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.renderer import Renderer
from remqa_data.sim.render.view import world_parts
from tests.helpers.embree_oracle import compare, trace

ROOMS = ("FloorPlan1", "FloorPlan201", "FloorPlan301", "FloorPlan401")
POSES = 50


@pytest.mark.slow
@pytest.mark.parametrize("name", ROOMS)
def test_ids_and_depths_are_those_of_embree(name: str) -> None:
    scene = load_scene(name)
    with World(scene) as world:
        grid = reachable_grid(world)
        parts, poses = world_parts(world)
    renderer = Renderer(parts, poses, lights=scene.lights)
    rng = np.random.default_rng(0)
    others, errors = [], []
    for _ in range(POSES):
        cell = grid.cells[int(rng.integers(len(grid.cells)))]
        camera = AgentPose(cell, int(rng.choice(HEADINGS_DEG)), int(rng.choice(HORIZONS_DEG))).camera(grid)
        agreement = compare(renderer.render(camera, shadows=False, antialias=False), *trace(parts, poses, camera))
        others.append(agreement.other_instance)
        errors.append(agreement.depth_error_p999_m)
    print(f"{name}: other ids {np.mean(others):.2e}, depth error p99.9 {max(errors):.2e} m")
    assert np.mean(others) <= 1e-4
    assert max(errors) < 1e-3
