"""A finished dataset of one room is checked, then told lies of every kind; each must be found, by its truth."""

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from remqa_data.cli import app
from remqa_data.generators.audit.truths import CheckedRoom
from remqa_data.generators.audit.verify import verify
from remqa_data.generators.config import load_config
from remqa_data.generators.pipeline import generate
from remqa_data.scene import Scene
from remqa_data.storage.card import write_card
from remqa_data.storage.manifest import load_manifest, write_manifest
from remqa_data.storage.shards import ShardWriter, file_info, read_rows
from remqa_data.tables.images import decode_instances
from remqa_data.tables.rows import QuestionRow, SceneRow
from remqa_data.tables.schema import table_spec

CONFIGS = Path(__file__).parents[3] / "configs"
pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    config = load_config(CONFIGS / "tiny.yaml")
    none = config.questions.train.model_copy(update=dict.fromkeys(("EXISTENCE", "COUNTING", "SPATIAL"), 0))
    questions = config.questions.model_copy(update={"train": none})
    folder = tmp_path_factory.mktemp("dataset")
    generate(folder, config.model_copy(update={"scenes": ("FloorPlan27",), "questions": questions}))
    return folder


@pytest.fixture(scope="module")
def questions(root: Path) -> dict[str, QuestionRow]:
    return {row.question_id: row for row in read_rows(root, QuestionRow, "test")}


def retold(root: Path, out: Path, row_type: type, change: Callable[[Any], Any]) -> Path:
    """A copy of a dataset with other rows in one table, and checksums that fit them."""
    shutil.copytree(root, out)
    manifest = load_manifest(out)
    table = {QuestionRow: "questions", SceneRow: "scenes"}[row_type]
    (old,) = manifest.files_of(table)
    rows = [change(row) for row in read_rows(root, row_type, old.split)]
    with ShardWriter(out / old.path, table) as writer:
        writer.write_rows(rows)
    new = file_info(out / old.path, old.path, table, old.split)
    files = tuple(new if file.path == old.path else file for file in manifest.files)
    told = replace(manifest, files=files)
    write_card(out, told)
    write_manifest(out, told)
    return out


def lie(root: Path, out: Path, question_id: str, **changes: object) -> Path:
    """A dataset in which one question says something else."""
    return retold(
        root, out, QuestionRow, lambda row: replace(row, **changes) if row.question_id == question_id else row
    )


def broken(root: Path) -> set[tuple[str, str]]:
    """Which truths are broken where."""
    return {(failure.where, failure.truth) for failure in verify(root).failures}


def run(*arguments: str) -> Result:
    return CliRunner().invoke(app, ["verify", *arguments])


def test_every_question_holds(root: Path) -> None:
    result = run(str(root))
    assert result.exit_code == 0, result.output
    assert "12 of 12 questions hold" in result.output


def test_a_sample_is_drawn_by_its_seed(root: Path) -> None:
    one, again, other = (verify(root, 3, seed) for seed in (1, 1, 2))
    assert one.checked == again.checked != other.checked
    assert len(one.checked) == 3
    assert "3 of 3 questions hold" in run(str(root), "--sample", "3").output


def test_a_flipped_answer_is_found_by_one_worker_and_by_two(root: Path, questions, tmp_path: Path) -> None:
    name, question = next((k, q) for k, q in questions.items() if q.answer == "yes")
    wrong = lie(root, tmp_path / "lie", name, answer="no")
    found = verify(wrong, workers=2)
    assert {(name, "answer"), (f"test {question.kind}", "unbiased")} <= {(f.where, f.truth) for f in found.failures}
    assert verify(wrong) == found
    result = run(str(wrong))
    assert result.exit_code == 1
    assert f"{name}: answer: the answer is yes, not no" in result.output
    assert "11 of 12 questions hold" in result.output


