"""Where the agent can stand, and from where it can reach: a grid over the floor and the paths between its cells.

The agent is a cylinder. The floor is rasterised finely, everything between ankle and head height blocks it, and a cell of
the coarse grid is free when the nearest obstacle is farther than the agent's radius; two neighbouring cells are joined
when the whole step between them is free.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from itertools import chain
from typing import TYPE_CHECKING

import networkx as nx
import numpy as np
import numpy.typing as npt

from remqa_data.assets.core.model import Asset, CollisionBox
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import rotation_of
from remqa_data.geometry.types import F64, Rect, Vec2, Vec3
from remqa_data.opencv import cv2
from remqa_data.scene import Scene
from remqa_data.sim.navigation.embodiment import AGENT, Embodiment

if TYPE_CHECKING:
    from remqa_data.sim.physics.world import World

FINE_M = 0.02
_ROUNDING_M = 1e-6

Cell = tuple[int, int]
Outline = npt.NDArray[np.float32]
"""(n, 1, 2) corners of a convex outline on the floor, metres."""


@dataclass(frozen=True)
class ReachableGrid:
    """The cells that the agent can get to: the connected part of the floor that most things are nearest to.

    Attributes
    ----------
    cells : tuple of (int, int)
        Sorted; cell (i, j) has its centre at (i, j) steps in the room.
    graph : networkx.Graph
        The same cells, joined where a step is free.
    other_parts : tuple of int
        Sizes of the parts of the floor that cannot be reached from there (behind a shower door, a bar), largest first.
    body : Embodiment
        Whose steps these are.
    """

    cells: tuple[Cell, ...]
    graph: nx.Graph[Cell]
    other_parts: tuple[int, ...]
    floor_z: float
    body: Embodiment = AGENT

    def position(self, cell: Cell) -> Vec2:
        """Centre of a cell in the room, metres."""
        return self.body.centre_of(cell)

    def positions(self) -> F64:
        """(n, 2) centres of all cells."""
        return np.array(self.cells, dtype=np.float64).reshape(-1, 2) * self.body.step_m


def reachable_grid(world: World, clearance: Clearance | None = None, body: Embodiment = AGENT) -> ReachableGrid:
    """The grid of a world as it is now; everything between ankle and head height blocks, but for what is held.

    Parameters
    ----------
    world : World
        The room.
    clearance : Clearance, optional
        `clearance_map(world, body)`, if the caller has it already.
    body : Embodiment
        Who is to stand there. Whatever its own step is, cells are 0.25 m apart, as those of datasets are.
    """
    clearance, step_m, radius_m = clearance or clearance_map(world, body), AGENT.step_m, body.radius_m
    x0, y0, x1, y1 = world.scene.bounds
    free: set[Cell] = set()
    for i in range(math.ceil(x0 / step_m), math.floor(x1 / step_m) + 1):
        for j in range(math.ceil(y0 / step_m), math.floor(y1 / step_m) + 1):
            if clearance.at(i * step_m, j * step_m) > radius_m:
                free.add((i, j))
    graph: nx.Graph[Cell] = nx.Graph()
    graph.add_nodes_from(sorted(free))
    for i, j in sorted(free):
        for k, m in ((i + 1, j), (i, j + 1)):
            if (k, m) in free and all(
                clearance.at((i + t * (k - i)) * step_m, (j + t * (m - j)) * step_m) > radius_m
                for t in (0.25, 0.5, 0.75)
            ):
                graph.add_edge((i, j), (k, m))
    parts = sorted((sorted(part) for part in nx.connected_components(graph)), key=lambda part: (-len(part), part))
    if not parts:
        return ReachableGrid((), nx.Graph(), (), world.scene.floor_z)
    main = _part_nearest_to_most(world, parts, step_m)
    sizes = tuple(len(part) for part in parts if part is not main)
    return ReachableGrid(tuple(main), nx.Graph(graph.subgraph(main)), sizes, world.scene.floor_z)


def _part_nearest_to_most(world: World, parts: list[list[Cell]], step_m: float) -> list[Cell]:
    """The part that is nearest to the largest number of objects; the largest such part."""
    things = np.array([world.state(object_id).position[:2] for object_id in world.ids]).reshape(-1, 2)
    gaps = [arithmetic.length(things[:, None] - np.array(part)[None] * step_m).min(axis=1) for part in parts]
    votes = np.bincount(np.argmin(gaps, axis=0), minlength=len(parts))
    return parts[int(votes.argmax())]


def obstacles(world: World, body: Embodiment = AGENT) -> list[Outline]:
    """Plan outlines of all that blocks an agent."""
    things = (object_outlines(world, name, body=body) for name in solid_ids(world))
    return [*building_outlines(world.scene, body), *chain(*things)]


def solid_ids(world: World) -> list[str]:
    """The objects that may block the agent: all but the floor and what is held."""
    return [name for name in world.ids if name not in world.held and world.type_of(name) != "Floor"]


def building_outlines(scene: Scene, body: Embodiment = AGENT) -> list[Outline]:
    """Plan outlines of the walls and what is built in, between an agent's ankle and head height."""
    low, high = scene.floor_z + body.step_over_m, scene.floor_z + body.height_m
    outlines = []
    for part in scene.structure:
        x0, y0, z0, x1, y1, z1 = part.box
        if z1 > low and z0 < high:
            outlines.append(_outline([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]))
    return outlines


def object_outlines(world: World, object_id: str, first_link: int = 0, body: Embodiment = AGENT) -> list[Outline]:
    """`asset_outlines` of an object as it is now."""
    return asset_outlines(world.assets[object_id], world.link_poses(object_id), world.scene.floor_z, first_link, body)


