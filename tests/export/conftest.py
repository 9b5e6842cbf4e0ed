"""A kitchen that many tests write and none changes."""

from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import pytest

from remqa_data.export.rooms import find_scene, write_room
from remqa_data.scene import Scene
from remqa_data.sim.physics.world import World

KITCHEN = "FloorPlan1"


@pytest.fixture(scope="session")
def kitchen() -> Scene:
    return find_scene(KITCHEN)


@pytest.fixture
def world(kitchen: Scene) -> Iterator[World]:
    with World(kitchen) as made:
        yield made


@pytest.fixture(scope="session")
def kitchen_files(kitchen: Scene, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the closed kitchen as room.glb, room.xml and room.urdf, and as room.usda where USD is installed."""
    folder = tmp_path_factory.mktemp("kitchen")
    for suffix in (".glb", ".xml", ".urdf", *([".usda"] if find_spec("pxr") else [])):
        write_room(kitchen, folder / f"room{suffix}")
    return folder
