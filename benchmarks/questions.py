"""Questions a second of the question engine alone: on the graphs of rooms, without simulating or drawing anything.

A question counts as accepted when its referring expression picks out one object, its program has been executed, and
nothing else nearly fits. `python benchmarks/questions.py`, on an idle machine.
"""

from __future__ import annotations

import time

from measure import Benchmark, Facts, Headline, Table

from remqa_data.catalog import object_type, question_types
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.generators.questions.expressions import Expressions
from remqa_data.generators.questions.questions import question_program, usable_expressions
from remqa_data.language.answers import execute, is_clear
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.sim.metadata import ObjectMetadata, object_metadata
from remqa_data.sim.physics.world import World

ROOMS = ("FloorPlan1", "FloorPlan5", "FloorPlan201", "FloorPlan215", "FloorPlan301", "FloorPlan315", "FloorPlan401")


def measure(arguments: list[str]) -> Facts:
    """Ask everything about each room; its objects are known before the clock starts."""
    rooms = {}
    for name in ROOMS:
        with World(load_scene(name)) as world:
            objects = list(object_metadata(world).values())
        start = time.process_time()
        asked, accepted = ask_everything(objects)
        rooms[name] = {"asked": asked, "accepted": accepted, "seconds": time.process_time() - start}
    return {"rooms": rooms}


def table(facts: Facts) -> Table:
    """Questions by room."""
    rows = [
        (name, f"{room['asked']:,}", f"{room['accepted']:,}", f"{room['accepted'] / room['seconds']:,.0f}")
        for name, room in facts["rooms"].items()
    ]
    return Table("The question engine, on one core", ("room", "asked", "accepted", "accepted per second"), rows)


def headlines(facts: Facts) -> list[Headline]:
    """Of all rooms together."""
    accepted, seconds = (sum(room[key] for room in facts["rooms"].values()) for key in ("accepted", "seconds"))
    return [Headline("question engine, on stored graphs", accepted / seconds, "accepted questions/s", at_least=2000)]


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


BENCHMARK = Benchmark("questions", measure, table, headlines)

if __name__ == "__main__":
    BENCHMARK.main()
