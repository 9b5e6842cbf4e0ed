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
from remqa_data.generators.audit.expressions import expression_failures
from remqa_data.generators.audit.frames import frame_failures
from remqa_data.generators.audit.truths import CheckedRoom
from remqa_data.generators.audit.verify import verify
from remqa_data.generators.config import Config, stored_config
from remqa_data.scene import Scene
from remqa_data.sim.agent.replay import Replay
from remqa_data.storage.card import write_card
from remqa_data.storage.manifest import load_manifest, write_manifest
from remqa_data.storage.shards import ShardWriter, file_info, read_rows
from remqa_data.tables.images import StoredImage, decode_instances, encode_rgb
from remqa_data.tables.rows import ExpressionRow, FrameRow, QuestionRow, SceneRow
from remqa_data.tables.schema import table_spec
from tests.helpers.bare_rooms import first_of
from tests.helpers.forgeries import black_jpeg, png

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def root(one_room: Path) -> Path:
    return one_room


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
    return {(failure.where, failure.truth) for failure in verify(root, rooms=0).failures}


def run(*arguments: str) -> Result:
    return CliRunner().invoke(app, ["verify", *arguments])


def test_every_question_holds(root: Path) -> None:
    result = run(str(root), "--all")
    assert result.exit_code == 0, result.output
    assert "12 of 12 questions hold" in result.output
    assert "1 of 1 rooms; 4 of 4 scenes" in result.output
    assert "16 of 16 frames" in result.output
    assert "not everything" not in result.output


def test_a_sample_is_drawn_by_its_seed(root: Path) -> None:
    one, again, other = (verify(root, 3, seed, rooms=0) for seed in (1, 1, 2))
    assert one.checked == again.checked != other.checked
    assert len(one.checked) == 3
    told = run(str(root), "--sample", "3", "--rooms", "0").output
    assert "3 of 3 questions hold" in told
    assert "3 of 12 questions" in told
    assert "not everything was checked: use --all" in told


def test_a_flipped_answer_is_found_by_one_worker_and_by_two(root: Path, questions, tmp_path: Path) -> None:
    name, question = next((k, q) for k, q in questions.items() if q.answer == "yes")
    wrong = lie(root, tmp_path / "lie", name, answer="no")
    found = verify(wrong, workers=2, rooms=0)
    assert {(name, "answer"), (f"test {question.kind}", "unbiased")} <= {(f.where, f.truth) for f in found.failures}
    assert verify(wrong, rooms=0) == found
    result = run(str(wrong), "--rooms", "0")
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
    result = run(str(wrong), "--rooms", "0")
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


def test_what_moves_without_being_in_the_target_is_found(rooms, questions) -> None:
    question = next(iter(questions.values()))
    replay = Replay(rooms[question.configuration].scene, question.initial_pose.pose())
    ids = replay.world.ids
    before = np.array([replay.world.box(name) for name in ids])
    floor = first_of(replay.world, "Floor")
    before[ids.index(question.target_id), :, 0] += 0.5  # as if it had been acted on
    before[ids.index(floor), :, 0] += 0.002
    broken = list(rooms[question.configuration]._is_undisturbed(question, before, replay))
    replay.close()
    assert ("undisturbed", f"{floor} moves by 0.002 m") in broken
    assert not any(f"{question.target_id} moves" in reason for _, reason in broken)


def test_what_comes_to_light_and_is_not_counted_is_found(rooms, questions) -> None:
    question = next(q for q in questions.values() if len(q.answer_ids) > 0)
    assert "undisturbed" in broken_by(rooms, question, answer_ids=question.answer_ids[1:])


@pytest.mark.parametrize("when", ["start", "end"])
@pytest.mark.parametrize("image", ["rgb", "depth", "instances"])
def test_every_stored_image_is_compared(rooms, questions, when: str, image: str) -> None:
    name = f"{when}_{image}"
    one, *others = questions.values()
    other = next(q for q in others if getattr(q, name).bytes != getattr(one, name).bytes)
    assert "replayable" in broken_by(rooms, one, **{name: getattr(other, name)})


@pytest.mark.parametrize("image", ["start_depth", "end_instances", "end_rgb"])
def test_pictures_of_several_sizes_are_told_and_not_compared(rooms, questions, image: str) -> None:
    question = next(iter(questions.values()))
    other = black_jpeg(100) if image.endswith("rgb") else png(1, 100)
    assert broken_by(rooms, question, **{image: replace(getattr(question, image), bytes=other)}) == {"consistent"}


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


