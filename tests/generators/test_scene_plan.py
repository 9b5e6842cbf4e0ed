"""Plans of a room that cannot be arranged at first."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from remqa_data.errors import ArrangementError
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.generators import scene_plan
from remqa_data.generators.arrangement.configurations import Configuration
from remqa_data.generators.arrangement.hiding_check import HidingWish
from remqa_data.generators.config import load_config
from remqa_data.generators.questions.allotment import allot
from remqa_data.generators.questions.capacity_table import capacities
from remqa_data.generators.questions.groups import GroupPlan
from remqa_data.generators.scene_plan import Job, RoomPlanner
from remqa_data.scene import Scene

ROOM = "FloorPlan421"


@pytest.fixture(scope="module")
def planner() -> RoomPlanner:
    config = load_config(Path(__file__).parents[2] / "configs" / "paper.yaml")
    (quota,) = allot(capacities([ROOM]), {"train": {"EXISTENCE": 12, "COUNTING": 4, "SPATIAL": 4}})
    return RoomPlanner(Job(quota, config), load_scene(ROOM))


@pytest.mark.slow
def test_a_plan_that_fails_keeps_what_fits_and_does_not_try_it_again(
    planner: RoomPlanner, monkeypatch: pytest.MonkeyPatch
) -> None:
    plans: list[list[GroupPlan]] = []
    tried: list[list[HidingWish]] = []
    plan_groups = scene_plan.plan_groups

    def planned(*args: object) -> list[GroupPlan]:
        plans.append(plan_groups(*args))
        return plans[-1]

    def infeasible_wishes(
        base: Scene, wishes: Sequence[HidingWish], rng: np.random.Generator
    ) -> list[ArrangementError]:
        tried.append(list(wishes))
        if len(tried) > 1:
            return []
        bad = next(wish for wish in wishes if wish.is_asked)
        return [ArrangementError("no room", bad.place.object_id, bad.place.relation, [bad.type])]

    monkeypatch.setattr(scene_plan, "plan_groups", planned)
    monkeypatch.setattr(scene_plan, "infeasible_wishes", infeasible_wishes)
    monkeypatch.setattr(scene_plan, "arrange", lambda base, *_: Configuration(base, ()))
    assert planner.next().groups == plans[-1]
    first, second = plans
    bad = next(wish for wish in tried[0] if wish.is_asked)
    fits = [g.question for g in first if (g.question.place, g.question.type) != (bad.place, bad.type)]
    assert 0 < len(fits) < len(first)
    assert set(fits) <= {g.question for g in second}
    assert all((g.question.place, g.question.type) != (bad.place, bad.type) for g in second)
    assert len({g.name for g in second}) == len(second)
    for kind, answers in planner.quota.answers.items():
        asked = [g.answers[c] for g in second if g.question.kind == kind for c in g.asked]
        assert sorted(asked) == sorted(answer for answer, count in answers.items() for _ in range(count))
    again = {wish.place.key for wishes in tried[4:] for wish in wishes}
    assert again < {wish.place.key for wishes in tried[:4] for wish in wishes}
