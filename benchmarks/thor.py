"""What the facade costs: milliseconds of `Controller.step` and of the frame that it draws, in the same run.

Run it alone on an idle machine: `python benchmarks/thor.py`. The figures are printed and stored in
out/benchmarks/thor.json.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from remqa_data.generators.floorplans.ithor import load_scene
from remqa_data.sim.navigation import reachable_grid
from remqa_data.sim.view import WorldView
from remqa_data.sim.viewpoints import AgentPose
from remqa_data.sim.world import World
from remqa_data.thor import Controller

OUTPUT = Path("out/benchmarks/thor.json")
ROOM, POSES, HEADINGS = "FloorPlan1", 20, 4


def main() -> None:
    """Measure and print."""
    rows = {**frames_ms(), **steps_ms()}
    table = Table("what", "ms, median", title=f"{ROOM}, 300 x 300, {POSES * HEADINGS} steps")
    for name, milliseconds in rows.items():
        table.add_row(name, f"{milliseconds:.2f}")
    Console().print(table)
    OUTPUT.parent.mkdir(parents=True, exist_ok=True)
    OUTPUT.write_text(json.dumps({"room": ROOM, "median_ms": rows}, indent=2) + "\n", encoding="utf-8")


def frames_ms() -> dict[str, float]:
    """The renderer alone, from the poses that the steps visit."""
    with World(load_scene(ROOM)) as world:
        world.settle()
        view, grid = WorldView(world), reachable_grid(world)
        cells = grid.cells[:: len(grid.cells) // POSES][:POSES]
        poses = [AgentPose(cell, heading) for cell in cells for heading in (0, 270, 180, 90)]
        view.render(poses[0].camera(grid))
        return {"frame alone": _median_ms([lambda pose=pose: view.render(pose.camera(grid)) for pose in poses])}


def steps_ms() -> dict[str, float]:
    """Turning right at the same places; the teleports between are not counted."""
    found = {}
    for name, images in (
        ("step with colour", {}),
        ("step with colour, depth, instances, classes", _ALL_IMAGES),
        ("step without pictures", {"renderImage": False}),
    ):
        always = {} if "renderImage" in images else images
        with Controller(scene=ROOM, **always) as controller:
            positions = controller.step("GetReachablePositions").metadata["actionReturn"]
            times = []
            for position in positions[:: len(positions) // POSES][:POSES]:
                controller.step("Teleport", position=position, rotation=0)
                per_step = {} if always else images
                turns = [lambda c=controller, k=per_step: c.step("RotateRight", **k)] * HEADINGS
                times.append(_median_ms(turns))
            found[name] = float(np.median(times))
            start = time.perf_counter()
            controller.reset()
            found["reset of the same room"] = 1e3 * (time.perf_counter() - start)
    return found


_ALL_IMAGES = {"renderDepthImage": True, "renderInstanceSegmentation": True, "renderSemanticSegmentation": True}


def _median_ms(calls: list[Callable[[], object]]) -> float:
    times = []
    for call in calls:
        start = time.perf_counter()
        call()
        times.append(1e3 * (time.perf_counter() - start))
    return float(np.median(times))


if __name__ == "__main__":
    main()
