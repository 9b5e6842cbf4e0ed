"""Actions on the simulation itself: scenes, what is in them, settings, cameras, what the metadata list."""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from remqa_data.catalog import object_type
from remqa_data.errors import MisuseError
from remqa_data.floorplans.load import scene_names
from remqa_data.sim.agent.results import ActionResult
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.thor.actions.targets import not_there, of_type
from remqa_data.thor.state.cameras import ThirdPartyCamera
from remqa_data.thor.state.dispatch import ActionFunction, missing_argument
from remqa_data.thor.state.floor_plan import LoadedFloorPlan
from remqa_data.thor.state.frames import PartialVector, Vector, to_thor, whole
from remqa_data.thor.state.objects import box_metadata
from remqa_data.thor.state.rest import let_fall, settle, sunken
from remqa_data.thor.state.settings import QUALITIES, FrameSize, Images, Settings
from remqa_data.thor.state.simulator import SCENE_SUFFIX, SimulatorState

MOST_AGENTS = 8
MOST_TIME_STEP_S = 0.05
ORTHOGRAPHIC_SIZE = 5.0
"""Half of the height, metres, that a camera without perspective shows if it is not told."""
EYE = "FirstPersonCharacter"
"""AI2-THOR's name of the agent's camera."""
INTERFACE = ("remqa_data", "ai2thor", "pydantic")
"""Packages between a client's line and what it calls."""
NO_EFFECT = frozenset(
    {
        "applyActionNoise",
        "continuous",
        "continuousMode",
        "fastActionEmit",
        "headless",
        "massThreshold",
        "quality",
        "renderClassImage",
        "renderImage",
        "renderObjectImage",
        "synchronizeTransforms",
        "useMassThreshold",
        "visibilityScheme",
    }
)
"""Initialization parameters of AI2-THOR that mean nothing here, or stand for another one; the rest draw a warning."""


def get_scenes_in_build(simulator: SimulatorState) -> ActionResult:
    """The names of all scenes."""
    return ActionResult(True, value=[name + SCENE_SUFFIX for name in scene_names()])


def reset(simulator: SimulatorState, sceneName: str) -> ActionResult:
    """Load a scene."""
    simulator.load(sceneName)
    return ActionResult(True)


