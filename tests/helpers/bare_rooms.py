"""Rooms with a floor, a few boxes and nothing else, and how one finds a thing in any room."""

from collections.abc import Iterable

from remqa_data.assets.core.model import AssetSpec
from remqa_data.assets.looks.materials import OAK
from remqa_data.geometry.types import Box, Vec3
from remqa_data.scene import Scene, SceneObject, StructureBox
from remqa_data.sim.physics.world import World


def room(*objects: SceneObject, walls: Iterable[Box] = ()) -> Scene:
    floor = StructureBox("floor", (-3, -3, -0.1, 3, 3, 0), OAK)
    extra = tuple(StructureBox("wall", box, OAK) for box in walls)
    return Scene("Test", "kitchen", (-3, -3, 3, 3), 0.0, 2.5, ((0, 0, 2.4),), (floor, *extra), objects)


def mug(object_id: str = "Mug|1", position: Vec3 = (0.0, 0.0, 0.3), is_fixed: bool = False) -> SceneObject:
    return SceneObject(object_id, AssetSpec("Mug", (0.12, 0.09, 0.1)), position, is_fixed=is_fixed)


def first_of(world: World, type_name: str) -> str:
    return next(name for name in world.ids if world.type_of(name) == type_name)
