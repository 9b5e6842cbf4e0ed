"""Where things are said to be: set to poses, placed at points.

What is moved comes to rest: it falls from where it was put, and a piece of furniture stands still afterwards. What would
end up in something else is refused, and the room is as before.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import NotRequired

import numpy as np
from typing_extensions import TypedDict

from remqa_data.catalog import object_type
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec3
from remqa_data.scene import Quaternion
from remqa_data.sim.agent import handling
from remqa_data.sim.agent.receptacles import lattice, open_spaces
from remqa_data.sim.agent.results import ActionResult
from remqa_data.sim.physics.state import ObjectState
from remqa_data.thor.actions.targets import copy_id_of, not_there, of_type
from remqa_data.thor.state.dispatch import ActionFunction, missing_argument
from remqa_data.thor.state.floor_plan import LoadedFloorPlan
from remqa_data.thor.state.frames import PartialVector, to_room, to_thor, turn_of_euler, whole
from remqa_data.thor.state.rest import come_to_rest, sunken
from remqa_data.thor.state.simulator import SimulatorState

SAME_M, SAME_COSINE = 1e-4, 1.0 - 1e-9
"""A pose that is so near to where an object is, or was when the room was loaded, is that pose."""
RECORDED_NAME = re.compile("([A-Z][A-Za-z]*)_[0-9a-f]{8}")
"""What AI2-THOR calls an object: its type and eight hexadecimal digits."""
MOST_STUCK_M = 0.02
"""What physics leaves in something by no more than this, among many things that were put somewhere at once, may stay there."""
BESIDE_M = 0.05
"""So far beyond the room's walls and floor a position may be: things lean, and their middles may be below what they show."""
ON_FLOOR_M = 0.02
"""A ray from above meets a receptacle so near to the floor of its space where nothing lies."""


class ObjectPose(TypedDict):
    """Where an object is to be, by its name in the metadata or by its id."""

    objectName: NotRequired[str]
    objectId: NotRequired[str]
    position: PartialVector
    rotation: NotRequired[PartialVector]


def set_object_poses(
    simulator: SimulatorState,
    objectPoses: list[ObjectPose],
    placeStationary: bool = True,
    forceAction: bool = False,
    skipMoveable: bool = False,
) -> ActionResult:
    """Put all that is pickupable or moveable where it is said to be; what is not mentioned leaves the scene.

    An object that is given several poses is copied. What is put into something is moved to the nearest place where there is
    room, or with `forceAction` left to physics to drive out. With `skipMoveable`, what is only moveable stays if it is not
    mentioned. As in AI2-THOR, a name that there is not is told, and the rest done.
    """
    poses, copies, complaint = _poses_by_id(simulator, objectPoses)
    if not poses:
        return ActionResult(not complaint, complaint)
    room = simulator.room
    room.copy(copies, "(Clone)_copy_", simulator.settings)
    world = room.world
    before, moved = world.save(), []
    for object_id, pose in poses.items():
        state = _wanted(room, object_id, pose)
        if state is not world.state(object_id) or object_id in world.held:
            for name, placed in {object_id: state, **_parts_with(room, object_id, state)}.items():
                world.put_back(name, placed)
                moved.append(name)
    for name in world.ids:
        if name not in poses and _leaves(world.type_of(name), skipMoveable):
            room.take_away(name)
    if not forceAction:
        for name in sorted(moved, key=lambda name: (float(world.box(name)[0, 2]), name)):  # the lowest first
            is_whole = name in poses and not world.built_into(name)
            if is_whole and world.state(name) is not room.at_rest.states.get(name):
                handling.move_out(world, name, room.depths)
    stuck = come_to_rest(room, moved, MOST_STUCK_M)
    if stuck is not None:
        world.restore(before)
        return ActionResult(False, f"the poses put {stuck[0]} into {stuck[1]}")
    return ActionResult(not complaint, complaint)


