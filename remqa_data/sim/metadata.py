"""What the simulator says about objects and the agent: plain typed records, of the whole room or of one frame.

World frame: right-handed, z up, metres; yaw in degrees counter-clockwise from +x.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from scipy.ndimage import find_objects

from remqa_data.catalog import object_type
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import rotation_of
from remqa_data.geometry.types import F32, I32, Box, Flags, Vec3
from remqa_data.sim.navigation.grid import ReachableGrid
from remqa_data.sim.navigation.viewpoints import FRAME_PX, MIN_PIXELS, AgentPose, pixel_counts
from remqa_data.sim.physics.support import SupportKind, supports

if TYPE_CHECKING:
    from remqa_data.sim.physics.state import ObjectState
    from remqa_data.sim.physics.world import World
    from remqa_data.sim.render.camera import Camera
    from remqa_data.sim.render.view import Observation

Box2D = tuple[int, int, int, int]
"""[x1, y1, x2, y2) in pixels, half open."""
FrameImages = tuple[npt.NDArray[np.integer[Any]], F32]
"""Object numbers and depth in metres, both (h, w)."""


@dataclass(frozen=True)
class AgentState:
    """Where the agent is.

    Attributes
    ----------
    position : tuple of float
        The middle of its base: x and y of its grid cell, z of the floor, metres. The camera is 1.576 m above.
    yaw_deg : float
        Where it faces, counter-clockwise from +x.
    horizon_deg : float
        Where the camera looks; positive is down.
    """

    position: Vec3
    yaw_deg: float
    horizon_deg: float

    @classmethod
    def of(cls, grid: ReachableGrid, pose: AgentPose) -> AgentState:
        """The state of an agent at a pose of the grid; data tells only of agents that stand, so whether it crouches is lost."""
        x, y = grid.position(pose.cell)
        return cls((x, y, grid.floor_z), float(pose.yaw_deg), float(pose.horizon_deg))

    def pose(self) -> AgentPose:
        """The nearest pose of the grid."""
        x, y, _ = self.position
        return AgentPose.nearest(x, y, self.yaw_deg, self.horizon_deg)


@dataclass(frozen=True)
class ObjectMetadata:
    """One object as it is now.

    Attributes
    ----------
    id : str
        AI2-THOR's objectId.
    type : str
        Such as "Mug".
    color, substance : str
        Words for what one sees most of, such as "red" and "ceramic".
    box : tuple of float
        Axis-aligned box of the visible mesh: x0, y0, z0, x1, y1, z1 in metres, world frame.
    openness : float
        0 (closed) to 1 (open).
    is_picked_up : bool
        Whether the agent holds it; then it is nowhere in the room, whatever `box` says.
    support : str or None
        Id of the receptacle that holds it, see `remqa_data.sim.physics.support`; the floor's id for what stands on the
        floor; None for what rests on nothing that is an object.
    support_kind : {"in", "on"} or None
        How the receptacle holds it: "in" what encloses it or has walls around it, else "on".
    facing_deg : float or None
        Where its front looks, degrees counter-clockwise from +x, 0 to 360: who stands before it sees its left on the
        left. None of what has no front, such as a book, and if not known.
    """

    id: str
    type: str
    color: str
    substance: str
    box: Box
    openness: float
    is_picked_up: bool
    support: str | None
    support_kind: SupportKind | None
    facing_deg: float | None = field(default=None, kw_only=True)


@dataclass(frozen=True)
class VisibleObject(ObjectMetadata):
    """One object of which a frame shows enough pixels.

    Attributes
    ----------
    box_2d : tuple of int
        Tight box of its pixels, [x1, y1, x2, y2) half open.
    pixels : int
        How many pixels show it.
    distance_m : float
        From the camera to the nearest point of its 3D box.
    """

    box_2d: Box2D
    pixels: int
    distance_m: float


@dataclass(frozen=True)
class FrameMetadata:
    """One frame: where it was taken and what it shows, in the scene's order."""

    agent: AgentState
    objects: tuple[VisibleObject, ...]