def initialize(
    simulator: SimulatorState,
    gridSize: float = 0.25,
    visibilityDistance: float = 1.5,
    rotateStepDegrees: float = 90.0,
    fieldOfView: float = 90.0,
    cameraNearPlane: float = 0.1,
    cameraFarPlane: float = 20.0,
    agentMode: str = "default",
    agentCount: int = 1,
    makeAgentsVisible: bool = True,
    renderDepthImage: bool = False,
    renderInstanceSegmentation: bool = False,
    renderSemanticSegmentation: bool = False,
    maxUpwardLookAngle: float = 0.0,
    maxDownwardLookAngle: float = 0.0,
    snapToGrid: bool = True,
    **others: Any,
) -> ActionResult:
    """Set what holds until the next Initialize; as in AI2-THOR, 0 stands for the default of a number."""
    gridSize, visibilityDistance, fieldOfView = gridSize or 0.25, visibilityDistance or 1.5, fieldOfView or 90.0
    cameraNearPlane, cameraFarPlane, agentMode = cameraNearPlane or 0.1, cameraFarPlane or 20.0, agentMode.lower()
    if agentMode not in ("default", "arm"):
        raise MisuseError(
            "InvalidArgument", f"agentMode {agentMode!r} is not supported here: choose 'default' or 'arm'"
        )
    if not 1 <= agentCount <= MOST_AGENTS:
        raise MisuseError("InvalidArgument", f"agentCount {agentCount} is not between 1 and {MOST_AGENTS}")
    if not 0.0 < gridSize <= 5.0:
        return ActionResult(False, f"gridSize {gridSize:g} is not in (0, 5]")
    if not 0.0 < fieldOfView < 180.0:
        return ActionResult(False, f"fieldOfView {fieldOfView:g} is not in (0, 180)")
    if rotateStepDegrees <= 0.0:
        return ActionResult(False, f"rotateStepDegrees must be positive, not {rotateStepDegrees:g}")
    if maxUpwardLookAngle < 0.0 or maxDownwardLookAngle < 0.0:
        return ActionResult(False, "maxUpwardLookAngle and maxDownwardLookAngle must not be negative")
    if visibilityDistance <= 0.0 or not 0.0 < cameraNearPlane < cameraFarPlane:
        return ActionResult(
            False, "visibilityDistance, cameraNearPlane and cameraFarPlane must be positive and in order"
        )
    if (refusal := simulator.room.let_go(simulator.room.agents[agentCount:])) is not None:
        return refusal
    for name in sorted(set(others) - NO_EFFECT):
        warnings.warn(f"initialization parameter {name} has no effect here", stacklevel=_callers_level())
    simulator.settings = Settings(
        grid_size=gridSize,
        visibility_distance=visibilityDistance,
        rotate_step_degrees=rotateStepDegrees,
        field_of_view=fieldOfView,
        far_plane=cameraFarPlane,
        agent_mode=agentMode,
        agent_count=agentCount,
        shows_agents=makeAgentsVisible,
        look_up_deg=maxUpwardLookAngle or -AGENT.least_horizon_deg,
        look_down_deg=maxDownwardLookAngle or AGENT.most_horizon_deg,
        images=Images(
            depth=renderDepthImage,
            instances=renderInstanceSegmentation,
            types=renderSemanticSegmentation,
        ),
    )
    simulator.room.embody(simulator.settings)
    if snapToGrid:
        simulator.room.snap_to_grid()
    return ActionResult(True, value={"cameraNearPlane": cameraNearPlane, "cameraFarPlane": cameraFarPlane})


def change_resolution(simulator: SimulatorState, x: int, y: int) -> ActionResult:
    """Set the size of all pictures."""
    simulator.resize(FrameSize(x, y))
    return ActionResult(True)


def change_quality(simulator: SimulatorState, quality: str) -> ActionResult:
    """Draw pictures of all rooms in another quality."""
    if quality not in QUALITIES:
        return ActionResult(False, f"quality {quality!r} is none: choose one of {', '.join(QUALITIES)}")
    simulator.quality = QUALITIES[quality]
    return ActionResult(True)


def change_fov(simulator: SimulatorState, fieldOfView: float, camera: str | None = None) -> ActionResult:
    """Give the eyes of all agents another field of view; `camera` may name no other one."""
    if camera not in (None, "", EYE):
        return ActionResult(False, f"camera {camera!r} is not {EYE!r}: see UpdateThirdPartyCamera for others")
    if not 0.0 < fieldOfView < 180.0:
        return ActionResult(False, f"fieldOfView {fieldOfView:g} is not in (0, 180)")
    simulator.settings = replace(simulator.settings, field_of_view=fieldOfView)
    for agent in simulator.room.agents:
        agent.change_field_of_view(fieldOfView)
    return ActionResult(True)


def do_nothing(simulator: SimulatorState) -> ActionResult:
    """Only take a picture."""
    return ActionResult(True)


def pause_physics(simulator: SimulatorState) -> ActionResult:
    """Say that physics is to go on by AdvancePhysicsStep only; as all is at rest between actions, that changes nothing."""
    simulator.is_paused = True
    return ActionResult(True)


def unpause_physics(simulator: SimulatorState) -> ActionResult:
    """Say that physics is to go on by itself."""
    simulator.is_paused = False
    return ActionResult(True)


