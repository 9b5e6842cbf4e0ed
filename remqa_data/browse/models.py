"""A room in three dimensions, for the page that shows it."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable

from remqa_data.catalog import types_with
from remqa_data.errors import RemqaError
from remqa_data.export.glb import glb_bytes, room_scene
from remqa_data.scene import Scene
from remqa_data.sim.metadata import ObjectMetadata
from remqa_data.sim.physics.world import World

NO_MODEL = b"const MODEL = null;\n"
"""Where the stored room is damaged: the page says so."""


def model_script(scene_json: str, where: str) -> bytes:
    """A script that holds a room as binary glTF, base64: a browser reads no other files from disk."""
    try:
        scene = Scene.from_json(scene_json, where)
        with World(scene) as world:
            model = glb_bytes(room_scene(world))
    except RemqaError:
        return NO_MODEL
    return b'const MODEL = "' + b64encode(model) + b'";\n'


def hung(objects: Iterable[ObjectMetadata]) -> list[str]:
    """Ids of what hangs on walls, such as windows and paintings: it is seen with its wall."""
    return [record.id for record in objects if record.type in types_with("on_wall")]


def carried(objects: Iterable[ObjectMetadata]) -> dict[str, list[str]]:
    """By an object's id, the ids of what lies in it, and on or in that: what a drawer takes along."""
    inside: dict[str, list[str]] = {}
    resting: dict[str, list[str]] = {}
    for thing in objects:
        if thing.support is not None:
            (inside if thing.support_kind == "in" else resting).setdefault(thing.support, []).append(thing.id)
    found = {}
    for holder, first in inside.items():
        taken, waiting = dict.fromkeys(first), list(first)
        while waiting:
            here = waiting.pop()
            more = [name for name in [*inside.get(here, ()), *resting.get(here, ())] if name not in taken]
            taken |= dict.fromkeys(more)
            waiting += more
        found[holder] = list(taken)
    return found
