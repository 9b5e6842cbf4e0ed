from collections import Counter
from collections.abc import Iterable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from remqa_data.errors import QuotaError
from remqa_data.floorplans.splits import split_of
from remqa_data.generators.questions.allotment import SceneQuota, allot
from remqa_data.generators.questions.capacity_table import SceneCapacity
from remqa_data.generators.questions.groups import group_shapes
from remqa_data.generators.questions.shortfalls import Answers, Deal, dealt_anew, missing, with_a_lot_less
from remqa_data.tables.rows import KINDS

NAMES = [f"FloorPlan{n}" for n in (1, 2, 3, 4, 26, 27, 28)]
TOTALS = {
    "train": {"EXISTENCE": 37, "COUNTING": 21, "SPATIAL": 18},
    "test": {"EXISTENCE": 22, "COUNTING": 16, "SPATIAL": 9},
}


def capacity(name: str, lots: int) -> SceneCapacity:
    return SceneCapacity(name, "kitchen", dict.fromkeys(KINDS, lots), dict.fromkeys(KINDS, lots))


def handed_in(quota: SceneQuota, can: dict[str, int]) -> Answers:
    """What a room has that can make so many lots of each kind."""
    answers: Answers = quota.answers
    for kind in KINDS:
        while sum(answers[kind].values()) > 4 * can[kind]:
            answers = with_a_lot_less(answers, kind)
    return answers


def sums(answers: Iterable[tuple[str, Answers]]) -> dict[tuple[str, str], Counter[str]]:
    found: dict[tuple[str, str], Counter[str]] = {}
    for scene, kinds in answers:
        for kind, counts in kinds.items():
            found.setdefault((split_of(scene), kind), Counter()).update(counts)
    return found


@pytest.mark.slow
@given(st.lists(st.fixed_dictionaries({kind: st.integers(0, 8) for kind in KINDS}), min_size=7, max_size=7))
def test_what_some_rooms_lack_others_have(can: list[dict[str, int]]) -> None:
    rooms, able = [capacity(name, 5) for name in NAMES], dict(zip(NAMES, can, strict=True))
    deal: Deal | None = Deal(tuple(allot(rooms, TOTALS)))
    wanted = sums((quota.scene, quota.answers) for quota in deal.quotas)
    enough = {(s, k): sum(able[n][k] for n in NAMES if split_of(n) == s) * 4 for s in TOTALS for k in KINDS}
    for _ in range(100):
        last, had = deal, {quota.scene: handed_in(quota, able[quota.scene]) for quota in deal.quotas}
        short = {quota.scene: missing(quota.answers, had[quota.scene]) for quota in deal.quotas}
        try:
            deal = dealt_anew(rooms, last, short)
        except QuotaError:
            assert any(
                enough[split, kind] < total + 4 for split, kinds in TOTALS.items() for kind, total in kinds.items()
            )
            return
        if deal is None:
            break
    assert deal is None
    assert sums(had.items()) == wanted
    for quota in last.quotas:
        for kind in KINDS:
            assert all(len(shape) > 1 for shape in group_shapes(had[quota.scene][kind], 4, quota.scene))


def test_only_who_steps_in_is_asked_anew() -> None:
    rooms = [capacity(name, 5) for name in NAMES]
    deal = Deal(tuple(allot(rooms, TOTALS)))
    lot = {"COUNTING": {"0": 1, "1": 1, "2": 1, "3": 1}}
    anew = dealt_anew(rooms, deal, {"FloorPlan2": lot})
    assert anew is not None
    changed = [(old, new) for old, new in zip(deal.quotas, anew.quotas, strict=True) if old != new]
    assert [new.scene for _, new in changed] != ["FloorPlan2"]
    assert len(changed) == 1
    assert changed[0][1].total("COUNTING") == changed[0][0].total("COUNTING") + 4
    assert dealt_anew(rooms, anew, {"FloorPlan2": lot}) is None  # it is excused


def test_where_all_rooms_are_full_it_is_said() -> None:
    rooms = [capacity(name, 5) for name in NAMES]
    deal = Deal(tuple(allot(rooms, TOTALS)))
    short = {quota.scene: {"SPATIAL": {"yes": 1, "no": 1}} for quota in deal.quotas}
    with pytest.raises(
        QuotaError, match=r"questions.train.SPATIAL: FloorPlan1 could not have .* no other room can"
    ) as caught:
        dealt_anew(rooms, deal, short)
    assert caught.value.kind == "SPATIAL"
