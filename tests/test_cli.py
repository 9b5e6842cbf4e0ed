import sys
from pathlib import Path
from types import ModuleType

import pytest
from typer.testing import CliRunner, Result

from remqa_data import __version__
from remqa_data.agents.cli import app as agents_app
from remqa_data.cli import app
from remqa_data.errors import FloorPlanError, UnknownNameError
from remqa_data.evaluation.cli import app as evaluation_app
from tests.helpers.damaged_files import files_of


def invoke(*arguments: str) -> Result:
    return CliRunner().invoke(app, list(arguments))


@pytest.fixture
def drawn(monkeypatch) -> list[tuple[str, Path, int, str, int]]:
    """Stands in for the drawing of rooms: knows FloorPlan1 only, and notes what it is asked for."""
    calls: list[tuple[str, Path, int, str, int]] = []

    def write_preview(scene: str, path: Path, size_px: int, light: str, seed: int) -> None:
        if scene != "FloorPlan1":
            raise UnknownNameError("scene", scene, ["FloorPlan1"])
        calls.append((scene, path, size_px, light, seed))

    module = ModuleType("remqa_data.generators.figures.preview")
    module.write_preview = write_preview  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, module.__name__, module)
    return calls


@pytest.mark.parametrize("arguments", [["--help"], ["assets", "--help"], ["preview", "-h"]])
def test_help(arguments):
    result = invoke(*arguments)
    assert result.exit_code == 0
    assert "Usage" in result.output


def test_version():
    result = invoke("--version")
    assert (result.exit_code, result.output) == (0, f"remqa-data {__version__}\n")


def test_assets_writes_one_sheet_for_each_type(tmp_path):
    result = invoke("assets", "--sheet", str(tmp_path / "sheets"), "Mug", "Drawer")
    assert result.exit_code == 0, result.output
    assert sorted(path.name for path in (tmp_path / "sheets").iterdir()) == ["Drawer.png", "Mug.png"]
    assert "2 sheets" in result.output


def test_assets_writes_a_mesh_for_each_variant(tmp_path):
    result = invoke("assets", "--glb", str(tmp_path / "glb"), "Mug")
    assert result.exit_code == 0, result.output
    names = sorted(path.name for path in (tmp_path / "glb").iterdir())
    assert names[:2] == ["Mug-0.glb", "Mug-1.glb"]
    assert f"{len(names)} meshes" in result.output


def test_assets_without_a_folder_says_which_options_name_one():
    result = invoke("assets", "Mug")
    assert result.exit_code == 2
    assert "--sheet" in result.output
    assert "--glb" in result.output


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("assets", "Mug", "--columns", "3", "--glb", "OUT"), "--columns is for --sheet"),
        (("verify", "DIR", "--all", "--sample", "3"), "--all checks everything, and draws nothing: leave --sample out"),
        (("verify", "DIR", "--all", "--rooms", "0", "--seed", "1"), "leave --rooms and --seed out"),
    ],
)
def test_an_option_that_would_be_ignored_is_refused(tmp_path, words, line):
    result = invoke(*(str(tmp_path / word) if word.isupper() else word for word in words))
    assert (result.exit_code, result.stderr.count("\n")) == (2, 1)
    assert line in result.stderr
    assert list(tmp_path.iterdir()) == []


def test_blanks_between_listed_rooms_and_numbers_are_no_part_of_them(finished, tmp_path):
    options = ("-o", str(tmp_path / "views"))
    for words, line in (
        (("--scenes", "Kitchen1, Nowhere"), "unknown scene 'Nowhere'"),
        (("--configurations", "76, 77"), "nothing is asked"),
    ):
        assert line in invoke("cache", str(finished[0]), *words, *options).stderr


