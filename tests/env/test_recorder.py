"""What is recorded: honest episodes of a dataset, scored by the evaluator as by the environment."""

import math
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

from remqa_data.env import ENV_ID, RemqaEnv
from remqa_data.env.actions import Command
from remqa_data.env.oracle import oracle_commands
from remqa_data.env.recorder import Recorder
from remqa_data.errors import ActionError
from remqa_data.evaluation.scoring.ground_truth import load_ground_truth
from remqa_data.evaluation.scoring.scoring import score
from remqa_data.evaluation.submission.reader import open_submission
from remqa_data.sim.agent.actions import Action, parse_action
from remqa_data.storage.shards import read_table


def test_a_walk_that_no_submission_holds_is_no_row(small_rooms: Path, tmp_path: Path) -> None:
    path = tmp_path / "long.jsonl"
    env = Recorder(gymnasium.make(ENV_ID, root=small_rooms, split="test", width=8, height=8, max_steps=600), path)
    env.reset(seed=0)
    for _ in range(500):
        env.step("RotateLeft")
    for step in ("RotateLeft", "Answer yes"):
        with pytest.raises(ActionError, match="at most 500 steps, not 501"):
            env.step(step)
    assert env.rows == {}
    env.close()


def test_a_recorder_overwrites_nothing_before_it_has_something_and_nothing_of_another(
    small_rooms: Path, tmp_path: Path
) -> None:
    path = tmp_path / "mine.jsonl"
    path.write_text("precious")
    Recorder(RemqaEnv(small_rooms, "test", width=8, height=8), path).close()
    assert path.read_text() == "precious"
    first, second = (Recorder(RemqaEnv(small_rooms, "test", width=8, height=8), path) for _ in range(2))
    for env in (first, second):
        env.reset(seed=0)
        env.step("Answer yes")
    first.save()
    first.close()
    written = path.read_text()
    assert len(written.splitlines()) == 2
    with pytest.raises(ActionError, match="give each recorder a file of its own"):
        second.close()
    assert path.read_text() == written


@pytest.mark.parametrize(
    ("name", "agent"),
    [
        ("a.parquet", "me"),
        ("a.txt", "me"),
        ("a.jsonl", "x" * 201),
        ("a.jsonl", ""),
        ("a.jsonl", 3),
        ("a.jsonl", "\ud800"),
    ],
)
def test_what_no_submission_can_be_called_is_told_at_once(
    small_rooms: Path, tmp_path: Path, name: str, agent: str
) -> None:
    env = RemqaEnv(small_rooms, "test", width=8, height=8)
    with pytest.raises(ActionError, match=r"is called something\.jsonl|the agent's name is"):
        Recorder(env, tmp_path / name, agent)
    env.close()


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("taken/p.jsonl", "Not a directory"),
        ("/proc/nope/p.jsonl", "cannot be written: "),
        ("/proc/p.jsonl", "cannot be written: "),
        ("long" * 100 + ".jsonl", "File name too long"),
        ("null\0.jsonl", "null byte"),
        ("folder.jsonl", "no regular file"),
        ("link.jsonl", "no regular file"),
        (3, "path is 3"),
    ],
)
def test_where_nothing_can_be_written_is_told_at_once_and_in_one_line(
    small_rooms: Path, tmp_path: Path, name: Any, why: str
) -> None:
    (tmp_path / "taken").write_text("")
    (tmp_path / "folder.jsonl").mkdir()
    (tmp_path / "link.jsonl").symlink_to("taken")
    env = RemqaEnv(small_rooms, "test", width=8, height=8)
    with pytest.raises(ActionError, match=why) as caught:
        Recorder(env, tmp_path / name if isinstance(name, str) else name)
    assert str(caught.value).isprintable()
    env.close()


def test_a_folder_that_is_not_there_is_made_and_one_that_goes_away_is_an_action_error(
    small_rooms: Path, tmp_path: Path
) -> None:
    path = tmp_path / "new" / "deep" / "p.jsonl"
    env = Recorder(RemqaEnv(small_rooms, "test", width=8, height=8), path)
    assert list(path.parent.iterdir()) == []
    path.parent.rmdir()
    path.parent.write_text("")
    with pytest.raises(ActionError, match=r"p\.jsonl cannot be written: Not a directory; give another path"):
        env.close()


@pytest.mark.slow
@pytest.mark.parametrize("hands", ["reach", "arm"])
def test_the_oracle_is_perfect_and_its_recording_too(two_rooms: Path, tmp_path: Path, hands: str) -> None:
    path = tmp_path / "oracle.jsonl"
    env = Recorder(
        gymnasium.make(ENV_ID, root=two_rooms, split="train", hands=hands, width=32, height=32), path, "oracle"
    )
    remqa = env.unwrapped
    assert isinstance(remqa, RemqaEnv)
    ended = []
    for question_id in remqa.episode_ids:
        seen, _ = env.reset(options={"episode": question_id})
        task = remqa.episode.task
        assert task is not None
        assert seen["question"] == task.question
        for step in oracle_commands(task):
            _, reward, terminated, _, info = env.step(step)
            assert info["success"], info["error"]
        assert terminated
        assert reward == 1.0
        ended.append(info)
    env.close()
    scores = score(open_submission(path), load_ground_truth(two_rooms, "remqa", "train"))
    assert len(ended) == 8
    assert scores.measures.keys() >= {"S_N", "S_QA", "S_MQA"}
    for name, values in scores.measures.items():
        assert [info[name] for info in ended] == values.tolist() == [True] * 8
    assert [info["SPL"] for info in ended] == [1.0] * 8


