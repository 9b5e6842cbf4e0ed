"""What the commands share."""

import errno
import json
import logging
import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import typer
from typer.testing import CliRunner, Result

from remqa_data import __version__
from remqa_data.command_line import PIPE_CLOSED
from remqa_data.kernels.progress import Compiling, tell
from tests.helpers.submissions import written

COMMANDS = {
    "remqa-data": ["assets", "play", "preview", "show", "verify"],
    "remqa-gen": [],
    "remqa-eval": ["score", "oracle", "random", "blind", "compare", "schema"],
    "remqa-agent": ["run", "table"],
}
WRITE_NOTHING = {"remqa-eval compare", "remqa-eval schema", "remqa-data verify"}
NAME_WHAT_THEY_WRITE = {f"remqa-data {name}" for name in ("assets", "browse", "recount", "stats")}
"""With --sheet, --glb, --export or --csv: they do something else, too, or write of several kinds."""
HOMES = {
    "remqa-data": "remqa_data",
    "remqa-gen": "remqa_data.generators",
    "remqa-eval": "remqa_data.evaluation",
    "remqa-agent": "remqa_data.agents",
}


def invoke(name: str, *arguments: object) -> Result:
    return CliRunner().invoke(import_module(f"{HOMES[name]}.cli").app, [str(word) for word in arguments])


def commands() -> dict[str, Any]:
    """All there are, by what is typed."""
    groups: dict[str, Any] = {
        name: typer.main.get_command(import_module(f"{home}.cli").app) for name, home in HOMES.items()
    }
    within = {f"{name} {word}": one for name, group in groups.items() for word, one in group.commands.items()}
    return {**within, "remqa-gen": groups["remqa-gen"]}


def context(name: str, command: Any, *words: str) -> Any:
    """What is given, with what groups hand down to their commands."""
    group, _, word = name.partition(" ")
    outer = typer.main.get_command(import_module(f"{HOMES[group]}.cli").app)
    parent = outer.make_context(group, [word or "--resume"], resilient_parsing=True)
    return command.make_context(name, list(words), parent=parent, resilient_parsing=True)


