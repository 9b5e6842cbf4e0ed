"""Memories of rooms made by hand, and a room of cells in which a walker walks: no simulator, no pictures."""

from __future__ import annotations

from collections.abc import Collection, Iterable

import numpy as np

from remqa_data.agents.knowledge.instance import Instance
from remqa_data.agents.knowledge.memory import WalkMemory
from remqa_data.agents.parts.interfaces import Percept, Walker
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.sim.metadata import ObjectMetadata
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.navigation.grid import Cell
from remqa_data.sim.navigation.paths import MOVE_AHEAD, cell_ahead
from remqa_data.sim.navigation.viewpoints import FRAME_PX, AgentPose
from remqa_data.tables.rows import SemanticMap

VOXEL_M = 0.05


def memory_of(objects: Iterable[ObjectMetadata], bounds: tuple[float, float, float, float]) -> WalkMemory:
    """The memory of a room with a floor, walls 2 m high around its bounds, and objects that fill their boxes."""
    things = list(objects)
    names = ("structure", *sorted({"Floor", *(thing.type for thing in things)}))
    x0, y0, x1, y1 = (round(edge / VOXEL_M) for edge in bounds)
    labels: dict[tuple[int, int, int], int] = {}
    for i in range(x0 - 1, x1 + 1):
        for j in range(y0 - 1, y1 + 1):
            is_wall = i in (x0 - 1, x1) or j in (y0 - 1, y1)
            for k in range(40 if is_wall else 1):
                labels[i, j, k] = 0 if is_wall else names.index("Floor")
    for thing in (thing for thing in things if thing.type != "Floor"):
        low = [round(edge / VOXEL_M) for edge in thing.box[:3]]
        high = [max(round(edge / VOXEL_M), start + 1) for edge, start in zip(thing.box[3:], low, strict=True)]
        for place in np.ndindex(*(b - a for a, b in zip(low, high, strict=True))):
            i, j, k = (int(a + p) for a, p in zip(low, place, strict=True))
            labels[i, j, k] = names.index(thing.type)
    voxels = np.array([[*place, label] for place, label in labels.items()], dtype=np.int16)
    stored = SemanticMap((0.0, 0.0, 0.0), VOXEL_M, (x0 - 1, y0 - 1), names, voxels)
    return WalkMemory.of_walk(SceneGraph.from_objects(things), stored, AGENT)


def percept_of(pose: AgentPose, instance: Instance | None = None, *, succeeded: bool = True) -> Percept:
    """What an agent perceives that sees a screen through the middle of an object, or nothing at all."""
    camera = pose.camera_above(0.0)
    depth = np.zeros((FRAME_PX, FRAME_PX), dtype=np.float32)
    if instance is not None:
        with np.errstate(divide="ignore"):  # beside the camera depth is 0
            depth[:] = max(float(camera.project(instance.centre)[0, 2]), 0.0)
    return Percept(np.zeros((FRAME_PX, FRAME_PX, 3), dtype=np.uint8), depth, pose, camera, succeeded)


def walk(
    walker: Walker,
    pose: AgentPose,
    instance: Instance | None = None,
    closed: Collection[Cell] = (),
    most_steps: int = 100,
) -> tuple[list[str], AgentPose]:
    """Let a walker walk where all cells but some are free: its actions, and where it stops."""
    actions: list[str] = []
    percept = percept_of(pose, instance)
    while len(actions) < most_steps and (action := walker.next_action(percept)) is not None:
        actions.append(action)
        after = moved(pose, action)
        succeeded = after.cell not in closed
        pose = after if succeeded else pose
        percept = percept_of(pose, instance, succeeded=succeeded)
    return actions, pose


def moved(pose: AgentPose, action: str) -> AgentPose:
    """The pose after an action in a room without obstacles."""
    turns = {"RotateLeft": 90, "RotateRight": -90}
    tilts = {"LookDown": 30, "LookUp": -30}
    cell = cell_ahead(pose.cell, pose.yaw_deg) if action == MOVE_AHEAD else pose.cell
    yaw, horizon = (pose.yaw_deg + turns.get(action, 0)) % 360, pose.horizon_deg + tilts.get(action, 0)
    return AgentPose(cell, yaw, horizon)