def test_an_unknown_type_is_one_line_with_the_nearest_names_and_writes_nothing(tmp_path):
    result = invoke("assets", "--sheet", str(tmp_path / "sheets"), "Mug", "Drawr")
    assert result.exit_code == 2
    assert result.stderr == "remqa-data: unknown object type 'Drawr'; did you mean 'Drawer'?\n"
    assert result.stdout == ""
    assert not (tmp_path / "sheets").exists()


@pytest.mark.parametrize(
    ("words", "light", "seed"),
    [((), "baked", 0), (("--light", "direct"), "direct", 0), (("--seed", "5"), "baked", 5)],
)
def test_preview_passes_scene_path_size_light_and_seed(drawn, words, light, seed):
    result = invoke("preview", "FloorPlan1", "-o", "room.png", "--size", "64", *words)
    assert (result.exit_code, result.output) == (0, "room.png\n")
    assert drawn == [("FloorPlan1", Path("room.png"), 64, light, seed)]


def test_an_unknown_scene_is_one_line_with_the_nearest_names(drawn):
    result = invoke("preview", "floorplan1")
    assert result.exit_code == 2
    assert result.stderr == "remqa-data: unknown scene 'floorplan1'; did you mean 'FloorPlan1'?\n"
    assert drawn == []


@pytest.mark.parametrize(
    ("error", "line"),
    [
        (FloorPlanError("row 3:\n  aabb_sx is negative"), "remqa-data: row 3: aabb_sx is negative\n"),
        (
            PermissionError(13, "Permission denied", "room.png"),
            "remqa-data: room.png: Permission denied; choose another path\n",
        ),
    ],
)
def test_an_error_on_purpose_is_one_line(error, line, drawn, monkeypatch):
    def fail(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr(sys.modules["remqa_data.generators.figures.preview"], "write_preview", fail)
    result = invoke("preview", "FloorPlan1")
    assert (result.exit_code, result.stderr) == (2, line)


def test_a_bug_is_not_hidden(drawn, monkeypatch):
    def fail(*_: object, **__: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(sys.modules["remqa_data.generators.figures.preview"], "write_preview", fail)
    assert isinstance(invoke("preview", "FloorPlan1").exception, ZeroDivisionError)


@pytest.mark.parametrize("arguments", [["preview"], ["preview", "FloorPlan1", "--size", "0"], ["assets"], ["show"]])
def test_wrong_usage_exits_with_2(arguments):
    assert invoke(*arguments).exit_code == 2


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "arguments"),
    [
        (app, ("stats", "ROOT", "--csv", "OUT")),
        (app, ("recount", "ROOT", "--csv", "OUT")),
        (app, ("show", "ROOT", "q", "-o", "OUT")),
        (app, ("play", "ROOT", "q", "-o", "OUT")),
        (app, ("rerun", "ROOT", "FloorPlan1", "-o", "OUT")),
        (app, ("cache", "ROOT", "-o", "OUT")),
        (app, ("export", "FloorPlan1", "--data", "ROOT", "-o", "OUT")),
        (evaluation_app, ("oracle", "--data", "ROOT", "-o", "OUT")),
        (agents_app, ("run", "random", "--data", "ROOT", "-o", "OUT")),
        (agents_app, ("train", "detector", "--data", "ROOT", "-o", "OUT")),
        (agents_app, ("predict", "detector", "--data", "ROOT", "-o", "OUT")),
        (agents_app, ("attend", "e", "--data", "ROOT", "-o", "OUT")),
        (agents_app, ("table", "--data", "ROOT", "-o", "OUT")),
    ],
)
@pytest.mark.parametrize("name", ["manifest.json", "new/file.jsonl"])
def test_nothing_is_written_into_a_dataset(finished, command, arguments, name) -> None:
    root = finished[0]
    before = files_of(root)
    places = {"ROOT": str(root), "OUT": str(root / name)}
    result = CliRunner().invoke(command, [places.get(word, word) for word in arguments])
    assert (result.exit_code, result.stderr.count("\n")) == (2, 1), result.stderr
    assert "which holds nothing else; give another place" in result.stderr
    assert files_of(root) == before
