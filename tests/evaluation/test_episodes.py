"""What was submitted for a question, done again in the environment, and as a film."""

from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from remqa_data.cli import app
from remqa_data.env import RemqaEnv
from remqa_data.env.video import write_film
from remqa_data.errors import SubmissionError, UnknownNameError
from remqa_data.evaluation.episodes import submitted_commands
from remqa_data.evaluation.scoring.ground_truth import dataset_sha256
from remqa_data.evaluation.submission.reader import Header, write_submission
from remqa_data.evaluation.submission.reference import reference_rows
from remqa_data.storage.manifest import load_manifest

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def rows(two_rooms: Path) -> list[dict]:
    """The oracle's."""
    return reference_rows("oracle", two_rooms, "remqa", "test", np.random.default_rng(0))


@pytest.fixture(scope="module")
def oracle(two_rooms: Path, rows: list[dict], tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("submitted") / "oracle.jsonl"
    write_submission(path, Header(track="remqa", split="test"), rows)
    return path


def test_what_the_oracle_submits_is_right_in_the_environment(two_rooms: Path, oracle: Path, rows: list[dict]) -> None:
    env = RemqaEnv(two_rooms, "test")
    done = []
    for row in rows[:3]:
        env.reset(options={"episode": row["question_id"]})
        for command in submitted_commands(oracle, two_rooms, row["question_id"]):
            *_, info = env.step(command)
        done.append((info["S_N"], info["S_L"], info["manipulated"], info["answer_accuracy"]))
    env.close()
    assert done == [(1.0, 1.0, 1.0, 1.0)] * 3


def test_a_film_shows_what_was_submitted(two_rooms: Path, rows: list[dict], tmp_path: Path) -> None:
    """Nothing but an answer: the frames at the start, of the answer, and those that stay."""
    path, question = tmp_path / "still.jsonl", rows[0]["question_id"]
    still = {"question_id": question, "actions": ["Done"], "box": None, "manipulation": None, "answer": "nothing"}
    write_submission(path, Header(track="remqa", split="test"), [still])
    command = ["play", str(two_rooms), question, "--submission", str(path), "-o", str(tmp_path / "film.webp"), "--json"]
    done = CliRunner().invoke(app, command)
    assert done.exit_code == 0, done.output
    assert '"frames": 12' in done.output
    assert (tmp_path / "film.webp").stat().st_size > 1000


def test_what_is_refused_when_it_is_scored_is_filmed_as_refused(
    two_rooms: Path, rows: list[dict], tmp_path: Path
) -> None:
    path = tmp_path / "odd.jsonl"
    odd = {**rows[0], "actions": ["Done"], "manipulation": "OpenObject Nothing|1", "box": [0, 0, 400, 9000]}
    write_submission(path, Header(track="remqa", split="test"), [odd])
    commands = submitted_commands(path, two_rooms, odd["question_id"])
    assert commands[-2].box == (0.0, 0.0, 1.0, 1.0)
    assert write_film(two_rooms, odd["question_id"], tmp_path / "film.webp", commands) == 14


def test_a_box_alone_is_pointed_at_with_the_answer(two_rooms: Path, rows: list[dict], tmp_path: Path) -> None:
    path = tmp_path / "box.jsonl"
    write_submission(
        path, Header(track="remqa", split="test"), [{**rows[0], "manipulation": None, "box": [0, 0, 150, 300]}]
    )
    assert submitted_commands(path, two_rooms, rows[0]["question_id"])[-1].box == (0.0, 0.0, 0.5, 1.0)


def test_what_cannot_be_played_is_told_in_one_line(
    two_rooms: Path, oracle: Path, rows: list[dict], tmp_path: Path
) -> None:
    with pytest.raises(UnknownNameError, match=r"unknown question 'nothing'"):
        submitted_commands(oracle, two_rooms, "nothing")
    answers, other = tmp_path / "qa.jsonl", tmp_path / "other.jsonl"
    asked = {"question_id": rows[0]["question_id"], "answer": "1"}
    write_submission(answers, Header(track="qa", split="test"), [asked])
    with pytest.raises(SubmissionError, match="in track 'qa' nobody walks"):
        submitted_commands(answers, two_rooms, rows[0]["question_id"])
    sha256 = dataset_sha256(load_manifest(two_rooms))
    for name in (sha256, sha256[:16]):
        write_submission(other, Header(track="remqa", split="test", dataset=name), rows)
        assert submitted_commands(other, two_rooms, rows[0]["question_id"])
    write_submission(other, Header(track="remqa", split="test", dataset="0" * 64), rows)
    with pytest.raises(SubmissionError, match=r"the predictions are for dataset '0{16}', not"):
        submitted_commands(other, two_rooms, rows[0]["question_id"])
    write_submission(other, Header(track="remqa", split="../x"), rows)
    with pytest.raises(SubmissionError, match=r"line 1, field split: the dataset has no split '\.\./x'"):
        submitted_commands(other, two_rooms, rows[0]["question_id"])
