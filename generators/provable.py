"""How much of the space in which a thing could be one sees after acting: "no" and 0 are to be seen, not guessed.

One may look about from the goal, standing and crouched, with the camera at any tilt, but not step or turn. Worked out from
the room's own geometry by chance points; `arrangement/interior_view` does it from a place's areas on a lattice, and a sample is
made only if both agree. `verify` looks again from the files.
"""

from __future__ import annotations

import zlib

import numpy as np

from remqa_data.generators.arrangement.hiding_rules import hidden_size
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import rotation_of
from remqa_data.geometry.types import F64, Flags
from remqa_data.scene import SceneObject
from remqa_data.sim.agent.replay import Replay
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.navigation.viewpoints import FRAME_PX, HORIZONS_DEG
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.camera import Camera, Scissor
from remqa_data.sim.render.view import WorldView
from remqa_data.tables.rows import QuestionRow

LEAST_SHARE_BY_CHANCE = 0.77
"""Of the 0.8 that is asked for; counted by chance points, a share may come out so much lower."""
WAYS = 5000.0
"""Things that are tried for each square metre in which their middles can be."""
LEAST_SHOWN = 0.3
"""Who sees so much of a thing's top sees the thing."""
NEARER_M = 0.012
"""What is nearer to the camera than a point by more than this hides it."""
OFF_WALLS_M = 0.012
LEAST_SIDE_M = 0.05
"""In what is narrower nothing is put."""
NO_ROOM = 0.02
"""Where no more than this of the ways in which things fit an empty place is left, there is no room for another."""
BENEATH = 0.6
"""Of the plan of what is taken away, so much of each side surely covered something."""


def seen_share(replay: Replay, question: QuestionRow) -> float:
    """Share of the ways in which a thing of the asked type could lie there that one would see, 0 to 1.

    One that fits nowhere beside what lies there is nowhere: then the share is 1.

    Parameters
    ----------
    replay : Replay
        The room after the question's actions.
    question : QuestionRow
        One that is answered with "no" or 0.
    """
    rng = np.random.default_rng(zlib.crc32(question.question_id.encode()))
    world, target = replay.world, question.target_id
    size = np.array(hidden_size(question.answer_type))
    if question.manipulation == "Open":
        tops = _inside(world, target, size, rng)
    else:
        tops = _beneath(world.scene.object(target), size, rng)
    others = [world.box(name) for name in world.ids if name != target and not world.state(name).is_fixed]
    low, high = tops.min(axis=1), tops.max(axis=1)
    low[:, 2] -= size[2]
    meets = [((low < box[1]) & (high > box[0])).all(axis=1) for box in others]
    free = tops[~np.any(meets, axis=0)] if meets else tops
    if len(free) <= NO_ROOM * len(tops):
        return 1.0
    tops = free
    goal, points = question.goal_poses[0], tops.reshape(-1, 3)
    seen = np.zeros(len(points), dtype=np.bool_)
    for height in (AGENT.camera_height_m, AGENT.crouched_camera_height_m):
        for horizon_deg in HORIZONS_DEG:
            x, y, floor_z = goal.position
            camera = Camera((x, y, floor_z + height), goal.yaw_deg, float(horizon_deg), width=FRAME_PX, height=FRAME_PX)
            rest = np.flatnonzero(~seen)
            seen[rest] = _are_seen(points[rest], camera, replay.view)
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


def _beneath(cover: SceneObject, size: F64, rng: np.random.Generator) -> F64:
    """(n, 25, 3) points on the tops of things of a size that lay where an object stood, well within its plan."""
    high = np.array(cover.asset.size) / 2 * BENEATH
    tops = arithmetic.turned(_tops(-high, high, size, rng), rotation_of(cover.quaternion)) + cover.position
    tops[..., 2] = cover.position[2] - cover.asset.size[2] / 2 + size[2]
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


def _are_seen(points: F64, camera: Camera, view: WorldView) -> Flags:
    """(n,) whether the agent's camera shows points and nothing in front of them."""
    (sin_yaw, sin_down), (cos_yaw, cos_down) = arithmetic.sin_cos_deg([camera.yaw_deg, camera.horizon_deg])
    ahead = np.array([cos_yaw * cos_down, sin_yaw * cos_down, -sin_down])
    right = np.array([sin_yaw, -cos_yaw, 0.0])
    away = points - np.asarray(camera.position)
    z = arithmetic.dot(away, ahead)
    height, width = camera.height, camera.width
    column = width / 2 + arithmetic.dot(away, right) / z * height / 2
    row = height / 2 - arithmetic.dot(away, arithmetic.cross(right, ahead)) / z * height / 2
    inside = (z > 0) & (column >= 0) & (row >= 0) & (column < width) & (row < height)
    if not inside.any():
        return np.asarray(inside)
    rows, columns = np.where(inside, row, 0).astype(int), np.where(inside, column, 0).astype(int)
    seen_rows, seen_columns = rows[inside].tolist(), columns[inside].tolist()
    around = Scissor(min(seen_columns), max(seen_columns), min(seen_rows), max(seen_rows))
    shown = view.depth(camera, scissor=around)[rows, columns]
    return np.asarray(inside & (shown > z - NEARER_M))
