"""From the simulator state to what AI2-THOR sends after an action: metadata and pictures."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import AbstractContextManager
from copy import deepcopy
from dataclasses import dataclass

from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import Vec3
from remqa_data.sim.agent.results import ActionResult
from remqa_data.sim.render.view import Observation
from remqa_data.thor.state.arm_metadata import arm_metadata
from remqa_data.thor.state.floor_plan import LoadedFloorPlan
from remqa_data.thor.state.frames import Vector, euler_to_thor, to_thor, turn_of_look, yaw_to_thor
from remqa_data.thor.state.images import Palette, as_bytes, depth_bytes
from remqa_data.thor.state.objects import InHand, Metadata, box_metadata
from remqa_data.thor.state.settings import Images
from remqa_data.thor.state.simulator import SimulatorState

Files = dict[str, list[bytes]]


class Listing:
    """The `objects` of an event, worked out when they are first read.

    Most of a step without pictures would go into them: some 80 records of 40 facts, and a look at what is visible.

    Parameters
    ----------
    work_out : callable
        What gives them while the room is as it was at the event. It must be `read` before the room changes.
    lock : context manager
        Held meanwhile, and by who changes the room: clients read events in one thread and step in another.
    """

    def __init__(self, work_out: Callable[[], list[Metadata]], lock: AbstractContextManager[object]) -> None:
        self._work_out: Callable[[], list[Metadata]] | None = work_out
        self._lock = lock
        self._found: list[Metadata] = []

    def read(self) -> list[Metadata]:
        """The objects, the same list each time."""
        with self._lock:
            if self._work_out is not None:
                self._found, self._work_out = self._work_out(), None
            return self._found


@dataclass(frozen=True)
class Reply:
    """What AI2-THOR's Python side makes an event of.

    Attributes
    ----------
    active : int
        Number of the agent that has acted.
    metadata : list of dict
        Of each agent, without the objects.
    objects : list of Listing
        Of each agent.
    files : dict of str to list of bytes
        Pictures by their names, in the order of the agents, or of the third party cameras.
    """

    active: int
    metadata: list[Metadata]
    objects: list[Listing]
    files: Files


@dataclass(frozen=True)
class Outcome:
    """What came of an action.

    Attributes
    ----------
    action : str
        Its name.
    result : ActionResult
        What came of it.
    code : str, optional
        AI2-THOR's errorCode, where it has one: of an action that could not be read, for instance.
    """

    action: str
    result: ActionResult
    code: str | None = None


def reply(simulator: SimulatorState, outcomes: Mapping[int, Outcome], images: Images) -> Reply:
    """The state after an action.

    Parameters
    ----------
    simulator : SimulatorState
        The state.
    outcomes : mapping
        Of the last action of each agent that has acted, by its number.
    images : Images
        Which pictures to send.
    """
    files: Files = defaultdict(list)
    if not simulator.has_room:
        files["image"].append(bytes(3 * simulator.frame.width * simulator.frame.height))
        return Reply(
            0, [_outcome(outcomes.get(0, NOTHING_DONE), 0) | _about(simulator)], [Listing(list, simulator.lock)], files
        )
    room, active = simulator.room, simulator.room.active
    room.show_conditions()
    if not images.none:
        settings = simulator.settings
        are_seen = settings.shows_agents and (len(room.agents) > 1 or simulator.cameras or settings.has_arm)
        room.have_bodies(len(room.agents) if are_seen else 0)
    metadata, objects = [], []
    for number in range(len(room.agents)):
        room.active = number
        outcome = _outcome(outcomes.get(number, NOTHING_DONE), number)
        if len(room.agents) > 1:  # it is told again while the others act
            outcome["actionReturn"] = deepcopy(outcome["actionReturn"])
        metadata.append(outcome | _about(simulator) | _state(simulator, images))
        objects.append(_listing(simulator, _seen(simulator, images, files)))
    room.active = active
    if not images.none:
        for third in simulator.cameras:
            camera = third.camera(simulator.frame)
            drawn = room.picture(camera, room.shown_to(camera), simulator.quality)
            _add(files, _THIRD_PARTY_FILES, drawn, images, room.palette, simulator.settings.far_plane)
    return Reply(active, metadata, objects, files)


def _about(simulator: SimulatorState) -> Metadata:
    return {
        "screenWidth": simulator.frame.width,
        "screenHeight": simulator.frame.height,
        "sceneName": simulator.scene_name,
    }


def _seen(simulator: SimulatorState, images: Images, files: Files) -> Callable[[], Collection[str]]:
    """What gives the ids of the objects that the agent sees, while the room is as it is; its pictures go to the files."""
    room, distance = simulator.room, simulator.settings.visibility_distance
    look = room.agent.look_around(distance)
    if images.none:
        return look
    camera = room.frame_camera()
    only = room.shown_to(camera)
    shown = room.picture(camera, only, simulator.quality, room.agent)
    _add(files, _AGENT_FILES, shown, images, room.palette, simulator.settings.far_plane)
    if only is not None or room.shows_map or room.shows_own_hand:
        return look
    return room.agent.look_at(shown, distance)


def _listing(simulator: SimulatorState, visible: Callable[[], Collection[str]]) -> Listing:
    """The objects as the agent that acts finds them."""
    return Listing(_recorded(simulator, visible, simulator.shown_objects), simulator.lock)


def object_records(simulator: SimulatorState, object_ids: Collection[str]) -> list[Metadata]:
    """The metadata of some objects as the agent that acts finds them."""
    seen = simulator.room.agent.look_around(simulator.settings.visibility_distance)
    return _recorded(simulator, seen, object_ids)()


def _recorded(
    simulator: SimulatorState, visible: Callable[[], Collection[str]], only: Collection[str] | None
) -> Callable[[], list[Metadata]]:
    room = simulator.room
    records, agent = room.records, room.agent_position()
    hands = {
        name: InHand(state, name in who.in_hand, who is room.agent and who.has_in_frame(who.offset_of(state.position)))
        for who in room.agents
        for name, state in who.states_of_held().items()
    }
    return lambda: records.listing(agent, frozenset(visible()), hands, only)


def _state(simulator: SimulatorState, images: Images) -> Metadata:
    """What the agent that acts finds, but for the objects."""
    room = simulator.room
    metadata: Metadata = {
        "sceneBounds": box_metadata(room.box()),
        "colors": room.palette.metadata() if images.colors else None,
        "thirdPartyCameras": [camera.metadata(index) for index, camera in enumerate(simulator.cameras)],
        "arm": arm_metadata(room) if simulator.settings.has_arm else None,
    }
    return metadata | _agent(room, room.agent.hand_at())


NOTHING_DONE = Outcome("Pass", ActionResult(True))
"""What is said of an agent that has not acted."""
_AGENT_FILES = ("image", "image_depth", "image_ids", "image_classes")
_THIRD_PARTY_FILES = (
    "image-thirdParty-camera",
    "image_thirdParty_depth",
    "image_thirdParty_image_ids",
    "image_thirdParty_classes",
)


def _add(files: Files, names: Sequence[str], seen: Observation, images: Images, palette: Palette, far_m: float) -> None:
    color, depth, instances, types = names
    if images.color:
        files[color].append(as_bytes(seen.rgb))
    if images.depth:
        files[depth].append(depth_bytes(seen.depth, far_m))
    if images.instances or images.types:
        rows = palette.rows(seen)
        if images.instances:
            files[instances].append(as_bytes(palette.instances(rows)))
        if images.types:
            files[types].append(as_bytes(palette.types(rows)))


def _outcome(done: Outcome, agent: int) -> Metadata:
    """All keys of the metadata: what the action says, and what has a meaning in no room of ours."""
    action, result, code = done.action, done.result, done.code
    return {
        "isSceneAtRest": True,
        "agent": None,
        "heldObjectPose": None,
        "arm": None,
        "fov": 90.0,
        "cameraPosition": None,
        "cameraOrthSize": -1.0,
        "thirdPartyCameras": [],
        "collided": result.blocked_by is not None,
        "collidedObjects": [] if result.blocked_by is None else [result.blocked_by],
        "inventoryObjects": [],
        "sceneName": "",
        "lastAction": action,
        "errorMessage": result.error,
        "errorCode": code,
        "lastActionSuccess": result.success,
        "screenWidth": 0,
        "screenHeight": 0,
        "agentId": agent,
        "colors": None,
        "depthFormat": "Meters",
        "flatSurfacesOnGrid": [],
        "distances": [],
        "normals": [],
        "isOpenableGrid": [],
        "segmentedObjectIds": [],
        "objectIdsInBox": [],
        "actionIntReturn": 0,
        "actionFloatReturn": 0.0,
        "actionStringsReturn": [],
        "actionFloatsReturn": [],
        "actionVector3sReturn": [],
        "visibleRange": None,
        "currentTime": 0.0,
        "sceneBounds": None,
        "actionReturn": result.value,
    }


def _agent(room: LoadedFloorPlan, hand: Vec3) -> Metadata:
    agent, world = room.agent, room.world
    above = room.map_camera() if room.shows_map else None
    rotation: Vector = {"x": 0.0, "y": yaw_to_thor(agent.yaw_deg), "z": 0.0}
    turn, camera = turn_of_look(agent.yaw_deg), turn_of_look(agent.yaw_deg, agent.horizon_deg)
    if agent.held is not None:
        turn = room.records.turn(agent.held)
    held = []
    if agent.held is not None and agent.hands != "arm":  # what an arm holds is told with the arm
        held.append({"objectId": agent.held, "objectType": world.type_of(agent.held)})
    return {
        "agent": {
            "name": "agent",
            "position": to_thor(room.agent_position()),
            "rotation": dict(rotation),
            "cameraHorizon": agent.horizon_deg,
            "isStanding": agent.is_standing,
            "inHighFrictionArea": False,
        },
        "cameraPosition": to_thor(agent.camera().position) if above is None else above.position,
        "cameraOrthSize": -1.0 if above is None else above.orthographic_size,
        "fov": agent.embodiment.fov_deg,
        "inventoryObjects": held,
        "heldObjectPose": {
            "localPosition": dict(zip("xyz", agent.hand_offset, strict=True)),
            "localRotation": euler_to_thor(arithmetic.product(camera.T, turn)),
            "position": to_thor(hand),
            "rotation": euler_to_thor(turn),
        },
    }
