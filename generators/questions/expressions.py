"""Referring expressions: "the cabinet above the sink", each of which picks out exactly one object.

Every pair of nodes with an edge between them is a candidate. A candidate is kept when its program, executed on the
graph of the whole room, gives the target and nothing else, and when nothing else nearly fits it: not under loosened
thresholds, not under another reading of its words (see `remqa_data.language.referring.candidates`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product
from typing import Literal

from remqa_data.catalog import object_type, types_with
from remqa_data.geometry.boxes import centre_distance
from remqa_data.language.question_rules import ExpressionKind
from remqa_data.language.referring import Program, Step, candidates, resolve
from remqa_data.language.rules import BARE, DESCRIBED, RELATED, SEEN_AS_ONE, expression_rules, may_be_called
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.scene_graph.relations import Relation, relation_rules
from remqa_data.sim.metadata import ObjectMetadata

STACKED = types_with("in_stacks")
IN_ROWS = types_with("in_rows")
NEVER_TARGETS = types_with("never_target")
TAKEN_FOR_GRANTED = types_with("taken_for_granted")
CLOSED_OPENNESS = 0.05
"""A receptacle that is open by less than this hides what is inside."""


@dataclass(frozen=True)
class Expression:
    """A phrase for one object.

    Attributes
    ----------
    text : str
        Such as "the mug on the dining table".
    target_id, target_type : str
        What it picks out.
    relation : str or None
        What the target is to the anchor; None for a phrase without one.
    anchor_id : str or None
        The object that the phrase leans on: of several that fit its words, the one whose centre is nearest.
    kind : {"bare", "relation", "attribute", "superlative"}
        The last two mark the extension: phrases with a colour or a material; phrases with "closest to", or with a place
        in a stack ("top", "bottom", "middle") or in a row ("left", "right", "leftmost", "rightmost").
    program : tuple
        What `remqa_data.language.referring.resolve` executes; JSON-able.
    """

    text: str
    target_id: str
    target_type: str
    relation: str | None
    anchor_id: str | None
    kind: ExpressionKind
    program: Program


class Expressions:
    """The referring expressions of one room as it is.

    Parameters
    ----------
    graph : SceneGraph
        Of the whole room: `SceneGraph.from_objects(object_metadata(world).values())`.
    """

    def __init__(self, graph: SceneGraph) -> None:
        self.graph = graph
        self._loose = SceneGraph.from_objects(graph.objects.values(), graph.rules.loosened())
        self._picks: dict[Program, str | None] = {}
        self._count: dict[str, int] = {}
        for record in graph.objects.values():
            self._count[record.type] = self._count.get(record.type, 0) + 1

    def of(self, target_id: str) -> list[Expression]:
        """All expressions that pick out an object, best first; none for what expressions never ask about.

        First the bare noun, then relations to landmarks, the best landmarks first. Where the noun alone does not do, the
        extension follows: superlatives, then attributes, each tried only where the same phrase without it does not do.

        Raises
        ------
        UnknownNameError
            If the object is not in the graph.
        """
        target = self.graph.node(target_id)
        if target.type in NEVER_TARGETS:
            return []
        found: dict[str, Expression] = {}
        for expression in self._tried(target):
            if expression.text not in found and self._picked_out(expression) == target_id:
                found[expression.text] = expression
        return list(found.values())

    def _tried(self, target: ObjectMetadata) -> Iterator[Expression]:
        """Phrases that may pick out the target, best first."""
        bare = _expression(target, None)
        related = [_expression(target, anchor) for anchor in self._anchors(target)]
        yield bare
        yield from related
        if self._picked_out(bare):
            return
        closest = [_expression(target, anchor) for anchor in self._closest_anchors(target)]
        yield from closest
        for plain in (bare, *related, *closest):
            if not self._picked_out(plain):
                singles = list(_placed(target, plain, doubly=False))
                yield from singles
                if not any(self._picked_out(single) == target.id for single in singles):
                    yield from _placed(target, plain, doubly=True)
        for plain in (bare, *related):
            if not self._picked_out(plain):
                yield from _described(target, plain)

    def _anchors(self, target: ObjectMetadata) -> list[_Anchor]:
        """What the target is related to and a person would point it out by, best first."""
        rules, ranked, order = expression_rules(), [], list(relation_rules().words)
        for _, other, data in self.graph.graph.out_edges(target.id, data=True):
            record, relation = self.graph.node(other), data["relation"]
            rank = _landmark_rank(record.type)
            if rank is None or relation not in rules.only_for.get(record.type, (relation,)):
                continue
            if record.type == target.type or not self._is_one(record.type) or self._is_hidden(other):
                continue
            if not _suits(record, target):
                continue
            key = (rank, order.index(relation), data["distance_m"], other)
            ranked.append((key, _Anchor(other, record.type, relation)))
        return [anchor for _, anchor in sorted(ranked, key=lambda pair: pair[0])]

    def _closest_anchors(self, target: ObjectMetadata) -> list[_Anchor]:
        """Landmarks that are the only ones of their type, nearest first: for what nobody carries away."""
        rules = expression_rules()
        if object_type(target.type).pickupable:
            return []
        types = {name for group in rules.landmarks[: rules.closest_landmark_groups] for name in group}
        others = [
            record
            for record in self.graph.objects.values()
            if record.type in types - {target.type} and self._is_one(record.type)
        ]
        apart = centre_distance(target.box, [record.box for record in others])[0] if others else ()
        ranked = sorted(zip(apart, others, strict=True), key=lambda pair: (pair[0], pair[1].id))
        return [_Anchor(record.id, record.type, "closest to") for _, record in ranked]

    def _is_one(self, type_name: str) -> bool:
        """Whether the word for a type means one thing: nothing else is called so, or all are seen as one."""
        called = sum(self._count.get(name, 0) for name in may_be_called(type_name))
        return called == 1 or type_name in SEEN_AS_ONE

    def _is_hidden(self, object_id: str) -> bool:
        """Whether it is in something closed."""
        inner = object_id
        for holder in self.graph.holders(object_id):
            record = self.graph.node(holder)
            closed = object_type(record.type).openable and record.openness < CLOSED_OPENNESS
            if closed and self.graph.node(inner).support_kind == "in":
                return True
            inner = holder
        return False

    def _picked_out(self, expression: Expression) -> str | None:
        """The one object that an expression picks out and that nothing else comes near, or None."""
        program = expression.program
        if program not in self._picks:
            exact = resolve(program, self.graph)
            unique = len(exact) == 1 and candidates(program, self._loose) == exact
            self._picks[program] = exact[0] if unique else None
        return self._picks[program]


@dataclass(frozen=True)
class _Anchor:
    id: str
    type: str
    relation: Relation | Literal["closest to"]


def _expression(target: ObjectMetadata, anchor: _Anchor | None) -> Expression:
    """The plain phrase and its program; whether it picks out the target is for the caller to find out."""
    rules, noun, kind = expression_rules(), object_type(target.type).singular, ("filter_type", target.type)
    if anchor is None:
        text = BARE.format(noun=noun)
        return Expression(text, target.id, target.type, None, None, "bare", (kind,))
    inner: Program = (("filter_type", anchor.type),)
    step: Step
    if anchor.relation == "closest to":
        word, step = rules.closest_word, ("closest", inner)
    else:
        word, step = relation_rules().words[anchor.relation], ("relate", anchor.relation, inner)
    text = RELATED.format(noun=noun, relation=word, noun2=object_type(anchor.type).singular)
    name: ExpressionKind = "superlative" if anchor.relation == "closest to" else "relation"
    return Expression(text, target.id, target.type, anchor.relation, anchor.id, name, (kind, step))


def _described(target: ObjectMetadata, plain: Expression) -> Iterator[Expression]:
    """The phrase with a colour, and with a material."""
    steps: list[Step] = []
    if any(target.color in group for group in expression_rules().similar_words):
        steps.append(("filter_color", target.color))
    if target.substance in expression_rules().substances:
        steps.append(("filter_substance", target.substance))
    for step in steps:
        text = _with_word(plain.text, plain.target_type, step[1])
        yield replace(plain, text=text, kind="attribute", program=(plain.program[0], step, *plain.program[1:]))


def _placed(target: ObjectMetadata, plain: Expression, *, doubly: bool) -> Iterator[Expression]:
    """The phrase with each place in a stack or a row; doubly: with one of each, as in "the top left drawer"."""
    rules = expression_rules()
    stack = rules.stack_words if target.type in STACKED else {}
    row = rules.row_words if target.type in IN_ROWS else {}
    levels: dict[str, Program] = {"": ()}
    if doubly:
        levels = {high: (("stack", place),) for high, place in stack.items() if place != "middle"}
        places = [(f"{h} {w}", (*level, ("row", end))) for h, level in levels.items() for w, end in row.items()]
    else:
        places = [(word, (("stack", place),)) for word, place in stack.items()]
        places += [(word, (("row", place),)) for word, place in row.items()]
    for words, steps in places:
        yield _superlative(plain, words, "", steps)
    for ordinal, side in product(rules.row_ordinals if row else (), rules.row_sides):
        end = f"{rules.row_ordinals[ordinal]} {rules.row_sides[side]}"
        for word, above in levels.items():
            yield _superlative(plain, f"{ordinal} {word}".strip(), f" {side}", (*above, ("row", end)))


def _superlative(plain: Expression, word: str, behind: str, steps: Program) -> Expression:
    """The phrase with a place in a stack or a row; there are so many that `replace` would take half of the time."""
    return Expression(
        _with_word(plain.text, plain.target_type, word, behind),
        plain.target_id,
        plain.target_type,
        plain.relation,
        plain.anchor_id,
        "superlative",
        (*plain.program, *steps),
    )


@lru_cache(maxsize=1 << 14)
def _with_word(text: str, target_type: str, word: str, behind: str = "") -> str:
    """A phrase with a word before its first noun, and words behind it."""
    noun = object_type(target_type).singular
    head = BARE.format(noun=noun)
    described = DESCRIBED.format(attribute=word, noun=noun)
    return text.replace(head, described + behind, 1)


def _suits(anchor: ObjectMetadata, target: ObjectMetadata) -> bool:
    """Furniture is not pointed out by what a hand can carry away, as phrases outlive an arrangement; nor by the floor."""
    carried = object_type(target.type).pickupable
    return carried or not (object_type(anchor.type).pickupable or anchor.type in TAKEN_FOR_GRANTED)


@lru_cache(maxsize=256)
def _landmark_rank(type_name: str) -> int | None:
    groups = expression_rules().landmarks
    return next((rank for rank, group in enumerate(groups) if type_name in group), None)