@pytest.fixture
def drawing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stands in for the drawing of rooms, which compiles a kernel and warns."""

    def write_preview(scene: str, path: Path, size_px: int, light: str, seed: int) -> None:
        for number in (1, 2):
            tell(Compiling("shade", number, 2))
        logging.getLogger("remqa_data.sim").warning("kept in %s", "/tmp")

    module = ModuleType("remqa_data.generators.figures.preview")
    module.write_preview = write_preview  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, module.__name__, module)


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_tells_its_version(name) -> None:
    done = invoke(name, "--version")
    assert (done.exit_code, done.stdout) == (0, f"{name} {__version__}\n")


@pytest.mark.slow
@pytest.mark.parametrize("name", COMMANDS)
def test_where_nobody_reads_on_a_command_ends_without_a_word(name) -> None:
    for option in ("--version", "--help"):
        reader, writer = os.pipe()
        os.close(reader)
        command = [sys.executable, "-m", f"{HOMES[name]}.cli", option]
        done = subprocess.run(command, stdout=writer, stderr=subprocess.PIPE, timeout=120, check=False)
        os.close(writer)
        assert (done.returncode, done.stderr) == (PIPE_CLOSED, b"")


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").is_char_device(), reason="needs /dev/full")
@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("remqa-gen", ["--help"]),
        ("remqa-data", ["--version"]),
        ("remqa-data", ["show", "--help"]),
        ("remqa-eval", ["schema"]),
        ("remqa-eval", ["--json", "schema"]),
    ],
)
def test_what_cannot_be_written_to_stdout_is_one_line_that_says_so(name, words) -> None:
    command = [sys.executable, "-m", f"{HOMES[name]}.cli", *words]
    with open("/dev/full", "w") as full:
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, timeout=120, check=False)
    assert (done.returncode, done.stderr) == (2, f"{name}: standard output: No space left on device\n")


def test_a_closed_pipe_is_no_error_of_a_file(drawing, monkeypatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise BrokenPipeError(32, "Broken pipe")

    monkeypatch.setattr(sys.modules["remqa_data.generators.figures.preview"], "write_preview", fail)
    done = invoke("remqa-data", "preview", "FloorPlan1")
    assert (done.exit_code, done.output) == (PIPE_CLOSED, "")


@pytest.mark.slow
@pytest.mark.parametrize(("name", "command"), [(n, c) for n, commands in COMMANDS.items() for c in (*commands, "")])
def test_every_command_can_be_quiet_and_speak_json(name, command) -> None:
    help_text = invoke(name, *command.split(), "--help").stdout
    assert "--quiet" in help_text
    assert "--json" in help_text


def test_a_command_says_what_it_wrote_and_that_kernels_are_compiled_once(drawing) -> None:
    done = invoke("remqa-data", "preview", "FloorPlan1", "-o", "a.png")
    assert done.stdout == "a.png\n"
    assert (
        done.stderr
        == "compiling 2 kernels, once; this takes one to four minutes, and what is done is kept\nkept in /tmp\n"
    )


@pytest.mark.parametrize(
    ("number", "told"),
    [
        (errno.ENOSPC, "a.png: No space left on device; choose another path"),
        (errno.EFBIG, "a.png: File too large"),
        (errno.EMFILE, "a.png: Too many open files"),
    ],
)
def test_another_path_is_proposed_where_it_would_help(drawing, monkeypatch, number: int, told: str) -> None:
    def fail(*_: object, **__: object) -> None:
        raise OSError(number, os.strerror(number), "a.png")

    monkeypatch.setattr(sys.modules["remqa_data.generators.figures.preview"], "write_preview", fail)
    done = invoke("remqa-data", "preview", "FloorPlan1")
    assert (done.exit_code, done.stderr) == (2, f"remqa-data: {told}\n")


@pytest.mark.parametrize("words", [["--json", "preview", "FloorPlan1"], ["preview", "FloorPlan1", "--json"]])
def test_json_is_one_object_on_stdout(drawing, words) -> None:
    assert json.loads(invoke("remqa-data", *words, "-o", "a.png").stdout) == {"picture": "a.png"}


def test_a_quiet_command_says_nothing_but_errors(drawing) -> None:
    done = invoke("remqa-data", "preview", "FloorPlan1", "-q")
    assert (done.exit_code, done.output) == (0, "")
    done = invoke("remqa-gen", "-q", "--config", "nowhere.yaml")
    assert done.exit_code == 2
    assert done.stderr.startswith("remqa-gen: nowhere.yaml: No such file")
    assert "a.png" in invoke("remqa-data", "preview", "FloorPlan1", "-o", "a.png").stdout  # the next one speaks again


@pytest.mark.parametrize(
    ("name", "word", "hint"),
    [
        ("remqa-data", "verfy", "Did you mean 'verify'?"),
        ("remqa-eval", "compar", "Did you mean 'compare'?"),
        ("remqa-eval", "scores", "Did you mean 'score'"),
        ("remqa-gen", "tiny", "give options only, such as --config tiny"),
    ],
)
def test_a_word_that_is_nearly_a_command_is_not_taken_for_a_file(name, word, hint) -> None:
    done = invoke(name, word)
    assert done.exit_code == 2
    assert hint in done.stderr


@pytest.mark.parametrize(
    ("name", "words", "line"),
    [
        ("remqa-gen", ["--scenes", "abc"], "remqa-gen: Invalid value for '--scenes': Input should be a valid integer"),
        ("remqa-gen", ["--out"], "remqa-gen: Option '--out' requires an argument"),
        ("remqa-gen", ["--scens", "3"], "remqa-gen: No such option: --scens"),
        ("remqa-data", ["preview"], "remqa-data preview: Missing argument 'scene'"),
        ("remqa-data", ["preview", "FloorPlan1", "--size", "9"], "remqa-data preview: Invalid value for '--size'"),
        ("remqa-data", ["assets"], "remqa-data assets: Invalid value: name a folder with --sheet DIR or --glb DIR"),
        ("remqa-eval", ["random", "--seed", str(2**63)], "remqa-eval random: Invalid value for '--seed'"),
    ],
)
def test_an_option_that_cannot_be_is_one_line_that_leads_to_help(name, words, line) -> None:
    done = invoke(name, *words)
    assert (done.exit_code, done.stdout) == (2, "")
    (said,) = done.stderr.splitlines()
    assert said.startswith(line)
    assert said.endswith(f"; see {line.partition(':')[0]} --help")


def test_whatever_writes_takes_its_place_by_the_same_names() -> None:
    writing = {}
    for name, command in commands().items():
        for param in command.params:
            if {"-o", "--out", "--output"} & set(param.opts):
                writing[name] = param.name
                assert param.opts == ["--out", "-o"], name
                places = [context(name, command, option, "x").params for option in ("--out", "-o", "--output")]
                assert [str(given[param.name]) for given in places] == ["x"] * 3, name
    assert set(commands()) - set(writing) == WRITE_NOTHING | NAME_WHAT_THEY_WRITE


def test_flags_take_no_value_in_any_help() -> None:
    checked = 0
    for name, command in commands().items():
        for param in command.get_params(context(name, command)):
            if getattr(param, "is_flag", False):
                assert param.metavar == "", (name, param.name)
                checked += 1
    assert checked > 0
    flags = [line for line in invoke("remqa-gen", "--help").output.splitlines() if " --overwrite " in line]
    assert flags
    assert "bool" not in flags[0].lower()


def test_what_takes_options_only_shows_no_command() -> None:
    assert "Usage: remqa-gen [OPTIONS]" in [line.strip() for line in invoke("remqa-gen", "--help").output.splitlines()]
    done = invoke("remqa-gen", "--overwrite", "true", "--out", "zz")
    assert done.exit_code == 2
    assert done.stderr.startswith("remqa-gen: unexpected argument 'true'; give options only, such as --config tiny")


@pytest.mark.parametrize(
    ("name", "words", "what"),
    [
        ("remqa-gen", ["--out", ""], "--out"),
        ("remqa-gen", ["--config="], "--config"),
        ("remqa-data", ["stats", ""], "DIR"),
        ("remqa-data", ["coco", "x", "--output", ""], "--out"),
        ("remqa-agent", ["train", "detector", "--data", "x", "--more", "y", "--more", ""], "--more"),
        ("remqa-eval", ["a.jsonl", "--data", ""], "--data"),
    ],
)
def test_no_path_is_empty(name, words, what, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = invoke(name, *words)
    assert (done.exit_code, done.stdout) == (2, "")
    assert f": {what} is empty; give a value; see remqa-" in done.stderr
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["remqa-data", "remqa-eval", "remqa-agent"])
def test_without_words_there_is_help(name) -> None:
    assert "--version" in invoke(name).output


@pytest.mark.parametrize("words", [["preview", "FloorPlan1"], ["show", "nowhere", "Kitchen1-q0"]])
def test_a_picture_has_the_name_of_one(words) -> None:
    done = invoke("remqa-data", *words, "-o", "room.jpg")
    assert (done.exit_code, done.stdout) == (2, "")
    assert done.stderr == "remqa-data: room.jpg: the picture is a PNG: give a name that ends with .png\n"


def test_a_file_whose_name_is_nearly_a_command_is_a_file_when_it_is_there(finished, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    written(tmp_path / "score.jsonl", "qa", [{"question_id": "Kitchen3-q0", "answer": "yes"}])
    for words in (["score.jsonl"], ["--json", "score", "score.jsonl"]):
        done = invoke("remqa-eval", *words, "--data", finished[0], "--no-report", "-o", tmp_path / "out")
        assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)["track"] == "qa"
    assert json.loads((tmp_path / "out" / "results.json").read_text())["counts"] == json.loads(done.stdout)["counts"]
