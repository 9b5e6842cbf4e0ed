"""Answers without looking: what is most often right in the train split."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

from remqa_data.agents.knowledge.reading import Question, read_question
from remqa_data.agents.parts.interfaces import Percept, Sighting
from remqa_data.tables.rows import QuestionKind


class MajorityAnswerer:
    """Gives every question of a kind the same answer.

    Parameters
    ----------
    answers : mapping of kind to str
        See `majority`.
    """

    def __init__(self, answers: Mapping[QuestionKind, str]) -> None:
        self.answers = answers

    def answer(self, asked: Question, before: Percept, after: Percept, sighting: Sighting | None) -> str | None:
        """See `remqa_data.agents.parts.interfaces.Answerer`; None where nothing of that kind is known."""
        return self.answers.get(asked.kind)


def majority(questions: Iterable[tuple[str, str]]) -> dict[QuestionKind, str]:
    """By kind the most frequent answer of some questions, given as text and answer; of equally frequent ones the first.

    >>> majority([("Is there a mug in the fridge?", "no"), ("Is there an egg in the fridge?", "no")])
    {'EXISTENCE': 'no'}
    """
    counts: dict[QuestionKind, Counter[str]] = {}
    for text, answer in questions:
        counts.setdefault(read_question(text).kind, Counter())[answer] += 1
    return {kind: min(found, key=lambda answer: (-found[answer], answer)) for kind, found in counts.items()}
