import csv
import errno
import json
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest
import torch

from remqa_data.agents.training import trainer
from remqa_data.agents.training.config import CURVES, DURATION
from remqa_data.agents.training.trainer import CHECKPOINT, deterministic, train
from remqa_data.errors import ConfigError
from tests.helpers.small_training import SCHEDULE, Sums, checksum


@pytest.mark.slow
def test_it_learns_and_writes_its_curves(tmp_path: Path) -> None:
    score = train(Sums(), replace(SCHEDULE, epochs=40), tmp_path)
    assert set(score) == {"val_error"}
    assert score["val_error"] < 0.1
    assert json.loads((tmp_path / DURATION).read_text())["minutes"] < 5
    with (tmp_path / CURVES).open() as file:
        curves = list(csv.DictReader(file))
    assert [row["epoch"] for row in curves] == [str(epoch) for epoch in range(1, 41)]
    assert float(curves[-1]["loss"]) < float(curves[0]["loss"]) / 4


@pytest.mark.slow
def test_the_same_seed_gives_the_same_weights_and_another_seed_others(tmp_path: Path) -> None:
    found = []
    for place, seed in enumerate((3, 3, 4)):
        task = Sums()
        train(task, replace(SCHEDULE, seed=seed), tmp_path / str(place))
        found.append(checksum(task.model))
    assert found[0] == found[1] != found[2]


@pytest.mark.slow
def test_other_processes_make_the_same_batches(tmp_path: Path) -> None:
    here, elsewhere, stopped = Sums(), Sums(), Sums()
    train(here, SCHEDULE, tmp_path / "here")
    train(elsewhere, SCHEDULE, tmp_path / "elsewhere", workers=2)
    assert elsewhere.drawn == 0 < here.drawn
    assert checksum(elsewhere.model) == checksum(here.model)

    def stop(count: int) -> None:
        if (tmp_path / "stopped" / CHECKPOINT).is_file():
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        train(stopped, SCHEDULE, tmp_path / "stopped", workers=2, checkpoint_s=0.0, progress=stop)
    train(stopped, SCHEDULE, tmp_path / "stopped", workers=2, resume=True)
    assert checksum(stopped.model) == checksum(here.model)


def test_where_no_process_can_be_forked_that_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("multiprocessing.get_all_start_methods", lambda: ["spawn"])
    with pytest.raises(ConfigError, match="--workers: this system forks no processes; leave it out"):
        train(Sums(), SCHEDULE, tmp_path, workers=1)


@pytest.mark.slow
def test_it_learns_in_bfloat16_with_weights_of_float32(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trainer, "knows_bfloat16", lambda device: True)
    short = replace(SCHEDULE, epochs=40, precision="bfloat16")
    tasks = [Sums() for _ in range(3)]
    scores = [
        train(task, schedule, tmp_path / str(place))
        for place, (task, schedule) in enumerate(
            zip(tasks, (short, short, replace(short, precision="float32")), strict=True)
        )
    ]
    assert scores[0]["val_error"] < 0.15
    assert {weights.dtype for weights in tasks[0].model.parameters()} == {torch.float32}
    assert checksum(tasks[0].model) == checksum(tasks[1].model) != checksum(tasks[2].model)


