"""What can be seen of points from a pose: looked up in depth images, which cost a millisecond each."""

from __future__ import annotations

import numpy as np

from remqa_data.geometry.types import F32, F64, Flags
from remqa_data.sim.navigation.grid import ReachableGrid
from remqa_data.sim.navigation.viewpoints import AgentPose
from remqa_data.sim.render.camera import Camera, scissor_around
from remqa_data.sim.render.view import WorldView

TOLERANCE_M = 0.012
"""A point counts as seen if nothing is nearer than it by more than this."""
HIDDEN_M = 0.002
"""A point counts as hidden if something is nearer than it by more than this."""
EDGE_PX = 0.01
"""Share of the image's side along its edges where a point does not count as seen."""


class Sightlines:
    """Depth images of one world from poses of its grid; those of the room at rest are kept."""

    def __init__(self, view: WorldView, grid: ReachableGrid, size_px: int) -> None:
        self.view, self.grid, self.size_px = view, grid, size_px
        self._at_rest: dict[AgentPose, F32] = {}

    def camera(self, pose: AgentPose) -> Camera:
        """The agent's camera at a pose."""
        return pose.camera(self.grid, self.size_px)

    def depth(self, pose: AgentPose, around: F64 | None = None) -> F32:
        """(h, w) depth of the world as it is now; if (n, 3) points are given, only of the part of the picture around them."""
        camera = self.camera(pose)
        return self.view.depth(camera, scissor=None if around is None else scissor_around(camera.view(), around))

    def depth_at_rest(self, pose: AgentPose) -> F32:
        """(h, w) depth of the world when it was first looked at from this pose; call it only when nothing is changed."""
        if pose not in self._at_rest:
            self._at_rest[pose] = self.depth(pose)
        return self._at_rest[pose]

    def sees(self, pose: AgentPose, depth: F32, points: F64) -> Flags:
        """(n,) whether points are in the image and nothing is in front of them."""
        inside, ahead = self._look(pose, depth, points)
        return np.asarray(inside & (ahead <= TOLERANCE_M))

    def hides(self, pose: AgentPose, depth: F32, points: F64) -> Flags:
        """(n,) whether points are out of the image, or behind something."""
        inside, ahead = self._look(pose, depth, points)
        return np.asarray(~inside | (ahead > HIDDEN_M))

    def _look(self, pose: AgentPose, depth: F32, points: F64) -> tuple[Flags, F64]:
        """Whether points are in the image, and how much nearer than they is what the image shows there, metres."""
        with np.errstate(divide="ignore", invalid="ignore"):
            x, y, z = self.camera(pose).project(points).T
        edge = EDGE_PX * self.size_px
        inside = (z > 0.02) & (x >= edge) & (y >= edge) & (x < self.size_px - edge) & (y < self.size_px - edge)
        column = np.where(inside, x, 0).astype(np.int64)
        row = np.where(inside, y, 0).astype(np.int64)
        shown = depth[row, column].astype(np.float64)
        return np.asarray(inside), np.where(shown > 0, z - shown, -np.inf)