def test_an_object_moved_in_the_stored_room_is_found(root: Path, questions, tmp_path: Path) -> None:
    name, question = next((k, q) for k, q in questions.items() if q.answer_ids)

    def moved(row: SceneRow) -> SceneRow:
        if row.configuration != question.configuration:
            return row
        scene = Scene.from_json(row.scene_json, row.scene)
        x, y, z = scene.object(question.answer_ids[0]).position
        objects = [
            replace(o, position=(x + 0.02, y, z)) if o.id == question.answer_ids[0] else o for o in scene.objects
        ]
        return replace(row, scene_json=scene.with_objects(tuple(objects)).to_json())

    wrong = retold(root, tmp_path / "moved", SceneRow, moved)
    found = broken(wrong)
    assert (f"FloorPlan27, configuration {question.configuration}", "consistent") in found
    assert (name, "replayable") in found


def test_a_swapped_end_frame_and_changed_actions_are_found(root: Path, questions, tmp_path: Path) -> None:
    (first, one), *_, (last, question) = questions.items()
    other = next(q for q in questions.values() if q.end_rgb.bytes != one.end_rgb.bytes)
    wrong = lie(root, tmp_path / "frame", first, end_rgb=other.end_rgb)
    wrong = lie(wrong, tmp_path / "both", last, actions=turned_away(question.actions, manipulation_at(question)))
    result = run(str(wrong))
    assert result.exit_code == 1
    assert f"{first}: replayable: end_rgb is not what is seen" in result.output
    assert f"{last}: replayable: start_rgb is not what is seen" in result.output


# ---- one question against its room, without files


@pytest.fixture(scope="module")
def rooms(root: Path) -> dict[int, CheckedRoom]:
    return {row.configuration: CheckedRoom(row) for row in read_rows(root, SceneRow, "test")}


def broken_by(rooms: dict[int, CheckedRoom], question: QuestionRow, **changes: Any) -> set[str]:
    """Which truths a question breaks that says something else."""
    room = rooms[question.configuration]
    assert not list(room.question_failures(question))
    return {failure.truth for failure in room.question_failures(replace(question, **changes))}


def manipulation_at(question: QuestionRow) -> int:
    return next(i for i, action in enumerate(question.actions) if " " in action)


def turned_away(actions: tuple[str, ...], at: int) -> tuple[str, ...]:
    return (*actions[:at], "RotateLeft", *actions[at:])


@pytest.mark.parametrize("when", ["start", "end"])
@pytest.mark.parametrize("image", ["rgb", "depth", "instances"])
def test_every_stored_image_is_compared(rooms, questions, when: str, image: str) -> None:
    name = f"{when}_{image}"
    one, *others = questions.values()
    other = next(q for q in others if getattr(q, name).bytes != getattr(one, name).bytes)
    assert "replayable" in broken_by(rooms, one, **{name: getattr(other, name)})


@pytest.mark.parametrize(
    ("change", "truth"),
    [
        (turned_away, "replayable"),
        (lambda actions, at: (*actions[:at], "RotateLeft", "RotateRight", *actions[at:]), "reachable"),
        (lambda actions, at: (*actions[:at], *actions[at + 1 :]), "consistent"),
        (lambda actions, at: (*actions[:at], actions[at] + "x", *actions[at + 1 :]), "replayable"),
        (lambda actions, at: ("MoveAhead",) * 40 + actions, "reachable"),
        (lambda actions, at: ("Fly", *actions), "replayable"),
    ],
)
def test_changed_actions_are_found(rooms, questions, change, truth: str) -> None:
    question = next(iter(questions.values()))
    assert truth in broken_by(rooms, question, actions=change(question.actions, manipulation_at(question)))


