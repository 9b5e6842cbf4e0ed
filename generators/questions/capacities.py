"""What each room can take, measured.

`python -m remqa_data.generators.questions.capacities` writes `templates/capacities.csv` anew. That takes a few minutes, so it
is done when rooms, hiding places or `templates/questions.yaml` have changed, and the table ships with the package: quotas can
then be dealt out without loading a single room.

What lies in a place hides a part of it, which only arranging tells: `generators.lowered_capacities` lowers the table to what
rooms gave.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path

import numpy as np

from remqa_data.files import atomic_path
from remqa_data.floorplans.ithor.scenes import load_scene, scene_names
from remqa_data.generators.arrangement.fitting_types import fitting_types
from remqa_data.generators.arrangement.hiding_places import hiding_places
from remqa_data.generators.arrangement.wished_things import has_room
from remqa_data.generators.questions.allotment import LOT_SIZE
from remqa_data.generators.questions.capacity_table import TABLE, SceneCapacity
from remqa_data.generators.questions.expressions import Expression, Expressions
from remqa_data.generators.questions.groups import shapes_of
from remqa_data.generators.questions.planning import Planner
from remqa_data.generators.questions.questions import P
from remqa_data.generators.questions.sites import FittingTypes, TakesThings, any_room, sites_of, takes
from remqa_data.language.question_rules import question_rules
from remqa_data.published import QUESTIONS
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.sim.metadata import object_metadata
from remqa_data.sim.physics.world import World
from remqa_data.tables.rows import KINDS, QuestionKind

HEADER = """\
# How many lots of four questions of each kind a room can take, counted on the room as recorded: easily, and at most,
# that is with more questions about a place, and longer ones, than templates/questions.yaml wants.
# Written by: python -m remqa_data.generators.questions.capacities
# and lowered to what rooms gave by: python -m remqa_data.generators.lowered_capacities DATASET
"""
WANTED = QUESTIONS["train"]
"""Kinds are filled up in these proportions."""
MOST_LOTS = 12
"""No room needs to take more lots of one kind."""


def measured_capacity(scene_name: str) -> SceneCapacity:
    """What a floor plan can take."""
    scene = load_scene(scene_name)
    places = hiding_places(scene)
    with World(scene) as world:
        room = Expressions(SceneGraph.from_objects(object_metadata(world).values()))
    phrases = {place.object_id: room.of(place.object_id) for place in places}
    return room_capacity(
        places,
        phrases,
        lambda place, count: fitting_types(place, scene.room_type, count),
        scene.name,
        scene.room_type,
        takes(cache(has_room), cache(lambda place: fitting_types(place, scene.room_type, 1, others=True))),
    )


def room_capacity(
    places: Sequence[P],
    expressions: Mapping[str, Sequence[Expression]],
    fitting_types: FittingTypes[P],
    scene: str,
    room_type: str,
    has_room: TakesThings[P] | None = None,
) -> SceneCapacity:
    """How many lots of each kind a room can take at once: a line of `capacities.csv`.

    Lots are added in the proportion in which the published benchmark has questions, until no more fit: first without
    crowding places and without long questions, then with them.
    """
    planner = Planner(
        sites_of(places, expressions, fitting_types),
        scene,
        LOT_SIZE,
        np.random.default_rng(0),
        {},
        has_room=has_room or any_room,
    )
    easy = _fill_up(planner, dict.fromkeys(KINDS, 0), crowd=False)
    return SceneCapacity(scene, room_type, easy, _fill_up(planner, easy, crowd=True))


def _fill_up(planner: Planner[P], had: Mapping[QuestionKind, int], crowd: bool) -> dict[QuestionKind, int]:
    """Add lots to those that a room has until no more fit; returns how many there are."""
    lots, waiting = dict(had), list(KINDS)
    while waiting:
        kind = min(waiting, key=lambda k: ((lots[k] + 1) / WANTED[k], KINDS.index(k)))
        if lots[kind] < MOST_LOTS and _add_lot(planner, kind, crowd):
            lots[kind] += 1
        else:
            waiting.remove(kind)
    return lots


def _add_lot(planner: Planner[P], kind: QuestionKind, crowd: bool) -> bool:
    """Add the groups of one lot; False if there is no room for all of them."""
    answers = question_rules().answers(kind)
    lot = dict.fromkeys(answers, LOT_SIZE // len(answers))
    shapes = shapes_of(kind, lot, planner.configurations, planner.scene)
    return all(planner.add(kind, shape, crowd=crowd) for shape in shapes)


def write_capacities(rooms: Iterable[SceneCapacity], path: Path) -> None:
    """Write the table."""
    names = ["scene", "room_type", *KINDS, *(f"{kind}_most" for kind in KINDS)]
    lines = [HEADER + ",".join(names)]
    for room in rooms:
        numbers = [*(room.lots[kind] for kind in KINDS), *(room.most[kind] for kind in KINDS)]
        lines.append(",".join([room.scene, room.room_type, *map(str, numbers)]))
    with atomic_path(path) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8")


def table_path() -> Path:
    """Where the table is in a checkout."""
    return Path(__file__).parents[2] / "templates" / TABLE


if __name__ == "__main__":
    write_capacities(map(measured_capacity, scene_names()), Path(sys.argv[1]) if len(sys.argv) > 1 else table_path())
