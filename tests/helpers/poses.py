"""Poses from which tests act."""

import numpy as np

from remqa_data.geometry.types import F64
from remqa_data.sim.navigation.grid import ReachableGrid, cells_in_reach
from remqa_data.sim.navigation.viewpoints import MIN_PIXELS, AgentPose, facing_poses
from remqa_data.sim.render.view import WorldView


def pose_that_sees_and_reaches(view: WorldView, grid: ReachableGrid, object_id: str, points: F64) -> AgentPose | None:
    """The nearest pose that sees an object and from which the arm reaches one of some points of it, or None.

    A standing pose is preferred; low drawers under a deep worktop are only seen by an agent that crouches.
    """
    index = view.world.ids.index(object_id)
    middle = np.mean(view.world.box(object_id), axis=0)
    cells = cells_in_reach(grid, points)
    for is_standing in (True, False):
        for pose in facing_poses(grid, cells, middle, is_standing=is_standing):
            if view.pixels(pose.camera(grid))[index] >= MIN_PIXELS:
                return pose
    return None
