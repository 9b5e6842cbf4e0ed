"""How far doors and drawers open before they meet a wall or a fixture."""

from __future__ import annotations

from dataclasses import replace

from remqa_data.catalog import object_type
from remqa_data.scene import Scene
from remqa_data.sim.physics.bodies import STRUCTURE_NAME
from remqa_data.sim.physics.world import World

STEPS = 24
"""Opennesses that are tried; of a door, every 4.4 degrees."""
TOUCH_M = 0.025
"""A moving part may get so much deeper into something than it is while closed."""


def with_limits(scene: Scene) -> Scene:
    """The same scene, in which every object knows how far it opens."""
    with World(scene) as world:
        limits = opening_limits(world)
    return scene.with_objects(tuple(replace(o, most_open=limits.get(o.id, 1.0)) for o in scene.objects))


def opening_limits(world: World) -> dict[str, float]:
    """How far the built-in things of a room open: openness by id, of those that do not open all the way.

    Parameters
    ----------
    world : World
        The room, in which nothing else moves; furniture that can be pushed aside is not in the way.

    Notes
    -----
    What was recorded open stays so, and what can be carried away opens elsewhere.
    """
    limits = {}
    for object_id in world.ids:
        state = world.state(object_id)
        if world.assets[object_id].is_openable and state.is_fixed and state.openness == 0.0:
            limit = _limit(world, object_id)
            if limit < 1.0:
                limits[object_id] = limit
    return limits


def _limit(world: World, object_id: str) -> float:
    closed = world.depths_when_open(object_id, 0.0)
    for step in range(1, STEPS + 1):
        depths = world.depths_when_open(object_id, step / STEPS)
        if any(depth > closed.get(name, 0.0) + TOUCH_M and _is_firm(world, name) for name, depth in depths.items()):
            return (step - 1) / STEPS
    return 1.0


def _is_firm(world: World, name: str) -> bool:
    if name == STRUCTURE_NAME:
        return True
    return world.state(name).is_fixed and not object_type(world.type_of(name)).is_loose
