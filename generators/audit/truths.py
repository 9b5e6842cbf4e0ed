"""The truths that a stored question must satisfy, checked from its row, its room's row and a freshly loaded world.

Nothing that generation found is trusted: answers are worked out anew, and pictures are drawn anew. Some of what it looks
with is used again: `surface_points`, `seen_share`, `most_pixels_anywhere`, the words of `question_words`, and the limits
`FRONT_DEG`, `LEAST_SHARE_BY_CHANCE` and `MOST_PIXELS`. The limits below are said again on purpose: where generation's
are lowered, that comes to light.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from typing import Literal

import numpy as np

from remqa_data.catalog import Manipulation
from remqa_data.errors import NoPathError, RemqaError, UnknownNameError, one_line
from remqa_data.generators.arrangement.hiding_goals import FRONT_DEG
from remqa_data.generators.audit.failures import Broken, Failure, Truth
from remqa_data.generators.audit.question_words import asked, understood
from remqa_data.generators.provable import LEAST_SHARE_BY_CHANCE, seen_share
from remqa_data.generators.seen_anywhere import MOST_PIXELS, most_pixels_anywhere
from remqa_data.generators.walks.scene_walk import EMBODIMENT
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import degrees_apart
from remqa_data.geometry.types import F64
from remqa_data.language.answers import execute, is_clear
from remqa_data.language.inner_relations import inner_of, is_sure, needed
from remqa_data.language.question_rules import NO
from remqa_data.language.referring import resolve
from remqa_data.metrics import DISTANCE_SLACK_M, SUCCESS_DISTANCE_M, distance_to_goal_m
from remqa_data.scene import Scene
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.sim.agent.actions import DONE, MANIPULATION, MOVE, OPEN, PICK_UP, parse_actions, walk_and_rest
from remqa_data.sim.agent.replay import Replay
from remqa_data.sim.metadata import (
    AgentState,
    changed_pixels,
    is_visible,
    object_metadata,
    scaled_min_pixels,
    tight_box,
)
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.navigation.grid import reach_distance, reachable_grid
from remqa_data.sim.navigation.paths import path_length_m, poses_along, shortest_actions
from remqa_data.sim.navigation.viewpoints import FRAME_PX, front_points, surface_points
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.contrast import contrast_de
from remqa_data.tables.images import (
    RgbFormat,
    decode_depth,
    decode_instances,
    decode_rgb,
    encode_depth,
    encode_instances,
    encode_rgb,
    image_size,
)
from remqa_data.tables.rows import GridCell, QuestionRow, SceneRow, configuration_name
from remqa_data.tables.schema import table_spec

CHANGED_FACTOR = 4
"""A manipulation changes so many times the pixels that an object needs to be visible."""
MOST_MOVED_M = 0.001
"""What moves by no more than this has stayed where it was."""
LEAST_CONTRAST_DE = 8.0
"""Of counted objects and their surroundings in the end frame, as it is stored."""
NOTICED_PX = 10
"""Of a thing of the asked type that comes to light elsewhere, so many pixels of 300 x 300 would be counted."""
PNG = b"\x89PNG"
LEAST_EVIDENCE_PX, LEAST_TARGET_PX = 50, 14
"""Pixels of each counted object, and along the short side of the target's box, in a view of 300 x 300."""