def object_metadata(world: World) -> dict[str, ObjectMetadata]:
    """The ground truth of a whole world as it is now, by id, in the scene's order."""
    boxes = {object_id: world.box(object_id) for object_id in world.ids}
    held_by = supports(world, boxes)
    facing_deg = _facing_deg([world.state(object_id) for object_id in world.ids])
    records = {}
    for object_id, facing in zip(world.ids, facing_deg, strict=True):
        asset = world.assets[object_id]
        support = held_by.get(object_id)
        low, high = boxes[object_id]
        records[object_id] = ObjectMetadata(
            id=object_id,
            type=world.type_of(object_id),
            color=asset.color,
            substance=asset.substance,
            box=(float(low[0]), float(low[1]), float(low[2]), float(high[0]), float(high[1]), float(high[2])),
            openness=float(world.state(object_id).openness),
            is_picked_up=object_id in world.held,
            support=support.id if support else None,
            support_kind=support.kind if support else None,
            facing_deg=facing if object_type(world.type_of(object_id)).has_front else None,
        )
    return records


def frame_metadata(
    world: World,
    observation: Observation,
    agent: AgentState,
    camera: Camera,
    known: Mapping[str, ObjectMetadata] | None = None,
) -> FrameMetadata:
    """What one frame shows: each object of which `scaled_min_pixels` pixels or more are seen.

    Parameters
    ----------
    world : World
        As it was when the frame was drawn.
    observation : Observation
        The frame.
    agent : AgentState
        Where the agent was.
    camera : Camera
        What drew the frame.
    known : mapping, optional
        `object_metadata(world)`, if the caller has it already: for many frames of one unchanged world.
    """
    records = object_metadata(world) if known is None else known
    image = observation.objects
    counts = pixel_counts(image, len(world.ids))
    boxes = find_objects(image + 1)
    eye = np.asarray(camera.position)
    visible = []
    for index in np.flatnonzero(counts >= scaled_min_pixels(image.shape)):
        record = records[world.ids[index]]
        box = np.asarray(record.box)
        visible.append(
            VisibleObject(
                **{name: getattr(record, name) for name in _SHARED},
                box_2d=_box_2d(*boxes[index]),
                pixels=int(counts[index]),
                distance_m=float(arithmetic.length(eye - np.clip(eye, box[:3], box[3:]))),
            )
        )
    return FrameMetadata(agent, tuple(visible))


def scaled_min_pixels(shape: tuple[int, ...]) -> int:
    """Pixels that make an object visible in a frame of a (height, width): the same share of it as in 300 x 300.

    >>> scaled_min_pixels((300, 300)), scaled_min_pixels((600, 600)), scaled_min_pixels((10, 10))
    (50, 200, 1)
    """
    return scaled_pixels(MIN_PIXELS, shape)


def scaled_pixels(count: int, shape: tuple[int, ...]) -> int:
    """So many pixels of a 300 x 300 frame in one that is (height, width), at least one."""
    return max(1, round(count * shape[0] * shape[1] / FRAME_PX**2))


def is_visible(mask: Flags) -> bool:
    """Whether the (h, w) mask of an object in a frame has as many pixels as make it visible."""
    return int(np.count_nonzero(mask)) >= scaled_min_pixels(mask.shape)


def tight_box(mask: Flags) -> Box2D | None:
    """The box [x1, y1, x2, y2) of the pixels of a (h, w) mask, or None where it has none.

    >>> tight_box(np.array([[0, 0, 0], [0, 1, 1]], dtype=bool))
    (1, 1, 3, 2)
    """
    rows, columns = np.nonzero(mask)
    if not len(rows):
        return None
    return int(columns.min()), int(rows.min()), int(columns.max()) + 1, int(rows.max()) + 1


def visible_box(objects: I32, index: int) -> Box2D | None:
    """Tight box of an object's pixels in a (h, w) image of object indices, or None where it is not visible."""
    mask = objects == index
    return tight_box(mask) if is_visible(mask) else None


def changed_pixels(before: FrameImages, after: FrameImages, tolerance_m: float = 0.0) -> int:
    """How many pixels of two frames from the same place show another object, or a depth that differs by more than that.

    A frame is its (h, w) images of object numbers and of depth in metres.
    """
    depth_m = np.abs(np.subtract(before[1], after[1]))
    return int(np.count_nonzero((before[0] != after[0]) | (depth_m > tolerance_m)))


_SHARED = tuple(f.name for f in fields(ObjectMetadata))


def _facing_deg(states: Sequence[ObjectState]) -> list[float]:
    """Where the front of each object, which is at -y of its asset, looks in the world."""
    fronts = np.array([rotation_of(state.quaternion)[:, 1] for state in states]).reshape(-1, 3)
    angles = arithmetic.arctan2(-fronts[:, 1], -fronts[:, 0])
    return [round(math.degrees(angle), 6) % 360.0 for angle in angles.tolist()]


def _box_2d(rows: slice, columns: slice) -> Box2D:
    return int(columns.start), int(rows.start), int(columns.stop), int(rows.stop)
