"""One task: walk to a place, manipulate it, look. Made only if it keeps every truth that docs/ARCHITECTURE.md names.

A sample that fails a check is refused, with the name of the truth that it would have broken.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from remqa_data.errors import ActionError
from remqa_data.generators.arrangement.hiding_place import HidingPlace
from remqa_data.generators.arrangement.hiding_rules import hiding_rules
from remqa_data.generators.arrangement.interior_view import LEAST_SHARE, share_in_view
from remqa_data.generators.audited_room import AuditedRoom
from remqa_data.generators.provable import LEAST_SHARE_BY_CHANCE
from remqa_data.generators.questions.groups import GroupPlan
from remqa_data.generators.questions.questions import Candidate, mentioned_types
from remqa_data.generators.revealed import Views
from remqa_data.generators.undisturbed import counted_again, disturbed
from remqa_data.language.answers import Answer, execute, is_clear
from remqa_data.language.inner_relations import inner_of, is_sure, needed
from remqa_data.metrics import DISTANCE_SLACK_M, SUCCESS_DISTANCE_M
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.sim.agent.actions import DONE, Action, move_action, open_action, pick_up_action
from remqa_data.sim.metadata import (
    AgentState,
    changed_pixels,
    scaled_min_pixels,
    tight_box,
)
from remqa_data.sim.navigation.grid import Cell, ReachableGrid
from remqa_data.sim.navigation.paths import path_length_m, shortest_actions
from remqa_data.sim.navigation.viewpoints import HEADINGS_DEG, AgentPose, pixel_counts
from remqa_data.sim.render.contrast import contrast_de
from remqa_data.sim.render.view import Observation
from remqa_data.tables.images import decode_rgb, encode_depth, encode_instances, encode_rgb
from remqa_data.tables.rows import QuestionRow

Truth = Literal[
    "answer",
    "unique",
    "clear",
    "reachable",
    "away",
    "visible",
    "necessary",
    "sufficient",
    "distinct",
    "provable",
    "undisturbed",
    "replayable",
]
"""What a refused sample would have broken: `answer` is that the room holds what was planned, `visible` that the target
is seen from the goal pose, `clear` that no other object nearly fits the question, `undisturbed` that acting moves nothing
else and that counting afterwards gives the answer; docs/ARCHITECTURE.md lists them all."""

AWAY_M = SUCCESS_DISTANCE_M + DISTANCE_SLACK_M
"""Who starts nearer to a goal pose than this, and looks at the target, has arrived without a step."""
LEAST_STARTS = 12
"""A further goal pose counts if it leaves so many cells to start from."""
LEAST_CONTRAST_DE = 8.2
"""Of evidence and its surroundings in the picture as it is stored; 8 are asked for, by whoever measures it otherwise."""


CHANGED_FACTOR, CHANGED_M = 4, 1e-3
"""A manipulation changes so many times the pixels that an object needs to be visible: what they show, or how far that is."""


class Refusal(NamedTuple):
    """Why a sample was not made."""

    truth: Truth
    what: str


def make_sample(room: AuditedRoom, group: GroupPlan[HidingPlace], rng: np.random.Generator) -> QuestionRow | Refusal:
    """The sample of one group in one configuration, audited; or why there is none.

    Parameters
    ----------
    room : AuditedRoom
        The configuration; it is at rest again afterwards.
    group : GroupPlan
        The question, its place and the answer planned for this configuration.
    rng : Generator
        Draws where the agent starts.
    """
    question, hiding = group.question, group.question.place
    answer = execute(question.program, room.graph)
    refusal = _misasked(room, group, answer.text)
    if refusal is not None:
        return refusal
    witness_ids = needed(question.program, answer.ids, room.graph)
    manipulation = _manipulation(hiding)
    found = _goal(room, question, witness_ids, manipulation)
    if isinstance(found, Refusal):
        return found
    goal, views = found
    others = (pose for pose in (hiding.goal, *hiding.other_goals) if pose != goal and pose.cell in room.grid.graph)
    goals, cells = goals_and_starts(room.grid, [goal, *others])
    if not cells:
        return Refusal("away", f"the agent stands nowhere farther than {AWAY_M} m from the goal at {hiding.object_id}")
    start = AgentPose(cells[int(rng.integers(len(cells)))], int(rng.choice(HEADINGS_DEG)))
    way = [Action(name) for name in shortest_actions(room.grid, start, goal)]
    refusal = _disturbance(room, group, answer.ids, views)
    if refusal is None and witness_ids and not room.hides(hiding, witness_ids):
        refusal = Refusal("necessary", f"what {hiding.object_id} hides is seen from elsewhere")
    if refusal is not None:
        return refusal
    if not (_leads_to(room, start, way, goal) and room.repeats(goal, manipulation)):
        return Refusal("replayable", f"{hiding.object_id}: the actions end in another picture")
    task = _Task(start, goals, (*way, manipulation, Action(DONE)), path_length_m(room.grid, start.cell, goal.cell))
    sample = _row(room, group, answer, task, views)
    shows_something = answer.ids or inner_of(question.program) is not None
    if not shows_something and room.share_by_chance(goal, manipulation, sample) < LEAST_SHARE_BY_CHANCE:
        return Refusal("provable", f"too little of what {hiding.object_id} hides comes to light, tried at random")
    return sample


class _Task(NamedTuple):
    """What the agent is to do: from where, to one of which poses, and how the shortest way goes."""

    start: AgentPose
    goals: Sequence[AgentPose]
    actions: tuple[Action, ...]
    length_m: float


def _row(room: AuditedRoom, group: GroupPlan[HidingPlace], answer: Answer, task: _Task, views: Views) -> QuestionRow:
    """The sample as it is stored."""
    question, hiding = group.question, group.question.place
    before, after = views.before, views.after
    name, form = f"{group.name}-c{room.info.configuration}", room.rgb_format
    ids = room.replay.world.ids
    shown = shown_ids(before, after, ids)
    return QuestionRow(
        question_id=name,
        kind=question.kind,
        question=question.text,
        expression=question.expression.text,
        answer=answer.text,
        program=json.dumps(question.program),
        scene=room.info.scene,
        room_type=room.info.room_type,
        configuration=room.info.configuration,
        split=room.info.split,
        group=group.name,
        initial_pose=AgentState.of(room.grid, task.start),
        goal_poses=tuple(AgentState.of(room.grid, pose) for pose in task.goals),
        target_id=hiding.object_id,
        target_type=hiding.type,
        start_target_box_2d=tight_box(before.objects == ids.index(hiding.object_id)),
        answer_type=question.type,
        answer_ids=answer.ids,
        manipulation=hiding.manipulation,
        manipulation_object_id=hiding.object_id,
        path_length_m=task.length_m,
        path_steps=len(task.actions) - 2,  # the others are the manipulation and Done
        actions=tuple(map(str, task.actions)),
        start_rgb=encode_rgb(before.rgb, f"{name}-start", form=form),
        start_depth=encode_depth(before.depth, f"{name}-start-depth"),
        start_instances=encode_instances(before.objects, ids, shown, f"{name}-start-instances"),
        end_rgb=encode_rgb(after.rgb, f"{name}-end", form=form),
        end_depth=encode_depth(after.depth, f"{name}-end-depth"),
        end_instances=encode_instances(after.objects, ids, shown, f"{name}-end-instances"),
        object_ids=shown,
    )


def goals_and_starts(grid: ReachableGrid, goals: Sequence[AgentPose]) -> tuple[list[AgentPose], list[Cell]]:
    """The goal poses that count, and the cells from which it is a walk to each of them.

    Parameters
    ----------
    grid : ReachableGrid
        Where the agent can stand.
    goals : sequence of AgentPose
        The best first. In a small room the others count only as long as they leave something to start from.

    Returns
    -------
    Goal poses, the first always among them, and cells that are farther than `AWAY_M` from all of them; there may be none.
    """
    kept: list[AgentPose] = []
    starts = list(grid.cells)
    for goal in goals:
        left = [cell for cell in starts if math.dist(grid.position(cell), grid.position(goal.cell)) > AWAY_M]
        if not kept or len(left) >= LEAST_STARTS:
            kept, starts = [*kept, goal], left
    return kept, starts


def shown_ids(before: Observation, after: Observation, ids: Sequence[str]) -> tuple[str, ...]:
    """Ids of the objects of which one of two views shows anything, in the order of the room."""
    seen = pixel_counts(before.objects, len(ids)) + pixel_counts(after.objects, len(ids))
    return tuple(object_id for object_id, pixels in zip(ids, seen, strict=True) if pixels)


def _misasked(room: AuditedRoom, group: GroupPlan[HidingPlace], answer: str) -> Refusal | None:
    """What the graph says against a question: another answer than was planned, or that it is not clear what it means."""
    question, hiding = group.question, group.question.place
    wanted = group.answers[room.info.configuration]
    if answer != wanted:
        return Refusal("answer", f"{question.text} is {answer}, planned was {wanted}")
    if question.expression.text not in {found.text for found in room.expressions.of(hiding.object_id)}:
        return Refusal("unique", f"{question.expression.text} does not pick out {hiding.object_id} only")
    if not is_clear(question.program, room.graph, room.loose_graph):
        return Refusal("clear", f"{question.text}: something else nearly fits")
    inner = inner_of(question.program)
    if inner is not None and not is_sure(inner, room.graph, wanted):
        return Refusal("clear", f"{question.text}: it is hard to say")
    return None


def _goal(
    room: AuditedRoom, question: Candidate[HidingPlace], witness_ids: tuple[str, ...], manipulation: Action
) -> tuple[AgentPose, Views] | Refusal:
    """The first goal pose that can be acted from and sees what it should, and its views; or why there is none.

    Those that see what the question tells its target by come first.
    """
    hiding, landmarks = question.place, mentioned_types(question.expression.program[1:])
    goals = [goal for goal in (hiding.goal, *hiding.other_goals) if goal.cell in room.grid.graph]
    refusals: list[Refusal] = []
    for goal in sorted(goals, key=lambda goal: bool(landmarks) and not landmarks <= room.types_in_view(goal)):
        try:
            views = room.views(goal, manipulation)
        except ActionError as error:
            refusals.append(Refusal("reachable", str(error)))
            continue
        found = _check_views(room, hiding, witness_ids, views)
        if found is None and not witness_ids:
            motion = views.motion if hiding.relation == "in" else None
            looks = room.looks(hiding, goal, manipulation, motion)
            share = share_in_view(hiding.interior, motion, looks, views.revealed, question.type)
            if share < LEAST_SHARE:
                found = Refusal("provable", f"only {share:.2f} of what {hiding.object_id} hides comes to light")
        if found is None:
            return goal, views
        refusals.append(found)
    return next(iter(refusals), Refusal("reachable", f"no way to {hiding.object_id}"))


def _manipulation(hiding: HidingPlace) -> Action:
    if hiding.manipulation == "Open":
        return open_action(hiding.object_id)
    if hiding.manipulation == "Pickup":
        return pick_up_action(hiding.object_id)
    assert hiding.move_to is not None, f"{hiding.object_id} is to be moved, but nowhere"
    return move_action(hiding.object_id, hiding.move_to)


def _check_views(room: AuditedRoom, hiding: HidingPlace, witness_ids: tuple[str, ...], views: Views) -> Refusal | None:
    """Whether the pictures show the target before, and the evidence clearly and only after."""
    before, after = views.before, views.after
    ids, rules = room.replay.world.ids, hiding_rules()
    least = scaled_min_pixels(before.objects.shape)
    target = tight_box(before.objects == ids.index(hiding.object_id))
    if target is None or min(target[2] - target[0], target[3] - target[1]) < rules.min_target_px:
        return Refusal("visible", f"{hiding.object_id} is a sliver at most from its goal pose")
    stored = decode_rgb(encode_rgb(after.rgb, form=room.rgb_format).bytes)
    for object_id in witness_ids:
        index = ids.index(object_id)
        if (before.objects == index).any():
            return Refusal("necessary", f"{object_id} is seen before the manipulation")
        if np.count_nonzero(after.objects == index) < rules.min_evidence_px:
            return Refusal("sufficient", f"{object_id} shows fewer than {rules.min_evidence_px} pixels afterwards")
        if contrast_de(stored, after.objects == index) < LEAST_CONTRAST_DE:
            return Refusal("distinct", f"{object_id} hardly stands out from what surrounds it")
    changed = changed_pixels((before.objects, before.depth), (after.objects, after.depth), CHANGED_M)
    if changed < CHANGED_FACTOR * least:
        return Refusal("sufficient", f"the manipulation of {hiding.object_id} hardly changes the view")
    return None


def _disturbance(
    room: AuditedRoom, group: GroupPlan[HidingPlace], answer_ids: tuple[str, ...], views: Views
) -> Refusal | None:
    """Whether the manipulation moves nothing else, and the answer counted again after it is the same."""
    hiding, before, after = group.question.place, room.graph.objects, views.records
    moved = disturbed(before, after, hiding.object_id, hiding.manipulation)
    if moved:
        return Refusal("undisturbed", f"{hiding.object_id} takes {', '.join(moved)} along")
    if group.question.partner is not None:
        again = execute(group.question.program, SceneGraph.from_objects(after.values()))
        if again.ids != answer_ids:
            return Refusal("undisturbed", f"looked at again: {again.text}")
        return None
    inside = hiding.object_id if hiding.relation == "in" else None
    images, ids = (views.before.objects, views.after.objects), room.replay.world.ids
    counted = counted_again(before, after, images, ids, group.question.type, inside, answer_ids)
    if counted != set(answer_ids):
        return Refusal("undisturbed", f"counted again: {', '.join(sorted(counted)) or 'nothing'}")
    return None


def _leads_to(room: AuditedRoom, start: AgentPose, way: Sequence[Action], goal: AgentPose) -> bool:
    """Whether steps and turns, which leave the room as it is, take the agent from one pose to exactly another."""
    room.start_over(start)
    is_done = all(room.replay.attempt(action).success for action in way)
    return is_done and room.replay.pose == goal
