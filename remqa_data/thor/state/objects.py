"""The `objects` of AI2-THOR's metadata.

What never changes of an object is written down once; poses and boxes only when an object has moved. Each event whose objects
are read gets records of its own, so that an agent may keep events and change them.
"""

from __future__ import annotations

import marshal
import zlib
from collections.abc import Collection, Mapping
from typing import Any, NamedTuple

import numpy as np

from remqa_data.assets.core.model import Asset
from remqa_data.catalog import object_type, types_with
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import rotation_of
from remqa_data.geometry.types import F64, Vec3
from remqa_data.scene import Quaternion
from remqa_data.sim.physics.state import ObjectState
from remqa_data.sim.physics.support import supports
from remqa_data.sim.physics.world import World
from remqa_data.thor.object_states.conditions import FILLED, Conditions
from remqa_data.thor.state.frames import (
    Vector,
    corners_to_thor,
    euler_to_thor,
    object_frames,
    to_room,
    to_thor,
    turn_to_room,
    turn_to_thor,
)

Metadata = dict[str, Any]
"""A part of an event's metadata: what AI2-THOR would send as JSON."""


class InHand(NamedTuple):
    """How an object is that is held, whether it is not only in or on what is, and whether the agent of the event sees it."""

    state: ObjectState
    is_itself: bool
    is_seen: bool


class Copy(NamedTuple):
    """What an object is that was copied: of which one it is a copy, and its `name` in the metadata."""

    original: str
    name: str