@pytest.mark.parametrize(
    ("changes", "truth"),
    [
        ({"expression": "the floor"}, "unique"),
        ({"expression": "the unicorn"}, "answer"),
        ({"program": "[["}, "answer"),
        ({"target_id": "Unicorn|1"}, "unique"),
        ({"target_type": "Unicorn"}, "consistent"),
        ({"start_target_box_2d": (0, 0, 1, 1)}, "visible"),
        ({"goal_poses": ()}, "reachable"),
        ({"path_steps": 0}, "reachable"),
        ({"path_length_m": 99.0}, "reachable"),
        ({"object_ids": ("Floor|1",)}, "consistent"),
        ({"split": "train"}, "consistent"),
    ],
)
def test_a_wrong_field_is_found(rooms, questions, changes: dict[str, object], truth: str) -> None:
    assert truth in broken_by(rooms, next(iter(questions.values())), **changes)


def test_other_answer_objects_are_found(rooms, questions) -> None:
    question = next(q for q in questions.values() if q.answer_ids)
    assert {"answer", "necessary"} <= broken_by(rooms, question, answer_ids=(question.target_id,))


def test_evidence_in_the_start_frame_and_none_in_the_end_frame_are_found(rooms, questions) -> None:
    question = next(q for q in questions.values() if q.answer_ids)
    images = ("rgb", "depth", "instances")
    swapped = {f"start_{i}": getattr(question, f"end_{i}") for i in images}
    swapped |= {f"end_{i}": getattr(question, f"start_{i}") for i in images}
    assert {"necessary", "sufficient", "replayable"} <= broken_by(rooms, question, **swapped)


def test_a_manipulation_that_changes_nothing_is_found(rooms, questions) -> None:
    question = next(q for q in questions.values() if not q.answer_ids)
    same = {f"end_{i}": getattr(question, f"start_{i}") for i in ("rgb", "depth", "instances")}
    assert "sufficient" in broken_by(rooms, question, **same)


def test_a_goal_out_of_the_arms_reach_is_found(rooms, questions) -> None:
    question = max(questions.values(), key=lambda q: q.path_length_m)
    far = replace(question.goal_poses[0], position=question.initial_pose.position)
    assert "reachable" in broken_by(rooms, question, goal_poses=(*question.goal_poses, far))


def test_the_stored_pictures_keep_the_promise_of_a_question(questions) -> None:
    """Looked up without the code under test: no pixel of the three things before, some of each after."""
    question = next(q for q in questions.values() if q.answer == "3")
    numbers = [question.object_ids.index(object_id) + 1 for object_id in question.answer_ids]
    before, after = (decode_instances(getattr(question, f"{when}_instances").bytes) for when in ("start", "end"))
    assert len(numbers) == 3
    assert not np.isin(before, numbers).any()
    assert set(numbers) <= set(np.unique(after).tolist())


# ---- the dataset as a whole


def test_a_question_that_is_always_answered_alike_is_found(root: Path, questions, tmp_path: Path) -> None:
    group = next(q.group for q in questions.values() if q.kind == "EXISTENCE")
    wrong = retold(
        root, tmp_path / "lie", QuestionRow, lambda row: replace(row, answer="yes") if row.group == group else row
    )
    first = next(name for name, question in questions.items() if question.group == group)
    assert {(first, "unbiased"), ("test EXISTENCE", "unbiased")} <= broken(wrong)


def test_a_damaged_shard_is_one_line_with_file_row_group_and_column(root: Path, questions, tmp_path: Path) -> None:
    bad = tmp_path / "bad"
    shutil.copytree(root, bad)
    question = list(questions.values())[-1]
    (path,) = (bad / "questions").iterdir()
    data, picture = path.read_bytes(), question.end_rgb.bytes
    at = data.rindex(picture) + len(picture) // 2
    path.write_bytes(data[:at] + bytes([data[at] ^ 1]) + data[at + 1 :])
    result = run(str(bad))
    assert result.exit_code == 2
    last = len(questions) - 1
    assert (
        f"{path.name}, row group {last // table_spec('questions').row_group_rows}, column end_rgb.bytes"
        in result.stderr
    )
    assert len(result.stderr.strip().splitlines()) == 1
