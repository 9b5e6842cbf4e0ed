"""What the words of a stored question and of its expression say, as programs."""

from __future__ import annotations

from functools import lru_cache
from typing import get_args

from remqa_data.catalog import catalog, question_types
from remqa_data.errors import ProgramError, UnknownNameError
from remqa_data.generators.questions.questions import (
    inner_question_program,
    inner_question_text,
    question_program,
    question_text,
)
from remqa_data.language.inner_relations import InnerRelation, Partner
from remqa_data.language.question_rules import RELATIONS_OF
from remqa_data.language.referring import Program, program_of
from remqa_data.tables.rows import QuestionKind, QuestionRow

LONGEST_TEXT = 300
"""Characters; a phrase that leans on one thing has fewer than 100."""


def understood(text: str) -> Program:
    """The program of a stored phrase.

    Raises
    ------
    ProgramError
        If it is not understood, or longer than any phrase.
    """
    if len(text) > LONGEST_TEXT:
        raise ProgramError(f"{text[:40]!r}...: {len(text):,} characters are no phrase")
    return program_of(text)


def asked(question: QuestionRow) -> Program:
    """The program that the words of a question say.

    Raises
    ------
    ProgramError
        If the question says something else than its expression, kind and type make it say.
    """
    return _program_of(question.kind, question.answer_type, question.expression, question.question)


@lru_cache(maxsize=64)
def _program_of(kind: QuestionKind, answer_type: str, expression: str, text: str) -> Program:
    where = understood(expression)
    if answer_type not in catalog():
        raise UnknownNameError("object type", answer_type, catalog())
    if kind == "SPATIAL":
        for partner in _partners():
            if text == inner_question_text(answer_type, partner, expression):
                return inner_question_program(answer_type, partner, where)
    for relation in RELATIONS_OF[kind]:
        if text == question_text(kind, answer_type, relation, expression):
            return question_program(kind, answer_type, relation, where)
    raise ProgramError(f"the words of the question do not ask for a {answer_type} by {expression!r}")


@lru_cache(maxsize=1)
def _partners() -> tuple[Partner, ...]:
    """All that a thing may be asked to lie on, next to, behind or between."""
    return tuple(Partner(relation, name) for relation in get_args(InnerRelation) for name in question_types())
