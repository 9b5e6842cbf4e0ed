"""Calls of all of the Controller's actions, with arguments that fit and that do not."""

from __future__ import annotations

import inspect
import json
import math
import random

from remqa_data.thor import Controller
from remqa_data.thor.session import ACTIONS, ARM_ACTIONS

NEVER = {"Initialize", "Reset", "ChangeResolution", "AddThirdPartyCamera"}  # they would make what follows another test
JUNK = (None, "", "far", True, -1, 0, 3, 1e9, -0.5, float("nan"), [], [1], {}, {"x": 1}, {"x": "left", "y": 0, "z": 0})


def parameters(name: str) -> list[str]:
    return [p for p in inspect.signature(ARM_ACTIONS[name].execute).parameters if p != "simulator"]


def argument(rng: random.Random, name: str, objects: list[str], places: list[dict[str, float]]) -> object:
    if rng.random() < 0.15:
        return rng.choice(JUNK)
    if "bjectId" in name or name == "objectName":
        listed = name.endswith(("s", "Candidates"))
        return rng.sample(objects, 2) if listed else rng.choice(objects)
    if name in ("position", "target", "offset", "origin", "destination"):
        return rng.choice(places) if rng.random() < 0.5 else {axis: rng.uniform(-0.5, 0.5) for axis in "xyz"}
    if name in ("rotation", "direction"):
        return {"x": 0.0, "y": rng.uniform(0.0, 360.0), "z": 0.0}
    if name in ("forceAction", "standing", "returnToStart", "placeStationary", "normalizedY"):
        return rng.random() < 0.5
    if name == "coordinateSpace":
        return rng.choice(("armBase", "world", "wrist"))
    return rng.choice((0.0, 0.1, 0.5, 1.0, 30.0, 90.0, rng.uniform(-2.0, 2.0)))


def assert_is_consistent(controller: Controller) -> None:
    metadata = controller.last_event.metadata
    json.dumps(metadata, allow_nan=False)
    listed = {record["objectId"]: record["isPickedUp"] for record in metadata["objects"]}
    held = [record["objectId"] for record in metadata["inventoryObjects"]]
    # `SetObjectFilter` may leave out what is held.
    assert [name for name, is_held in listed.items() if is_held] == [name for name in held if name in listed]
    assert all(math.isfinite(value) for value in metadata["agent"]["position"].values())
    assert metadata["lastActionSuccess"] or metadata["errorMessage"]


def call_at_random(controller: Controller, rng: random.Random, count: int) -> dict[str, int]:
    """How often each outcome came."""
    outcomes = {"done": 0, "refused": 0, "misuse": 0}
    objects = [record["objectId"] for record in controller.last_event.metadata["objects"]]
    places = controller.step("GetReachablePositions").metadata["actionReturn"]
    actions = sorted((ARM_ACTIONS if controller.last_event.metadata["arm"] else ACTIONS).keys() - NEVER)
    for _ in range(count):
        action = rng.choice(actions)
        known = parameters(action)
        names = [name for name in known if rng.random() < 0.7] + (["unheardOf"] if rng.random() < 0.05 else [])
        arguments = {name: argument(rng, name, objects, places) for name in names}
        if action in ("GetInteractablePoses", "PositionsFromWhichItemIsInteractable"):
            arguments["maxPoses"] = 1
        try:
            event = controller.step(action, renderImage=False, **arguments)
            outcomes["done" if event else "refused"] += 1
        except ValueError:
            assert controller.last_event.metadata["errorCode"], (action, arguments)
            outcomes["misuse"] += 1
        except Exception as error:
            raise AssertionError(f"{action} {arguments}") from error
        assert_is_consistent(controller)
    return outcomes
