"""Which room is meant, and the commands `remqa-data export` and `remqa-data coco`."""

import json
import shutil
from dataclasses import replace
from pathlib import Path
from unittest.mock import Mock

import pytest
from typer.testing import CliRunner, Result

from remqa_data.cli import app
from remqa_data.errors import ConfigError, DatasetError
from remqa_data.export import rooms
from remqa_data.export.rooms import find_scene, write_room
from remqa_data.storage.manifest import load_manifest
from tests.helpers.small_rooms import FRIDGE, small_room

pytestmark = pytest.mark.slow


def invoke(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def test_a_room_of_a_dataset_is_that_configuration_as_it_stands(small_rooms) -> None:
    for configuration in (0, 1):
        assert find_scene("Small2", small_rooms, configuration) == small_room("Small2", configuration)


def test_a_room_that_is_there_twice_is_refused_by_name(small_rooms, monkeypatch) -> None:
    real = rooms.read_rows
    monkeypatch.setattr(rooms, "read_rows", lambda *which, **wanted: [*real(*which, **wanted)] * 2)
    with pytest.raises(DatasetError, match="Small2, configuration 1, is there 2 times"):
        find_scene("Small2", small_rooms, 1)


def test_a_saved_scene_is_read_from_its_file(tmp_path) -> None:
    small_room("Small1", 0).save(tmp_path / "room.json")
    assert find_scene(str(tmp_path / "room.json")) == small_room("Small1", 0)


def test_a_sampled_room_has_a_seed_and_nothing_else_has(tmp_path, small_rooms) -> None:
    small_room("Small1", 0).save(str(tmp_path / "room.json"))
    first, other = (find_scene("Sampled-bathroom-000003", seed=seed) for seed in (0, 5))
    assert first == find_scene("Sampled-bathroom-000003") != other
    for name in ("FloorPlan401", str(tmp_path / "room.json")):
        with pytest.raises(ConfigError, match=rf"^seed 5: {name} is no sampled room"):
            find_scene(name, seed=5)
    with pytest.raises(ConfigError, match=r"^--seed 5: .* says itself of which seed it is"):
        find_scene("Small2", small_rooms, seed=5)


@pytest.mark.slow
def test_a_saved_scene_can_be_previewed(tmp_path) -> None:
    small_room("Small1", 0).save(tmp_path / "room.json")
    result = invoke("preview", tmp_path / "room.json", "-o", tmp_path / "a.png", "--size", "32", "--light", "direct")
    assert result.exit_code == 0, result.output
    assert (tmp_path / "a.png").stat().st_size > 1000


def test_open_says_what_is_open_and_the_suffix_the_format(small_rooms, tmp_path) -> None:
    written = {}
    for name, options in {"closed": (), "one": ("--open", FRIDGE), "all": ("--open", "all")}.items():
        result = invoke("export", "Small1", "--data", small_rooms, "-o", tmp_path / f"{name}.glb", *options)
        assert (result.exit_code, result.stdout) == (0, f"{tmp_path / name}.glb\n")
        written[name] = (tmp_path / f"{name}.glb").read_bytes()
    assert written["one"] == written["all"] != written["closed"]


@pytest.mark.parametrize(("name", "options"), [("r.xml", ()), ("r.urdf", ()), ("r.txt", ("--format", "mjcf"))])
def test_meshes_lie_in_a_folder_beside_the_file(small_rooms, tmp_path, name, options) -> None:
    result = invoke("export", "Small1", "--data", small_rooms, "-o", tmp_path / name, "--json", *options)
    assert result.exit_code == 0, result.output
    files = [Path(path) for path in json.loads(result.stdout)["files"]]
    assert files[-1] == tmp_path / name
    assert {path.parent for path in files[:-1]} == {tmp_path / f"{name}-meshes"}
    assert sorted(files[:-1]) == sorted((tmp_path / f"{name}-meshes").iterdir())
    text, meshes = files[-1].read_text(), [path for path in files if path.suffix == ".obj"]
    assert meshes
    assert all(path.name in text for path in meshes)


@pytest.mark.parametrize("name", ["room.GLB", "room.Xml", "room.URDF"])
def test_suffixes_in_large_letters_tell_the_format_too(small_rooms, tmp_path, name) -> None:
    assert invoke("export", "Small1", "--data", small_rooms, "-o", tmp_path / name).exit_code == 0
    assert (tmp_path / name).read_bytes()[:4] == (b"glTF" if name == "room.GLB" else b"<?xm")


def test_another_room_takes_the_place_of_the_first_with_all_its_meshes_or_not_at_all(tmp_path, monkeypatch) -> None:
    def contents() -> dict[Path, bytes]:
        return {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}

    one, other = small_room("Small1", 0), small_room("Small2", 1)
    other = replace(other, objects=other.objects[:2])
    write_room(one, tmp_path / "room.xml")
    before, writing = contents(), rooms._write
    monkeypatch.setattr(rooms, "_write", Mock(side_effect=KeyboardInterrupt))
    with pytest.raises(KeyboardInterrupt):
        write_room(other, tmp_path / "room.xml")
    assert contents() == before
    monkeypatch.setattr(rooms, "_write", writing)
    assert set(write_room(other, tmp_path / "room.xml")) == set(contents())
    assert set(before) - set(contents())


@pytest.mark.parametrize("name", ["notes.txt", "textures/wood.png"])
def test_a_folder_with_something_else_is_not_replaced(small_rooms, tmp_path, name) -> None:
    kept = tmp_path / "room.xml-meshes" / name
    kept.parent.mkdir(parents=True)
    kept.touch()
    result = invoke("export", "Small1", "--data", small_rooms, "-o", tmp_path / "room.xml")
    assert (result.exit_code, result.stderr.count("\n")) == (2, 1)
    assert "is replaced as a whole: move it, or give another name" in result.stderr
    assert kept.exists()


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (("FloorPlan0",), "unknown scene 'FloorPlan0'; did you mean 'FloorPlan30'"),
        (
            ("FloorPlan1", "--configuration", "2"),
            "--configuration 2: only rooms of a dataset have several; name it with",
        ),
        (("Small3", "--data", "DATA"), "unknown room 'Small3'; did you mean"),
        (("Small1", "--data", "DATA", "--configuration", "7"), "Small1 has no configuration 7; it has: 0, 1"),
        (
            ("Small1", "--data", "DATA", "-o", "room.obj"),
            "room.obj: give a name that ends with .glb, .xml, .urdf, .usd",
        ),
        (("Small1", "--data", "DATA", "--open", "Stool|1"), "Stool|1 is not openable"),
        (("Small1", "--data", "DATA", "--open", "Fridge|2"), "unknown object 'Fridge|2'; did you mean 'Fridge|1'?"),
        (("Small1", "--data", "DATA", "-o", "r.urdf", "--open", "all"), "--open: URDF holds no joint positions"),
        (("Small1", "--data", "DATA", "--open", "all", "--open", "Fridge|2"), "unknown object 'Fridge|2'"),
        (("nowhere.json",), "nowhere.json: No such file or directory"),
    ],
)
def test_what_cannot_be_written_is_one_line_and_no_file(small_rooms, tmp_path, monkeypatch, arguments, line) -> None:
    monkeypatch.chdir(tmp_path)
    result = invoke("export", *(small_rooms if word == "DATA" else word for word in arguments))
    assert result.exit_code == 2
    assert line in result.stderr
    assert result.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_another_room_beside_leaves_the_files_of_the_first_as_they_are(small_rooms, tmp_path) -> None:
    invoke("export", "Small1", "--data", small_rooms, "-o", tmp_path / "room.xml")
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    assert len(before) > 10
    invoke("export", "Small2", "--data", small_rooms, "-o", tmp_path / "room.urdf")
    assert (tmp_path / "room.urdf").is_file()
    assert all(path.read_bytes() == was for path, was in before.items())


