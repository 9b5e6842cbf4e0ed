"""Which of the samples that passed the audit a room hands in: exactly its quota, whatever was refused."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

from remqa_data.errors import QuotaError
from remqa_data.generators.questions.allotment import SceneQuota
from remqa_data.generators.questions.groups import GroupPlan
from remqa_data.generators.questions.questions import P
from remqa_data.tables.rows import KINDS, QuestionKind

Passed = Mapping[str, Sequence[int]]
"""By the name of a group, the configurations for which its sample passed the audit."""


def select(groups: Sequence[GroupPlan[P]], passed: Passed, quota: SceneQuota) -> dict[str, tuple[int, ...]]:
    """Choose samples that meet a quota exactly, each question with at least two different answers.

    Where nothing was refused, these are the groups' `asked`. Otherwise spare groups, and configurations that were not
    asked about, step in.

    Parameters
    ----------
    groups : sequence of GroupPlan
        All groups of a room.
    passed : mapping
        What the audit let through.
    quota : SceneQuota
        What the room owes.

    Returns
    -------
    By the names of the groups that are used, in their order, the configurations.

    Raises
    ------
    QuotaError
        If too few samples passed: names the room and the kind, what is owed and what there is.
    """
    chosen: dict[str, tuple[int, ...]] = {}
    for kind in KINDS:
        own = [group for group in groups if group.question.kind == kind]
        asked = {group.name: group.asked for group in own if group.asked}
        if all(set(configurations) <= set(passed.get(name, ())) for name, configurations in asked.items()):
            chosen |= asked
            continue
        found = _search(own, passed, {answer: n for answer, n in quota.answers[kind].items() if n})
        if found is None:
            raise QuotaError(_refusal(own, passed, quota, kind), kind)
        chosen |= found
    return {group.name: chosen[group.name] for group in groups if group.name in chosen}


def _search(
    groups: Sequence[GroupPlan[P]], passed: Passed, owed: Mapping[str, int]
) -> dict[str, tuple[int, ...]] | None:
    """Samples of these groups that are exactly what is owed; the first groups give as much as they can."""
    dead: set[tuple[int, tuple[int, ...]]] = set()

    def go(index: int, left: dict[str, int]) -> dict[str, tuple[int, ...]] | None:
        if not any(left.values()):
            return {}
        state = (index, tuple(left.values()))
        if index == len(groups) or state in dead:
            return None
        group = groups[index]
        for configurations in _choices(group, passed.get(group.name, ()), left):
            after = dict(left)
            for configuration in configurations:
                after[group.answers[configuration]] -= 1
            rest = go(index + 1, after)
            if rest is not None:
                return {group.name: configurations, **rest} if configurations else rest
        dead.add(state)
        return None

    return go(0, dict(owed))


def _choices(group: GroupPlan[P], passed: Sequence[int], left: Mapping[str, int]) -> Iterator[tuple[int, ...]]:
    """Sets of configurations that a group could hand in, the largest first; the last one is empty."""
    useful = sorted({c for c in passed if left.get(group.answers[c], 0) > 0}, key=lambda c: (c not in group.asked, c))
    seen = set()
    for size in range(len(useful), 1, -1):
        for configurations in combinations(useful, size):
            answers = [group.answers[c] for c in configurations]
            counts = tuple(sorted(answers))
            enough = all(answers.count(answer) <= left[answer] for answer in answers)
            if enough and len(set(answers)) > 1 and counts not in seen:
                seen.add(counts)
                yield tuple(sorted(configurations))
    yield ()


def _refusal(groups: Sequence[GroupPlan[P]], passed: Passed, quota: SceneQuota, kind: QuestionKind) -> str:
    there: dict[str, int] = {}
    for group in groups:
        for configuration in passed.get(group.name, ()):
            there[group.answers[configuration]] = there.get(group.answers[configuration], 0) + 1
    made = sum(len(group.answers) for group in groups)
    return (
        f"{quota.scene}: {kind}: of {made} samples that were made, the audit passed {dict(sorted(there.items()))}, which "
        f"cannot make {dict(quota.answers[kind])} with two answers to each question; ask for more spare_groups, or lower "
        "this room's capacity in templates/capacities.csv"
    )