def asset_outlines(
    asset: Asset, link_poses: F64, floor_z: float, first_link: int = 0, body: Embodiment = AGENT
) -> list[Outline]:
    """Plan outlines of one object, its links at (n, 4, 4) poses in the room, between an agent's ankle and head height.

    With `first_link` 1, only of what moves when it opens.
    """
    low, high = floor_z + body.step_over_m, floor_z + body.height_m
    outlines = []
    for link, pose in zip(asset.links[first_link:], link_poses[first_link:], strict=True):
        placed = arithmetic.moved(collision_corners(link.boxes), pose)
        heights = placed[..., 2]
        in_the_way = (heights.max(axis=1) > low) & (heights.min(axis=1) < high)
        outlines += [_outline(corners[:, :2]) for corners in placed[in_the_way]]
    return outlines


@lru_cache(maxsize=1 << 12)
def collision_corners(boxes: tuple[CollisionBox, ...]) -> F64:
    """(n, 8, 3) corners of some boxes of a link, in its frame."""
    found = [arithmetic.turned(_CORNERS * box.size, rotation_of(box.quaternion)) + box.centre for box in boxes]
    return np.array(found).reshape(-1, 8, 3)


def outline_distance(outlines: Iterable[Outline], point: Vec2) -> float:
    """Metres from a point to the nearest of some outlines; 0 inside one."""
    return min((max(0.0, -cv2.pointPolygonTest(outline, point, True)) for outline in outlines), default=math.inf)


def reach_distance(position: Vec2, floor_z: float, point: Vec3 | F64) -> float:
    """Metres from the shoulder, at its best height and facing the point, to a point; the arm reaches 0.63 m."""
    x, y, z = (float(v) for v in point)
    shoulder = min(max(z, floor_z + AGENT.shoulder_low_m), floor_z + AGENT.shoulder_high_m)
    ahead = max(math.dist(position, (x, y)) - AGENT.shoulder_ahead_m, 0.0)
    return math.hypot(ahead, z - shoulder)


def cells_in_reach(grid: ReachableGrid, points: Iterable[Vec3] | F64, reach_m: float = AGENT.reach_m) -> list[Cell]:
    """Cells from which the arm reaches at least one of some points."""
    targets = np.asarray(list(points), dtype=np.float64).reshape(-1, 3)
    if not len(targets):
        return []
    farthest = reach_m + AGENT.shoulder_ahead_m + _ROUNDING_M
    low, high = targets.min(axis=0).tolist(), targets.max(axis=0).tolist()
    found = []
    for cell in grid.cells:
        x, y = grid.position(cell)
        gap = math.hypot(max(low[0] - x, x - high[0], 0.0), max(low[1] - y, y - high[1], 0.0))
        if gap <= farthest and any(reach_distance((x, y), grid.floor_z, target) <= reach_m for target in targets):
            found.append(cell)
    return found


def nearest_cells_in_reach(grid: ReachableGrid, points: F64, reach_m: float) -> list[Cell]:
    """Cells from which the arm reaches at least one of some points, nearest to their middle first."""
    middle = points.mean(axis=0)[:2]
    return sorted(
        cells_in_reach(grid, points, reach_m), key=lambda cell: (math.dist(grid.position(cell), middle), cell)
    )


@dataclass(frozen=True, eq=False)
class Clearance:
    """How far the nearest obstacle is, on a fine raster.

    Attributes
    ----------
    distance_m : (rows, columns) float32
    corner : tuple of float
        x, y of entry (0, 0), metres.
    """

    distance_m: npt.NDArray[np.float32]
    corner: Vec2

    def at(self, x: float, y: float) -> float:
        """Metres from a point of the room to the nearest obstacle; 0 outside the room."""
        column, row = round((x - self.corner[0]) / FINE_M), round((y - self.corner[1]) / FINE_M)
        if not (0 <= row < self.distance_m.shape[0] and 0 <= column < self.distance_m.shape[1]):
            return 0.0
        return float(self.distance_m[row, column])

    def at_each(self, x: F64, y: F64) -> npt.NDArray[np.float32]:
        """The same of many points, given by arrays of one shape."""
        rows, columns = self.distance_m.shape
        row = np.rint((y - self.corner[1]) / FINE_M).astype(np.intp).clip(0, rows - 1)  # on the border it is 0, too
        column = np.rint((x - self.corner[0]) / FINE_M).astype(np.intp).clip(0, columns - 1)
        return np.asarray(self.distance_m[row, column])


def clearance_map(world: World, body: Embodiment = AGENT) -> Clearance:
    """The clearance of a world as it is now; the border of the room counts as an obstacle."""
    return clearance_from(world.scene.bounds, obstacles(world, body))


def clearance_from(bounds: Rect, outlines: Iterable[Outline]) -> Clearance:
    """The clearance of a room with given bounds and obstacles."""
    x0, y0, x1, y1 = bounds
    columns, rows = math.ceil((x1 - x0) / FINE_M) + 1, math.ceil((y1 - y0) / FINE_M) + 1
    free = np.full((rows + 2, columns + 2), 255, dtype=np.uint8)
    free[[0, -1], :] = 0
    free[:, [0, -1]] = 0
    scale = 1 << _SHIFT
    for outline in outlines:
        pixels = np.round(((outline - np.array([x0, y0])) / FINE_M + 1) * scale).astype(np.int32)
        cv2.fillConvexPoly(free, pixels, 0, shift=_SHIFT)
    distance = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE) * FINE_M
    return Clearance(np.asarray(distance, dtype=np.float32), (x0 - FINE_M, y0 - FINE_M))


_CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
_SHIFT = 4


def _outline(points: npt.ArrayLike) -> Outline:
    return np.asarray(cv2.convexHull(np.asarray(points, dtype=np.float32)), dtype=np.float32)