class ObjectRecords:
    """The metadata of all objects of a world.

    Parameters
    ----------
    world : World
        Whose objects; later changes of it are followed.

    Attributes
    ----------
    conditions : Conditions
        What they are in besides where they are. Nothing in the world depends on it.
    sliced : set of str
        Those of the objects that are away from the scene that have been sliced: they are listed all the same, where they were.
    copies : dict of str to Copy
        The objects that were copied, by their ids.
    """

    def __init__(self, world: World) -> None:
        self.conditions = Conditions(world)
        self.sliced: set[str] = set()
        self.copies: dict[str, Copy] = {}
        self._world = world
        self._masses: dict[str, float] = {}
        self._frames = object_frames(world.scene)
        self._static = self._statics()
        self._shown: dict[str, ObjectState] = {}
        self._held = frozenset[str]()
        self._revision: int | None = None
        self._boxes: dict[str, F64] = {}
        self._moving: dict[str, Metadata] = {}
        self._records: dict[str, Metadata] = {}
        self._lists = marshal.dumps([])
        self._contents: dict[str, list[str]] = {}
        self._positions = np.zeros((len(world.ids), 3))

    def take_over(self, before: ObjectRecords) -> None:
        """Go on from the records of the same room with fewer objects."""
        self.conditions.take_over(before.conditions)
        self.sliced, self.copies, self._masses = before.sliced, before.copies, before._masses
        for object_id, copy in self.copies.items():
            if copy.original in self._frames:
                self._frames[object_id] = self._frames[copy.original]
        self._write_anew()
        for object_id in self.sliced:
            self._moving[object_id] = before._moving[object_id]
            self._positions[self._world.ids.index(object_id)] = to_room(self._moving[object_id]["position"])

    def position(self, object_id: str) -> Vec3:
        """Where AI2-THOR says an object is, metres in the room: its pivot, such as a door's hinge."""
        return self._position_in(object_id, self._world.state(object_id))

    def _position_in(self, object_id: str, state: ObjectState) -> Vec3:
        frame = self._frames.get(object_id)
        if frame is None:
            return state.position
        x, y, z = (rotation_of(state.quaternion) @ frame.pivot + np.asarray(state.position)).tolist()
        return x, y, z

    def rotation(self, object_id: str) -> Vector:
        """How AI2-THOR says an object is turned: as recorded, and with it since, whichever side its front is on."""
        return euler_to_thor(self.turn(object_id))

    def mass_kg(self, object_id: str) -> float:
        """What an object weighs; 1 if that is not known."""
        return self._masses.get(object_id) or object_type(self._world.type_of(object_id)).mass_kg or 1.0

    def set_mass(self, object_id: str, mass_kg: float) -> None:
        """Let an object weigh something else."""
        self._masses[object_id] = mass_kg
        self._write_anew()

    def id_of(self, name: str) -> str | None:
        """The object with this `name` or id, if there is one."""
        names = {str(record["name"]): object_id for object_id, record in self._static.items()}
        return name if name in self._static else names.get(name)

    def copy_of(self, object_id: str, copy_id: str, name: str) -> None:
        """Say that an object that is not there yet will be a copy of one, and like it in all that is known of that."""
        self.copies[copy_id] = Copy(object_id, name)
        if object_id in self._masses:
            self._masses[copy_id] = self._masses[object_id]
        if changed := self.conditions.of(object_id):
            self.conditions.change(copy_id, **changed)

    def name_of(self, object_id: str) -> str:
        """The `name` of an object."""
        return str(self._static[object_id]["name"])

    def turn(self, object_id: str) -> F64:
        """(3, 3) how AI2-THOR says an object is turned, in its frame."""
        return self._turn_in(object_id, self._world.state(object_id))

    def _turn_in(self, object_id: str, state: ObjectState) -> F64:
        turn, frame = turn_to_thor(state.quaternion), self._frames.get(object_id)
        return turn if frame is None else arithmetic.product(turn, frame.turn)

    def pose_of(self, object_id: str, pivot: Vec3, turn: F64) -> tuple[Vec3, Quaternion]:
        """Pose of an object's box, if `position` and `turn` are to be these; metres in the room, snapped."""
        frame = self._frames.get(object_id)
        quaternion = turn_to_room(turn if frame is None else arithmetic.product(turn, frame.turn.T))
        offset = np.zeros(3) if frame is None else arithmetic.turned(frame.pivot, rotation_of(quaternion))
        x, y, z = arithmetic.snapped(np.asarray(pivot) - offset).tolist()
        return (x, y, z), quaternion

    def listing(
        self, agent: Vec3, visible: Collection[str], hands: Mapping[str, InHand], only: Collection[str] | None
    ) -> list[Metadata]:
        """The metadata of all objects as they were at the last `update`.

        Parameters
        ----------
        agent : tuple of float
            Where AI2-THOR says the agent is, metres in the room; distances are measured from there.
        visible : collection of str
            Ids of the objects that the agent sees within its visibility distance.
        hands : mapping
            By the ids of the objects that are held: where they are.
        only : collection of str, optional
            Ids of the objects to list, by default all.
        """
        lit = self.conditions.lit_burners()
        distances = np.linalg.norm(self._positions - np.asarray(agent), axis=1).tolist()
        listed, changed = [], self.conditions.changed
        for object_id, distance, lists in zip(self._world.ids, distances, marshal.loads(self._lists), strict=True):
            is_away = object_id in self._world.away and object_id not in self.sliced
            if is_away or (only is not None and object_id not in only):
                continue
            record = self._records[object_id].copy()
            record.update(zip(_LISTS, lists, strict=True))
            record["visible"] = record["isInteractable"] = object_id in visible
            if object_id in changed:
                record.update(changed[object_id])
            if object_id in lit:
                record["isToggled"] = True
            record["distance"] = distance
            if object_id in hands:
                self._put_into_hand(record, agent, hands[object_id])
            listed.append(record)
        return listed

    def update(self) -> None:
        """Follow the world, and let what is on or cold do what it does."""
        self._follow()
        self.conditions.spread(self._contents)

    def _follow(self) -> None:
        """Bring the records up to the world's state; states are replaced, never changed, so identity tells."""
        world = self._world
        if world.revision == self._revision:
            return
        self._revision = world.revision
        moved = [name for name in world.ids if world.state(name) is not self._shown.get(name)]
        if not moved and world.held.keys() == self._held and self._shown:
            return
        for object_id in moved:
            self._shown[object_id] = world.state(object_id)
            self._boxes[object_id] = world.box(object_id)
            if object_id not in self.sliced:
                self._moving[object_id] = self._pose_and_boxes(object_id)
                self._positions[world.ids.index(object_id)] = self.position(object_id)
            if self.conditions.of(object_id).get(FILLED) and self.turn(object_id)[1, 1] < 0.0:
                self.conditions.put(object_id, FILLED, False)  # it is turned over
        self._held = frozenset(world.held)
        parents, self._contents = _parents_and_contents(world, self._boxes, world.away)
        holding = _holding(world, parents, self._contents)
        self._records = {
            object_id: {**self._static[object_id], **self._moving[object_id], **holding[object_id]}
            for object_id in world.ids
        }
        # The quickest way to many copies of plain lists and dicts.
        self._lists = marshal.dumps([[record[name] for name in _LISTS] for record in self._records.values()])

    def _write_anew(self) -> None:
        self._static = self._statics()
        self._shown, self._revision = {}, None

    def _statics(self) -> dict[str, Metadata]:
        controlled = self.conditions.controlled
        records = {name: _static(self._world, name, controlled.get(name)) for name in self._world.ids}
        for name, mass_kg in self._masses.items():
            records[name]["mass"] = mass_kg
        for name, copy in self.copies.items():
            records[name]["name"] = copy.name
        return records

    def _pose_and_boxes(self, object_id: str) -> Metadata:
        state, kind = self._world.state(object_id), object_type(self._world.type_of(object_id))
        oriented = None
        if kind.is_loose:
            oriented = {"cornerPoints": corners_to_thor(_oriented_corners(self._world.assets[object_id], state))}
        return {
            "position": to_thor(self.position(object_id)),
            "rotation": self.rotation(object_id),
            "openness": float(state.openness),
            "isOpen": state.openness > 0,
            "axisAlignedBoundingBox": box_metadata(self._boxes[object_id]),
            "objectOrientedBoundingBox": oriented,
        }

    def _put_into_hand(self, record: Metadata, agent: Vec3, hand: InHand) -> None:
        """A held object is nowhere in the world; its metadata say that it is in the hand, and turns with it."""
        object_id, state = record["objectId"], hand.state
        asset, position = self._world.assets[object_id], self._position_in(object_id, state)
        record["isPickedUp"] = hand.is_itself
        record["visible"] = record["isInteractable"] = hand.is_seen
        record["position"], record["rotation"] = to_thor(position), euler_to_thor(self._turn_in(object_id, state))
        record["distance"] = float(np.linalg.norm(np.asarray(position) - np.asarray(agent)))
        record["axisAlignedBoundingBox"] = box_metadata(asset.box_at(state.link_poses(asset)))
        record["objectOrientedBoundingBox"] = {"cornerPoints": corners_to_thor(_oriented_corners(asset, state))}


