"""What the facade costs: milliseconds of `Controller.step` and of the frame that it draws, in the same run.

`python benchmarks/thor.py`, on an idle machine.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from ai2thor.server import Event
from measure import Benchmark, Facts, Headline, Table, median_ms, times_ms

from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.sim.navigation.grid import reachable_grid
from remqa_data.sim.navigation.viewpoints import AgentPose
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.view import WorldView
from remqa_data.thor import Controller

ROOM, POSES, HEADINGS = "FloorPlan1", 20, 3


def measure(arguments: list[str]) -> Facts:
    """Median milliseconds of frames and steps."""
    return {"median_ms": {**frames_ms(), **steps_ms()}}


def table(facts: Facts) -> Table:
    """All of them."""
    rows = [(name, f"{ms:.2f}") for name, ms in facts["median_ms"].items()]
    return Table(f"AI2-THOR's Controller in {ROOM}, 300 x 300, {POSES * HEADINGS} steps", ("what", "median ms"), rows)


def headlines(facts: Facts) -> list[Headline]:
    """What the facade costs."""
    ms = facts["median_ms"]
    return [
        Headline("AI2-THOR's Controller, step with colour", ms["step with colour"] / ms["frame alone"], "x a frame")
    ]


def frames_ms() -> dict[str, float]:
    """The renderer alone, from the poses that the steps visit."""
    with World(load_scene(ROOM)) as world:
        world.settle()
        view, grid = WorldView(world), reachable_grid(world)
        cells = grid.cells[:: len(grid.cells) // POSES][:POSES]
        poses = [AgentPose(cell, heading) for cell in cells for heading in (270, 180, 90)]
        view.render(poses[0].camera(grid))
        return {"frame alone": median_ms(partial(view.render, pose.camera(grid)) for pose in poses)}


def steps_ms() -> dict[str, float]:
    """Turning right at the same places, to new views and to the same again; the teleports between are not counted."""
    found = {}
    for name, images in (
        ("step with colour", {}),
        ("step with colour, depth, instances, classes", _ALL_IMAGES),
        ("step without pictures", {"renderImage": False}),
        ("step without pictures, objects read", {"renderImage": False}),
    ):
        always = {} if "renderImage" in images else images
        with Controller(scene=ROOM, **always) as controller:
            positions = controller.step("GetReachablePositions").metadata["actionReturn"]
            times, again = [], []
            for position in positions[:: len(positions) // POSES][:POSES]:
                controller.step("Teleport", position=position, rotation=0)
                per_step = {} if always else images
                turn = partial(controller.step, "RotateRight", **per_step)
                turns = [partial(read_objects, turn) if "read" in name else turn] * HEADINGS
                times.append(median_ms(turns))
                controller.step("RotateRight", **per_step)
                again.append(median_ms(turns))
            found[name] = float(np.median(times))
            found[f"{name}, again"] = float(np.median(again))
            found["reset of the same room"] = times_ms([controller.reset])[0]
    return found


def read_objects(step: Callable[[], Event]) -> list[dict[str, object]]:
    """A step, and the objects of its event."""
    found: list[dict[str, object]] = step().metadata["objects"]
    return found


_ALL_IMAGES = {"renderDepthImage": True, "renderInstanceSegmentation": True, "renderSemanticSegmentation": True}


BENCHMARK = Benchmark("thor", measure, table, headlines)

if __name__ == "__main__":
    BENCHMARK.main()
