"""From an action as it is sent to the function that executes it, with AI2-THOR's errors for what does not fit."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import ConfigDict, ValidationError, validate_call

from remqa_data.errors import MisuseError, nearest_names
from remqa_data.sim.agent.results import ActionResult

ActionFunction = Callable[..., ActionResult]
"""Executes an action on a simulator state; its parameters are AI2-THOR's, by name."""

WITH_EVERY_ACTION = frozenset(
    {
        "action",
        "actionSimulationSeconds",
        "agentId",
        "autoSimulation",
        "sequenceId",
        "simplifyPhysics",
        "renderImage",
        "renderDepthImage",
        "renderInstanceSegmentation",
        "renderSemanticSegmentation",
        "renderObjectImage",
        "renderClassImage",
        "disableRendering",
        "fixedDeltaTime",
        "physicsSimulationParams",
        "restrictMovement",
        "returnToStart",
        "speed",
        "visibilityDistance",
    }
)
"""What AI2-THOR's Python side may add to any action, which pictures it asks for, and how long things take to move: here
they are there at once. An action that has such a parameter gets it; from the others it is kept away."""
MEANS_NOTHING = frozenset(
    {
        "allowAgentsToIntersect",
        "allowAutoSimulation",
        "antiAliasing",
        "autoSyncTransforms",
        "enablePhysicsJitter",
        "farClippingPlane",
        "forceAction",
        "forceKinematic",
        "forceVisible",
        "gridColor",
        "gridWidth",
        "ignoreAgentInTransition",
        "manualInteract",
        "markAsKinematic",
        "maxNumRepeats",
        "moveSpeed",
        "nearClippingPlane",
        "noise",
        "physicsInterval",
        "placeStationary",
        "putNearXY",
        "randomSeed",
        "randomizeOpen",
        "renderFlowImage",
        "renderNormalsImage",
        "rotateOnTeleport",
        "simSeconds",
        "skyboxColor",
        "snapToGrid",
        "stopAtNonStaticCol",
        "tempRenderChange",
        "timestep",
        "useGripper",
        "visibilityScheme",
        "visualize",
        "waitForFixedUpdate",
    }
)
"""Arguments of some actions, in this version or an earlier one, that choose among ways to simulate or draw where there is one
here. They are kept away from actions that have no such parameter, too."""


HEEDS_NO_OTHERS = frozenset(
    {
        "BreakObject",
        "ChangeFOV",
        "CleanObject",
        "CookObject",
        "DirectionalPush",
        "DirtyObject",
        "EmphasizeObject",
        "EmptyLiquidFromObject",
        "FillObjectWithLiquid",
        "GetSpawnCoordinatesAboveReceptacle",
        "LookDown",
        "LookUp",
        "MaskObject",
        "PlaceHeldObject",
        "PullObject",
        "PushObject",
        "RotateLook",
        "SetObjectPoses",
        "SetObjectStates",
        "SliceObject",
        "TeleportObjectToFloor",
        "TouchThenApplyForce",
        "UnmaskObject",
        "UseUpObject",
    }
)
"""In AI2-THOR these take one record of all arguments that there are, and so anything: what they do not know means nothing."""


@dataclass(frozen=True)
class CheckedAction:
    """An action that checks the types of its arguments, and the names of its parameters."""

    execute: ActionFunction
    parameters: frozenset[str]


def checked(actions: Mapping[str, ActionFunction]) -> dict[str, CheckedAction]:
    """Actions with a check of their arguments, by name.

    As in Unity's JSON, "100" is a number where one is asked for, and 1 and "true" are true.
    """
    config = ConfigDict(allow_inf_nan=False, arbitrary_types_allowed=True)
    return {
        name: CheckedAction(validate_call(config=config)(action), frozenset(inspect.signature(action).parameters))
        for name, action in actions.items()
    }


def call(actions: Mapping[str, CheckedAction], simulator: object, request: Mapping[str, Any]) -> ActionResult:
    """Execute what a request asks for.

    Parameters
    ----------
    actions : mapping
        By name, as `checked` returns them.
    simulator : SimulatorState
        The first argument of every action.
    request : mapping
        "action" and its arguments.

    Raises
    ------
    MisuseError
        If there is no such action, an argument is missing, unknown, or of the wrong type.
    """
    name = request.get("action")
    if not isinstance(name, str) or name not in actions:
        near = nearest_names(str(name), actions)
        hint = f"; did you mean {' or '.join(near)}?" if near else ""
        raise MisuseError("InvalidAction", f"Invalid action: {name}{hint}")
    action = actions[name]
    unheeded = request.keys() if name in HEEDS_NO_OTHERS else WITH_EVERY_ACTION | MEANS_NOTHING
    ignored = unheeded - action.parameters
    try:
        return action.execute(simulator, **{key: value for key, value in request.items() if key not in ignored})
    except ValidationError as error:
        raise _misuse(name, error) from None


def missing_argument(action: str, argument: str) -> MisuseError:
    """What is raised where an action is not told what it needs."""
    return MisuseError("MissingArguments", f"action: {action} is missing the following arguments: {argument}")


def _misuse(name: str, error: ValidationError) -> MisuseError:
    problems = error.errors(include_url=False)
    missing = [str(p["loc"][0]) for p in problems if p["type"].startswith("missing_argument")]
    missing += [str(p["loc"][0]) for p in problems if p["type"] == "missing_keyword_only_argument"]
    if missing:
        return missing_argument(name, ",".join(missing))
    first = problems[0]
    why = "unknown" if first["type"] == "unexpected_keyword_argument" else first["msg"]
    where = ".".join(str(part) for part in first["loc"])
    return MisuseError("InvalidArgument", f"action: {name} has an invalid argument: {where} ({why})")