class CheckedRoom:
    """A stored configuration, loaded once for what its questions share.

    Parameters
    ----------
    row : SceneRow
        The configuration.

    Raises
    ------
    RemqaError
        If it cannot be loaded.
    """

    def __init__(self, row: SceneRow) -> None:
        self.row = row
        self.name = configuration_name(row.scene, row.configuration)
        self.scene = Scene.from_json(row.scene_json, self.name)
        with World(self.scene) as world:
            self.records = object_metadata(world)
            self.grid = reachable_grid(world)
        self.graph = SceneGraph.from_objects(self.records.values())
        self.loose_graph = SceneGraph.from_objects(self.records.values(), self.graph.rules.loosened())

    def failures(self) -> Iterator[Failure]:
        """What the configuration's row says of the room, and is not so."""
        if len(self.records) != len(self.row.objects):
            yield Failure(self.name, "consistent", f"{len(self.row.objects)} objects are listed of {len(self.records)}")
        for stored in self.row.objects:
            if self.records.get(stored.id) != stored:
                yield Failure(self.name, "consistent", f"{stored.id} is not as its ground truth says")
        if tuple(stored.id for stored in self.row.objects) != tuple(self.records):
            yield Failure(self.name, "consistent", "objects are not in the order of the room")
        if self.row.navigation_cells != tuple(GridCell(*cell) for cell in self.grid.cells):
            yield Failure(self.name, "consistent", "the agent can stand on other cells than those listed")
        if self.row.walk_start_cell not in self.grid.graph:
            yield Failure(self.name, "reachable", "the walk starts where the agent cannot stand")
        if self.row.embodiment != EMBODIMENT:
            yield Failure(self.name, "consistent", "the embodiment is not that of the agent")
        if (self.scene.name, self.scene.room_type) != (self.row.scene, self.row.room_type):
            yield Failure(self.name, "consistent", f"scene_json is of {self.scene.name}, a {self.scene.room_type}")
        if self.scene.to_json() != self.row.scene_json.encode():
            yield Failure(self.name, "consistent", "scene_json is not written as scenes are")

    def question_failures(self, question: QuestionRow) -> Iterator[Failure]:
        """What does not hold of a question about this configuration; it is replayed in a world of its own."""
        sizes = {image_size(getattr(question, name).bytes) for name in table_spec("questions").image_columns}
        if len(sizes) > 1:
            yield Failure(question.question_id, "consistent", f"its pictures are of {len(sizes)} sizes")
            return  # they cannot be compared
        for check in (self._is_consistent, self._words, self._pictures, self._seen_well, self._way, self._replayed):
            try:
                for truth, reason in check(question):
                    yield Failure(question.question_id, truth, reason)
            except RemqaError as error:
                yield Failure(question.question_id, _TRUTH_OF[check.__name__], one_line(error))

    def _is_consistent(self, question: QuestionRow) -> Iterator[Broken]:
        if (question.split, question.room_type) != (self.row.split, self.row.room_type):
            yield "consistent", f"split and room type are not those of {self.name}"
        shown = [decode_instances(image.bytes) for image in (question.start_instances, question.end_instances)]
        numbers = [int(number) for number in np.union1d(*shown) if number]
        if numbers != list(range(1, len(question.object_ids) + 1)):
            yield "consistent", "object_ids are not the objects that the views show"
        if question.object_ids != tuple(i for i in self.records if i in set(question.object_ids)):
            yield "consistent", "object_ids are not objects of the room, in its order"
        if self.type_of(question.target_id) != question.target_type:
            yield "consistent", f"{question.target_id} is no {question.target_type}"
        if question.expression not in question.question:
            yield "consistent", f"the question does not say {question.expression!r}"
        _, rest = walk_and_rest(parse_actions(question.actions))
        acted = [(action.name, action.target) for action in rest]
        if acted != [(_WORD_OF[question.manipulation], question.manipulation_object_id), (DONE, None)]:
            yield "consistent", f"the actions do not {question.manipulation} {question.manipulation_object_id}"
        if question.manipulation_object_id != question.target_id:
            yield "consistent", f"{question.manipulation_object_id} is not what the expression means"

    def _words(self, question: QuestionRow) -> Iterator[Broken]:
        """The answer, and what the expression picks out, by executing the program and reading the expression."""
        meant = resolve(understood(question.expression), self.graph)
        if meant != [question.target_id]:
            names = ", ".join(meant) or "nothing"
            yield "unique", f"{question.expression!r} picks out {names}, not {question.target_id}"
        program = asked(question)
        if question.program != json.dumps(program):
            yield "answer", "the program is not that of the question's words"
        answer = execute(program, self.graph)
        if answer.text != question.answer:
            yield "answer", f"the answer is {answer.text}, not {question.answer}"
        elif answer.ids != question.answer_ids:
            yield "answer", f"the objects that make the answer are {', '.join(answer.ids) or 'none'}"
        for object_id in answer.ids:
            if self.type_of(object_id) != question.answer_type:
                yield "answer", f"{object_id} is no {question.answer_type}"
        if not is_clear(program, self.graph, self.loose_graph):
            yield "clear", "something else nearly fits the question"
        inner = inner_of(program)
        if inner is not None and not is_sure(inner, self.graph, question.answer):
            yield "clear", "it is hard to say how the things lie"

    def _pictures(self, question: QuestionRow) -> Iterator[Broken]:
        """What the stored pictures show before and after the manipulation."""
        before = decode_instances(question.start_instances.bytes)
        after = decode_instances(question.end_instances.bytes)
        end_rgb = decode_rgb(question.end_rgb.bytes)
        least = scaled_min_pixels(before.shape)
        clear = round(LEAST_EVIDENCE_PX * before.size / FRAME_PX**2)
        target = before == _number(question, question.target_id)
        if not is_visible(target):
            yield "visible", f"{question.target_id} shows {np.count_nonzero(target)} pixels in the start frame"
        if question.start_target_box_2d != tight_box(target):
            yield (
                "visible",
                f"the box of {question.target_id} is {tight_box(target)}, not {question.start_target_box_2d}",
            )
        for object_id in needed(asked(question), question.answer_ids, self.graph):
            shown, revealed = (np.count_nonzero(image == _number(question, object_id)) for image in (before, after))
            if shown:
                yield "necessary", f"{object_id} shows {shown} pixels before the manipulation"
            if revealed < clear:
                yield "sufficient", f"{object_id} shows {revealed} pixels afterwards, and {clear} are needed"
            elif contrast_de(end_rgb, after == _number(question, object_id)) < LEAST_CONTRAST_DE:
                yield "distinct", f"{object_id} hardly stands out from what surrounds it in the end frame"
        depths = decode_depth(question.start_depth.bytes), decode_depth(question.end_depth.bytes)
        changed = changed_pixels((before, depths[0]), (after, depths[1]))
        if changed < CHANGED_FACTOR * least:
            yield "sufficient", f"the manipulation changes {changed} pixels, and {CHANGED_FACTOR * least} are needed"

    def _seen_well(self, question: QuestionRow) -> Iterator[Broken]:
        """The target is no sliver and seen from before its front."""
        scale = len(decode_instances(question.start_instances.bytes)) / FRAME_PX
        x1, y1, x2, y2 = question.start_target_box_2d or (0, 0, 0, 0)
        if min(x2 - x1, y2 - y1) < LEAST_TARGET_PX * scale:
            yield "visible", f"the box of {question.target_id} is {x2 - x1} x {y2 - y1} pixels"
        if not question.goal_poses:
            raise NoPathError("there is no goal pose")
        self.type_of(question.target_id)
        if question.manipulation == "Open":
            record = self.records[question.target_id]
            x, y, _ = question.goal_poses[0].position
            dx, dy = x - (record.box[0] + record.box[3]) / 2, y - (record.box[1] + record.box[4]) / 2
            aside_deg = degrees_apart(math.degrees(arithmetic.arctan2(dy, dx)), record.facing_deg or 0.0)
            if aside_deg > FRONT_DEG + 1e-6:
                yield "visible", f"the goal is {aside_deg:.0f} degrees off the front of {question.target_id}"

    def _way(self, question: QuestionRow) -> Iterator[Broken]:
        """The shortest way leads to the first goal, and from every goal the arm reaches the target."""
        if not question.goal_poses:
            raise NoPathError("there is no goal pose")
        start, goals = question.initial_pose.pose(), [goal.pose() for goal in question.goal_poses]
        stored = (question.initial_pose, *question.goal_poses)
        if any(AgentState.of(self.grid, pose) != state for pose, state in zip((start, *goals), stored, strict=True)):
            yield "reachable", "a pose is not on the grid"
        ways = np.array([goal.position[:2] for goal in question.goal_poses])
        away_m = float(distance_to_goal_m(question.initial_pose.position[:2], ways))
        if away_m <= SUCCESS_DISTANCE_M + DISTANCE_SLACK_M:
            yield "away", f"the start is {away_m:.2f} m from a goal pose, and {SUCCESS_DISTANCE_M} m count as there"
        walk, _ = walk_and_rest(parse_actions(question.actions))
        if poses_along(self.grid, start, (step.name for step in walk))[-1] != goals[0]:
            yield "reachable", "the actions do not lead to the first goal pose"
        steps = len(walk)
        shortest = len(shortest_actions(self.grid, start, goals[0]))
        if not steps == question.path_steps == shortest:
            yield "reachable", f"{steps} steps are taken, {question.path_steps} are told, and {shortest} are enough"
        length = path_length_m(self.grid, start.cell, goals[0].cell)
        if question.path_length_m != length:
            yield "reachable", f"the shortest path is {length} m, not {question.path_length_m} m"
        unreachable = [goal.cell for goal in goals if goal.cell not in self.grid.graph]
        if unreachable:
            raise NoPathError(f"the agent cannot get to {unreachable[0]}")

    def _replayed(self, question: QuestionRow) -> Iterator[Broken]:
        """The oracle's actions, in a freshly loaded world, give the stored pictures."""
        actions = parse_actions(question.actions)
        replay = Replay(self.scene, question.initial_pose.pose())
        try:
            for number, goal in enumerate(question.goal_poses):
                if goal in question.goal_poses[:number]:
                    yield "consistent", f"goal pose {number} is there twice"
                distance = _reach_m(replay, question, goal.position)
                if distance > AGENT.reach_m:
                    yield (
                        "reachable",
                        f"the arm reaches {AGENT.reach_m} m, and {question.target_id} is {distance:.3f} m off",
                    )
                seen = replay.view.instances(goal.pose().camera(replay.grid))
                if not is_visible(seen == replay.world.ids.index(question.target_id)):
                    yield "visible", f"{question.target_id} is not seen from goal pose {number}"
            is_manipulated = False
            for action in actions:
                if action.name in MANIPULATION and not is_manipulated:
                    is_manipulated = True
                    yield from _different(question, replay, "start")
                    evidence = needed(asked(question), question.answer_ids, self.graph)
                    if evidence:
                        shown = most_pixels_anywhere(replay.view, replay.grid, evidence, [question.target_id])
                        if shown > MOST_PIXELS:
                            yield (
                                "necessary",
                                f"the evidence shows {shown} pixels from elsewhere before the manipulation",
                            )
                    positions = _corners(replay.world)
                replay.step(action)
            yield from _different(question, replay, "end")
            is_none = question.answer in (NO, "0") and inner_of(asked(question)) is None
            if is_manipulated and is_none and question.goal_poses:
                share = seen_share(replay, question)
                if share < LEAST_SHARE_BY_CHANCE:
                    yield (
                        "provable",
                        f"one sees {share:.0%} of the ways in which a {question.answer_type} could lie there",
                    )
            if is_manipulated:
                yield from self._is_undisturbed(question, positions, replay)
        finally:
            replay.close()

    def _is_undisturbed(self, question: QuestionRow, before: F64, replay: Replay) -> Iterator[Broken]:
        """What the manipulation moves was in the target by the stored records, and all that comes to light is counted."""
        ids = replay.world.ids
        shift = np.abs(_corners(replay.world) - before).max(axis=(1, 2))
        for index in np.flatnonzero(shift > MOST_MOVED_M):
            if ids[index] != question.target_id and question.target_id not in self._holders(ids[index], question):
                yield "undisturbed", f"{ids[index]} moves by {shift[index]:.3f} m"
        start, end = (decode_instances(image.bytes) for image in (question.start_instances, question.end_instances))
        revealed = np.setdiff1d(end, [0, *np.unique(start)])
        revealed = revealed[[np.count_nonzero(end == n) * FRAME_PX**2 >= NOTICED_PX * end.size for n in revealed]]
        if len(revealed) and revealed.max() > len(question.object_ids):
            yield "consistent", f"the end view shows object {revealed.max()} of {len(question.object_ids)}"
            return
        shown = [question.object_ids[number - 1] for number in revealed]
        records = object_metadata(replay.world)
        program = asked(question)
        if inner_of(program) is not None:
            again = execute(program, SceneGraph.from_objects(records.values()))
            if again.ids != question.answer_ids:
                yield "undisturbed", f"after acting the answer is {again.text}"
            return
        found = sorted(name for name in shown if self.type_of(name) == question.answer_type)
        if found != sorted(question.answer_ids):
            yield "undisturbed", f"after acting one counts {', '.join(found) or 'nothing'}"
        held_by = {name: record.support for name, record in records.items()}
        for name in question.answer_ids:
            self.type_of(name)
            if question.manipulation == "Open" and held_by[name] != question.target_id:
                yield "undisturbed", f"{name} is not in {question.target_id} after it was opened"
            if question.manipulation != "Open" and shift[ids.index(name)] > MOST_MOVED_M:
                yield "undisturbed", f"{name} moves by {shift[ids.index(name)]:.3f} m"

    def _holders(self, object_id: str, question: QuestionRow) -> set[str]:
        """What holds an object by the stored records, and what holds that; of what is opened, only what is inside counts."""
        found: set[str] = set()
        record = self.records[object_id]
        for _ in self.records:
            if record.support is None:
                break
            if record.support != question.target_id or question.manipulation != "Open" or record.support_kind == "in":
                found.add(record.support)
            record = self.records[record.support]
        return found

    def type_of(self, object_id: str) -> str:
        """Type of an object; UnknownNameError if there is none."""
        if object_id not in self.records:
            raise UnknownNameError("object", object_id, self.records)
        return self.records[object_id].type


