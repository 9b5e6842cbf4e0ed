from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from remqa_data.agents.cli import app
from remqa_data.agents.training import learn as learn_module
from remqa_data.agents.training.learn import check_places
from remqa_data.agents.training.trainer import CHECKPOINT
from remqa_data.agents.training.weights import About

PLACES = ["detector.safetensors", f"detector/{CHECKPOINT}", "detector-3.safetensors"]


@pytest.fixture
def learnt(monkeypatch: pytest.MonkeyPatch) -> list[tuple[str, bool]]:
    """Names of what was trained, and whether it was gone on with; nothing is."""
    found: list[tuple[str, bool]] = []

    def learn(name: str, *_: Any, resume: bool, **__: Any) -> About:
        found.append((name, resume))
        return About({}, ("",), ())

    monkeypatch.setattr(learn_module, "learn", learn)
    return found


def trained(tmp_path: Path, *options: str) -> Any:
    command = ["train", "refiner", "detector", "--data", str(tmp_path / "data"), "--out", str(tmp_path / "out")]
    return CliRunner().invoke(app, [*command, *options])


def put(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"of before")
    return path


@pytest.mark.parametrize("place", PLACES)
def test_what_has_weights_or_a_checkpoint_is_not_trained_unless_that_is_asked_for(
    tmp_path: Path, learnt: list[tuple[str, bool]], place: str
) -> None:
    path = put(tmp_path / "out" / place)
    name = place.partition("/")[0].removesuffix(".safetensors")
    seed = ("--seed", "3") if name == "detector-3" else ()
    done = trained(tmp_path, *seed)
    assert (done.exit_code, done.stderr.count("\n")) == (2, 1), done.stderr
    assert f"{tmp_path / 'out' / name} has been trained already; use --resume to go on" in done.stderr
    assert "--overwrite to replace it, or another folder" in done.stderr
    assert learnt == []  # not even the first one, of which nothing is there
    assert path.read_bytes() == b"of before"
    for option in ("--resume", "--overwrite"):
        assert trained(tmp_path, *seed, option).exit_code == 0
    assert [resume for _, resume in learnt] == [True, True, False, False]


def test_to_go_on_and_to_replace_are_not_asked_for_together(tmp_path: Path, learnt: list[tuple[str, bool]]) -> None:
    done = trained(tmp_path, "--resume", "--overwrite")
    assert (done.exit_code, done.stderr.count("\n")) == (2, 1), done.stderr
    assert "give one of them" in done.stderr
    assert learnt == []


def test_networks_are_trained_beside_others(tmp_path: Path) -> None:
    for place in PLACES:
        put(tmp_path / place)
    check_places(["refiner", "detector-4"], tmp_path, overwrite=False, resume=False)