def _poses_by_id(
    simulator: SimulatorState, wanted: Sequence[ObjectPose]
) -> tuple[dict[str, ObjectPose], dict[str, str], str]:
    """The poses by the ids of the objects, which of them are copies of which, and why the last one that has none has none."""
    world, records = simulator.room.world, simulator.room.records
    known = {name: object_id for pose in wanted if (object_id := records.id_of(name := _named(pose))) is not None}
    known |= _meant_by_others(simulator, wanted, known)
    poses: dict[str, ObjectPose] = {}
    copies: dict[str, str] = {}
    complaint = ""
    for number, pose in enumerate(wanted):
        name = _named(pose)
        object_id = known.get(name)
        if object_id is None or not object_type(world.type_of(object_id)).is_loose:
            complaint = f"No Pickupable or Moveable object of name {name} found in scene."
            continue
        if object_id in records.sliced:
            complaint = f"{object_id} has been sliced"
            continue
        if object_id in poses:
            copy_id = copy_id_of(object_id, number, poses)
            copies[copy_id] = object_id
            object_id = copy_id
        poses[object_id] = pose
    return poses, copies, complaint


def _named(pose: ObjectPose) -> str:
    return pose.get("objectId") or pose.get("objectName") or ""


def _meant_by_others(
    simulator: SimulatorState, wanted: Sequence[ObjectPose], known: Mapping[str, str]
) -> dict[str, str]:
    """Which objects are meant by names that AI2-THOR has recorded, whose digits are others than ours.

    A name stands for an object of its type that no other name stands for, of several for the one that is nearest to its pose.
    """
    room, found, taken = simulator.room, dict[str, str](), set(known.values())
    for pose in wanted:
        name = _named(pose)
        type_name = RECORDED_NAME.fullmatch(name)
        if name in known or name in found or type_name is None:
            continue
        ids = of_type(simulator, type_name[1])
        free = [one for one in ids if one not in room.records.copies and one not in taken]
        there = to_room(whole(pose["position"]))
        if free:
            found[name] = min(free, key=lambda one: (math.dist(room.records.position(one), there), one))
            taken.add(found[name])
    return found


def place_object_at_point(
    simulator: SimulatorState,
    objectId: str,
    position: PartialVector | None = None,
    rotation: PartialVector | None = None,
    forceKinematic: bool = False,
    positions: list[PartialVector] | None = None,
) -> ActionResult:
    """Put the bottom of an object's box at a point, or the first of some, with what is in or on it; it comes to rest."""
    places = _places("PlaceObjectAtPoint", position, positions)
    return _first_that_works(_place_at(simulator, objectId, place, rotation) for place in places)


def _place_at(
    simulator: SimulatorState, objectId: str, position: PartialVector, rotation: PartialVector | None
) -> ActionResult:
    room, world = simulator.room, simulator.room.world
    if (refusal := not_there(simulator, objectId) or _out_of_bounds(room, position)) is not None:
        return refusal
    if not object_type(world.type_of(objectId)).is_loose:
        return ActionResult(False, f"{objectId} is neither pickupable nor moveable")
    before = world.save()
    if objectId in world.held:
        world.put(objectId, world.state(objectId).position)
    quaternion = world.state(objectId).quaternion
    if rotation is not None:
        quaternion = room.records.pose_of(objectId, (0.0, 0.0, 0.0), turn_of_euler(whole(rotation)))[1]
    parts = world.built_into(objectId)
    moved = [objectId, *world.move(objectId, world.state(objectId).position, quaternion, along=parts)]
    low, high = world.box(objectId)
    bottom = np.array([*(low + high)[:2] / 2, low[2] - handling.GAP_M])
    x, y, z = arithmetic.snapped(
        world.state(objectId).position + np.asarray(to_room(whole(position))) - bottom
    ).tolist()
    world.move(objectId, (x, y, z), along=parts)
    stuck = sunken(room, moved, as_one=True) or come_to_rest(room, moved)
    if stuck is not None:
        world.restore(before)
        return ActionResult(False, f"spawn area not clear ({stuck[1]} is in the way), can't place object at that point")
    simulator.agent.rest_hand()
    return ActionResult(True, value=to_thor(room.records.position(objectId)))


