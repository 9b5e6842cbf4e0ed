"""What AI2-THOR raises as ValueError, and says in errorCode; how it says it matters to its clients."""

import pytest

from remqa_data.errors import MissingExtraError
from remqa_data.thor import Controller

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(
    ("request_", "code", "message"),
    [
        ({"action": "Moveahead"}, "InvalidAction", "Invalid action: Moveahead"),
        (
            {"action": "CreateObject", "objectId": "Apple|1"},
            "InvalidAction",
            "Invalid action: CreateObject",
        ),
        (
            {"action": "OpenObject"},
            "MissingArguments",
            "action: OpenObject is missing the following arguments: objectId",
        ),
        (
            {"action": "SetMassProperties"},
            "MissingArguments",
            "action: SetMassProperties is missing the following arguments: objectId,mass",
        ),
        (
            {"action": "RotateRight", "degree": 30},
            "InvalidArgument",
            "action: RotateRight has an invalid argument: degree",
        ),
        ({"action": "Pass", "foo": 1}, "InvalidArgument", "action: Pass has an invalid argument: foo"),
        ({"action": "MoveAhead", "moveMagnitude": "far"}, "InvalidArgument", "has an invalid argument: moveMagnitude"),
        ({"action": "MoveAhead", "moveMagnitude": float("nan")}, "InvalidArgument", "moveMagnitude"),
        ({"action": "MoveAhead", "forceAction": "perhaps"}, "InvalidArgument", "forceAction"),
        ({"action": "GetReachablePositions", "maxStepCount": 1.5}, "InvalidArgument", "maxStepCount"),
        ({"action": "Teleport", "position": 5}, "InvalidArgument", "has an invalid argument: position"),
        ({"action": "Teleport", "position": {"x": "left", "y": 0, "z": 0}}, "InvalidArgument", "position.x"),
        ({"action": "Teleport", "position": {"x": 0, "y": 0, "z": 0}, "x": 1}, "AmbiguousAction", "Ambiguous action"),
    ],
)
def test_misuse_raises(kitchen, request_, code, message) -> None:
    before = kitchen.last_event.metadata["agent"]
    with pytest.raises(ValueError) as raised:  # noqa: PT011 - the message is compared below
        kitchen.step(**request_)
    assert message in str(raised.value)
    metadata = kitchen.last_event.metadata
    assert (metadata["errorCode"], metadata["lastActionSuccess"]) == (code, False)
    assert metadata["lastAction"] == request_["action"]
    assert metadata["agent"] == before
    assert kitchen.step("Pass").metadata["errorMessage"] == ""


def test_refusals_raise_only_on_request(kitchen) -> None:
    event = kitchen.step("MoveAhead", moveMagnitude=50.0)
    assert not event
    assert event.metadata["errorCode"] is None
    with pytest.raises(RuntimeError, match="is blocking Agent"):
        kitchen.step("MoveAhead", moveMagnitude=50.0, raise_for_failure=True)


def test_arguments_of_numpy_are_read(kitchen) -> None:
    np = pytest.importorskip("numpy")
    assert kitchen.step(
        "Teleport", position={"x": np.float32(1.5), "y": np.float64(0.9), "z": np.int64(0)}, horizon=np.float32(0)
    )
    assert kitchen.last_event.metadata["agent"]["position"]["x"] == 1.5


def test_arguments_of_json_are_read(kitchen) -> None:
    asked = kitchen.step("MoveRight", moveMagnitude=0.25, forceAction=True)
    kitchen.reset()
    again = kitchen.step("MoveRight", moveMagnitude="0.25", forceAction=1)
    assert again.metadata == asked.metadata
    kitchen.reset()
    assert kitchen.step("Teleport", horizon="30").metadata["agent"]["cameraHorizon"] == 30.0


@pytest.mark.parametrize(
    "argument",
    [{"simplifyPhysics": True}, {"autoSimulation": False}, {"actionSimulationSeconds": 0.5}, {"fixedDeltaTime": 0.02}],
)
def test_arguments_without_a_meaning_change_nothing(kitchen, argument) -> None:
    plain = kitchen.step("RotateRight")
    assert plain
    kitchen.reset()
    assert kitchen.step("RotateRight", **argument).metadata == plain.metadata


def test_the_missing_extra_is_named(monkeypatch) -> None:
    import importlib
    import sys

    for name in [
        name for name in sys.modules if name.partition(".")[0] == "ai2thor" or name.startswith("remqa_data.thor")
    ]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "ai2thor", None)
    with pytest.raises(MissingExtraError, match=r"remqa-data\[thor\]"):
        importlib.import_module("remqa_data.thor")


@pytest.mark.parametrize("mode", ["default", "arm"])
@pytest.mark.parametrize(
    ("action", "arguments"),
    [
        ("OpenObject", {}),
        ("CloseObject", {}),
        ("PickupObject", {}),
        ("PutObject", {}),
        ("PushObject", {"moveMagnitude": 10.0}),
        ("DirectionalPush", {"moveMagnitude": 10.0, "pushAngle": 45.0}),
        ("ToggleObjectOn", {}),
        ("GetInteractablePoses", {}),
        ("GetShortestPath", {}),
    ],
)
def test_an_unknown_object_is_refused(kitchen, mode, action, arguments) -> None:
    kitchen.reset(agentMode=mode)
    event = kitchen.step(action, objectId="Apple|+99.00|+01.15|+00.48", **arguments)
    assert not event
    assert event.metadata["errorMessage"]


@pytest.mark.parametrize("call", ["step", "reset"])
def test_after_stop_there_is_an_error(call) -> None:
    controller = Controller(scene="FloorPlan401", width=32, height=32)
    controller.stop()
    controller.stop()
    with pytest.raises(ValueError, match="has been stopped"):
        controller.step("Pass") if call == "step" else controller.reset()


@pytest.mark.parametrize("agent", [1, -1, "1", 0.5, True])
def test_an_agent_that_is_not_there_cannot_act(kitchen, agent) -> None:
    before = kitchen.last_event.metadata["agent"]
    with pytest.raises(ValueError, match="is not an agent here"):
        kitchen.step("RotateRight", agentId=agent)
    assert kitchen.last_event.metadata["agent"] == before
    assert kitchen.step("Pass", agentId=0)
    assert kitchen.step("Pass", agentId="0")


@pytest.mark.parametrize("other", [{"agentMode": "locobot"}, {"agentMode": "drone"}])
def test_other_agents_are_refused_in_one_line(kitchen, other) -> None:
    with pytest.raises(ValueError, match="is not supported here") as raised:
        kitchen.reset(**other)
    assert "\n" not in str(raised.value)
