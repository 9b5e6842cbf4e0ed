"""Reading a question: its kind, what it asks for, and the expression that says where to look.

The patterns are those of `templates/questions.yaml`, read backwards: an agent gets the words alone.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import get_args

from remqa_data.catalog import Manipulation, object_type
from remqa_data.errors import ProgramError
from remqa_data.language.inner_relations import InnerRelation
from remqa_data.language.question_rules import question_rules
from remqa_data.language.referring import Program, program_of
from remqa_data.scene_graph.relations import Relation, relation_rules
from remqa_data.tables.rows import QuestionKind

HIDING: tuple[Relation, ...] = ("in", "under")
"""How what is asked for lies to the target."""


@dataclass(frozen=True)
class Question:
    """What the words of a question say.

    Attributes
    ----------
    text : str
        The question.
    kind : {"EXISTENCE", "COUNTING", "SPATIAL"}
        By its pattern.
    relation : {"in", "under"}
        Where it asks to look: inside the target, or under it.
    expression : str
        The referring expression, such as "the drawer next to the toaster".
    target : program
        What the expression means.
    """

    text: str
    kind: QuestionKind
    relation: Relation
    expression: str
    target: Program

    @property
    def target_type(self) -> str:
        """The type that the expression names."""
        return str(self.target[0][1])

    @property
    def anchor_type(self) -> str | None:
        """The type that the target is told by: of "the drawer next to the toaster", the toaster's; None if there is none."""
        inner = (step[-1] for step in self.target if isinstance(step[-1], tuple))
        return next((str(program[0][1]) for program in inner), None)

    @property
    def manipulation(self) -> Manipulation | None:
        """What shows the answer: one opens to look inside, and takes or pushes away what covers; None for what is fixed."""
        kind = object_type(self.target_type)
        if self.relation == "in":
            return "Open" if kind.openable else None
        return "Pickup" if kind.pickupable else "Move" if kind.moveable else None


def asked_types(asked: Question, types: Sequence[str]) -> tuple[int, int]:
    """Places of the target's and the anchor's type among some types, from 1; 0 for what is not there.

    >>> asked_types(read_question("Is there a mug in the drawer next to the toaster?"), ("Drawer", "Mug", "Toaster"))
    (1, 3)
    """
    wanted = (asked.target_type, asked.anchor_type)
    first, second = (types.index(name) + 1 if name in types else 0 for name in wanted)
    return first, second


def read_question(text: str) -> Question:
    """Read a question.

    Raises
    ------
    ProgramError
        If it follows no pattern, or its expression is not understood.

    Examples
    --------
    >>> asked = read_question("How many mugs are there in the fridge?")
    >>> asked.kind, asked.relation, asked.expression, asked.target_type, asked.manipulation
    ('COUNTING', 'in', 'the fridge', 'Fridge', 'Open')
    """
    for pattern, kind, relation in _patterns():
        found = pattern.fullmatch(text.strip())
        if found:
            return Question(text, kind, relation, found["re"], program_of(found["re"]))
    raise ProgramError(f"{text!r} follows no pattern of templates/questions.yaml")


@lru_cache(maxsize=1)
def _patterns() -> tuple[tuple[re.Pattern[str], QuestionKind, Relation], ...]:
    """The patterns as regular expressions; those of two things in one place come first, as they say "in" twice."""
    rules = question_rules()
    inner = "|".join(re.escape(relation_rules().said(relation)) for relation in get_args(InnerRelation))
    found: list[tuple[re.Pattern[str], QuestionKind, Relation]] = [
        (_pattern(rules.inner_template, f"(?:{inner})"), "SPATIAL", "in")
    ]
    for kind, template in rules.templates.items():
        for relation in HIDING:
            found.append((_pattern(template, re.escape(rules.said(kind, relation))), kind, relation))
            if "{relation}" not in template:
                break  # it says "in" itself
    return tuple(found)


def _pattern(template: str, relation: str) -> re.Pattern[str]:
    """A template with a relation, as an expression that finds {re} in a question; {re} begins where the first relation ends."""
    words = "|".join({relation_rules().words[name] for name in HIDING} | set(question_rules().spatial_words.values()))
    thing = rf"(?:(?! (?:{words}) )[\w\-' ])+"
    fields = {"a_obj": thing, "objs": thing, "obj": thing, "obj2": thing, "relation": relation, "re": r"(?P<re>the .+)"}
    text = re.escape(template)
    for name, expression in fields.items():
        text = text.replace(re.escape("{" + name + "}"), expression)
    return re.compile(text)
