"""Many objects at once: what is switched on and off, what is opened and closed, and what else AI2-THOR can set."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Required

from typing_extensions import TypedDict

from remqa_data.catalog import object_type
from remqa_data.sim.agent.handling import OVERLAP_M
from remqa_data.sim.agent.results import ActionResult
from remqa_data.sim.physics.world import World
from remqa_data.thor.actions.conditions import break_all, can_be_cut, cut
from remqa_data.thor.object_states.conditions import BROKEN, CONDITIONS, FILLED
from remqa_data.thor.state.dispatch import ActionFunction, missing_argument
from remqa_data.thor.state.floor_plan import LoadedFloorPlan
from remqa_data.thor.state.simulator import SimulatorState


class ObjectToggle(TypedDict):
    """Whether all objects of a type are switched on."""

    objectType: str
    isOn: bool


def set_object_toggles(simulator: SimulatorState, objectToggles: list[ObjectToggle]) -> ActionResult:
    """Switch all objects of some types on or off; a type that the room has not, or that has no switch, is passed over."""
    types = [object_type(toggle["objectType"]) for toggle in objectToggles]
    world = simulator.room.world
    for type_, toggle in zip(types, objectToggles, strict=True):
        if type_.toggleable:
            chosen = {name for name in world.ids if world.type_of(name) == toggle["objectType"]}
            _switch(simulator, chosen, toggle["isOn"])
    return ActionResult(True)


class ObjectStates(TypedDict, total=False):
    """What all objects of a type, or all that can be, are to be: `stateChange` says of what kind, a flag says how."""

    objectType: str
    stateChange: Required[str]
    isOpen: bool
    isToggled: bool
    isBroken: bool
    isFilledWithLiquid: bool
    isDirty: bool
    isCooked: bool
    isSliced: bool
    isUsedUp: bool


def set_object_states(simulator: SimulatorState, SetObjectStates: ObjectStates) -> ActionResult:
    """Give all objects of a type a state, or its opposite."""
    change = SetObjectStates["stateChange"]
    if change not in STATE_CHANGES:
        return ActionResult(False, f"{change} is no state change: choose one of {', '.join(STATE_CHANGES)}")
    _, flag = STATE_CHANGES[change]
    type_name = SetObjectStates.get("objectType")
    world = simulator.room.world
    wanted = None if type_name is None else object_type(type_name).name
    chosen = [other for other in world.ids if wanted in (None, world.type_of(other))]
    _change(simulator, flag, bool(SetObjectStates.get(flag, False)), chosen)
    return ActionResult(True)


def set_state_of_all_objects(
    simulator: SimulatorState, stateChange: str | None = None, forceAction: bool = False, StateChange: str | None = None
) -> ActionResult:
    """Give all objects that can have a state this state, or its opposite.

    Parameters
    ----------
    simulator : SimulatorState
        The room.
    stateChange, StateChange : str
        A property of AI2-THOR's: "CanOpen" opens and closes; "CanToggleOnOff" switches.
    forceAction : bool
        True for open, on, dirty and so on; False for the opposite.
    """
    change = stateChange or StateChange
    if change is None:
        raise missing_argument("SetStateOfAllObjects", "stateChange")
    flags = dict(STATE_CHANGES.values())
    if change not in flags:
        return ActionResult(False, f"{change} is no state change: choose one of {', '.join(flags)}")
    _change(simulator, flags[change], forceAction, simulator.room.world.ids)
    return ActionResult(True)


def open_visible_objects(simulator: SimulatorState, openness: float = 1.0) -> ActionResult:
    """Open what the agent sees within its visibility distance, each as far as it can be opened beside the others."""
    if not 0.0 < openness <= 1.0:
        return ActionResult(False, f"openness {openness:g} is not more than 0 and at most 1")
    return _open_visible(simulator, True, openness)


def close_visible_objects(simulator: SimulatorState) -> ActionResult:
    """Close what the agent sees within its visibility distance."""
    return _open_visible(simulator, False)


def accept(simulator: SimulatorState, **ignored: Any) -> ActionResult:
    """Do nothing: what this sets (how fast, how hot, how breakable) means nothing here."""
    return ActionResult(True)


STATE_CHANGES = {
    "openable": ("CanOpen", "isOpen"),
    "toggleable": ("CanToggleOnOff", "isToggled"),
    "cookable": ("CanBeCooked", "isCooked"),
    "dirtyable": ("CanBeDirty", "isDirty"),
    "canFillWithLiquid": ("CanBeFilled", FILLED),
    "sliceable": ("CanBeSliced", "isSliced"),
    "canBeUsedUp": ("CanBeUsedUp", "isUsedUp"),
    "breakable": ("CanBreak", BROKEN),
}
"""State changes as SetObjectStates calls them, with their names in SetStateOfAllObjects, and what an object then is."""

WITHOUT_EFFECT = (
    "ChangeOpenSpeed",
    "ChangeTimeScale",
    "DisableTemperatureDecay",
    "EnableTemperatureDecay",
    "HideTranslucentObjects",
    "MakeAllObjectsBreakable",
    "MakeAllObjectsMoveable",
    "MakeAllObjectsStationary",
    "MakeAllObjectsUnbreakable",
    "MakeAllPickupableObjectsMoveable",
    "MakeObjectBreakable",
    "MakeObjectUnbreakable",
    "MakeObjectsOfTypeUnbreakable",
    "MakeObjectsStaticKinematicMassThreshold",
    "PhysicsSyncTransforms",
    "SetDecayTemperatureBool",
    "SetGlobalRoomTempDecayTime",
    "SetRoomTempDecayTimeForType",
    "SetTemperatureDecayTime",
    "Sleep",
)

ACTIONS: dict[str, ActionFunction] = {
    "CloseVisibleObjects": close_visible_objects,
    "OpenVisibleObjects": open_visible_objects,
    "SetObjectStates": set_object_states,
    "SetObjectToggles": set_object_toggles,
    "SetStateOfAllObjects": set_state_of_all_objects,
    **dict.fromkeys(WITHOUT_EFFECT, accept),
}


def _open_visible(simulator: SimulatorState, is_open: bool, openness: float = 1.0) -> ActionResult:
    world, seen = simulator.room.world, simulator.agent.visible_objects(simulator.settings.visibility_distance)
    chosen = [name for name in seen if (world.state(name).openness > 0.0) != is_open]
    _set_openness(simulator.room, is_open, chosen, openness)
    return ActionResult(True)


def _change(simulator: SimulatorState, flag: str, is_so: bool, chosen: Sequence[str]) -> None:
    """Set a flag of those of some objects that can have it and are in the scene."""
    room, world = simulator.room, simulator.room.world
    chosen = [name for name in chosen if name not in world.away]
    if flag == "isOpen":
        _set_openness(room, is_so, chosen)
    elif flag == "isToggled":
        _switch(simulator, {name for name in chosen if object_type(world.type_of(name)).toggleable}, is_so)
    elif flag == "isSliced":
        if is_so and (whole := [name for name in chosen if can_be_cut(world, name)]):
            cut(simulator, whole)
    else:
        able = [name for name in chosen if CONDITIONS[flag].able in object_type(world.type_of(name)).can]
        if flag == BROKEN and is_so:
            break_all(simulator, [name for name in able if not room.conditions.of(name).get(BROKEN)])
        else:
            for name in able:
                room.conditions.put(name, flag, is_so)


def _switch(simulator: SimulatorState, chosen: set[str], on: bool) -> None:
    """Switch some objects, but for those that cannot be switched on as they are."""
    conditions = simulator.room.conditions
    for name in chosen:
        if not on or conditions.switch_refusal(name) is None:
            conditions.change(name, isToggled=on)


def _set_openness(room: LoadedFloorPlan, is_open: bool, chosen: Sequence[str], openness: float = 1.0) -> None:
    """Open some objects so far, or as far as they can be opened beside each other, in their order; or close them.

    What is to be switched off first stays closed.
    """
    world = room.world
    shares = [openness * share for share in _OPENNESSES] if is_open else [0.0]
    for name in chosen:
        is_shut = is_open and room.conditions.opening_refusal(name) is not None
        if name not in world.held and world.assets[name].is_openable and not is_shut:
            world.open(name, next(share for share in shares if _fits(world, name, share)))


_OPENNESSES = (1.0, 0.8, 0.6, 0.4, 0.2, 0.0)


def _fits(world: World, object_id: str, openness: float) -> bool:
    """Whether what opens meets nothing that it does not touch anyway; what lies in it comes along."""
    if openness == 0.0:
        return True
    before, carried = world.depths_when_open(object_id, world.state(object_id).openness), world.contents(object_id)
    then = world.depths_when_open(object_id, min(openness, world.most_open(object_id)))
    return all(depth <= max(OVERLAP_M, before.get(other, 0.0)) or other in carried for other, depth in then.items())
