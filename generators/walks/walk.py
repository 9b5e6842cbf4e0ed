"""The walk that takes the frames of a configuration: breadth-first over the reachable grid from where the agent starts.

The poses, in the order in which the walk reaches them, are split into as many runs as frames are wanted, and each run
gives one frame: so the frames are spread over the room and come in breadth-first order. Which pose of a run it is, is
decided on small instance images, which cost a fraction of a picture: again and again the pose, of all runs that have
none yet, that shows the most objects, and the most ground, that no chosen pose shows.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from remqa_data.errors import NoPathError
from remqa_data.geometry.types import Flags
from remqa_data.sim.metadata import AgentState, FrameMetadata, frame_metadata, object_metadata, scaled_min_pixels
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.navigation.grid import Cell, ReachableGrid
from remqa_data.sim.navigation.viewpoints import FRAME_PX, HEADINGS_DEG, AgentPose, pixel_counts
from remqa_data.sim.render.camera import Camera
from remqa_data.sim.render.view import Observation, WorldView

GROUND_VIEW_M = 3.0
"""Farther away, the rows of a 300 x 300 frame are more than a voxel apart on the ground."""


@dataclass(frozen=True)
class WalkSettings:
    """How the frames of a configuration are taken.

    Attributes
    ----------
    frames : int
        How many are wanted. A room where fewer poses are worth a frame gives fewer.
    headings_deg, horizons_deg : tuple of int
        The views at each cell: degrees counter-clockwise from +x, and degrees downwards.
    min_objects : int
        Poses that see fewer objects, not counting the floor, are skipped.
    stride : int or None
        Only every so many-th cell of the walk is tried; None spreads `cells_per_frame` cells for each frame evenly.
    cells_per_frame : float
        See `stride`. More cells see more from fewer frames, and take longer.
    ground_worth : float
        What it is worth to see the ground of a cell for the first time, which makes the semantic map complete; an
        object is worth 1.
    repeat_worth : float
        A further view of something of which there are n is worth this share of the first, times 1 / (1 + n)^2.
    similar_worth : float
        Share of its worth that a pose keeps for each chosen pose that looks the same way from within `similar_m`.
    similar_m : float
        See `similar_worth`; metres.
    size_px : int
        Side of a frame.
    scout_px : int
        Side of the images by which poses are chosen.
    """

    frames: int = 24
    headings_deg: tuple[int, ...] = HEADINGS_DEG
    horizons_deg: tuple[int, ...] = (0, 30)
    min_objects: int = 3
    stride: int | None = None
    cells_per_frame: float = 2.0
    ground_worth: float = 0.1
    repeat_worth: float = 0.1
    similar_worth: float = 0.5
    similar_m: float = 0.5
    size_px: int = FRAME_PX
    scout_px: int = 75


@dataclass(frozen=True, eq=False)
class WalkFrame:
    """One frame of a walk.

    Attributes
    ----------
    pose : AgentPose
        Where the agent stood and looked.
    steps : int
        Cells on the shortest way from the start; never fewer than those of the frame before.
    camera : Camera
        What drew the frame.
    observation : Observation
        RGB, depth, object and link images.
    metadata : FrameMetadata
        The agent, and the visible objects.
    """

    pose: AgentPose
    steps: int
    camera: Camera
    observation: Observation
    metadata: FrameMetadata


def walk(
    view: WorldView, grid: ReachableGrid, start: Cell, settings: WalkSettings, rng: np.random.Generator
) -> Iterator[WalkFrame]:
    """Take the frames of a configuration, breadth-first from a cell.

    Parameters
    ----------
    view : WorldView
        The room; it must not change before the last frame is taken.
    grid : ReachableGrid
        Where the agent can stand in it.
    start : Cell
        Where the walk begins.
    settings : WalkSettings
        Which frames to take.
    rng : numpy.random.Generator
        Decides which neighbours the walk visits first; the same state gives the same frames.

    Yields
    ------
    WalkFrame
        At most `settings.frames`, in the order of the walk.

    Raises
    ------
    NoPathError
        If the start is not in the grid.
    """
    steps = dict(breadth_first(grid, start))
    known = object_metadata(view.world)
    for pose in plan_walk(view, grid, start, settings, rng):
        camera = pose.camera(grid, settings.size_px)
        observation = view.render(camera)
        x, y = grid.position(pose.cell)
        agent = AgentState((x, y, grid.floor_z), float(pose.yaw_deg), float(pose.horizon_deg))
        metadata = frame_metadata(view.world, observation, agent, camera, known=known)
        yield WalkFrame(pose, steps[pose.cell], camera, observation, metadata)


def plan_walk(
    view: WorldView, grid: ReachableGrid, start: Cell, settings: WalkSettings, rng: np.random.Generator
) -> list[AgentPose]:
    """The poses at which `walk` takes its frames, in the order of the walk; see there."""
    cells = [cell for cell, _ in breadth_first(grid, start, rng)]
    poses = [
        AgentPose(cell, heading, horizon)
        for cell in _spread(cells, settings)
        for heading in settings.headings_deg
        for horizon in settings.horizons_deg
    ]
    return [poses[i] for i in sorted(_choose(_Scout(view, grid), settings, poses))]


def breadth_first(
    grid: ReachableGrid, start: Cell, rng: np.random.Generator | None = None
) -> Iterator[tuple[Cell, int]]:
    """Every cell of the grid with its distance from a start in steps, nearest first.

    Parameters
    ----------
    grid : ReachableGrid
        The cells.
    start : Cell
        One of them.
    rng : numpy.random.Generator, optional
        Draws the order of the four directions in which neighbours are visited; +x, +y, -x, -y without it.

    Raises
    ------
    NoPathError
        If the start is not in the grid.
    """
    if start not in grid.graph:
        raise NoPathError(f"a walk cannot start at {start}: it is not among the {len(grid.cells)} reachable cells")
    directions = [_DIRECTIONS[i] for i in (rng.permutation(4) if rng is not None else range(4))]
    steps = {start: 0}
    queue = deque([start])
    while queue:
        cell = queue.popleft()
        yield cell, steps[cell]
        for dx, dy in directions:
            neighbour = (cell[0] + dx, cell[1] + dy)
            if neighbour in grid.graph.adj[cell] and neighbour not in steps:
                steps[neighbour] = steps[cell] + 1
                queue.append(neighbour)


_DIRECTIONS = ((1, 0), (0, 1), (-1, 0), (0, -1))


def _spread(cells: list[Cell], settings: WalkSettings) -> list[Cell]:
    """The cells whose poses are tried."""
    if settings.stride is not None:
        return cells[:: settings.stride]
    count = min(len(cells), math.ceil(settings.frames * settings.cells_per_frame))
    return [cells[i * len(cells) // count] for i in range(count)]


def _choose(scout: _Scout, settings: WalkSettings, poses: list[AgentPose]) -> list[int]:
    """Indices of the chosen poses: one of each run, and more where a run has none that is worth a frame.

    The small images only say which pose to try next; whether it sees enough, and what, is counted at full size.
    """
    first_worth = np.repeat([1.0, settings.ground_worth], [scout.objects, scout.cells])
    runs = np.arange(len(poses)) * settings.frames // len(poses)
    guesses = np.array([scout.sees(pose, settings.scout_px) for pose in poses], dtype=np.float64)
    seen = np.zeros(guesses.shape[1])
    is_untried = np.ones(len(poses), dtype=np.bool_)
    is_without = np.ones(settings.frames, dtype=np.bool_)
    novelty = np.ones(len(poses))
    chosen: list[int] = []
    while len(chosen) < settings.frames and is_untried.any():
        is_open = is_untried & is_without[runs]
        if not is_open.any():
            is_open = is_untried
        worth = np.where(seen == 0, 1.0, settings.repeat_worth / (1.0 + seen) ** 2) * first_worth
        best = int(np.argmax(np.where(is_open, (guesses * worth).sum(axis=1) * novelty, -1.0)))
        is_untried[best] = False
        sees = scout.sees(poses[best], settings.size_px)
        if np.count_nonzero(sees[: scout.objects]) >= settings.min_objects:
            chosen.append(best)
            seen += sees
            is_without[runs[best]] = False
            novelty[[_are_similar(pose, poses[best], settings) for pose in poses]] *= settings.similar_worth
    return chosen


def _are_similar(a: AgentPose, b: AgentPose, settings: WalkSettings) -> bool:
    is_same_way = (a.yaw_deg, a.horizon_deg) == (b.yaw_deg, b.horizon_deg)
    return is_same_way and math.dist(a.cell, b.cell) * AGENT.step_m <= settings.similar_m


class _Scout:
    """Looks from poses for what is worth seeing: the objects but for the floor, and the ground of each cell."""

    def __init__(self, view: WorldView, grid: ReachableGrid) -> None:
        self._view, self._grid = view, grid
        world = view.world
        self.objects, self.cells = len(world.ids), len(grid.cells)
        self._is_thing = np.array([world.type_of(object_id) != "Floor" for object_id in world.ids], dtype=np.bool_)
        tops = [world.box(object_id)[1, 2] for object_id in world.ids]
        # The last entry answers for the structure, -1.
        self._is_ground = np.array([*(top < grid.floor_z + AGENT.step_over_m for top in tops), False], dtype=np.bool_)
        self._ground = np.column_stack([grid.positions(), np.full(len(grid.cells), grid.floor_z)])

    def sees(self, pose: AgentPose, size_px: int) -> Flags:
        """(objects + cells,) whether each object is visible, and the ground of each cell of the grid."""
        camera = pose.camera(self._grid, size_px)
        image = self._view.instances(camera)
        is_seen = (pixel_counts(image, self.objects) >= scaled_min_pixels(image.shape)) & self._is_thing
        with np.errstate(divide="ignore", invalid="ignore"):  # points beside the camera have depth 0
            x, y, depth = camera.project(self._ground).T
        is_near = (depth > 0.0) & (depth < GROUND_VIEW_M) & (abs(x - size_px / 2) < size_px / 2)
        in_view = np.flatnonzero(is_near & (abs(y - size_px / 2) < size_px / 2))
        is_ground_seen = np.zeros(len(self._ground), dtype=np.bool_)
        is_ground_seen[in_view] = self._is_ground[image[y[in_view].astype(int), x[in_view].astype(int)]]
        return np.concatenate([is_seen, is_ground_seen])