def test_a_start_at_a_goal_is_found(rooms, questions) -> None:
    question = next(iter(questions.values()))
    assert "away" in broken_by(rooms, question, initial_pose=question.goal_poses[-1])


def test_a_no_that_cannot_be_seen_from_the_goal_is_found(rooms, questions) -> None:
    question = next(q for q in questions.values() if not q.answer_ids)
    pose = question.goal_poses[0]
    away = replace(pose, yaw_deg=(pose.yaw_deg + 180.0) % 360.0)
    assert "provable" in broken_by(rooms, question, goal_poses=(away, *question.goal_poses[1:]))


def test_evidence_of_the_colour_of_its_surroundings_is_found(rooms, questions) -> None:
    question = next(q for q in questions.values() if q.answer_ids)
    grey = encode_rgb(np.full((300, 300, 3), 128, dtype=np.uint8))
    assert "distinct" in broken_by(rooms, question, end_rgb=grey)


def test_something_comes_to_light_whatever_the_answer_is(questions) -> None:
    """And as much of it each time the same question is asked."""
    revealed: dict[str, set[int]] = {}
    for question in questions.values():
        before, after = (decode_instances(getattr(question, f"{when}_instances").bytes) for when in ("start", "end"))
        revealed.setdefault(question.group, set()).add(len(np.setdiff1d(after, before)))
    assert revealed
    assert all(min(counts) >= 1 for counts in revealed.values())
    assert sum(len(counts) == 1 for counts in revealed.values()) >= 0.7 * len(revealed)


def test_a_row_names_only_what_its_views_show(questions) -> None:
    assert questions
    for question in questions.values():
        images = [decode_instances(getattr(question, f"{when}_instances").bytes) for when in ("start", "end")]
        assert np.union1d(*images).max() == len(question.object_ids)
        assert set(range(1, len(question.object_ids) + 1)) <= set(np.union1d(*images).tolist())


def test_a_goal_out_of_the_arms_reach_is_found(rooms, questions) -> None:
    question = max(questions.values(), key=lambda q: q.path_length_m)
    far = replace(question.goal_poses[0], position=question.initial_pose.position)
    assert "reachable" in broken_by(rooms, question, goal_poses=(*question.goal_poses, far))


def test_goals_that_do_not_see_the_target_or_are_there_twice_are_found(rooms, questions) -> None:
    question = max(questions.values(), key=lambda q: len(q.goal_poses))
    *_, last = question.goal_poses
    away = replace(last, yaw_deg=(last.yaw_deg + 180.0) % 360.0)
    assert broken_by(rooms, question, goal_poses=(*question.goal_poses, away)) == {"visible"}
    assert broken_by(rooms, question, goal_poses=(*question.goal_poses, last)) == {"consistent"}


def test_the_stored_pictures_keep_the_promise_of_a_question(questions) -> None:
    """Looked up without the code under test: no pixel of the three things before, some of each after."""
    question = next(q for q in questions.values() if q.answer == "3")
    numbers = [question.object_ids.index(object_id) + 1 for object_id in question.answer_ids]
    before, after = (decode_instances(getattr(question, f"{when}_instances").bytes) for when in ("start", "end"))
    assert len(numbers) == 3
    assert not np.isin(before, numbers).any()
    assert set(numbers) <= set(np.unique(after).tolist())


# ---- frames and expressions against their room, without files


@pytest.fixture(scope="module")
def config(root: Path) -> Config:
    return stored_config(load_manifest(root).config)


@pytest.fixture(scope="module")
def frames(root: Path) -> list[FrameRow]:
    return list(read_rows(root, FrameRow, "test", configuration=0))


@pytest.fixture(scope="module")
def expressions(root: Path) -> list[ExpressionRow]:
    return list(read_rows(root, ExpressionRow, "test", configuration=0))


def shifted_box(frame: FrameRow) -> FrameRow:
    first, *others = frame.objects
    x1, y1, x2, y2 = first.box_2d
    return replace(frame, objects=(replace(first, box_2d=(x1, y1, x2 + 1, y2)), *others))


def repainted(frame: FrameRow) -> FrameRow:
    first, *others = frame.objects
    return replace(frame, objects=(replace(first, color="purple"), *others))


def moved(frame: FrameRow, by_m: float) -> FrameRow:
    x, y, z = frame.agent.position
    return replace(frame, agent=replace(frame.agent, position=(x + by_m, y, z)))


