"""What the arm can bump into: the collision boxes of a room, and a test of many postures against them at once.

The arm is a chain of balls that overlap along its links, which makes a capsule of each link. The boxes are those that
PyBullet has, but they are read from the world's own poses, so that a test leaves nothing behind in the simulation.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from remqa_data.catalog import object_type
from remqa_data.compiled import exact
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import rotation_of
from remqa_data.geometry.types import F64, Vec3
from remqa_data.sim.arm.postures import BASE_TOP_M, COLUMN_TOP_M, ArmBase
from remqa_data.sim.physics.bodies import STRUCTURE_NAME
from remqa_data.sim.physics.state import ObjectState
from remqa_data.sim.physics.world import World

EXTENT_M = 1.3
"""No part of the arm is farther than this from the middle of the agent's base, seen from above."""
OF_BUILDING, OF_AGENT, OF_OTHER = -1, -2, -3
"""Owners of boxes that are no object's: the building, the agent's own body, and those of others."""
NAMES = {OF_BUILDING: STRUCTURE_NAME, OF_AGENT: "Agent", OF_OTHER: "another Agent"}
_BODY = np.array(
    [
        [-0.055, -0.055, 0.0, 0.055, 0.055, COLUMN_TOP_M],
        [-0.14, -0.14, 0.0, 0.14, 0.14, BASE_TOP_M],
        [-0.19, -0.07, 0.0, 0.19, 0.07, BASE_TOP_M],
        [-0.07, -0.19, 0.0, 0.07, 0.19, BASE_TOP_M],
    ]
)
"""Column and round base, whichever way they are turned: corners of boxes from the middle of the base, metres."""


class Boxes(NamedTuple):
    """Oriented boxes in the room.

    Attributes
    ----------
    centres : (n, 3) array
        Metres.
    axes : (n, 3, 3) array
        Rows are the directions of a box's sides.
    halves : (n, 3) array
        Half of its sides, metres.
    low, high : (n, 3) array
        Corners of the upright boxes around them, metres.
    """

    centres: F64
    axes: F64
    halves: F64
    low: F64
    high: F64


class Obstacles:
    """The boxes of a world, kept in step with its poses.

    Parameters
    ----------
    world : World
        What to keep in step with.

    Attributes
    ----------
    let_loads_pass : list of int
        Owners of the boxes in which what a hand holds may be: the agent itself, and what a hand could pick up.
    """

    def __init__(self, world: World) -> None:
        self._world = world
        solid = np.array([p.box for p in world.scene.structure if p.kind != "outside"]).reshape(-1, 6)
        count = len(solid)
        self._first: dict[str, int] = {}
        self._local: dict[str, tuple[npt.NDArray[np.int64], F64, F64]] = {}
        owner, halves = [OF_BUILDING] * count, [(solid[:, 3:] - solid[:, :3]) / 2]
        for index, object_id in enumerate(world.ids):
            links = world.assets[object_id].links
            boxes = [(i, box) for i, link in enumerate(links) for box in link.boxes]
            self._first[object_id] = len(owner)
            self._local[object_id] = (
                np.array([i for i, _ in boxes], dtype=np.int64),
                np.array([box.centre for _, box in boxes]).reshape(-1, 3),
                np.array([rotation_of(box.quaternion) for _, box in boxes]).reshape(-1, 3, 3),
            )
            owner += [index] * len(boxes)
            halves.append(np.array([box.size for _, box in boxes]).reshape(-1, 3) / 2)
        self._owner = np.array(owner)
        self._halves = np.vstack(halves)
        self._centres = np.zeros((len(owner), 3))
        self._centres[:count] = (solid[:, 3:] + solid[:, :3]) / 2
        self._axes = np.tile(np.eye(3), (len(owner), 1, 1))
        self._seen: dict[str, ObjectState] = {}
        pickupable = (object_type(world.type_of(object_id)).pickupable for object_id in world.ids)
        self.let_loads_pass = [OF_AGENT, *(index for index, can_be in enumerate(pickupable) if can_be)]

    def near(
        self, base: ArmBase, beyond_m: float = 0.0, others: Sequence[ArmBase] = ()
    ) -> tuple[Boxes, npt.NDArray[np.int64]]:
        """The boxes that the arm could come near to, the agent's own body among them, and the owner of each.

        Parameters
        ----------
        base : ArmBase
            Where the agent stands.
        beyond_m : float
            So far it may walk from there, or reaches beyond its hand what that holds, metres.
        others : sequence of ArmBase
            Where other agents stand.

        Returns
        -------
        Boxes, and (n,) owners: index of the object in the scene, or `OF_BUILDING`, `OF_AGENT` or `OF_OTHER`.
        """
        self._sync()
        around = arithmetic.turned_back(self._halves, np.abs(self._axes))
        gaps = np.maximum(np.abs(self._centres - [base.x, base.y, 0.0]) - around, 0.0)
        near = arithmetic.length(gaps[:, :2]) < EXTENT_M + beyond_m
        for object_id in self._world.held:
            near &= self._owner != self._world.ids.index(object_id)
        body = np.vstack([_BODY + np.tile([agent.x, agent.y, agent.floor_z], 2) for agent in (base, *others)])
        halves = np.vstack([self._halves[near], (body[:, 3:] - body[:, :3]) / 2])
        centres = np.vstack([self._centres[near], (body[:, 3:] + body[:, :3]) / 2])
        axes = np.vstack([self._axes[near], np.tile(np.eye(3), (len(body), 1, 1))])
        around = np.vstack([around[near], halves[-len(body) :]])
        agents = np.full(len(body), OF_OTHER)
        agents[: len(_BODY)] = OF_AGENT
        owners = np.append(self._owner[near], agents)
        return Boxes(centres, axes, halves, centres - around, centres + around), owners

    def gaps(self, point: Vec3) -> F64:
        """(objects,) metres from a point to the nearest box of each object; infinite where it has none."""
        self._sync()
        local = arithmetic.turned(np.asarray(point) - self._centres, self._axes)
        outside = arithmetic.length(np.maximum(np.abs(local) - self._halves, 0.0))
        nearest = np.full(len(self._world.ids), np.inf)
        np.minimum.at(nearest, self._owner[self._owner >= 0], outside[self._owner >= 0])
        return nearest

    def name(self, owner: int) -> str:
        """Id of the object that is an owner, or what the building or the agent's body is called."""
        return NAMES.get(owner) or self._world.ids[owner]

    def indices(self, object_ids: Collection[str]) -> npt.NDArray[np.int64]:
        """Indices of objects in the scene.

        Raises
        ------
        UnknownNameError
            If there is no such object.
        """
        for object_id in object_ids:
            self._world.state(object_id)  # raises
        return np.array([self._world.ids.index(object_id) for object_id in object_ids], dtype=np.int64)

    def _sync(self) -> None:
        for object_id, first in self._first.items():
            state = self._world.state(object_id)
            if self._seen.get(object_id) is state:
                continue
            self._seen[object_id] = state
            links, centres, rotations = self._local[object_id]
            poses = self._world.link_poses(object_id)[links]
            rows = slice(first, first + len(links))
            self._centres[rows] = arithmetic.moved(centres, poses)
            self._axes[rows] = np.swapaxes(arithmetic.product(poses[:, :3, :3], rotations), 1, 2)


