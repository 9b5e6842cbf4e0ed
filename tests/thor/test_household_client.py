"""A client in the manner of household-task benchmarks for AI2-THOR 2: it inherits from Controller, restores scenes from what
was recorded, walks smoothly by teleports, and names arguments that are no longer there."""

import numpy as np
import pytest

from remqa_data.thor import Controller
from tests.thor.test_objects import APPLE, EGG, FRIDGE, ISLAND

pytestmark = pytest.mark.slow

PICTURES = {"renderImage": True, "renderDepthImage": True, "renderClassImage": True, "renderObjectImage": True}


class HouseholdEnv(Controller):
    """Plays recorded tasks."""

    def __init__(self) -> None:
        super().__init__(quality="MediumCloseFitShadows")
        self.local_executable_path = None
        self.start(x_display="0.0", player_screen_height=120, player_screen_width=160)

    def restore(self, scene: str, poses: list[dict], toggles: list[dict], dirty_and_empty: bool) -> None:
        super().reset(scene)
        super().step(
            {
                "action": "Initialize",
                "gridSize": 0.25,
                "cameraY": 0.675,
                "visibilityDistance": 1.5,
                "makeAgentsVisible": False,
            }
            | PICTURES
        )
        super().step({"action": "SetObjectToggles", "objectToggles": toggles})
        if dirty_and_empty:
            super().step({"action": "SetStateOfAllObjects", "StateChange": "CanBeDirty", "forceAction": True})
            super().step({"action": "SetStateOfAllObjects", "StateChange": "CanBeFilled", "forceAction": False})
        super().step({"action": "SetObjectPoses", "objectPoses": poses})

    def glide(self, share: float) -> None:
        """A part of a step ahead, with the pictures that a whole one would have."""
        agent = self.last_event.metadata["agent"]
        yaw = np.round(agent["rotation"]["y"], 3)
        x = agent["position"]["x"] + share * 0.25 * np.sin(np.radians(yaw))
        z = agent["position"]["z"] + share * 0.25 * np.cos(np.radians(yaw))
        teleport = {"action": "TeleportFull", "rotation": yaw, "x": x, "z": z, "y": agent["position"]["y"]}
        more = {"horizon": agent["cameraHorizon"], "tempRenderChange": True, "renderNormalsImage": False}
        super().step({**teleport, **more, **PICTURES})


@pytest.fixture(scope="module")
def env():
    env = HouseholdEnv()
    yield env
    env.stop()


@pytest.fixture
def played(env):
    with Controller(scene="FloorPlan1") as other:
        loose = [o for o in other.last_event.metadata["objects"] if o["pickupable"] or o["moveable"]]
    poses = [{"objectName": o["name"], "position": o["position"], "rotation": o["rotation"]} for o in loose]
    env.restore("FloorPlan1", poses, [{"objectType": "DeskLamp", "isOn": False}], True)
    assert env.last_event, env.last_event.metadata["errorMessage"]
    return env


def done(env, **action):
    event = env.step(action)
    assert event.metadata["lastActionSuccess"], (action, event.metadata["errorMessage"])
    return event


def test_an_apple_gets_into_the_fridge(played) -> None:
    assert played.last_event.frame.shape == (120, 160, 3)
    assert {o["isDirty"] for o in played.last_event.metadata["objects"] if o["dirtyable"]} == {True}
    start = {"x": -1.0, "y": 0.900999, "z": 0.5, "rotation": 90, "horizon": 30, "rotateOnTeleport": True}
    done(played, action="TeleportFull", **start)
    done(played, action="PickupObject", objectId=APPLE, forceVisible=True)
    done(played, action="RotateHand", x=40)
    done(played, action="LookUp", forceAction=True)
    for share in (0.5, 0.5):
        played.glide(-share)
        assert played.last_event.metadata["lastActionSuccess"]
        assert played.last_event.depth_frame.shape == (120, 160)
    done(played, action="TeleportFull", x=-0.75, y=0.900999, z=1.5, rotation=270, horizon=30, rotateOnTeleport=True)
    done(played, action="OpenObject", objectId=FRIDGE, moveMagnitude=1.0)
    put = {
        "action": "PutObject",
        "objectId": APPLE,
        "receptacleObjectId": FRIDGE,
        "forceAction": True,
        "placeStationary": True,
    }
    event = done(played, **put)
    assert event.get_object(APPLE)["parentReceptacles"] == [FRIDGE]
    event = done(played, action="CloseObject", objectId=FRIDGE)
    assert event.get_object(APPLE)["temperature"] == "Cold"


@pytest.mark.parametrize(
    "action",
    [
        {
            "action": "MoveAhead",
            "moveMagnitude": 0.25,
            "noise": 0.0,
            "snapToGrid": True,
            "allowAgentsToIntersect": True,
        },
        {"action": "RotateLeft", "rotateStepDegrees": 90} | {"manualInteract": False, "waitForFixedUpdate": False},
        {"action": "LookDown", "forceAction": True, "manualInteract": False},
        {"action": "GetReachablePositions", "visualize": False, "gridColor": {"r": 1.0, "g": 0.0, "b": 0.0, "a": 1.0}},
        {
            "action": "OpenObject",
            "objectId": FRIDGE,
            "forceAction": True,
            "useGripper": False,
            "stopAtNonStaticCol": False,
        },
        {"action": "RemoveFromScene", "objectIds": [APPLE, EGG]},
    ],
    ids=lambda action: action["action"],
)
def test_arguments_that_choose_how_to_simulate_are_accepted(played, action) -> None:
    if "rotateStepDegrees" in action:
        with pytest.raises(ValueError, match="rotateStepDegrees"):
            played.step(action)
        action = {name: value for name, value in action.items() if name != "rotateStepDegrees"}
    start = {"x": 1.25, "y": 0.900999, "z": 1.25, "rotation": np.float64(270.0), "horizon": 0, "rotateOnTeleport": True}
    done(played, action="TeleportFull", **start)
    done(played, **action)


def test_pictures_that_there_are_not_are_an_error(played) -> None:
    for name in ("renderNormalsImage", "renderFlowImage"):
        with pytest.raises(ValueError, match=f"{name} is not supported here"):
            played.step(dict(action="Pass", **{name: True}))
    assert played.step({"action": "Pass", "renderNormalsImage": False})
    removed = played.step({"action": "RemoveFromScene", "objectIds": [APPLE, EGG]})
    listed = {o["objectId"] for o in removed.metadata["objects"]}
    assert not listed & {APPLE, EGG}
    assert ISLAND in listed