@pytest.mark.slow
def test_a_processor_that_would_imitate_bfloat16_learns_in_float32(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    learnt = {}
    for known, precision in ((False, "float32"), (False, "bfloat16"), (True, "bfloat16")):
        monkeypatch.setattr(torch.cpu, "get_capabilities", lambda known=known: {"avx512_bf16": known}, raising=False)
        task = Sums()
        train(task, replace(SCHEDULE, epochs=1, precision=precision), tmp_path / f"{known}-{precision}")
        learnt[known, precision] = checksum(task.model)
    assert learnt[False, "bfloat16"] == learnt[False, "float32"] != learnt[True, "bfloat16"]


@pytest.mark.slow
def test_a_run_that_was_stopped_goes_on_where_it_was_to_the_same_weights(tmp_path: Path) -> None:
    whole, stopped = Sums(), Sums()
    train(whole, SCHEDULE, tmp_path / "whole")
    learnt = 0

    def stop(count: int) -> None:
        nonlocal learnt
        learnt += count
        if learnt >= 200:  # in the third epoch
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        train(stopped, SCHEDULE, tmp_path / "stopped", checkpoint_s=0.0, progress=stop)
    again = Sums()
    train(again, SCHEDULE, tmp_path / "stopped", resume=True)
    assert again.drawn < 4 * 80
    assert checksum(again.model) == checksum(whole.model)
    whole_curves, curves = ((tmp_path / name / CURVES).read_text() for name in ("whole", "stopped"))
    assert curves == whole_curves


@pytest.mark.slow
def test_a_run_that_was_killed_after_its_last_checkpoint_ends_with_all_curves(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    train(Sums(), SCHEDULE, tmp_path / "whole")
    write = trainer._write_curves

    def killed(path: Path, curves: list[dict[str, float]]) -> None:
        if len(curves) == SCHEDULE.epochs:
            raise KeyboardInterrupt
        write(path, curves)

    with monkeypatch.context() as patch:
        patch.setattr(trainer, "_write_curves", killed)
        with pytest.raises(KeyboardInterrupt):
            train(Sums(), SCHEDULE, tmp_path / "killed")
    whole, before = ((tmp_path / name / CURVES).read_text() for name in ("whole", "killed"))
    assert whole.startswith(before)
    assert whole != before
    again = Sums()
    train(again, SCHEDULE, tmp_path / "killed", resume=True)
    assert again.drawn == 0
    assert (tmp_path / "killed" / CURVES).read_text() == whole


@pytest.mark.slow
def test_a_killed_run_ends_with_the_same_weights(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tests.helpers.small_training"]
    killed = subprocess.Popen([*command, str(tmp_path / "killed"), "0.2"], stdout=subprocess.DEVNULL)
    patience = time.monotonic() + 60
    while not (tmp_path / "killed" / CHECKPOINT).is_file() and time.monotonic() < patience:
        time.sleep(0.05)
    assert (tmp_path / "killed" / CHECKPOINT).is_file()
    killed.kill()
    assert killed.wait() == -9  # it was not at its end
    sums = [
        subprocess.run([*command, str(tmp_path / name)], check=True, capture_output=True, text=True).stdout
        for name in ("killed", "whole")
    ]
    assert sums[0] == sums[1]


def test_only_the_same_training_is_gone_on_with(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    train(Sums(), SCHEDULE, tmp_path)
    with pytest.raises(ConfigError, match="is of another training; use --overwrite in place of --resume"):
        train(Sums(), replace(SCHEDULE, learning_rate=0.02), tmp_path, resume=True)
    with pytest.raises(ConfigError, match="is of another training"):
        train(Sums(), SCHEDULE, tmp_path, fingerprint="another dataset", resume=True)
    monkeypatch.setattr(trainer, "__version__", "0.0.1")
    with pytest.raises(ConfigError, match="is of another training"):
        train(Sums(), SCHEDULE, tmp_path, resume=True)


@pytest.mark.parametrize("device", ["cpu", "cpu:0"])
def test_torch_is_left_as_it_was(device: str) -> None:
    before = torch.get_rng_state()
    with deterministic(device):
        torch.manual_seed(1)
        assert torch.are_deterministic_algorithms_enabled()
    assert torch.equal(torch.get_rng_state(), before)
    assert not torch.are_deterministic_algorithms_enabled()


@pytest.mark.slow
@pytest.mark.parametrize(
    "damage", [b"", b"junk" * 100, b"PK\x03\x04" + b"\0" * 50, "half", "other", "model", "epoch", "no minutes"]
)
def test_a_damaged_checkpoint_is_told_in_one_line(tmp_path: Path, damage: bytes | str) -> None:
    train(Sums(), SCHEDULE, tmp_path)
    path = tmp_path / CHECKPOINT
    if damage in ("model", "epoch", "no minutes"):
        stored = torch.load(path)
        if damage == "model":
            del stored["model"]["0.weight"]
        elif damage == "epoch":
            stored["state"]["epoch"] = "two"
        else:
            del stored["state"]["minutes"]
        torch.save(stored, path)
    elif damage == "half":
        path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    elif damage == "other":
        torch.save({"weights": torch.ones(3)}, path)
    else:
        path.write_bytes(bytes(damage))
    with pytest.raises(ConfigError, match="is no checkpoint of a training; use --overwrite in place of --resume"):
        train(Sums(), SCHEDULE, tmp_path, resume=True)


def test_a_full_disk_is_told_as_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(path: Path, data: object) -> int:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(OSError, match="No space left"):
        train(Sums(), SCHEDULE, tmp_path)
    assert not (tmp_path / CHECKPOINT).exists()


def test_what_is_finished_is_not_done_again(tmp_path: Path) -> None:
    first, again = Sums(), Sums()
    score = train(first, SCHEDULE, tmp_path)
    assert train(again, SCHEDULE, tmp_path, resume=True) == score
    assert again.drawn == 0
    assert torch.equal(first.model[0].weight, again.model[0].weight)


def test_the_rate_rises_and_falls() -> None:
    rates = [SCHEDULE.rate(share) for share in (0, SCHEDULE.warm_up / 2, SCHEDULE.warm_up, 1)]
    assert rates == pytest.approx([0, 0.005, 0.01, 0])


def test_a_loss_that_is_no_number_ends_it_and_the_last_checkpoint_stays(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    task = Sums()
    learn = task.losses

    def losses(batch: torch.Tensor) -> dict[str, torch.Tensor]:
        return {name: loss * (float("nan") if task.drawn > 100 else 1.0) for name, loss in learn(batch).items()}

    monkeypatch.setattr(task, "losses", losses)
    with pytest.raises(ConfigError, match=r"^epoch 2, up to step \d+: loss is nan; .* a lower learning_rate"):
        train(task, SCHEDULE, tmp_path, checkpoint_s=0.0)
    stored = torch.load(tmp_path / CHECKPOINT, weights_only=True)
    assert all(torch.isfinite(tensor).all() for tensor in stored["model"].values())