def box_metadata(box: F64) -> Metadata:
    """AI2-THOR's description of an axis-aligned box, given as its (2, 3) corners in the room, metres."""
    low, high = box
    return {
        "cornerPoints": corners_to_thor(np.where(_CORNERS > 0, high, low)),
        "center": to_thor((low + high) / 2),
        "size": to_thor(high - low),
    }


def _static(world: World, object_id: str, controlled: str | None) -> Metadata:
    """What does not change, and the conditions that all begin in."""
    type_name = world.type_of(object_id)
    kind, asset = object_type(type_name), world.assets[object_id]
    return {
        "name": f"{type_name}_{zlib.crc32(object_id.encode()):08x}",
        "position": {},
        "rotation": {},
        "visible": False,
        "isInteractable": False,
        "receptacle": kind.receptacle,
        "toggleable": kind.toggleable,
        "isToggled": False,
        "breakable": kind.breakable,
        "isBroken": False,
        "canFillWithLiquid": kind.fillable,
        "isFilledWithLiquid": False,
        "fillLiquid": None,
        "dirtyable": kind.dirtyable,
        "isDirty": False,
        "canBeUsedUp": kind.used_up,
        "isUsedUp": False,
        "cookable": kind.cookable,
        "isCooked": False,
        "temperature": "RoomTemp",
        "isHeatSource": False,
        "isColdSource": False,
        "sliceable": kind.sliceable,
        "isSliced": False,
        "openable": asset.is_openable,
        "isOpen": False,
        "openness": 0.0,
        "pickupable": kind.pickupable,
        "isPickedUp": False,
        "moveable": kind.moveable,
        "mass": kind.mass_kg if kind.is_loose and kind.mass_kg else 0.0,
        "salientMaterials": list(kind.materials) if kind.is_loose else None,
        "receptacleObjectIds": None,
        "distance": 0.0,
        "objectType": type_name,
        "objectId": object_id,
        "assetId": f"{type_name}_{asset.spec.variant}",
        "parentReceptacles": None,
        "controlledObjects": [controlled] if controlled else ([] if kind.toggleable else None),
        "isMoving": False,
        "axisAlignedBoundingBox": {},
        "objectOrientedBoundingBox": None,
    }