_TRUTH_OF: dict[str, Truth] = {
    "_is_consistent": "consistent",
    "_words": "answer",
    "_pictures": "visible",
    "_seen_well": "visible",
    "_way": "reachable",
    "_replayed": "replayable",
}
"""What an error in each check breaks."""
_WORD_OF: dict[Manipulation, str] = {"Open": OPEN, "Move": MOVE, "Pickup": PICK_UP}


def _number(question: QuestionRow, object_id: str) -> int:
    """Which value means an object in the instance images."""
    if object_id not in question.object_ids:
        raise UnknownNameError("object", object_id, question.object_ids)
    return question.object_ids.index(object_id) + 1


def _corners(world: World) -> F64:
    """(objects, 2, 3) corners of the boxes around all objects, metres."""
    return np.array([world.box(object_id) for object_id in world.ids])


def _reach_m(replay: Replay, question: QuestionRow, position: tuple[float, float, float]) -> float:
    """From the shoulder of an agent to the nearest point where the target can be taken hold of; metres."""
    if question.manipulation == "Open":
        points = front_points(replay.view, question.target_id)
    else:
        points = surface_points(replay.world, question.target_id)
    return min(reach_distance(position[:2], position[2], point) for point in points)


def _different(question: QuestionRow, replay: Replay, when: Literal["start", "end"]) -> Iterator[Broken]:
    """Which stored images of the start or the end are not what is seen now, byte for byte."""
    stored = {name: getattr(question, f"{when}_{name}").bytes for name in ("rgb", "depth", "instances")}
    seen = replay.observe(len(decode_instances(stored["instances"])))
    form: RgbFormat = "png" if stored["rgb"].startswith(PNG) else "jpeg"
    now = {
        "rgb": encode_rgb(seen.rgb, form=form),
        "depth": encode_depth(seen.depth),
        "instances": encode_instances(seen.objects, replay.world.ids, question.object_ids),
    }
    for name, image in now.items():
        if image.bytes != stored[name]:
            yield "replayable", f"{when}_{name} is not what is seen"
    unlisted = [replay.world.ids[i] for i in np.unique(seen.objects) if i >= 0]
    unlisted = [object_id for object_id in unlisted if object_id not in question.object_ids]
    if unlisted:
        yield "consistent", f"object_ids lack {unlisted[0]}, which the {when} view shows"
