"""Commands and programs of README and docs: each is run, or, where that takes minutes or another machine, read as it would be.

They run where they say they do: beside `out/tiny` and `out/remqa`, which are the two rooms of the tests here.
"""

import re
import shlex
import shutil
import tomllib
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from remqa_data.export.rooms import find_scene, write_room
from remqa_data.processes import cores
from remqa_data.views.build import Wanted, cache_views
from tests.helpers.remade_rooms import RememberedRooms

ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
APPS = {
    "remqa-data": "remqa_data.cli",
    "remqa-gen": "remqa_data.generators.cli",
    "remqa-eval": "remqa_data.evaluation.cli",
    "remqa-agent": "remqa_data.agents.cli",
}
READ_ONLY = (
    "remqa-gen",  # minutes; what it makes, and its options, are tests of their own
    "remqa-agent train",
    "remqa-agent run framework",  # its weights are refused on another dataset
    "remqa-agent run a3c",
    "remqa-agent predict",
    "remqa-agent attend",
    "remqa-agent curves",  # of trainings: tests/agents/test_curves.py
    "remqa-data assets --sheet sheets",
    "remqa-data cache",  # features and all rooms: tests/views
    "remqa-data verify s3://",
)
"""Not run: their options are read, and help is shown."""
PLAYED = Path("out/agents/random.jsonl")
"""The submission that is scored, whatever it is called."""
SERVES = re.compile(r"remqa-data browse \S+$")
"""Waits for a browser: tests/browse."""
MACHINE = ("apt-get", "pip install", "python3 -m venv", ". .venv", "rerun ", "pre-commit", "git ", "docker ", "uv ")
"""Sets a machine up."""


COMMAND = re.compile(r"(remqa-(data|gen|eval|agent)|make|python\d?|pip)\b")
WITH_PROGRAMS = [page for page in PAGES[2:] if "```python" in page.read_text(encoding="utf-8")]


def commands() -> list[tuple[str, str]]:
    """Page and command of every line of a shell block."""
    found = []
    for page in PAGES:
        for block in re.findall(r"```(?:sh)?\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL):
            lines = (line.split("  #")[0].split(" # ")[0].strip() for line in block.splitlines())
            found += [
                (page.name, line)
                for line in lines
                if re.match(r"(remqa-(data|gen|eval|agent)|make|python\d?|pip)\b", line)
            ]
    return found


OF_REMQA = [(page, line) for page, line in commands() if line.startswith("remqa-")]


def test_there_are_commands_and_all_are_of_a_known_kind() -> None:
    assert len(OF_REMQA) > 35
    for page, line in commands():
        known = ("remqa-", "make", "python benchmarks/", "python mine.py", "python -m remqa_data", *MACHINE)
        assert line.startswith(known), (page, line)


def test_targets_extras_and_files_that_commands_name_are_there() -> None:
    extras = set(tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["optional-dependencies"])
    targets = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    checked = 0
    for page, line in commands():
        for named in re.findall(r"\[([a-z,]+)\]", line) if line.startswith("pip install") else ():
            assert set(named.split(",")) <= extras, (page, line)
            checked += 1
        if line.startswith("make "):
            assert set(re.findall(r"\b[a-z-]+\b", line.partition(" ")[2].split("=")[-1])) & targets, (page, line)
            checked += 1
        if line.startswith("python benchmarks/"):
            assert (ROOT / line.split()[1]).is_file(), (page, line)
            checked += 1
    assert checked > 8


@pytest.fixture(scope="module")
def home(two_rooms: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the datasets that pages name, cached views and a submission to one of them, and a room for MuJoCo."""
    folder = tmp_path_factory.mktemp("home")
    for name in ("tiny", "remqa"):
        shutil.copytree(two_rooms, folder / "out" / name)
    cache_views(
        folder / "out" / "remqa", folder / "out" / "remqa-views", Wanted(split="train", configurations=(0,), size_px=24)
    )
    write_room(find_scene("FloorPlan27", two_rooms), folder / "room.xml")
    agents: Any = import_module(APPS["remqa-agent"]).app
    options = ["--data", str(folder / "out" / "remqa"), "--out", str(folder / PLAYED.parent), "--workers", "1"]
    assert CliRunner().invoke(agents, ["run", "random", *options]).exit_code == 0
    return folder


@pytest.fixture(scope="module")
def remembered(two_rooms: Path) -> RememberedRooms:
    return RememberedRooms(two_rooms)


@pytest.mark.slow
@pytest.mark.parametrize("page", list(dict.fromkeys(page for page, _ in OF_REMQA)))
def test_every_command_of_a_page_does_what_it_says(
    page: str, home: Path, remembered: RememberedRooms, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Verification compares with what is remembered of the rooms; that they are made again is tested in `test_verify`.

    On a machine with one core, so that no command starts others.
    """
    monkeypatch.chdir(home)
    remembered.use(monkeypatch)
    monkeypatch.setattr(cores, "usable_cores", lambda: 1)
    lines = list(dict.fromkeys(line for where, line in OF_REMQA if where == page))
    assert lines
    for line in lines:
        program, *arguments = shlex.split(re.sub(r"\S+\.jsonl --data", f"{PLAYED} --data", line.split("&&")[0]))
        is_read = line.startswith(READ_ONLY) or SERVES.match(line)
        app: Any = import_module(APPS[program]).app
        said = CliRunner().invoke(app, [*arguments, "--help"] if is_read else arguments)
        assert said.exit_code == 0, (line, said.output, said.exception)
        named = [arguments[place + 1] for place, word in enumerate(arguments) if word in ("-o", "--export", "--out")]
        assert all(Path(name).exists() for name in named if not is_read), line


@pytest.mark.slow
@pytest.mark.parametrize("page", WITH_PROGRAMS, ids=lambda page: page.name)
def test_the_programs_of_a_page_run(page: Path, home: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(home)
    names: dict[str, object] = {"__name__": "page"}
    blocks = re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    assert blocks
    for block in blocks:
        exec(block, names)
