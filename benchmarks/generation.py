"""Where the time of generation goes: rooms of the published configuration, made as `remqa-gen` makes them, on one core.

`python benchmarks/generation.py [ROOM...]` makes some rooms (by default one of each type) and throws them away. Each moment
belongs to the innermost of the steps below, so that the shares add up to one. The figures are printed and stored in
out/benchmarks/generation.json.
"""

from __future__ import annotations

import json
import platform
import resource
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import wraps
from pathlib import Path
from typing import Any
from unittest.mock import patch

from rich.console import Console
from rich.table import Table

from remqa_data import images
from remqa_data.generators import room, room_plan
from remqa_data.generators.allotment import allot, capacities
from remqa_data.generators.config import paper_config
from remqa_data.generators.expressions import Expressions
from remqa_data.generators.pipeline import RoomJob, make_part
from remqa_data.generators.room_plan import Job
from remqa_data.parts import Parts
from remqa_data.scene_graph import SceneGraph
from remqa_data.sim.renderer import Renderer
from remqa_data.sim.view import WorldView
from remqa_data.sim.world import World

OUTPUT = Path("out/benchmarks/generation.json")
ROOMS = ("FloorPlan2", "FloorPlan212", "FloorPlan308", "FloorPlan402")
ALL_ROOMS = 120

STEPS: tuple[tuple[str, Any, str], ...] = (
    ("read the floor plan", room, "load_scene"),
    ("find hiding places", room_plan, "hiding_places"),
    ("plan questions", room_plan, "plan_groups"),
    ("arrange", room_plan, "arrange"),
    ("walk, graph, map", room, "tour"),
    ("make and audit questions", room, "make_sample"),
    ("write", Parts, "write"),
    ("referring expressions", Expressions, "__init__"),
    ("referring expressions", Expressions, "of"),
    ("scene graph of a room", SceneGraph, "from_objects"),
    ("load a world", World, "__init__"),
    ("load a world's pictures", WorldView, "__init__"),
    ("settle", World, "settle"),
    ("draw pictures", Renderer, "render"),
    ("draw instances only", Renderer, "render_instances"),
    ("encode images", images, "_encoded"),
)
"""Name of a step, and what does it: an attribute of a module or class."""
OTHER = "everything else"


@dataclass
class Stopwatch:
    """Adds up time by step; the innermost running step gets it."""

    seconds: dict[str, float] = field(default_factory=dict)
    calls: dict[str, int] = field(default_factory=dict)
    running: list[str] = field(default_factory=lambda: [OTHER])
    since: float = field(default_factory=time.process_time)

    def lap(self) -> None:
        """Give the time since the last lap to what is running."""
        now = time.process_time()
        self.seconds[self.running[-1]] = self.seconds.get(self.running[-1], 0.0) + now - self.since
        self.since = now

    def timed(self, step: str, work: Callable[..., Any]) -> Callable[..., Any]:
        """The same function, timed."""

        @wraps(work)
        def run(*args: Any, **kwargs: Any) -> Any:
            self.lap()
            self.calls[step] = self.calls.get(step, 0) + 1
            self.running.append(step)
            try:
                return work(*args, **kwargs)
            finally:
                self.lap()
                self.running.pop()

        return run


def main() -> None:
    """Make rooms, print a table and store the figures."""
    rooms = tuple(sys.argv[1:]) or ROOMS
    config = paper_config()
    jobs = [
        Job(quota, config) for quota in allot(capacities(config.scene_names), config.totals) if quota.scene in rooms
    ]
    make_all(jobs[:1])  # compiles the renderer and draws the textures
    watch = Stopwatch()
    with ExitStack() as stack:
        for step, owner, name in STEPS:
            stack.enter_context(patch.object(owner, name, watch.timed(step, getattr(owner, name))))
        made = make_all(jobs)
        watch.lap()
    report(watch, made)


def make_all(jobs: list[Job]) -> list[dict[str, Any]]:
    """Make rooms and throw them away; the reports."""
    with tempfile.TemporaryDirectory() as folder:
        parts = Parts(folder, {"benchmark": 1})
        made = [make_part(RoomJob(parts, job)) for job in jobs]
        return [{**part.report, "scene": part.scene} for part in made]


def report(watch: Stopwatch, made: list[dict[str, Any]]) -> None:
    """Print what was measured, and store it."""
    total = sum(watch.seconds.values())
    names = ", ".join(room["scene"] for room in made)
    counts = ", ".join(f"{sum(room[what] for room in made)} {what}" for what in ("questions", "frames"))
    table = Table(title=f"{names}: {counts} in {total:.1f} s of one core")
    for heading in ("step", "calls", "s per room", "share"):
        table.add_column(heading, justify="left" if heading == "step" else "right")
    for step, seconds in sorted(watch.seconds.items(), key=lambda pair: -pair[1]):
        share = f"{100 * seconds / total:.1f} %"
        table.add_row(step, str(watch.calls.get(step, "")), f"{seconds / len(made):.2f}", share)
    Console().print(table)
    minutes = total / len(made) * ALL_ROOMS / 60
    peak_gb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    print(
        f"{ALL_ROOMS} such rooms: {minutes:.1f} minutes on one core, {minutes / 2:.1f} on two; peak memory {peak_gb:.2f} GB"
    )
    OUTPUT.parent.mkdir(parents=True, exist_ok=True)
    facts = {"cpu": platform.processor(), "rooms": made, "minutes_on_one_core": minutes, "peak_gb": peak_gb}
    OUTPUT.write_text(json.dumps(facts | {"seconds": watch.seconds, "calls": watch.calls}, indent=2) + "\n")


if __name__ == "__main__":
    main()
