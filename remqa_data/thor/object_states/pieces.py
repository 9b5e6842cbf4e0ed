"""The pieces that an object is sliced into: how large each is, and where it is before it falls."""

from __future__ import annotations

import numpy as np

from remqa_data.assets import AssetSpec
from remqa_data.catalog import Slices, object_type
from remqa_data.errors import ActionError
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import quaternion_of, snapped_quaternion
from remqa_data.geometry.types import Vec3
from remqa_data.scene import SceneObject
from remqa_data.sim.physics.world import World

GAP = 0.12
"""Pieces leave so much of their thickness free between each other."""
OUTERMOST = 0.75
"""The middles of the outermost slices are at most this far out, as a share of half the length, where they are still broad."""
POOL = (2.2, 1.9, 0.75)
"""A cracked egg is so many times as wide, deep and high as a whole one."""


def pieces_of(world: World, object_id: str) -> list[SceneObject]:
    """What an object becomes when it is sliced, with ids as AI2-THOR has them, such as "Apple|...|AppleSliced_0"."""
    slices = object_type(world.type_of(object_id)).slices
    if slices is None:
        raise ActionError(f"{object_id} is not sliceable")
    spec, state = world.assets[object_id].spec, world.state(object_id)
    names = [f"{object_id}|{slices.type}_{number}" for number in range(slices.count)]
    if slices.count == 1:
        wide, deep, high = (side * share for side, share in zip(spec.size, POOL, strict=True))
        x, y, _ = state.position
        asset = AssetSpec(slices.type, (wide, deep, high), spec.variant, spec.seed)
        return [SceneObject(names[0], asset, (x, y, float(world.box(object_id)[0, 2]) + high / 2), is_fixed=False)]
    frame, found = state.matrix(), []
    for number, name in enumerate(names):
        asset, offset = _slice(spec, slices, number)
        x, y, z = arithmetic.snapped(arithmetic.moved(offset, frame)).tolist()
        turn = arithmetic.product(frame[:3, :3], _ALONG[_length_axis(spec)])
        quaternion = snapped_quaternion(quaternion_of(turn))
        found.append(SceneObject(name, asset, (x, y, z), quaternion, is_fixed=False))
    return found


def _slice(spec: AssetSpec, slices: Slices, number: int) -> tuple[AssetSpec, Vec3]:
    """One of the slices, and where its middle is in the whole one's frame; they all stand on its bottom."""
    axis = _length_axis(spec)
    length, across, high = spec.size[axis], spec.size[1 - axis], spec.size[2]
    step = length / slices.count
    middle = (number + 0.5) * step - length / 2
    out = min(2 * abs(middle) / length, OUTERMOST)
    share = float(np.cbrt(1.0 - out**3))
    thick = min(step * (1.0 - GAP), slices.thickest_m or length)
    thin = AssetSpec(slices.type, (thick, across * share, high * share), spec.variant, spec.seed)
    low = (share - 1.0) * high / 2
    return thin, (middle, 0.0, low) if axis == 0 else (0.0, middle, low)


def _length_axis(spec: AssetSpec) -> int:
    """0 or 1: what is sliced is cut across its longer side in plan."""
    return 0 if spec.size[0] >= spec.size[1] else 1


_ALONG = (np.eye(3), np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]))
"""How a slice, which is thin along x, is turned in a whole one that is sliced along x or y."""