def teleport_object_to_floor(
    simulator: SimulatorState, objectId: str, x: float, z: float, rotation: PartialVector | None = None
) -> ActionResult:
    """Put an object on the floor, with the middle of its box above a point; it comes to rest."""
    if objectId in simulator.room.world.held:
        return ActionResult(False, "Cannot teleport object in hand.")
    return _place_at(simulator, objectId, {"x": x, "y": simulator.room.world.scene.floor_z, "z": z}, rotation)


def teleport_object(
    simulator: SimulatorState,
    objectId: str,
    position: PartialVector | None = None,
    rotation: PartialVector | None = None,
    positions: list[PartialVector] | None = None,
    forceAction: bool = False,
    allowTeleportOutOfHand: bool = False,
    forceKinematic: bool = False,
    makeUnbreakable: bool = False,
    x: float | None = None,
    y: float | None = None,
    z: float | None = None,
) -> ActionResult:
    """Put an object to a position, or to the first of some where there is room, with what is in or on it.

    A position is that of its metadata. What is loose comes to rest from there, with `forceKinematic` too; with `forceAction`
    it may be put into other things, and physics drives them apart. What is built in stays where it is put.
    """
    room, world = simulator.room, simulator.room.world
    if (refusal := not_there(simulator, objectId)) is not None:
        return refusal
    if objectId in world.held and not allowTeleportOutOfHand:
        return ActionResult(False, f"{objectId} is in the hand, and allowTeleportOutOfHand is not set")
    if position is None and None not in (x, y, z):
        position = {"x": x or 0.0, "y": y or 0.0, "z": z or 0.0}
    places = _places("TeleportObject", position, positions)
    turn = room.records.turn(objectId) if rotation is None else turn_of_euler(whole(rotation))
    done = _first_that_works(_teleport_to(simulator, objectId, place, turn, forceAction) for place in places)
    return replace(done, value=None) if positions else done


def _teleport_to(
    simulator: SimulatorState, objectId: str, position: PartialVector, turn: F64, force: bool
) -> ActionResult:
    room, world = simulator.room, simulator.room.world
    if (refusal := _out_of_bounds(room, position)) is not None:
        return refusal
    before, was_held = world.save(), objectId in world.held
    if was_held:
        world.put(objectId, world.state(objectId).position)
    pivot, quaternion = room.records.pose_of(objectId, to_room(whole(position)), turn)
    if was_held or not _is_same(world.state(objectId), pivot, quaternion):
        moved = [objectId, *world.move(objectId, pivot, quaternion, along=world.built_into(objectId))]
        home = room.at_rest.states.get(objectId)
        is_home = home is not None and _is_same(home, pivot, quaternion)  # there it was at rest, or it hung
        stuck = None if force else sunken(room, moved, as_one=True)
        if stuck is None and not is_home:
            stuck = come_to_rest(room, moved)
        if stuck is not None and not force:
            world.restore(before)
            return ActionResult(False, f"{stuck[1]} is in the way of {objectId}")
    simulator.agent.rest_hand()
    return ActionResult(True, value=to_thor(room.records.position(objectId)))