@pytest.mark.parametrize(
    ("change", "truth"),
    [
        (lambda frame, other: replace(frame, rgb=other.rgb), "replayable"),
        (lambda frame, other: replace(frame, depth=other.depth), "replayable"),
        (lambda frame, other: replace(frame, instances=other.instances), "replayable"),
        (lambda frame, other: replace(frame, agent=other.agent), "replayable"),
        (lambda frame, other: moved(frame, 0.1), "reachable"),
        (lambda frame, other: moved(frame, 1000.0), "reachable"),
        (lambda frame, other: replace(frame, agent=replace(frame.agent, yaw_deg=45.0)), "reachable"),
        (lambda frame, other: replace(frame, objects=frame.objects[1:]), "visible"),
        (lambda frame, other: replace(frame, objects=frame.objects[::-1]), "visible"),
        (lambda frame, other: shifted_box(frame), "visible"),
        (lambda frame, other: repainted(frame), "visible"),
        (lambda frame, other: replace(frame, added_nodes=()), "consistent"),
        (lambda frame, other: replace(frame, added_edges=()), "consistent"),
    ],
)
def test_a_frame_that_says_something_else_is_found(rooms, frames, config, change, truth: str) -> None:
    frame, other = frames[0], frames[-1]
    found = list(frame_failures(rooms[0], [change(frame, other), *frames[1:]], config))
    assert (frame.frame_id, truth) in {(failure.where, failure.truth) for failure in found}


@pytest.mark.parametrize(
    "change",
    [
        lambda row: replace(row, graph_nodes=row.graph_nodes[::-1]),
        lambda row: replace(row, graph_edges=row.graph_edges[1:]),
        lambda row: replace(row, semantic_map=replace(row.semantic_map, voxels=row.semantic_map.voxels[1:])),
        lambda row: replace(row, map_2d=StoredImage(row.map_2d.bytes[:-1], row.map_2d.path)),
    ],
)
def test_a_graph_or_map_that_frames_do_not_show_is_found(rooms, frames, config, change) -> None:
    room = CheckedRoom(change(rooms[0].row))
    found = {(failure.where, failure.truth) for failure in frame_failures(room, frames, config)}
    assert found == {(room.name, "consistent")}


@pytest.mark.parametrize(
    ("change", "truth"),
    [
        (lambda said, other: replace(said, text=other.text), "unique"),
        (lambda said, other: replace(said, text="the unicorn"), "unique"),
        (lambda said, other: replace(said, text="the mug on " * 1000 + "the table"), "unique"),
        (lambda said, other: replace(said, program=other.program), "consistent"),
        (lambda said, other: replace(said, program=said.program + " "), "consistent"),
        (lambda said, other: replace(said, target_id=other.target_id), "unique"),
        (lambda said, other: replace(said, target_id="Unicorn|1"), "unique"),
        (lambda said, other: replace(said, target_type=other.target_type), "consistent"),
        (lambda said, other: replace(said, anchor_id=said.target_id), "consistent"),
        (lambda said, other: replace(said, relation="under"), "consistent"),
        (lambda said, other: replace(said, kind="superlative"), "consistent"),
        (lambda said, other: replace(said, split="val"), "consistent"),
        (lambda said, other: replace(said, frame_id="FloorPlan27-c0-f99"), "visible"),
        (lambda said, other: replace(said, box_2d=(0, 0, 1, 1)), "visible"),
    ],
)
def test_an_expression_that_says_something_else_is_found(rooms, frames, expressions, change, truth: str) -> None:
    said = next(said for said in expressions if said.relation not in (None, "under"))
    other = next(one for one in expressions if one.target_type != said.target_type)
    assert not list(expression_failures(rooms[0], frames, expressions))
    found = expression_failures(rooms[0], frames, [change(said, other)])
    assert truth in {failure.truth for failure in found}


# ---- the dataset as a whole


def test_a_question_that_is_always_answered_alike_is_found(root: Path, questions, tmp_path: Path) -> None:
    group = next(q.group for q in questions.values() if q.kind == "EXISTENCE")
    wrong = retold(
        root, tmp_path / "lie", QuestionRow, lambda row: replace(row, answer="yes") if row.group == group else row
    )
    first = next(name for name, question in questions.items() if question.group == group)
    assert {(first.rsplit("-c", 1)[0], "unbiased"), ("test EXISTENCE", "unbiased")} <= broken(wrong)


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
