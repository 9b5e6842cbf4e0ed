"""Where the time of generation goes: rooms of the published configuration, made as `remqa-gen` makes them, on one core.

`python benchmarks/generation.py [ROOM...]` makes some rooms (by default one of each type) and throws them away. Each moment
belongs to the innermost of the steps below, so that the shares add up to one.
"""

from __future__ import annotations

import resource
import tempfile
import time
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import wraps
from typing import Any
from unittest.mock import patch

from measure import Benchmark, Facts, Headline, Table, nothing_cached

from remqa_data.generators import scene_job as room
from remqa_data.generators import scene_plan as room_plan
from remqa_data.generators.config import load_config
from remqa_data.generators.pipeline import RoomJob, make_part
from remqa_data.generators.questions.allotment import allot
from remqa_data.generators.questions.capacity_table import capacities
from remqa_data.generators.questions.expressions import Expressions
from remqa_data.generators.scene_plan import Job
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.sim.light import cache as light_cache
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.renderer import Renderer
from remqa_data.sim.render.view import WorldView
from remqa_data.storage.parts import Parts
from remqa_data.tables import images

ROOMS = ("FloorPlan2", "FloorPlan212", "FloorPlan308", "FloorPlan402")

STEPS: tuple[tuple[str, Any, str], ...] = (
    ("read the floor plan", room, "load_scene"),
    ("find hiding places", room_plan, "hiding_places"),
    ("plan questions", room_plan, "plan_groups"),
    ("arrange", room_plan, "arrange"),
    ("walk, graph, map", room, "walk_through"),
    ("make and audit questions", room, "make_sample"),
    ("write", Parts, "write"),
    ("referring expressions", Expressions, "__init__"),
    ("referring expressions", Expressions, "of"),
    ("scene graph of a room", SceneGraph, "from_objects"),
    ("load a world", World, "__init__"),
    ("load a world's pictures", WorldView, "__init__"),
    ("settle", World, "settle"),
    ("draw pictures", Renderer, "render"),
    ("draw instances or depth only", Renderer, "render_instances"),
    ("draw instances or depth only", Renderer, "render_labels"),
    ("draw instances or depth only", Renderer, "render_depth"),
    ("light a room", light_cache, "bake"),
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


def measure(arguments: list[str]) -> Facts:
    """Make rooms; seconds and calls of each step."""
    rooms = tuple(arguments) or ROOMS
    config = load_config("paper")
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
    peak_gb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    return {"rooms": made, "seconds": watch.seconds, "calls": watch.calls, "peak_gb": peak_gb}


def table(facts: Facts) -> Table:
    """Steps, the longest first."""
    made, seconds = facts["rooms"], facts["seconds"]
    total = sum(seconds.values())
    counts = ", ".join(f"{sum(room[what] for room in made)} {what}" for what in ("questions", "frames"))
    title = f"{', '.join(room['scene'] for room in made)} with {counts}, made in {total:.0f} s of one core"
    rows = [
        (step, f"{facts['calls'].get(step, 0):,}", f"{taken / len(made):.2f}", f"{100 * taken / total:.1f} %")
        for step, taken in sorted(seconds.items(), key=lambda pair: -pair[1])
    ]
    return Table(title, ("step", "calls", "s per room", "share"), rows)


def headlines(facts: Facts) -> list[Headline]:
    """Memory, and the share of time that goes into drawing."""
    seconds = facts["seconds"]
    drawing = sum(seconds[step] for step in ("draw pictures", "draw instances or depth only"))
    return [
        Headline("generation, peak memory of a process", facts["peak_gb"], "GB", at_most=3),
        Headline("generation, share of drawing", 100 * drawing / sum(seconds.values()), "%"),
    ]


def make_all(jobs: list[Job]) -> list[dict[str, Any]]:
    """Make rooms and throw them away; the reports."""
    with tempfile.TemporaryDirectory() as folder, nothing_cached():
        parts = Parts(folder, {"benchmark": 1})
        made = [make_part(RoomJob(parts, job)) for job in jobs]
        return [{**part.report, "scene": part.scene} for part in made]


BENCHMARK = Benchmark("generation", measure, table, headlines)

if __name__ == "__main__":
    BENCHMARK.main()
