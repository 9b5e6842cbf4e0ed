"""A small dataset from beginning to end."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from remqa_data.cli import app as data_app
from remqa_data.generators.cli import app
from remqa_data.generators.config import load_config
from remqa_data.generators.pipeline import generate
from remqa_data.processes.executors import LocalExecutor
from remqa_data.storage.manifest import Manifest, load_manifest
from remqa_data.storage.shards import read_rows, read_table
from remqa_data.tables.rows import FrameRow, QuestionRow
from tests.helpers.real_datasets import CONFIGS, two_rooms_config


@pytest.fixture
def made(two_rooms: Path) -> tuple[Path, Manifest]:
    return two_rooms, load_manifest(two_rooms)


@pytest.mark.slow
def test_quotas_are_met_and_answers_balanced(made: tuple[Path, Manifest]) -> None:
    root, manifest = made
    assert manifest.questions == {
        "test": {"COUNTING": 4, "EXISTENCE": 4, "SPATIAL": 4},
        "train": {"EXISTENCE": 4, "SPATIAL": 4},
    }
    for split in ("train", "test"):
        rows = list(read_rows(root, QuestionRow, split))
        for kind in ("EXISTENCE", "SPATIAL"):
            answers = [row.answer for row in rows if row.kind == kind]
            assert answers.count("yes") == answers.count("no") == 2
        by_group: dict[str, set[str]] = {}
        for row in rows:
            by_group.setdefault(row.group, set()).add(row.answer)
            assert row.actions[-1] == "Done"
            assert row.path_steps >= 1
        assert all(len(answers) > 1 for answers in by_group.values())
    counts = sorted(row.answer for row in read_rows(root, QuestionRow, "test") if row.kind == "COUNTING")
    assert counts == ["0", "1", "2", "3"]


@pytest.mark.slow
def test_tables_belong_together(made: tuple[Path, Manifest]) -> None:
    root, manifest = made
    assert manifest.rows("scenes") == 8
    frames = {row.frame_id: row for split in ("train", "test") for row in read_rows(root, FrameRow, split)}
    assert len(frames) == manifest.rows("frames") == 32
    expressions = [
        row
        for split in manifest.splits("expressions")
        for row in read_table(root, "expressions", split, ["frame_id", "target_id"]).to_pylist()
    ]
    assert len(expressions) == manifest.rows("expressions") > 0
    for row in expressions:
        assert row["target_id"] in {seen.id for seen in frames[row["frame_id"]].objects}
    assert json.loads((root / "croissant.json").read_text())["name"]
    assert not (root / ".parts").exists()


@pytest.mark.slow
def test_two_workers_make_the_same_bytes(made: tuple[Path, Manifest], tmp_path: Path) -> None:
    _, manifest = made
    assert generate(tmp_path / "again", two_rooms_config(), LocalExecutor(2)) == manifest


@pytest.mark.slow
def test_every_question_holds(made: tuple[Path, Manifest]) -> None:
    root, _ = made
    result = CliRunner().invoke(data_app, ["verify", str(root), "--rooms", "0"])
    assert result.exit_code == 0, result.output
    assert "20 of 20 questions hold" in result.output


@pytest.mark.slow
def test_a_sample_can_be_drawn(made: tuple[Path, Manifest], tmp_path: Path) -> None:
    root, _ = made
    name = next(read_rows(root, QuestionRow, "test")).question_id
    result = CliRunner().invoke(data_app, ["show", str(root), name, "-o", str(tmp_path / "sample.png")])
    assert result.exit_code == 0, result.output
    assert (tmp_path / "sample.png").stat().st_size > 20_000
    result = CliRunner().invoke(data_app, ["show", str(root), name + "x", "-o", str(tmp_path / "no.png")])
    assert result.exit_code == 2
    assert f"did you mean '{name}'" in result.output
    assert not (tmp_path / "no.png").exists()


def test_the_shipped_configuration_is_the_published_benchmark() -> None:
    config = load_config("paper")
    assert config == load_config(CONFIGS / "paper.yaml")
    assert len(config.scene_names) == 120
    assert sum(sum(kinds.values()) for kinds in config.totals.values()) == 4072


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--scenes", "0"], "not between 1 and 120"),
        (["--scenes", "121"], "use --layouts sampled for more rooms"),
        (["--config", "missing.yaml"], "missing.yaml"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(arguments: list[str], message: str, tmp_path: Path) -> None:
    result = CliRunner().invoke(app, [*arguments, "--out", str(tmp_path / "out")])
    assert result.exit_code == 2
    assert message in result.output
    assert len(result.output.strip().splitlines()) == 1
    assert not (tmp_path / "out").exists()


def test_a_folder_with_other_files_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("mine")
    result = CliRunner().invoke(app, ["--config", str(CONFIGS / "tiny.yaml"), "--out", str(tmp_path)])
    assert result.exit_code == 2
    assert "holds thesis.txt: no part of a dataset of ours" in result.output
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]