@exact
def depth(balls: F64, radii: F64, boxes: Boxes, spared: npt.NDArray[np.bool_]) -> F64:
    """How deep each of many postures is in a box.

    Parameters
    ----------
    balls : (n, b, 3) array
        Middles of the arm's balls in each posture, metres.
    radii : (b,) array
        Their radii, metres.
    boxes : Boxes
        What they can bump into.
    spared : (b, boxes) array of bool
        Pairs that may touch.

    Returns
    -------
    (n,) metres, 0 where nothing touches; a posture that touches something gets the depth in the first such box.
    """
    deepest = np.zeros(balls.shape[0])
    for i in range(balls.shape[0]):
        low, high = _bounds(balls[i], radii)
        for k in range(boxes.centres.shape[0]):
            deepest[i] = _depth_in(balls[i], radii, boxes, k, spared) if _meets(low, high, boxes, k) else 0.0
            if deepest[i] > 0.0:
                break
    return deepest


@exact
def first_push(balls: F64, radii: F64, boxes: Boxes, spared: npt.NDArray[np.bool_]) -> tuple[int, int]:
    """The first of successive postures that pushes into a box, and into which.

    A box that the first posture is in already, such as a drawer that was opened around the hand, stops nothing until the
    arm is out of it. Arguments as for `depth`; the first posture is where the arm is.

    Returns
    -------
    Index of the posture and of the box; the number of postures and -1 if there is none.
    """
    is_left = np.zeros(boxes.centres.shape[0], dtype=np.bool_)
    for i in range(balls.shape[0]):
        low, high = _bounds(balls[i], radii)
        for k in range(boxes.centres.shape[0]):
            touches = _meets(low, high, boxes, k) and _depth_in(balls[i], radii, boxes, k, spared) > 0.0
            if touches and is_left[k]:
                return i, k
            is_left[k] |= not touches
    return balls.shape[0], -1


@exact
def _bounds(balls: F64, radii: F64) -> tuple[F64, F64]:
    """Corners of the upright box around some balls."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for b in range(len(balls)):
        for j in range(3):
            low[j] = min(low[j], balls[b, j] - radii[b])
            high[j] = max(high[j], balls[b, j] + radii[b])
    return low, high


@exact
def _meets(low: F64, high: F64, boxes: Boxes, k: int) -> bool:
    """Whether an upright box meets that around one of the boxes."""
    meets = True
    for j in range(3):
        meets &= low[j] < boxes.high[k, j] and high[j] > boxes.low[k, j]
    return meets


@exact
def _depth_in(balls: F64, radii: F64, boxes: Boxes, k: int, spared: npt.NDArray[np.bool_]) -> float:
    """How deep any of some balls is in one box, metres; 0 if none is."""
    deepest = 0.0
    for b in range(len(balls)):
        if spared[b, k]:
            continue
        is_near = True
        for j in range(3):
            is_near &= boxes.low[k, j] - radii[b] < balls[b, j] < boxes.high[k, j] + radii[b]
        if not is_near:
            continue
        outside, inside = 0.0, -np.inf
        for i in range(3):
            along = 0.0
            for j in range(3):
                along += boxes.axes[k, i, j] * (balls[b, j] - boxes.centres[k, j])
            gap = abs(along) - boxes.halves[k, i]
            inside = max(inside, gap)
            outside += max(gap, 0.0) ** 2
        distance = np.sqrt(outside) if inside > 0.0 else inside
        deepest = max(deepest, radii[b] - distance)
    return deepest
