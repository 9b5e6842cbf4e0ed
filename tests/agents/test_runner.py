"""Agents in real rooms: what they submit, that it does not depend on how they were run, and what they never see."""

import json
import shutil
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from remqa_data.agents import runner
from remqa_data.agents.config import load_system
from remqa_data.agents.runner import NOTE, Player, pace_path, play_all, play_split, read_pace
from remqa_data.agents.systems import make_agent
from remqa_data.errors import ConfigError
from remqa_data.storage.manifest import MANIFEST, load_manifest
from remqa_data.storage.shards import file_info
from remqa_data.tables.schema import table_spec
from tests.helpers.submissions import results_of

pytestmark = pytest.mark.slow


def played(root: Path, path: Path, system: str = "semantic_map", **options: Any) -> list[dict[str, Any]]:
    config = load_system(system)
    play_split(make_agent(config, root), root, "test", path, title=config.title, seed=config.seed, **options)
    return rows_of(path)


def rows_of(path: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in path.read_text().splitlines()[1:]]


@pytest.fixture(scope="module")
def map_walk(two_rooms: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What `semantic_map` submits. Not to be changed."""
    path = tmp_path_factory.mktemp("map") / "map.jsonl"
    played(two_rooms, path)
    return path


@pytest.fixture(scope="module")
def random_walk(two_rooms: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What `random` submits. Not to be changed."""
    path = tmp_path_factory.mktemp("random") / "random.jsonl"
    played(two_rooms, path, "random")
    return path


def test_who_knows_the_map_gets_there_and_acts(two_rooms: Path, map_walk: Path) -> None:
    path = map_walk
    assert len(rows_of(path)) == 12
    results = results_of(two_rooms, path)
    assert results.counts.answered == 12
    assert results.metric("S_N").value >= 0.8
    assert results.metric("S_L").value >= 0.8
    assert results.metric("manipulated").value >= 0.7  # the short walks of this dataset have not seen the microwave
    assert sorted(path.parent.iterdir()) == [path, pace_path(path)]  # no parts are left


def test_who_walks_anywhere_does_not(two_rooms: Path, random_walk: Path) -> None:
    rows = rows_of(random_walk)
    assert len(rows) == 12
    assert all(row["box"] is row["manipulation"] is None for row in rows)
    assert results_of(two_rooms, random_walk).metric("S_N").value <= 0.3


def test_a_submission_depends_neither_on_workers_nor_on_where_a_run_was_stopped(
    two_rooms: Path, random_walk: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = rows_of(random_walk)
    assert played(two_rooms, tmp_path / "two.jsonl", "random", workers=2) == rows

    stopped, done = tmp_path / "stopped.jsonl", []

    def stop(count: int) -> None:
        done.append(count)
        if len(done) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        played(two_rooms, stopped, "random", progress=stop)
    assert not stopped.exists()
    again: list[tuple[str, int]] = []
    play = runner.play_room
    monkeypatch.setattr(runner, "play_room", lambda job: (again.append(job.room), play(job))[1])
    assert played(two_rooms, stopped, "random", resume=True) == rows
    assert len(again) == 2  # of four configurations


def test_who_plays_beside_others_does_what_he_does_alone(
    two_rooms: Path, random_walk: Path, map_walk: Path, tmp_path: Path
) -> None:
    names = ("random", "semantic_map")
    alone = [rows_of(random_walk), rows_of(map_walk)]
    configs = [load_system(name) for name in names]
    players = [
        Player(make_agent(config, two_rooms), tmp_path / f"{name}-again.jsonl", config.title, config.seed)
        for name, config in zip(names, configs, strict=True)
    ]
    counts: list[int] = []
    assert play_all(players, two_rooms, "test", progress=counts.append) == 12
    assert [rows_of(player.path) for player in players] == alone
    assert sum(counts) == 24
    assert all(pace_path(player.path).is_file() for player in players)


def test_two_systems_do_not_write_one_file(two_rooms: Path, tmp_path: Path) -> None:
    agent = make_agent(load_system("random"), two_rooms)
    players = [Player(agent, tmp_path / "random.jsonl", title) for title in ("one", "another")]
    with pytest.raises(ConfigError, match=r"2 systems would write .*random\.jsonl: let them play one after the other"):
        play_all(players, two_rooms, "test")
    assert not list(tmp_path.iterdir())


def test_a_finished_submission_is_not_played_again_but_by_another_run(two_rooms: Path, tmp_path: Path) -> None:
    path, counts = tmp_path / "a.jsonl", list[int]()
    rows = played(two_rooms, path, "random", fingerprint="one")
    path.touch()
    was = path.stat().st_mtime_ns
    assert played(two_rooms, path, "random", resume=True, fingerprint="one", progress=counts.append) == rows
    assert (path.stat().st_mtime_ns, sum(counts)) == (was, 12)
    for options in ({"fingerprint": "another", "resume": True}, {"fingerprint": "another"}):
        was = path.stat().st_mtime_ns
        assert played(two_rooms, path, "random", **options) == rows
        assert path.stat().st_mtime_ns > was
    pace_path(path).write_text("{")
    assert played(two_rooms, path, "random", resume=True, fingerprint="another") == rows
    assert read_pace(path)["steps"] > 0


def test_only_the_same_run_is_gone_on_with(two_rooms: Path, tmp_path: Path) -> None:
    path = tmp_path / "a.jsonl"

    def stop(count: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        played(two_rooms, path, "random", progress=stop, fingerprint="one")
    with pytest.raises(ConfigError, match="holds rooms of another run; use --overwrite"):
        played(two_rooms, path, "random", resume=True, fingerprint="another")
    (tmp_path / "a.jsonl.parts" / NOTE).write_text("{")
    with pytest.raises(ConfigError, match="holds rooms of another run; use --overwrite"):
        played(two_rooms, path, "random", resume=True, fingerprint="one")


# ---- what an agent never sees


def test_with_other_truths_an_agent_does_the_same(two_rooms: Path, map_walk: Path, tmp_path: Path) -> None:
    """The target, goals and answers of the test split, and what the simulator knows of its rooms, are replaced by lies."""
    lies = _with_lies(two_rooms, tmp_path / "lies")
    told = played(lies, tmp_path / "lied-to.jsonl")
    assert told == rows_of(map_walk)
    # The lies reach what scores: nobody is where he should be now.
    assert results_of(two_rooms, map_walk).metric("S_N").value > 0.5
    assert results_of(lies, tmp_path / "lied-to.jsonl").metric("S_N").value == 0


def _with_lies(root: Path, out: Path) -> Path:
    """A copy of a dataset in which all truths of the test split that an agent should not see are others."""
    shutil.copytree(root, out)
    far = {"position": [90.0, 90.0, 0.0], "yaw_deg": 0.0, "horizon_deg": 0.0}
    question: dict[str, Callable[[dict[str, Any]], Any]] = {
        "expression": lambda row: "the floor",
        "answer": lambda row: {"yes": "no", "no": "yes"}.get(row["answer"], "3"),
        "program": lambda row: json.dumps([["filter_type", "Floor"], ["exist"]]),
        "kind": lambda row: "EXISTENCE",
        "goal_poses": lambda row: [far],
        "target_id": lambda row: row["object_ids"][0],
        "target_type": lambda row: "Floor",
        "answer_type": lambda row: "Mug",
        "answer_ids": lambda row: [],
        "manipulation": lambda row: "Move",
        "manipulation_object_id": lambda row: row["object_ids"][0],
        "path_length_m": lambda row: 99.0,
        "path_steps": lambda row: 0,
        "actions": lambda row: ["Done"],
    }
    scene: dict[str, Callable[[dict[str, Any]], Any]] = {
        "objects": lambda row: [thing | {"box": [9.0, 9.0, 9.0, 9.1, 9.1, 9.1]} for thing in row["objects"]],
        "navigation_cells": lambda row: row["navigation_cells"][:1],
        "walk_start_cell": lambda row: row["navigation_cells"][0],
    }
    _rewrite(out, "questions", question)
    _rewrite(out, "scenes", scene)
    return out


def _rewrite(root: Path, table: str, changes: dict[str, Callable[[dict[str, Any]], Any]]) -> None:
    manifest = load_manifest(root)
    for info in manifest.files_of(table, "test"):
        data = pq.read_table(root / info.path)
        rows = data.to_pylist()
        for column, change in changes.items():
            place, kept = data.schema.get_field_index(column), data.schema.field(column)
            data = data.set_column(place, kept, pa.array([change(row) for row in rows], kept.type))
        pq.write_table(data, root / info.path, row_group_size=table_spec(table).row_group_rows)
        new = file_info(root / info.path, info.path, info.table, info.split)
        files = tuple(new if file.path == info.path else file for file in manifest.files)
        manifest = replace(manifest, files=files)
    (root / MANIFEST).write_text(json.dumps(asdict(manifest)))
