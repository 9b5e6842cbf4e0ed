"""How much of the space in which a thing could be a stored end view shows: "no" and 0 are to be seen, not guessed.

Worked out from the stored depth and the room's own geometry, by chance points, apart from what made the sample.
"""

from __future__ import annotations

import zlib

import numpy as np

from remqa_data.generators.arrangement.hiding_rules import hidden_size
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64
from remqa_data.scene import Scene
from remqa_data.sim.metadata import AgentState
from remqa_data.sim.navigation.grid import CAMERA_HEIGHT_M
from remqa_data.sim.physics.world import World
from remqa_data.tables.images import decode_depth
from remqa_data.tables.rows import QuestionRow

LEAST_SHARE = 0.8
WAYS = 5000.0
"""Things that are tried for each square metre in which their middles can be."""
LEAST_SHOWN = 0.3
"""Who sees so much of a thing's top sees the thing."""
NEARER_M = 0.012
"""What is nearer to the camera than a point by more than this hides it."""
OFF_WALLS_M = 0.012
LEAST_SIDE_M = 0.05
"""In what is narrower nothing is put."""
BENEATH = 0.6
"""Of the plan of what is taken away, so much of each side surely covered something."""


def seen_share(scene: Scene, question: QuestionRow) -> float:
    """Share of the ways in which a thing of the asked type could lie there that the end view would show, 0 to 1.

    One that fits nowhere is nowhere: then the share is 1.
    """
    rng = np.random.default_rng(zlib.crc32(question.question_id.encode()))
    with World(scene) as world:
        opens = question.manipulation == "Open"
        if opens:
            world.open(question.target_id, 1.0)
        tops = (_inside if opens else _beneath)(
            world, question.target_id, np.array(hidden_size(question.answer_type)), rng
        )
        others = [
            world.box(name) for name in world.ids if name != question.target_id and not world.state(name).is_fixed
        ]
    low, high = tops.min(axis=1), tops.max(axis=1)
    low[:, 2] -= hidden_size(question.answer_type)[2]
    meets = [((low < box[1]) & (high > box[0])).all(axis=1) for box in others]
    tops = tops[~np.any(meets, axis=0)] if meets else tops
    if not len(tops):
        return 1.0
    seen = _are_seen(tops.reshape(-1, 3), question.goal_poses[0], decode_depth(question.end_depth.bytes))
    return float((seen.reshape(len(tops), -1).mean(axis=1) >= LEAST_SHOWN).mean())


def _inside(world: World, object_id: str, size: F64, rng: np.random.Generator) -> F64:
    """(n, 25, 3) points on the tops of things of a size that lie in the enclosed spaces of an object, as it is now."""
    poses, found = world.link_poses(object_id), []
    for space in world.assets[object_id].spaces:
        low, high = np.array(space.box[:3]), np.array(space.box[3:])
        low[:2], high[:2] = low[:2] + OFF_WALLS_M, high[:2] - OFF_WALLS_M
        if not space.enclosed or (high - low)[:2].min() < LEAST_SIDE_M:
            continue
        tops = _tops(low, high, size, rng)
        found.append(arithmetic.moved(tops, poses[space.link]))
    return np.concatenate(found) if found else np.empty((0, 25, 3))


def _beneath(world: World, object_id: str, size: F64, rng: np.random.Generator) -> F64:
    """(n, 25, 3) points on the tops of things of a size that lay where an object stood, well within its plan."""
    state, plan = world.state(object_id), np.array(world.assets[object_id].spec.size)
    high = plan / 2 * BENEATH
    tops = arithmetic.moved(_tops(-high, high, size, rng), state.matrix())
    tops[..., 2] = world.box(object_id)[0, 2] + size[2]
    return np.asarray(tops)


def _tops(low: F64, high: F64, size: F64, rng: np.random.Generator) -> F64:
    """(n, 25, 3) points on the tops of things that lie in a box at random, along its sides; none if they do not fit."""
    found = []
    for sides in (size, size[[1, 0, 2]]):
        room = (high - low)[:2] - sides[:2]
        if room.min() < 0:
            continue
        middle = (low + high)[:2] / 2 + rng.uniform(-0.5, 0.5, (round(WAYS * np.prod(room)) + 1, 2)) * room
        spread = np.linspace(-0.45, 0.45, 5)
        on_top = np.array([(a, b) for a in spread for b in spread]) * sides[:2]
        flat = middle[:, None] + on_top
        found.append(np.dstack([flat, np.full(flat.shape[:2], min(low[2] + size[2], high[2]))]))
    return np.concatenate(found) if found else np.empty((0, 25, 3))


def _are_seen(points: F64, pose: AgentState, depth: np.ndarray[tuple[int, ...], np.dtype[np.float32]]) -> F64:
    """(n,) whether the agent's camera at a pose shows points and nothing in front of them."""
    (sin_yaw, sin_down), (cos_yaw, cos_down) = arithmetic.sin_cos_deg([pose.yaw_deg, pose.horizon_deg])
    ahead = np.array([cos_yaw * cos_down, sin_yaw * cos_down, -sin_down])
    right = np.array([sin_yaw, -cos_yaw, 0.0])
    x, y, floor_z = pose.position
    away = points - np.array([x, y, floor_z + CAMERA_HEIGHT_M])
    z = arithmetic.dot(away, ahead)
    height, width = depth.shape
    column = width / 2 + arithmetic.dot(away, right) / z * height / 2
    row = height / 2 - arithmetic.dot(away, np.cross(right, ahead)) / z * height / 2
    inside = (z > 0) & (column >= 0) & (row >= 0) & (column < width) & (row < height)
    shown = depth[np.where(inside, row, 0).astype(int), np.where(inside, column, 0).astype(int)]
    return np.asarray(inside & (shown > z - NEARER_M), dtype=np.float64)
