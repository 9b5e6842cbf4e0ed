"""A run in which rooms cannot have all that they were asked for; rooms are made up in no time."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pytest

from remqa_data.generators.config import Config, load_config
from remqa_data.generators.pipeline import RoomJob, generate
from remqa_data.generators.questions.allotment import allot
from remqa_data.generators.questions.capacity_table import capacities
from remqa_data.generators.questions.shortfalls import missing, with_a_lot_less
from remqa_data.processes.executors import J, LocalExecutor, R
from remqa_data.storage.manifest import Manifest
from remqa_data.storage.parts import Part
from tests.helpers.dataset_rows import scene_rows

pytestmark = pytest.mark.slow

TINY = Path(__file__).parents[2] / "configs" / "tiny.yaml"
FULL = "FloorPlan1"
"""The room that can have nothing about how many there are."""


def four_kitchens() -> Config:
    config = load_config(TINY)
    train = config.questions.train.model_copy(update={"EXISTENCE": 16, "COUNTING": 16, "SPATIAL": 16})
    test = config.questions.test.model_copy(update={"EXISTENCE": 0, "COUNTING": 0, "SPATIAL": 0})
    questions = config.questions.model_copy(update={"train": train, "test": test})
    scenes = tuple(f"FloorPlan{n}" for n in range(1, 5))
    return config.model_copy(update={"scenes": scenes, "questions": questions})


def room_that_may_be_full(job: RoomJob) -> Part:
    answers = job.room.quota.answers
    if job.room.scene == FULL:
        while sum(answers["COUNTING"].values()):
            answers = with_a_lot_less(answers, "COUNTING")
    short = missing(job.room.quota.answers, answers)
    rows = scene_rows(job.room.scene, job.room.quota.split)
    report = {"questions": len(rows["questions"]), "frames": len(rows["frames"]), "refused": {}}
    return job.write(rows, report | ({"short": short} if short else {}))


class MadeUp(LocalExecutor):
    """Makes rooms up, and counts them; may be cut off after some."""

    def __init__(self, most: int = 1000) -> None:
        super().__init__(1)
        self.most, self.made = most, list[str]()

    def run(self, work: Callable[[J], R], jobs: Sequence[J]) -> Iterator[tuple[J, R]]:
        if not all(isinstance(job, RoomJob) for job in jobs):
            yield from super().run(work, jobs)
            return
        for job in jobs:
            if len(self.made) == self.most:
                raise KeyboardInterrupt
            self.made.append(job.room.scene)  # type: ignore[attr-defined]
            yield job, room_that_may_be_full(job)  # type: ignore[arg-type, misc]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Manifest, list[str]]:
    executor = MadeUp()
    return generate(tmp_path_factory.mktemp("whole"), four_kitchens(), executor), executor.made


def test_others_step_in_and_the_manifest_says_so(whole: tuple[Manifest, list[str]]) -> None:
    manifest, made = whole
    config = four_kitchens()
    first = {quota.scene: quota.answers for quota in allot(capacities(config.scene_names), config.totals)}
    owed = sum(first[FULL]["COUNTING"].values())
    assert owed > 0
    stepped_in = made[len(first) :]
    assert FULL not in stepped_in
    assert sorted(manifest.asked_anew) == sorted(set(stepped_in)) != []
    more = sum(
        sum(answers["COUNTING"].values()) - sum(first[name]["COUNTING"].values())
        for name, answers in manifest.asked_anew.items()
    )
    assert more == owed


@pytest.mark.parametrize("most", [1, 3, 4, 5])
def test_a_run_that_is_cut_off_goes_on_where_it_stopped(
    whole: tuple[Manifest, list[str]], most: int, tmp_path: Path
) -> None:
    manifest, made = whole
    first = MadeUp(most)
    if most < len(made):
        with pytest.raises(KeyboardInterrupt):
            generate(tmp_path, four_kitchens(), first)
    second = MadeUp()
    assert generate(tmp_path, four_kitchens(), second) == manifest
    assert first.made + second.made == made
