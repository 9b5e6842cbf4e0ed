"""Questions about how two types of things lie to one another in one place: "Is the fork behind the mug in the drawer?".

All the things are there, whatever the answer, and they lie clearly as said or clearly not so: by tightened rules, or not even
by loosened ones.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal, get_args

from remqa_data.language.referring import AnyProgram, resolve
from remqa_data.language.semantics import ExactSemantics
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.scene_graph.relations import RelationRules, relation_rules
from remqa_data.sim.metadata import ObjectMetadata

InnerRelation = Literal["on", "next to", "behind", "between"]
"""What a question may ask of two things that lie in the same closed thing."""


@dataclass(frozen=True)
class Partner:
    """What a thing is asked to lie on, next to, behind or between, in the same place.

    Attributes
    ----------
    relation : {"on", "next to", "behind", "between"}
        What the thing is to it.
    type : str
        Its type: there is one of it in the place, or two, for what lies between.
    """

    relation: InnerRelation
    type: str

    @property
    def count(self) -> int:
        """How many there are of it."""
        return 2 if self.relation == "between" else 1


@dataclass(frozen=True)
class Inner:
    """What a program asks of how two types of things lie to one another in a place.

    Attributes
    ----------
    type : str
        What is asked for.
    partner : Partner
        What it is asked to be on, next to, behind or between.
    others : program
        Picks the partner's things out.
    """

    type: str
    partner: Partner
    others: AnyProgram


def inner_of(program: AnyProgram) -> Inner | None:
    """What a program asks of two types of things in one place; None if it asks something else.

    >>> inner_of((("filter_type", "Apple"), ("relate", "in", (("filter_type", "Fridge"),)), ("exist",))) is None
    True
    """
    match list(program):
        case [
            ["filter_type", str(type_)],
            ["relate", str(relation), [["filter_type", str(other)], ["relate", "in", _]] as others],
            ["exist"],
        ] if relation in get_args(InnerRelation):
            return Inner(type_, Partner(relation, other), others)  # type: ignore[arg-type]  # just checked
    return None


def witnesses(inner: Inner, graph: SceneGraph) -> tuple[list[str], list[str]]:
    """Ids of the things asked for in the place, and of their partners there: what one must see to answer; sorted."""
    others = resolve(inner.others, graph)
    places = {graph.node(other).support for other in others} - {None}
    held = {name for place in places for name in graph.contents(str(place))}
    return sorted(name for name in held if graph.node(name).type == inner.type), others


def needed(program: AnyProgram, answer_ids: tuple[str, ...], graph: SceneGraph) -> tuple[str, ...]:
    """What one must see to answer: the evidence, or both of what lies to one another, whatever the answer."""
    inner = inner_of(program)
    if inner is None:
        return answer_ids
    things, others = witnesses(inner, graph)
    return (*things, *others)


def is_sure(inner: Inner, graph: SceneGraph, answer: str) -> bool:
    """Whether there is one thing, and as many partners as there are to be, and they clearly lie as the answer says."""
    things, others = witnesses(inner, graph)
    if (len(things), len(others)) != (1, inner.partner.count):
        return False
    holders = {name for other in others for name in graph.holders(other)}
    known = [graph.node(name) for name in sorted({*things, *others, *holders})]
    return clearly_related(known, things[0], inner.partner.relation, others) is (answer == "yes")


def clearly_related(
    records: Iterable[ObjectMetadata], thing_id: str, relation: InnerRelation, other_ids: Collection[str]
) -> bool | None:
    """Whether a thing is on, next to, behind or between others, with room to spare; None where it is hard to say.

    Parameters
    ----------
    records : iterable of ObjectMetadata
        The things, and what holds them.
    thing_id : str
        The thing.
    relation : {"on", "next to", "behind", "between"}
        What it may be.
    other_ids : collection of str
        To what.
    """
    known = list(records)
    tight, loose = _margins()
    if ExactSemantics().related(SceneGraph.from_objects(known, tight), thing_id, relation, set(other_ids)):
        return True
    if ExactSemantics().related(SceneGraph.from_objects(known, loose), thing_id, relation, set(other_ids)):
        return None
    return False


@lru_cache(maxsize=1)
def _margins() -> tuple[RelationRules, RelationRules]:
    return relation_rules().tightened(), relation_rules().loosened()
