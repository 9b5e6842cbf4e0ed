"""Questions a second of the question engine alone: on the graphs of rooms, without simulating or drawing anything.

A question counts as accepted when its referring expression picks out one object, its program has been executed, and
nothing else nearly fits. Run it alone: `python benchmarks/questions.py`. The figures are printed and stored in
out/benchmarks/questions.json.
"""

from __future__ import annotations

import json
import platform
import time
from pathlib import Path

from remqa_data.answers import execute, is_clear
from remqa_data.catalog import object_type, question_types
from remqa_data.generators.expressions import Expressions
from remqa_data.generators.floorplans.ithor import load_scene
from remqa_data.generators.questions import question_program, usable_expressions
from remqa_data.metadata import ObjectMetadata, object_metadata
from remqa_data.scene_graph import SceneGraph
from remqa_data.sim.world import World

OUTPUT = Path("out/benchmarks/questions.json")
ROOMS = ("FloorPlan1", "FloorPlan5", "FloorPlan201", "FloorPlan215", "FloorPlan301", "FloorPlan315", "FloorPlan401")


def main() -> None:
    """Measure, print and store."""
    rooms = []
    for name in ROOMS:
        with World(load_scene(name)) as world:
            rooms.append(list(object_metadata(world).values()))
    begin = time.process_time()
    asked, accepted = (sum(counts) for counts in zip(*map(ask_everything, rooms), strict=True))
    seconds = time.process_time() - begin
    print(
        f"{accepted} of {asked} questions about {len(ROOMS)} rooms accepted in {seconds:.2f} s of one core: "
        f"{accepted / seconds:.0f} accepted questions a second"
    )
    OUTPUT.parent.mkdir(parents=True, exist_ok=True)
    facts = {"cpu": platform.processor(), "asked": asked, "accepted": accepted, "accepted_per_s": accepted / seconds}
    OUTPUT.write_text(json.dumps(facts, indent=2) + "\n")


def ask_everything(objects: list[ObjectMetadata]) -> tuple[int, int]:
    """Every question of a room about what is in its receptacles: how many there are, and how many are accepted."""
    graph = SceneGraph.from_objects(objects)
    loose_graph = SceneGraph.from_objects(objects, graph.rules.loosened())
    expressions = Expressions(graph)
    things = [name for name in question_types() if object_type(name).pickupable]
    asked = accepted = 0
    for record in objects:
        if not object_type(record.type).receptacle:
            continue
        for expression, _ in usable_expressions(expressions.of(record.id)):
            for thing in things:
                program = question_program("COUNTING", thing, "in", expression.program)
                execute(program, graph)
                asked += 1
                accepted += is_clear(program, graph, loose_graph)
    return asked, accepted


if __name__ == "__main__":
    main()
