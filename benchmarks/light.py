"""What baked light costs: a frame beside one with direct light, from the same poses, and baking a room.

`python benchmarks/light.py`, on an idle machine.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from measure import Benchmark, Facts, Headline, Table, nothing_cached, times_ms
from raster import frame_times

from remqa_data.floorplans.load import load_scene
from remqa_data.scene import Scene
from remqa_data.sim.navigation.grid import ReachableGrid, reachable_grid
from remqa_data.sim.navigation.viewpoints import HEADINGS_DEG, AgentPose
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.camera import Camera
from remqa_data.sim.render.room_light import room_light
from remqa_data.sim.render.room_mirrors import room_mirrors
from remqa_data.sim.render.view import WorldView

ROOMS, POSES = ("FloorPlan1", "FloorPlan212", "FloorPlan309", "FloorPlan410"), 30
"""One of each type; FloorPlan410 has a mirror over two basins."""


def measure(arguments: list[str]) -> Facts:
    """Milliseconds per frame under both lights, and to bake."""
    with nothing_cached():
        return {"rooms": {name: _room_facts(name) for name in ROOMS}}


def table(facts: Facts) -> Table:
    """Both lights, by room."""
    rows = [
        (name, *(f"{room[key]:.2f}" for key in ("direct_ms", "baked_ms", "ratio", "bake_s")))
        for name, room in facts["rooms"].items()
    ]
    title = "300 x 300 frames with shadows, median over poses; ratio: median over poses; baking: light and mirrors"
    return Table(title, ("room", "direct, ms", "baked, ms", "ratio", "to bake, s"), rows)


def headlines(facts: Facts) -> list[Headline]:
    """The dearest room of each."""
    rooms = facts["rooms"].values()
    return [
        Headline("frame with baked light, dearest room", max(r["ratio"] for r in rooms), "x a direct one", at_most=1.2),
        Headline("baking a room, dearest", max(r["bake_s"] for r in rooms), "s", at_most=1.5),
    ]


def _room_facts(name: str) -> dict[str, float]:
    scene = load_scene(name, "baked")
    with World(scene) as baked, World(replace(scene, light="direct")) as direct:
        baked.settle()
        direct.settle()
        cameras = _cameras(reachable_grid(baked))
        views = {"baked": WorldView(baked), "direct": WorldView(direct)}
        draws = {light: partial(view.render, antialias=False) for light, view in views.items()}
        times = frame_times(draws, cameras)
    unknown = [replace(scene, name=f"{name} {number}") for number in range(3)]  # so that this process does not know it
    return {
        "direct_ms": float(np.median(times["direct"])),
        "baked_ms": float(np.median(times["baked"])),
        "ratio": float(np.median(times["baked"] / times["direct"])),
        "bake_s": float(np.median([_bake_ms(scene) for scene in unknown])) / 1000,
    }


def _cameras(grid: ReachableGrid) -> list[Camera]:
    rng = np.random.default_rng(0)
    cells = [grid.cells[int(i)] for i in rng.integers(len(grid.cells), size=POSES)]
    poses = [AgentPose(cell, int(rng.choice(HEADINGS_DEG)), int(rng.choice((0, 30)))) for cell in cells]
    return [pose.camera(grid) for pose in poses]


def _bake_ms(scene: Scene) -> float:
    with nothing_cached():  # the other rooms here differ in their names only
        return sum(times_ms([partial(room_light, scene), partial(room_mirrors, scene)]))


BENCHMARK = Benchmark("light", measure, table, headlines)

if __name__ == "__main__":
    BENCHMARK.main()
