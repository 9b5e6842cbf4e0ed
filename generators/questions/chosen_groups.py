"""The groups that a room has been given so far, and all that is counted of them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import Generic

import numpy as np

from remqa_data.catalog import Manipulation
from remqa_data.generators.questions.groups import GroupPlan
from remqa_data.generators.questions.questions import Candidate, P, mentioned_types
from remqa_data.generators.questions.sites import SiteKey, site_key
from remqa_data.geometry.types import F64
from remqa_data.language.question_rules import question_rules
from remqa_data.tables.rows import QuestionKind


class ChosenGroups(Generic[P]):
    """What has been chosen for a room.

    Parameters
    ----------
    sites : iterable of SiteKey
        All places that could be asked about.
    configurations : int
        How many arrangements of the room there will be.

    Attributes
    ----------
    groups : list of GroupPlan
        In the order in which they were chosen.
    filled : dict
        By place, (configurations,) how many things are to lie there.
    at_site, per_kind : Counter
        Groups, by kind and place and by kind.
    asked_for : Counter
        How many groups ask for a type.
    mentioned, texts : set of str
        Types that phrases name, and the words of the questions.
    samples : Counter
        By kind and manipulation.
    excess_words : Counter
        By kind, how many words samples have in all beyond what is aimed at.
    """

    def __init__(self, sites: Iterable[SiteKey], configurations: int) -> None:
        self.groups: list[GroupPlan[P]] = []
        self.filled: dict[SiteKey, F64] = {key: np.zeros(configurations) for key in sites}
        self.at_site: Counter[tuple[QuestionKind, SiteKey]] = Counter()
        self.per_kind: Counter[QuestionKind] = Counter()
        self.asked_for: Counter[str] = Counter()
        self.mentioned: set[str] = set()
        self.texts: set[str] = set()
        self.samples: Counter[tuple[QuestionKind, Manipulation]] = Counter()
        self.excess_words: Counter[QuestionKind] = Counter()

    def add(self, group: GroupPlan[P]) -> None:
        """Choose a group."""
        question, kind, key = group.question, group.question.kind, site_key(group.question.place)
        self.groups.append(group)
        self.filled[key] += group.counts
        self.at_site[kind, key] += 1
        self.per_kind[kind] += 1
        self.asked_for.update(question.types)
        self.mentioned |= mentioned_types(question.expression.program)
        self.texts.add(question.text)
        self.count_samples(question, len(group.asked))

    def widen(self, position: int, wider: GroupPlan[P]) -> None:
        """Let the group at a position of the list ask in more configurations."""
        group = self.groups[position]
        self.groups[position] = wider
        self.filled[site_key(group.question.place)] = self.filled_by(group, wider)
        self.count_samples(group.question, len(wider.asked) - len(group.asked))

    def filled_by(self, group: GroupPlan[P], wider: GroupPlan[P]) -> F64:
        """(configurations,) how many things would lie in a group's place if it were another one about the same."""
        return np.asarray(self.filled[site_key(group.question.place)] + wider.counts - np.array(group.counts))

    def count_samples(self, question: Candidate[P], count: int) -> None:
        """So many more samples ask a question."""
        kind = question.kind
        self.samples[kind, question.place.manipulation] += count
        excess = question.words - question_rules().aim_words[kind]
        self.excess_words[kind] += count * excess  # type: ignore[assignment]
