"""Questions: a place, what the agent looks for there, and the words and the program that ask for it.

What the words are, and how often each is chosen, is in `templates/questions.yaml`. Which questions a room gets is decided
in `remqa_data.generators.questions.groups`; the answers come from `remqa_data.language.answers`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Generic, Literal, Protocol, TypeVar

from remqa_data.catalog import Manipulation, object_type, plural, with_article
from remqa_data.generators.questions.expressions import Expression
from remqa_data.language.inner_relations import Partner
from remqa_data.language.question_rules import question_rules
from remqa_data.language.referring import AnyProgram, Program
from remqa_data.language.rules import may_be_called
from remqa_data.scene_graph.relations import Relation, relation_rules
from remqa_data.tables.rows import KINDS, QuestionKind


class QuestionSite(Protocol):
    """What questions need to know of a place where things are hidden; see `hiding_places.HidingPlace`."""

    @property
    def object_id(self) -> str:
        """The object that hides them."""

    @property
    def type(self) -> str:
        """Its type."""

    @property
    def manipulation(self) -> Manipulation:
        """What reveals them."""

    @property
    def relation(self) -> Literal["in", "under"]:
        """Where they are."""

    @property
    def spots(self) -> Sequence[object]:
        """One for each thing that it can hide at a time."""


P = TypeVar("P", bound=QuestionSite)


@dataclass(frozen=True)
class Candidate(Generic[P]):
    """A question that could be asked in every configuration of a room.

    Attributes
    ----------
    kind : {"EXISTENCE", "COUNTING", "SPATIAL"}
        Kind of question.
    place : QuestionSite
        Where the evidence is, if there is any.
    expression : Expression
        The phrase that picks out the place.
    type : str
        What is asked for.
    partner : Partner, optional
        What it is asked to lie on, next to, behind or between. Then both are there, whatever the answer.
    """

    kind: QuestionKind
    place: P
    expression: Expression
    type: str
    partner: Partner | None = None

    @property
    def text(self) -> str:
        """The question, such as "Is there a mug in the drawer next to the toaster?"."""
        if self.partner is not None:
            return inner_question_text(self.type, self.partner, self.expression.text)
        return question_text(self.kind, self.type, self.place.relation, self.expression.text)

    @property
    def words(self) -> int:
        """Length of the question in words."""
        return len(self.text.split())

    @property
    def types(self) -> frozenset[str]:
        """What is put in the place for it: what is asked for, and its partner."""
        return frozenset({self.type} if self.partner is None else {self.type, self.partner.type})

    @property
    def program(self) -> Program:
        """What `remqa_data.language.answers.execute` executes; JSON-able."""
        if self.partner is not None:
            return inner_question_program(self.type, self.partner, self.expression.program)
        return question_program(self.kind, self.type, self.place.relation, self.expression.program)


def question_text(kind: QuestionKind, type_name: str, relation: Relation, expression: str) -> str:
    """The words of a question about things of a type that are in a relation to what an expression picks out.

    >>> question_text("COUNTING", "Mug", "in", "the fridge")
    'How many mugs are there in the fridge?'
    """
    rules = question_rules()
    words = {"a_obj": with_article(type_name), "objs": plural(type_name), "relation": rules.said(kind, relation)}
    return rules.templates[kind].format(**words, re=expression)


def question_program(kind: QuestionKind, type_name: str, relation: Relation, where: Program) -> Program:
    """The program of a question about things of a type that are in a relation to what an expression picks out.

    >>> question_program("COUNTING", "Mug", "in", (("filter_type", "Fridge"),))
    (('filter_type', 'Mug'), ('relate', 'in', (('filter_type', 'Fridge'),)), ('count',))
    """
    last = "count" if kind == "COUNTING" else "exist"
    return (("filter_type", type_name), ("relate", relation, where), (last,))


def inner_question_text(type_name: str, partner: Partner, expression: str) -> str:
    """The words of a question about how two things lie to one another in what an expression picks out.

    >>> inner_question_text("Apple", Partner("next to", "Bread"), "the fridge")
    'Is the apple next to the loaf of bread in the fridge?'
    >>> inner_question_text("Fork", Partner("between", "Mug"), "the drawer")
    'Is the fork between the mugs in the drawer?'
    """
    other = object_type(partner.type)
    return question_rules().inner_template.format(
        obj=object_type(type_name).singular,
        relation=relation_rules().said(partner.relation),
        obj2=other.singular if partner.count == 1 else other.plural,
        re=expression,
    )


def inner_question_program(type_name: str, partner: Partner, where: Program) -> Program:
    """The program of such a question: what the others are is found in the place first.

    >>> inner_question_program("Apple", Partner("on", "Plate"), (("filter_type", "Fridge"),))[1]
    ('relate', 'on', (('filter_type', 'Plate'), ('relate', 'in', (('filter_type', 'Fridge'),))))
    """
    others = (("filter_type", partner.type), ("relate", "in", where))
    return (("filter_type", type_name), ("relate", partner.relation, others), ("exist",))


def kinds_for(place: QuestionSite) -> tuple[QuestionKind, ...]:
    """The kinds of question that a place serves: what is opened serves all, what is lifted or pushed the last two."""
    return KINDS if place.relation == "in" else ("COUNTING", "SPATIAL")


def usable_expressions(expressions: Sequence[Expression]) -> list[tuple[Expression, float]]:
    """The phrases for one place that questions may use, with weights, the best first.

    A phrase must be true of all configurations of a room, so it leans on nothing that a hand carries away. Where the noun
    alone picks out the place, it is all that is said.
    """
    rules = question_rules()
    usable: list[tuple[Expression, float]] = []
    bare = [expression for expression in expressions if expression.kind == "bare"]
    for expression in bare or expressions:
        anchor = expression.anchor_id
        weight = rules.expression_weights[expression.kind]
        if weight > 0 and not (anchor is not None and any(map(_is_loose, mentioned_types(expression.program[1:])))):
            usable.append((expression, weight * rules.rank_factor ** len(usable)))
    return usable


def mentioned_types(program: AnyProgram) -> frozenset[str]:
    """The types that a program names, at any depth."""
    return frozenset(_mentioned(program))


@cache
def confusable(one: str, other: str) -> bool:
    """Whether a person may take the word for one type to mean the other."""
    return other in may_be_called(one) or one in may_be_called(other)


def any_confusable(some: Iterable[str], others: Iterable[str]) -> bool:
    """Whether a type of some is confusable with one of others."""
    return any(confusable(one, other) for one in some for other in others)


def _is_loose(type_name: str) -> bool:
    return object_type(type_name).pickupable


def _mentioned(program: AnyProgram) -> Iterator[str]:
    for step in program:
        if step[0] == "filter_type":
            yield step[1]
        for part in step[1:]:
            if isinstance(part, list | tuple):
                yield from _mentioned(part)