Lists = dict[str, list[str]]


def _parents_and_contents(
    world: World, boxes: Mapping[str, F64], away: Mapping[str, ObjectState]
) -> tuple[Lists, Lists]:
    """What holds each object, and what each object holds; on the top of a microwave, things are not in it.

    All that is out of the scene is kept in one place: nothing holds it, and it holds nothing.
    """
    parents: Lists = {object_id: [] for object_id in world.ids}
    contents: Lists = {object_id: [] for object_id in world.ids}
    for object_id, support in supports(world, boxes, by_agents=True).items():
        if object_id in away or support.id in away:
            continue
        if support.kind == "on" and world.type_of(support.id) in types_with("takes_in"):
            continue
        parents[object_id].append(support.id)
        contents[support.id].append(object_id)
    for held in (name for name in world.held if object_type(world.type_of(name)).receptacle):
        for object_id in world.load_of(held):
            parents[object_id].append(held)
            contents[held].append(object_id)
    return parents, contents


def _holding(world: World, parents: Lists, contents: Lists) -> dict[str, Metadata]:
    """The same in AI2-THOR's words; what holds something is a receptacle, such as the sinks of some rooms."""
    found = {}
    for object_id in world.ids:
        held, is_receptacle = contents[object_id], object_type(world.type_of(object_id)).receptacle
        found[object_id] = {
            "parentReceptacles": parents[object_id] or None,
            "receptacle": is_receptacle or bool(held),
            "receptacleObjectIds": held if held or is_receptacle else None,
        }
    return found


def _oriented_corners(asset: Asset, state: ObjectState) -> F64:
    """(8, 3) corners of the box of an object as it is turned, with what of it is open, metres."""
    half = np.asarray(asset.spec.size) / 2
    low, high = -half, half
    if state.openness > 0.0:
        opened = asset.box_at(asset.link_poses(state.openness))
        low, high = np.minimum(low, opened[0]), np.maximum(high, opened[1])
    pose = state.matrix()
    return np.asarray(np.where(_CORNERS > 0, high, low) @ pose[:3, :3].T + pose[:3, 3])


_LISTS = (
    "position",
    "rotation",
    "axisAlignedBoundingBox",
    "objectOrientedBoundingBox",
    "salientMaterials",
    "receptacleObjectIds",
    "parentReceptacles",
    "controlledObjects",
)
"""What is a list or a dict in a record."""
_CORNERS = np.array([[x, y, z] for z in (-1.0, 1.0) for y in (-1.0, 1.0) for x in (-1.0, 1.0)])
