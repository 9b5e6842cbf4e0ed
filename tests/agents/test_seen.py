"""Systems in rooms that networks learn in, several seeds of one, and how long playing takes: through the command line."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from remqa_data.agents.cli import app
from remqa_data.agents.runner import pace_path
from remqa_data.agents.seen import seen_questions
from remqa_data.agents.training.rooms import learning_rooms
from remqa_data.storage.shards import read_table

pytestmark = pytest.mark.slow


def test_seen_questions_are_spread_over_the_rooms_that_are_learnt_from(two_rooms: Path) -> None:
    asked = read_table(two_rooms, "questions", "train", ["question_id", "scene", "configuration"]).to_pylist()
    of_first = [row for row in asked if row["configuration"] == 0]
    known = [row["question_id"] for row in of_first if row["scene"] in learning_rooms([two_rooms])]
    assert 3 < len(known) < len(asked)
    assert seen_questions(two_rooms, 10_000) == known
    few = seen_questions(two_rooms, 3)
    assert len(few) == 3
    assert (few[0], few[-1]) == (known[0], known[-1])


def run(*args: str | Path) -> str:
    done = CliRunner().invoke(app, [*map(str, args), "--workers", "1"])
    assert done.exit_code == 0, done.output
    return done.output


def test_what_was_played_is_replaced_only_if_told_to(two_rooms: Path, tmp_path: Path) -> None:
    words = ("run", "random", "--seen", "30000", "--data", two_rooms, "-o", tmp_path)
    count = len(seen_questions(two_rooms, 30_000))
    assert f"--seen 30000: there are {count} such questions, and all of them are played\n" in run(*words)
    path = tmp_path / "seen" / "random.jsonl"
    played = path.read_bytes()
    path.write_bytes(b"mine")
    done = CliRunner().invoke(app, [*map(str, words)])
    assert (done.exit_code, done.stderr.count("\n")) == (2, 1)
    assert f"{path} has been played already; use --resume to go on with it, --overwrite to replace it" in done.stderr
    assert path.read_bytes() == b"mine"
    run(*words, "--overwrite")
    assert path.read_bytes() == played
    path.unlink()
    path.with_name("random.jsonl.parts").mkdir()  # of a run that was stopped
    assert "has been played already" in CliRunner().invoke(app, [*map(str, words)]).stderr


def test_seeds_seen_rooms_and_pace_stand_in_the_tables(two_rooms: Path, tmp_path: Path) -> None:
    folder = ("--data", two_rooms, "-o", tmp_path)
    run("run", "random", "--seed", "0", "--seed", "1", *folder)
    run("run", "random", "--seen", "3", *folder)
    played = [json.loads(line) for line in (tmp_path / "seen" / "random.jsonl").read_text().splitlines()]
    assert played[0]["split"] == "train"
    assert [row["question_id"] for row in played[1:]] == seen_questions(two_rooms, 3)
    run("table", *folder)
    tables = (tmp_path / "table.md").read_text().split("**")
    shown = dict(zip(tables[1::2], tables[2::2], strict=True))
    (seeds,) = rows(shown["Means over seeds, split test"])
    assert seeds[:2] == ["random walk, majority answer", "2"]
    seen = {row[2]: row for row in rows(shown["Seen and unseen rooms, 3 train questions"])}
    assert seen["success@50"][3] == "0.035"  # the paper's
    assert all(0 <= float(row[place].split()[0]) <= 1 for row in seen.values() for place in (4, 5))
    assert seen["success@50"][5] == seeds[4]  # of unseen rooms, the mean over both seeds
    paces = rows(shown["What playing takes"])
    assert [row[0].partition(",")[0] for row in paces] == ["random walk"] * 3
    for row, path in zip(paces, (*sorted(tmp_path.glob("*.jsonl")), tmp_path / "seen" / "random.jsonl"), strict=True):
        lines = [json.loads(line) for line in path.read_text().splitlines()[1:]]
        steps = sum(len(line["actions"]) for line in lines)
        assert int(row[1].replace(",", "")) == steps == json.loads(pace_path(path).read_text())["steps"]


def rows(markdown: str) -> list[list[str]]:
    lines = [line for line in markdown.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]
