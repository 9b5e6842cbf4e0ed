"""Groups: one question each, about all configurations of a room, with another answer in another configuration.

Answers are balanced by construction: a group fixes, before anything is placed, how many things of a type are in its place
in each configuration, so that yes and no, or 0 to 3, come out as often as the room's quota says.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Generic

from remqa_data.errors import QuotaError
from remqa_data.generators.arrangement.hiding_check import HidingWish
from remqa_data.generators.arrangement.hiding_place import HidingPlace
from remqa_data.generators.questions.questions import Candidate, P
from remqa_data.language.question_rules import NO, YES
from remqa_data.tables.rows import QuestionKind


@dataclass(frozen=True)
class GroupPlan(Generic[P]):
    """One question about all configurations of a room.

    Attributes
    ----------
    name : str
        Unique in the dataset, such as "FloorPlan1-COUNTING-00".
    question : Candidate
        Place, phrase and type.
    answers : tuple of str
        What the answer is to be in each configuration.
    asked : tuple of int
        The configurations that the room's quota counts on; none for a spare group, which steps in where the audit refuses
        samples (see `selection.select`).
    """

    name: str
    question: Candidate[P]
    answers: tuple[str, ...]
    asked: tuple[int, ...]

    @property
    def counts(self) -> tuple[int, ...]:
        """How many things are in the place for this question, in each configuration."""
        return tuple(len(things_of(self.question, answer)) for answer in self.answers)

    def things(self, configuration: int) -> tuple[str, ...]:
        """Types of the things that are in the place for this question, each named as often as there are."""
        return things_of(self.question, self.answers[configuration])


def wishes(groups: Sequence[GroupPlan[HidingPlace]], configuration: int) -> list[HidingWish]:
    """What one configuration of the room must hold for all groups to have their answers."""
    return [wish for group in groups for wish in _wishes(group, configuration)]


def _wishes(group: GroupPlan[HidingPlace], configuration: int) -> list[HidingWish]:
    question, answer, is_asked = group.question, group.answers[configuration], configuration in group.asked
    if question.partner is None:
        return [HidingWish(question.place, question.type, things_for(answer), is_asked=is_asked)]
    partner = question.partner
    return [
        HidingWish(question.place, partner.type, partner.count, is_asked=is_asked),
        HidingWish(question.place, question.type, 1, partner, answer == YES, is_asked),
    ]


def things_of(question: Candidate[P], answer: str) -> tuple[str, ...]:
    """Types of the things that are to be in a place for an answer, each named as often as there are.

    Of two that lie to one another in some way, both are there for each answer.
    """
    partner = question.partner
    if partner is None:
        return (question.type,) * things_for(answer)
    return (question.type, *(partner.type,) * partner.count)


def things_for(answer: str) -> int:
    """How many things make an answer: one for yes, none for no, and as many as a number says."""
    return {YES: 1, NO: 0}[answer] if answer in (YES, NO) else int(answer)


def shapes_of(kind: QuestionKind, quota: Mapping[str, int], most: int, where: str) -> list[dict[str, int]]:
    """Split a quota of a kind of question into groups; parameters and errors as of `group_shapes`.

    A question about how many has every answer once, as far as that can be: of some types there is more often room for two
    than for three, so that a question with some of the answers would tell by its words which these are.

    Examples
    --------
    >>> shapes_of("COUNTING", {"0": 2, "1": 2, "2": 1, "3": 1}, 4, "FloorPlan1")
    [{'0': 1, '1': 1, '2': 1, '3': 1}, {'0': 1, '1': 1}]
    >>> shapes_of("COUNTING", {"0": 2, "1": 1, "2": 1, "3": 1}, 4, "FloorPlan1")
    [{'0': 1, '1': 1, '3': 1}, {'0': 1, '2': 1}]
    """
    whole = min(quota.values(), default=0) if kind == "COUNTING" and len(quota) <= most else 0
    while True:
        try:
            rest = group_shapes({answer: count - whole for answer, count in quota.items()}, most, where)
        except QuotaError:
            if not whole:
                raise
            whole -= 1  # what is left, such as one sample, makes no group by itself
        else:
            return [dict.fromkeys(quota, 1) for _ in range(whole)] + rest


def group_shapes(quota: Mapping[str, int], most: int, where: str) -> list[dict[str, int]]:
    """Split a quota into groups that each ask for at least two different answers.

    Parameters
    ----------
    quota : mapping
        Samples by answer.
    most : int
        The most samples of one group.
    where : str
        What to call the quota in an error.

    Returns
    -------
    For each group, samples by answer; as many groups as possible, so that as many different questions are asked.

    Raises
    ------
    QuotaError
        If that cannot be done, as with 4 yes and no no.

    Examples
    --------
    >>> group_shapes({"yes": 3, "no": 2}, 4, "FloorPlan1")
    [{'yes': 2, 'no': 1}, {'yes': 1, 'no': 1}]
    >>> group_shapes({"0": 1, "1": 1, "2": 1, "3": 1}, 4, "FloorPlan1")
    [{'0': 1, '2': 1}, {'1': 1, '3': 1}]
    """
    total = sum(quota.values())
    count = min(total // 2, total - max(quota.values(), default=0))
    if total > most * count:
        msg = f"{where}: {dict(quota)} cannot be split into groups of questions with different answers; balance the answers"
        raise QuotaError(msg)
    # The most frequent answer first: what is left then comes to each group at most once.
    dealt = [answer for answer in sorted(quota, key=lambda name: -quota[name]) for _ in range(quota[answer])]
    return [dict(Counter(dealt[index::count])) for index in range(count)]
