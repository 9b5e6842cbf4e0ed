"""Referring expressions, understood anew: each picks out its target in the stored room, and a frame shows it."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

from remqa_data.errors import RemqaError, one_line
from remqa_data.floorplans.splits import expression_split
from remqa_data.generators.audit.failures import Broken, Failure
from remqa_data.generators.audit.question_words import understood
from remqa_data.generators.audit.truths import CheckedRoom
from remqa_data.language.referring import Program, candidates, resolve
from remqa_data.language.rules import SEEN_AS_ONE, may_be_called
from remqa_data.tables.rows import ExpressionRow, FrameRow


def expression_failures(
    room: CheckedRoom, frames: Sequence[FrameRow], expressions: Sequence[ExpressionRow]
) -> Iterator[Failure]:
    """What does not hold of the expressions of one configuration.

    Parameters
    ----------
    room : CheckedRoom
        The configuration.
    frames : sequence of FrameRow
        All its frames, in order.
    expressions : sequence of ExpressionRow
        All its expressions, in order.
    """
    by_name = {frame.frame_id: frame for frame in frames}
    for said in expressions:
        try:
            for truth, reason in (
                *_meaning(room, said),
                *_view(said, by_name.get(said.frame_id)),
                *_anchor(room, said),
            ):
                yield Failure(said.expression_id, truth, reason)
        except RemqaError as error:
            yield Failure(said.expression_id, "unique", one_line(error))
    texts = [(said.target_id, said.text) for said in expressions]
    for target, text in dict.fromkeys(texts):
        if texts.count((target, text)) > 1:
            yield Failure(f"{room.name}: {target}", "complete", f"{text!r} is said {texts.count((target, text))} times")


def _meaning(room: CheckedRoom, said: ExpressionRow) -> Iterator[Broken]:
    """The words pick out the target, and nothing else comes near; the program and the columns say the same."""
    program = understood(said.text)
    meant = resolve(program, room.graph)
    if meant != [said.target_id]:
        yield "unique", f"{said.text!r} picks out {', '.join(meant) or 'nothing'}, not {said.target_id}"
    elif candidates(program, room.loose_graph) != meant:
        yield "clear", f"something else nearly fits {said.text!r}"
    if said.program != json.dumps(program):
        yield "consistent", "the program is not that of the words"
    if said.target_type != room.type_of(said.target_id):
        yield "consistent", f"{said.target_id} is no {said.target_type}"
    if said.split != expression_split(said.scene):
        yield "consistent", f"split is not that of the expressions of {said.scene}"
    if said.kind != _kind(program):
        yield "consistent", f"the expression is of the kind {_kind(program)}, not {said.kind}"


def _view(said: ExpressionRow, frame: FrameRow | None) -> Iterator[Broken]:
    """The frame shows the target and the landmark, and the box is where it shows the target."""
    boxes = {seen.id: seen.box_2d for seen in frame.objects} if frame is not None else {}
    if said.target_id not in boxes:
        yield "visible", f"{said.frame_id} does not show {said.target_id}"
    elif said.box_2d != boxes[said.target_id]:
        yield "visible", f"the box of {said.target_id} is {boxes[said.target_id]}, not {said.box_2d}"
    if said.anchor_id is not None and said.anchor_id not in boxes:
        yield "visible", f"{said.frame_id} does not show {said.anchor_id}, which the words lean on"


def _anchor(room: CheckedRoom, said: ExpressionRow) -> Iterator[Broken]:
    """What the expression leans on, and how."""
    leaning = next((step for step in understood(said.text) if step[0] in ("relate", "closest")), None)
    if leaning is None:
        if (said.relation, said.anchor_id) != (None, None):
            yield "consistent", "the expression leans on no other object"
        return
    relation = "closest to" if leaning[0] == "closest" else leaning[1]
    if said.relation != relation:
        yield "consistent", f"the relation is {relation}, not {said.relation}"
    if said.anchor_id is None or said.anchor_id not in resolve(leaning[-1], room.graph):
        yield "consistent", f"{said.anchor_id} is not what the expression leans on"
    elif len(_called(room, said.anchor_id)) > 1 and room.type_of(said.anchor_id) not in SEEN_AS_ONE:
        yield "unique", f"{said.text!r} leans on one of several things that are called so"
    elif leaning[0] == "relate" and room.graph.relation(said.target_id, said.anchor_id) != relation:
        yield "consistent", f"{said.target_id} is not {relation} {said.anchor_id}"


def _kind(program: Program) -> str:
    steps = {step[0] for step in program}
    if steps & {"closest", "row", "stack"}:
        return "superlative"
    if steps & {"filter_color", "filter_substance"}:
        return "attribute"
    return "relation" if "relate" in steps else "bare"


def _called(room: CheckedRoom, object_id: str) -> list[str]:
    """The objects of the room that the word for one of them may mean."""
    names = may_be_called(room.type_of(object_id))
    return [name for name, record in room.records.items() if record.type in names]