def advance_physics(
    simulator: SimulatorState,
    timeStep: float = 0.02,
    simSeconds: float | None = None,
    allowAutoSimulation: bool = False,
) -> ActionResult:
    """Let physics go on, seconds, as AI2-THOR allows it: there is nothing left to do."""
    if not (simulator.is_paused or allowAutoSimulation):
        return ActionResult(False, "physics goes on by itself: PausePhysicsAutoSim first, or set allowAutoSimulation")
    if not 0.0 < timeStep <= MOST_TIME_STEP_S:
        return ActionResult(False, f"timeStep {timeStep:g} is not more than 0 and at most {MOST_TIME_STEP_S}")
    if simSeconds is not None and simSeconds < 0.0:
        return ActionResult(False, f"simSeconds {simSeconds:g} is negative")
    return ActionResult(True)


def set_object_filter(simulator: SimulatorState, objectIds: list[str]) -> ActionResult:
    """List only some objects in the metadata."""
    simulator.shown_objects = frozenset(objectIds)
    return ActionResult(True)


def set_object_filter_for_type(simulator: SimulatorState, objectTypes: list[str]) -> ActionResult:
    """List only the objects of some types in the metadata."""
    world = simulator.room.world
    return set_object_filter(simulator, [name for name in world.ids if world.type_of(name) in objectTypes])


def reset_object_filter(simulator: SimulatorState) -> ActionResult:
    """List all objects again."""
    simulator.shown_objects = None
    return ActionResult(True)


def remove_from_scene(
    simulator: SimulatorState, objectId: str | None = None, objectIds: list[str] | None = None
) -> ActionResult:
    """Take an object, or some, out of the scene; what lay on them falls."""
    names = objectIds if objectId is None else [objectId]
    if names is None:
        raise missing_argument("RemoveFromScene", "objectId")
    if not names:
        return ActionResult(False, "objectIds must not be empty!")
    for name in names:
        if (refusal := not_there(simulator, name)) is not None:
            return refusal
    return _remove(simulator.room, names)


def _remove(room: LoadedFloorPlan, names: Sequence[str]) -> ActionResult:
    for name in dict.fromkeys(names):
        if name in room.world.away:
            continue  # it was held with one before
        parts = room.world.built_into(name)
        borne = [other for other in room.world.borne(name, along=parts) if other not in room.world.held]
        room.take_away(name)
        if borne:
            let_fall(room.world, [other for other in borne if room.world.state(other).is_fixed], borne)
    return ActionResult(True)


def disable_all_objects_of_type(simulator: SimulatorState, objectType: str) -> ActionResult:
    """Take all objects of a type out of the scene."""
    return _remove(simulator.room, of_type(simulator, object_type(objectType).name))


def enable_object(simulator: SimulatorState, objectId: str) -> ActionResult:
    """Put an object back to where it was when it was taken out of the scene, with what it is made of."""
    room, world = simulator.room, simulator.room.world
    absence = not_there(simulator, objectId)
    if absence is None:
        return ActionResult(True)
    if objectId in room.records.sliced:
        return absence
    before = world.save()
    names = [objectId, *(part for part in world.built_into(objectId) if part in world.away)]
    for name in names:
        world.put_back(name, world.away[name])
    if stuck := sunken(room, names):
        world.restore(before)
        return ActionResult(False, f"{objectId} cannot come back: {stuck[1]} is where it was")
    settle(world)
    return ActionResult(True)


def get_scene_bounds(simulator: SimulatorState) -> ActionResult:
    """The box of the room."""
    return ActionResult(True, value=box_metadata(simulator.room.box()))


def get_map_view_camera_properties(simulator: SimulatorState) -> ActionResult:
    """A camera under the ceiling that sees the whole floor plan."""
    camera = simulator.room.map_camera()
    value = {
        "position": camera.position,
        "rotation": camera.rotation,
        "orthographicSize": camera.orthographic_size,
        "orthographic": True,
    }
    return ActionResult(True, value=value)


