"""What a command line can get wrong, in its own process: one line on stderr, exit code 2, and nothing has been written."""

import os
import re
import resource
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.helpers.forked_runs import run_forked

MODULES = {
    "remqa-gen": "remqa_data.generators.cli",
    "remqa-eval": "remqa_data.evaluation.cli",
    "remqa-data": "remqa_data.cli",
    "remqa-agent": "remqa_data.agents.cli",
}
TINY = str(Path(__file__).parents[1] / "configs" / "tiny.yaml")

ARGUMENTS: dict[str, tuple[str | bytes, ...]] = {
    "a seed that no int64 holds": ("remqa-gen", "--config", TINY, "--seed", "9223372036854775808"),
    "a million workers": ("remqa-gen", "--config", TINY, "--workers", "1000000"),
    "a folder as a URI": ("remqa-gen", "--config", TINY, "--out", "file:///tmp/somewhere"),
    "a folder that is a file": ("remqa-gen", "--config", TINY, "--out", TINY),
    "a folder that is no UTF-8": ("remqa-gen", "--config", TINY, "--out", b"out-\xff"),
    "a configuration that is no UTF-8": ("remqa-gen", "--config", b"\xff.yaml"),
    "a configuration that is not there": ("remqa-gen", "--config", "nobody.yaml"),
    "a configuration that is a folder": ("remqa-gen", "--config", "."),
    "no such executor": ("remqa-gen", "--config", TINY, "--executor", "nobody"),
    "too many scenes": ("remqa-gen", "--scenes", "1000000000000"),
    "no such layouts": ("remqa-gen", "--layouts", "[/bad]"),
    "a submission that is not there": ("remqa-eval", "nobody.jsonl", "--data", "nowhere"),
    "a submission of another kind": ("remqa-eval", TINY, "--data", "nowhere"),
    "no dataset": ("remqa-eval", "oracle", "--data", "[/bad]", "-o", "oracle.jsonl"),
    "no such system": ("remqa-agent", "run", "nobody", "--data", "nowhere"),
    "nothing to play": ("remqa-agent", "run", "random", "--data", "nowhere"),
    "no submissions to show": ("remqa-agent", "table", "--data", "nowhere", "-o", "nowhere"),
    "nothing to verify": ("remqa-data", "verify", "\x1b[2J"),
    "a million workers to verify": ("remqa-data", "verify", "nowhere", "--workers", "1000000"),
    "nothing to cache": ("remqa-data", "cache", "nowhere"),
    "no numbers of configurations": ("remqa-data", "cache", "nowhere", "--configurations", "a,b"),
    "frames of no size": ("remqa-data", "cache", "nowhere", "--size", "0"),
    "nothing to show": ("remqa-data", "show", "nowhere", "nobody"),
}


def run(
    name: str, *arguments: str | bytes, folder: Path, before: Sequence[str] = (), **options: object
) -> subprocess.CompletedProcess[str]:
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parents[1])}
    command = [*before, sys.executable, "-m", MODULES[name], *arguments]
    return subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, timeout=120, check=False, **options
    )


@pytest.mark.slow
@pytest.mark.parametrize("what", ARGUMENTS)
def test_a_wrong_argument_is_one_line_and_nothing_is_written(what: str, tmp_path: Path) -> None:
    name, *arguments = ARGUMENTS[what]
    assert isinstance(name, str)
    done = run_forked(MODULES[name], *arguments, folder=tmp_path)
    lines = done.stderr.splitlines()
    assert (done.returncode, len(lines)) == (2, 1), done.stderr
    assert lines[0].isprintable()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_with_stderr_closed_a_command_ends_as_it_should(tmp_path: Path) -> None:
    command = f"{sys.executable} -m remqa_data.generators.cli --config nobody.yaml 2>&-"
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parents[1])}
    done = subprocess.run(
        ["sh", "-c", command], cwd=tmp_path, env=environment, capture_output=True, timeout=120, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (2, b"", b"")
    assert list(tmp_path.iterdir()) == []


def test_too_little_address_space_is_one_line(tmp_path: Path) -> None:
    least = 1 << 30
    done = run(
        "remqa-gen",
        *("--config", TINY, "--out", "out"),
        folder=tmp_path,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (least, least)),
    )
    assert done.returncode == 2
    assert (
        done.stderr == "remqa-gen: the address space is limited to 1024 MB (ulimit -v); at least 3072 MB are needed\n"
    )
    assert list(tmp_path.iterdir()) == []


STRANGER = "4001797"
"""A user without processes, so that limits of their number are exact."""


@pytest.mark.slow
@pytest.mark.skipif(os.getuid() != 0 or shutil.which("setpriv") is None, reason="only root can be a stranger")
@pytest.mark.parametrize(("most", "who", "left"), [(1, "", "0"), (12, "", "11"), (36, "a worker: ", r"\d+")])
def test_too_few_threads_are_one_line(tmp_path: Path, most: int, who: str, left: str) -> None:
    """With as few, pyarrow waits for ever, and OpenBLAS sends its own process the signal of Ctrl-C."""
    may = "--inh-caps=-all,+dac_override", "--ambient-caps=+dac_override"  # this interpreter may be root's alone
    stranger = ["setpriv", "--reuid", STRANGER, "--clear-groups", *may, "prlimit", f"--nproc={most}"]
    arguments = "--config", TINY, "--scenes", "2", "--workers", "2", "--out", "out"
    done = run("remqa-gen", *arguments, folder=tmp_path, before=stranger)
    line = rf"remqa-gen: {who}the system starts only {left} more threads \(ulimit -u\); at least 32 are needed"
    assert done.returncode == 2, done.stderr
    assert re.match(line, done.stderr.splitlines()[-1])
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("umask", [0o777, 0o200])
def test_a_umask_that_forbids_its_own_user_is_one_line(
    tmp_path: Path, umask: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")  # else it leaves folders that nobody may enter in this tree
    done = run("remqa-gen", "--config", TINY, "--out", "out", folder=tmp_path, umask=umask)
    assert done.returncode == 2
    assert (
        done.stderr == f"remqa-gen: the umask {umask:03o} takes away your own rights to what is written; "
        "use another one (umask 022)\n"
    )
    assert list(tmp_path.iterdir()) == []