def recorded(root: Path, path: Path) -> tuple[Recorder, RemqaEnv]:
    """An environment that writes what is done in it, and what it wraps."""
    env = Recorder(gymnasium.make(ENV_ID, root=root, split="train", hands="reach", width=32, height=32), path)
    assert isinstance(env.unwrapped, RemqaEnv)
    return env, env.unwrapped


@pytest.mark.slow
def test_an_agent_that_errs_is_scored_alike_by_the_environment_and_the_evaluator(
    two_rooms: Path, tmp_path: Path
) -> None:
    path = tmp_path / "random.jsonl"
    env, remqa = recorded(two_rooms, path)
    rng = np.random.default_rng(0)
    walking = ["MoveAhead", "MoveBack", "MoveLeft", "RotateLeft", "RotateRight", "LookDown", "LookUp", "Crouch"]
    ended = []
    for question_id in remqa.episode_ids:
        env.reset(options={"episode": question_id})
        task = remqa.episode.task
        assert task is not None
        for step in oracle_commands(task)[: int(rng.integers(1, 9))]:
            env.step(step)
        for word in rng.choice(walking, 6):
            env.step(str(word))
        ended.append(env.step(Command(answer=task.answer, box=(0.1, 0.1, 0.9, 0.9)))[-1])
    env.close()
    scores = score(open_submission(path), load_ground_truth(two_rooms, "remqa", "train"))
    assert len(ended) == 8
    assert scores.measures.keys() >= {"S_N", "S_QA", "S_MQA"}
    for name, values in scores.measures.items():
        assert [info[name] for info in ended] == values.tolist()
    assert all(math.isfinite(info["distance_to_goal_m"]) for info in ended)


@pytest.mark.slow
def test_the_strict_chain_is_that_of_the_evaluator_whatever_follows_the_first_manipulation(
    two_rooms: Path, tmp_path: Path
) -> None:
    path = tmp_path / "a.jsonl"
    env, remqa = recorded(two_rooms, path)
    asked = read_table(two_rooms, "questions", "train", ["question_id", "manipulation", "target_id"]).to_pylist()
    drawers = [row for row in asked if row["manipulation"] == "Open"]
    plans = (
        (["OpenObject {}", "CloseObject {}"], True),  # it has seen the open drawer before it closed it
        (["OpenObject {} 0.5"], False),
        (["OpenObject {} 0.5", "OpenObject {}"], False),  # a submission has one manipulation
        (["CloseObject {}", "OpenObject {} 0.9"], True),  # the first is refused
    )
    ended = []
    for row, (words, _) in zip(drawers, plans, strict=True):
        env.reset(options={"episode": row["question_id"]})
        task = remqa.episode.task
        assert task is not None
        for step in oracle_commands(task)[:-2]:
            env.step(step)
        for word in words:
            env.step(Command(parse_action(word.format(row["target_id"])), box=task.target_box))
        ended.append(env.step(Command(answer=task.answer, box=task.target_box))[-1])
    env.close()
    assert [info["S_QA"] for info in ended] == [True] * 4
    for name in ("manipulated", "S_M", "S_MQA"):
        assert [info[name] for info in ended] == [counts for _, counts in plans]
    scores = score(open_submission(path), load_ground_truth(two_rooms, "remqa", "train"))
    assert scores.measures.keys() >= {"S_N", "S_QA", "S_MQA"}
    for name, values in scores.measures.items():
        assert [info[name] for info in ended] == values[scores.answered].tolist()


@pytest.mark.slow
def test_only_honest_episodes_of_a_dataset_are_recorded(two_rooms: Path, tmp_path: Path) -> None:
    with pytest.raises(ActionError, match="root="):
        Recorder(RemqaEnv(scenes=["FloorPlan406"]), tmp_path / "a.jsonl")
    with pytest.raises(ActionError, match="privileged"):
        Recorder(RemqaEnv(two_rooms, "test", privileged=True), tmp_path / "a.jsonl")
    env = Recorder(RemqaEnv(two_rooms, "test", action_mode="parametrised"), tmp_path / "a.jsonl")
    env.reset(seed=0)
    for step in ("MoveAhead 0.1", "Answer yes"):
        with pytest.raises(ActionError, match=r"whole steps, not 'MoveAhead 0\.1'"):
            env.step(step)
    assert env.rows == {}


def test_numbers_of_numpy_are_recorded_as_numbers(small_rooms: Path, tmp_path: Path) -> None:
    path = tmp_path / "said.jsonl"
    env = RemqaEnv(small_rooms, "test", width=32, height=32, hands="reach")
    recorder = Recorder(env, path)
    recorder.reset(options={"episode": env.episode_ids[0]})
    task = env.episode.task
    assert task is not None
    *walk, manipulation, answer = oracle_commands(task)
    for step in walk:
        recorder.step(step)
    assert manipulation.action is not None
    name, target = manipulation.action.name, manipulation.action.target
    box = np.array((0.1, 0.2, 0.9, 0.8), dtype=np.float32)
    action = Action(name, target, np.array([1.0], dtype=np.float32))  # type: ignore[arg-type]
    info = recorder.step(Command(action, box=box))[-1]  # type: ignore[arg-type]
    assert (info["success"], info["action"]) == (True, f"{name} {target} 1.0")
    recorder.step(answer)
    recorder.close()
    row = next(iter(open_submission(path).batches(replay=True, max_rows=9))).rows.to_pylist()[0]
    assert row["manipulation"] == f"{name} {target}"
    np.testing.assert_allclose(row["box"], 300.0 * box, rtol=1e-6)