def toggle_map_view(simulator: SimulatorState) -> ActionResult:
    """Take the agent's pictures with the map camera, or with its own eye again; returns the room's highest corner."""
    simulator.room.shows_map = not simulator.room.shows_map
    return ActionResult(True, value=to_thor(simulator.room.box()[1]))


def add_third_party_camera(
    simulator: SimulatorState,
    position: PartialVector,
    rotation: PartialVector,
    fieldOfView: float = 90.0,
    orthographic: bool = False,
    orthographicSize: float = ORTHOGRAPHIC_SIZE,
) -> ActionResult:
    """Add a camera; its pictures come with every event. Its skybox and clipping planes are not the caller's to choose."""
    size = orthographicSize if orthographic else None
    return _keep(
        simulator, len(simulator.cameras), ThirdPartyCamera(whole(position), whole(rotation), fieldOfView, size)
    )


def update_third_party_camera(
    simulator: SimulatorState,
    thirdPartyCameraId: int = 0,
    position: PartialVector | None = None,
    rotation: PartialVector | None = None,
    fieldOfView: float | None = None,
    orthographic: bool | None = None,
    orthographicSize: float | None = None,
) -> ActionResult:
    """Change a camera; what is not given stays as it is."""
    if not 0 <= thirdPartyCameraId < len(simulator.cameras):
        return ActionResult(
            False, f"there is no third party camera {thirdPartyCameraId}: {len(simulator.cameras)} were added"
        )
    camera = simulator.cameras[thirdPartyCameraId]
    size = camera.orthographic_size if orthographicSize is None else orthographicSize
    if orthographic is not None:
        size = (size or ORTHOGRAPHIC_SIZE) if orthographic else None
    camera = replace(
        camera,
        position=_changed(camera.position, position),
        rotation=_changed(camera.rotation, rotation),
        field_of_view=camera.field_of_view if fieldOfView is None else fieldOfView,
        orthographic_size=size,
    )
    return _keep(simulator, thirdPartyCameraId, camera)


ACTIONS: dict[str, ActionFunction] = {
    "AddThirdPartyCamera": add_third_party_camera,
    "AdvancePhysicsStep": advance_physics,
    "ChangeFOV": change_fov,
    "ChangeQuality": change_quality,
    "ChangeResolution": change_resolution,
    "DisableAllObjectsOfType": disable_all_objects_of_type,
    "DisableObject": remove_from_scene,
    "Done": do_nothing,
    "EnableObject": enable_object,
    "GetMapViewCameraProperties": get_map_view_camera_properties,
    "GetSceneBounds": get_scene_bounds,
    "GetScenesInBuild": get_scenes_in_build,
    "Initialize": initialize,
    "NoOp": do_nothing,
    "Pass": do_nothing,
    "PausePhysicsAutoSim": pause_physics,
    "RemoveFromScene": remove_from_scene,
    "RemoveObjsFromScene": remove_from_scene,
    "Reset": reset,
    "ResetObjectFilter": reset_object_filter,
    "SetObjectFilter": set_object_filter,
    "SetObjectFilterForType": set_object_filter_for_type,
    "ToggleMapView": toggle_map_view,
    "UnpausePhysicsAutoSim": unpause_physics,
    "UpdateThirdPartyCamera": update_third_party_camera,
}


def _keep(simulator: SimulatorState, index: int, camera: ThirdPartyCamera) -> ActionResult:
    if problem := camera.problem():
        return ActionResult(False, problem)
    simulator.cameras[index : index + 1] = [camera]
    return ActionResult(True)


def _callers_level() -> int:
    """The `stacklevel` of a warning, for the function that asks, which leads to the client's own line."""
    frame, level = inspect.currentframe(), 0
    while frame is not None and frame.f_globals.get("__name__", "").partition(".")[0] in INTERFACE:
        frame, level = frame.f_back, level + 1
    return level


def _changed(old: Vector, new: PartialVector | None) -> Vector:
    return whole({**old, **(new or {})})
