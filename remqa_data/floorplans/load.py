"""Rooms by their names: recorded floor plans and sampled rooms."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

from remqa_data.errors import ConfigError, UnknownNameError
from remqa_data.floorplans.ithor import scenes as ithor
from remqa_data.floorplans.ithor.table import recorded_objects, unity_rotation
from remqa_data.floorplans.sampled import scenes as sampled
from remqa_data.floorplans.sampled.naming import is_sampled, sampled_index
from remqa_data.geometry.types import F64
from remqa_data.scene import Light, Scene


def scene_names() -> tuple[str, ...]:
    """The names of all floor plans, such as "FloorPlan1"."""
    return ithor.scene_names()


def check_scene_name(name: str) -> None:
    """Refuse what is not the name of a floor plan or a sampled room.

    Raises
    ------
    UnknownNameError
        If there is none; names the nearest.
    """
    if is_sampled(name):
        sampled_index(name)
    elif name not in scene_names():
        raise UnknownNameError("scene", name, scene_names())


def load_scene(name: str, light: Light = "baked", seed: int = 0) -> Scene:
    """A floor plan as a scene, or a sampled room such as "Sampled-kitchen-000000".

    Parameters
    ----------
    name : str
        Such as "FloorPlan1".
    light : {"baked", "direct"}
        How it is drawn.
    seed : int
        Of a sampled room; of a floor plan there is one.

    Raises
    ------
    UnknownNameError
        If there is no such floor plan; names the nearest.
    ConfigError
        If a seed is asked for of what is no sampled room.
    """
    if seed and not is_sampled(name):
        raise ConfigError(f"seed {seed}: {name} is no sampled room, and only those have several")
    scene = sampled.sampled_scene(sampled_index(name), seed=seed) if is_sampled(name) else ithor.load_scene(name)
    return replace(scene, light=light)


class RecordedPose(NamedTuple):
    """What AI2-THOR calls an object's position and rotation.

    Attributes
    ----------
    pivot : (3,) array
        Its `position`, metres in the room.
    turn : (3, 3) array
        Its `rotation`, in AI2-THOR's frame.
    """

    pivot: F64
    turn: F64


def recorded_poses(name: str) -> dict[str, RecordedPose]:
    """AI2-THOR's poses of the objects in a floor plan, by id; none for a room that was not recorded."""
    try:
        return {row.id: RecordedPose(row.pivot, unity_rotation(row.angles)) for row in recorded_objects(name)}
    except UnknownNameError:
        return {}