def get_spawn_coordinates_above_receptacle(
    simulator: SimulatorState, objectId: str, anywhere: bool = False
) -> ActionResult:
    """Points of a receptacle on which nothing lies; with `anywhere` those, too, that are out of the frame or of reach."""
    agent, world = simulator.agent, simulator.room.world
    if (refusal := not_there(simulator, objectId)) is not None:
        return refusal
    if not object_type(world.type_of(objectId)).receptacle:
        return ActionResult(False, f"{objectId} is not a receptacle")
    if not anywhere and objectId not in agent.visible_objects(simulator.settings.visibility_distance):
        return ActionResult(False, "No valid Receptacle found in view")
    links = world.link_poses(objectId)
    found: list[Vec3] = []
    for space in open_spaces(world, objectId):
        for x, y, z in lattice(links[space.link], space):
            hit = world.first_hit((x, y, z + space.box[5] - space.box[2]), (x, y, z - ON_FLOOR_M))
            if hit is not None and hit[0] == objectId and abs(hit[1][2] - z) <= ON_FLOOR_M:
                found.append(hit[1])
    found = [point for point in found if _is_within(simulator.room, point)]
    if not anywhere:
        offsets = [agent.offset_of(np.asarray(point)) for point in found]
        reach = simulator.settings.visibility_distance
        found = [
            point
            for point, offset in zip(found, offsets, strict=True)
            if agent.has_in_frame(offset) and float(arithmetic.length(offset)) <= reach
        ]
    return ActionResult(True, value=[to_thor(point) for point in found])


ACTIONS: dict[str, ActionFunction] = {
    "GetSpawnCoordinatesAboveReceptacle": get_spawn_coordinates_above_receptacle,
    "PlaceObjectAtPoint": place_object_at_point,
    "SetObjectPoses": set_object_poses,
    "TeleportObject": teleport_object,
    "TeleportObjectToFloor": teleport_object_to_floor,
}


def _places(action: str, position: PartialVector | None, positions: list[PartialVector] | None) -> list[PartialVector]:
    """Where an action is to put an object, the best place first."""
    places = positions or ([] if position is None else [position])
    if not places:
        raise missing_argument(action, "position")
    return places


def _first_that_works(tries: Iterable[ActionResult]) -> ActionResult:
    """The first success of some tries, of which there is one at least, or the last failure; none is made after a success."""
    for result in tries:
        if result.success:
            break
    return result


def _out_of_bounds(room: LoadedFloorPlan, position: PartialVector) -> ActionResult | None:
    """That a position is not in the room, if it is not."""
    if _is_within(room, to_room(whole(position))):
        return None
    words = ", ".join(f"{value:g}" for value in whole(position).values())
    return ActionResult(False, f"Position coordinate ({words}) is not within scene bounds")


def _is_within(room: LoadedFloorPlan, point: Vec3) -> bool:
    low, high = room.box()
    return bool((low - BESIDE_M <= point).all() and (point <= high + BESIDE_M).all())


def _is_same(state: ObjectState, position: Vec3, quaternion: Quaternion) -> bool:
    """Whether an object in a state is at a pose."""
    apart = arithmetic.length(np.subtract(state.position, position))
    return bool(apart < SAME_M) and abs(float(arithmetic.dot(state.quaternion, quaternion))) > SAME_COSINE


def _leaves(type_name: str, skips_moveable: bool) -> bool:
    """Whether objects of a type leave the scene if no pose is given for them."""
    kind = object_type(type_name)
    return kind.pickupable if skips_moveable else kind.is_loose


def _wanted(room: LoadedFloorPlan, object_id: str, pose: ObjectPose) -> ObjectState:
    """The state that a pose asks for: the one that the object has, or had when the room was loaded, if that is it."""
    now = room.world.state_when_there(object_id)
    loaded = room.at_rest.states.get(object_id, now)  # slices and copies were not there then
    position, quaternion = room.records.pose_of(
        object_id, to_room(whole(pose["position"])), turn_of_euler(whole(pose.get("rotation", {})))
    )
    wanted = replace(now, position=position, quaternion=quaternion, is_fixed=loaded.is_fixed)
    for known in (now, replace(loaded, openness=now.openness) if now.openness != loaded.openness else loaded):
        if _is_same(known, position, quaternion):
            return known
    return wanted


def _parts_with(room: LoadedFloorPlan, object_id: str, state: ObjectState) -> dict[str, ObjectState]:
    """The states of what a piece of furniture is made of, once that is in another state, by their ids."""
    world = room.world
    before = world.state_when_there(object_id)
    motion = arithmetic.product(state.matrix(), arithmetic.inverse(before.matrix()))
    return {part: world.state_when_there(part).moved(motion) for part in world.built_into(object_id)}