def test_coco_is_written_beside_the_dataset_however_that_is_named(finished, tmp_path, monkeypatch) -> None:
    shutil.copytree(finished[0], tmp_path / "data")
    monkeypatch.chdir(tmp_path / "data")
    before = sorted(tmp_path.rglob("*"))
    assert "unknown object type 'Table'" in invoke("coco", ".").stderr  # a dataset that was made up
    result = invoke("coco", ".", "-o", "../taken")
    (tmp_path / "taken").mkdir(exist_ok=True)
    (tmp_path / "taken" / "file").touch()
    result = invoke("coco", ".", "-o", "../taken")
    assert (result.exit_code, result.stderr.count("\n")) == (2, 1)
    assert "is not an empty folder; name a new one with --out, or remove it\n" in result.stderr
    assert set(before) <= set(tmp_path.rglob("*"))


def test_coco_says_what_it_has_written(one_room, tmp_path) -> None:
    result = invoke("coco", one_room, "-o", tmp_path / "coco", "--no-images", "--json")
    assert result.exit_code == 0, result.output
    assert json.loads(result.stdout)["images"] == load_manifest(one_room).rows("frames")
    assert sorted(path.name for path in (tmp_path / "coco").rglob("*")) == [
        *("annotations", "instances_test.json", "refs_test.json")
    ]


def test_coco_refuses_a_type_that_is_not_in_the_catalog_in_one_line(finished, tmp_path) -> None:
    result = invoke("coco", finished[0], "-o", tmp_path / "coco")
    assert (result.exit_code, result.stderr.count("\n")) == (2, 1)
    assert "unknown object type 'Table'" in result.stderr
