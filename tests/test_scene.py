import json
import time

import pytest

from remqa_data.assets.core.model import AssetSpec
from remqa_data.assets.looks.materials import OAK
from remqa_data.assets.registry import build
from remqa_data.errors import RemqaError, SceneFormatError, UnknownNameError, one_line
from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.scene import Scene, SceneObject, StructureBox
from tests.helpers.forged_rows import room_forgeries


def small_scene() -> Scene:
    mug = AssetSpec("Mug", (0.1 + 0.2, 0.09, 1 / 3), 1, 5, levels=(0.01,))
    return Scene(
        "Test",
        "kitchen",
        (-1.0, -1.0, 1.0, 1.0),
        0.0,
        2.5,
        ((0.0, 0.0, 2.4),),
        (StructureBox("floor", (-1, -1, -0.1, 1, 1, 0), OAK),),
        (SceneObject("Mug|1", mug, (0.1, 0.2, 1 / 7), is_fixed=False, parents=("Floor|1",)),),
    )


@pytest.mark.parametrize("scene", [small_scene(), load_scene("FloorPlan1")], ids=["small", "FloorPlan1"])
def test_json_round_trip_keeps_every_bit(scene: Scene) -> None:
    again = Scene.from_json(scene.to_json())
    assert again == scene
    assert again.to_json() == scene.to_json()


def test_file_round_trip(tmp_path) -> None:
    small_scene().save(tmp_path / "scene.json")
    assert Scene.load(tmp_path / "scene.json") == Scene.load(str(tmp_path / "scene.json")) == small_scene()
    assert [path.name for path in tmp_path.iterdir()] == ["scene.json"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d.pop("bounds"), "bounds: Field required"),
        (lambda d: d["objects"][0].update(position=[1, 2]), "objects.0.position"),
        (lambda d: d["objects"][0]["asset"].update(size="big"), "objects.0.asset.size"),
        (lambda d: d.update(format_version=99), "format version 99"),
        (lambda d: d["objects"].append(d["objects"][0]), "'Mug|1' occurs twice"),
    ],
)
def test_damage_is_named(change, message: str) -> None:
    data = json.loads(small_scene().to_json())
    change(data)
    with pytest.raises(SceneFormatError) as caught:
        Scene.from_json(json.dumps(data), "kitchen.json")
    assert str(caught.value).startswith("kitchen.json: ")
    assert message in str(caught.value)


def test_not_json_at_all() -> None:
    with pytest.raises(SceneFormatError, match="the whole text"):
        Scene.from_json("not json")


def test_objects_by_id() -> None:
    assert small_scene().object("Mug|1").type == "Mug"
    with pytest.raises(UnknownNameError, match=r"did you mean 'Mug\|1'"):
        small_scene().object("Mug|2")


@pytest.mark.slow
@pytest.mark.parametrize("forgery", list(room_forgeries()), ids=lambda forgery: forgery.what)
def test_a_room_that_cannot_be_is_refused_or_built_in_no_time(forgery):
    text = forgery.change(small_scene().to_json().decode())
    started, said = time.process_time(), ""
    try:
        scene = Scene.from_json(text, "stored")
        for thing in scene.objects:
            build(thing.asset)
    except RemqaError as error:
        said = one_line(error)
    assert len(said) < 500
    assert time.process_time() - started < 20
