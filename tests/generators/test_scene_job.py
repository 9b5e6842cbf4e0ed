"""A room whose samples the audit refuses."""

from pathlib import Path

import numpy as np
import pytest

from remqa_data.generators import scene_job
from remqa_data.generators.arrangement.hiding_place import HidingPlace
from remqa_data.generators.audited_room import AuditedRoom
from remqa_data.generators.config import load_config
from remqa_data.generators.questions.allotment import allot
from remqa_data.generators.questions.capacity_table import capacities
from remqa_data.generators.questions.groups import GroupPlan
from remqa_data.generators.samples import Refusal
from remqa_data.generators.scene_job import make_room
from remqa_data.generators.scene_plan import Job
from remqa_data.tables.rows import QuestionRow

ROOM = "FloorPlan405"
CONFIG = load_config(Path(__file__).parents[2] / "configs" / "tiny.yaml")
(QUOTA,) = allot(capacities([ROOM]), {"train": {"EXISTENCE": 4}})


@pytest.mark.slow
def test_one_configuration_is_arranged_anew_where_a_sample_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    rows, report = make_room(Job(QUOTA, CONFIG))
    assert report["questions"] == 4
    assert not report["refused"]
    make_sample, refused = scene_job.make_sample, list[str]()

    def refuses_one(
        room: AuditedRoom, group: GroupPlan[HidingPlace], rng: np.random.Generator
    ) -> QuestionRow | Refusal:
        if not refused:
            refused.append(f"{group.name}-c{room.info.configuration}")
            return Refusal("necessary", "seen from elsewhere")
        return make_sample(room, group, rng)

    monkeypatch.setattr(scene_job, "make_sample", refuses_one)
    others, report = make_room(Job(QUOTA, CONFIG))
    assert report["refused"] == {"necessary": 1}
    ids = [[row.question_id for row in made["questions"]] for made in (rows, others)]
    assert refused[0] in ids[0]
    assert ids[0] == ids[1]
    changed = [one.configuration for one, other in zip(rows["scenes"], others["scenes"], strict=True) if one != other]
    assert changed == [int(refused[0][-1])]
