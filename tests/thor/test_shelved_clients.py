"""What code of other labs does with AI2-THOR's Controller, in as few lines as show it."""

import threading
from collections.abc import Iterator
from typing import Any

import pytest

from remqa_data.thor import Controller


@pytest.fixture(scope="module")
def controller() -> Iterator[Controller]:
    made = Controller(scene="FloorPlan405", width=64, height=64, renderDepthImage=True, commit_id="a" * 40)
    yield made
    made.stop()


def objects(controller: Controller) -> dict[str, dict[str, Any]]:
    return {thing["objectId"]: thing for thing in controller.last_event.metadata["objects"]}


def test_the_version_that_was_asked_for_is_where_clients_look_for_it(controller: Controller) -> None:
    assert controller._build.commit_id == "a" * 40
    assert "a" * 40 in controller._build.url


def test_what_is_taken_out_of_the_way_is_put_back_by_its_own_pose(controller: Controller) -> None:
    controller.reset("FloorPlan405")
    before = objects(controller)
    loose = [thing for thing in before.values() if thing["pickupable"]]
    assert len(loose) > 5
    for thing in loose:
        name, (x, y, z) = thing["objectId"], thing["position"].values()
        for position in ({"x": x, "y": y + 0.4, "z": z}, {"x": x, "y": y, "z": z}):
            event = controller.step(
                "TeleportObject", objectId=name, position=position, rotation=thing["rotation"], forceAction=True
            )
            assert event.metadata["lastActionSuccess"], (name, event.metadata["errorMessage"])
        after = objects(controller)[name]
        assert after["position"] == pytest.approx(thing["position"], abs=0.01), name
        assert after["parentReceptacles"] == thing["parentReceptacles"]


def test_a_forced_teleport_looks_anywhere_and_another_says_how_far(controller: Controller) -> None:
    controller.reset("FloorPlan405")
    here = {
        **controller.last_event.metadata["agent"]["position"],
        "rotation": {"x": 0, "y": 90, "z": 0},
        "standing": True,
    }
    for horizon, stored in ((330, -30.0), (75, 75.0), (-30.0, -30.0)):
        event = controller.step("TeleportFull", **here, horizon=horizon, forceAction=True)
        assert event.metadata["lastActionSuccess"]
        assert event.metadata["agent"]["cameraHorizon"] == stored
    event = controller.step("TeleportFull", **here, horizon=330)
    assert event.metadata["errorMessage"] == "Each horizon must be in [-30:60]. You gave 330."


def test_without_renderimage_nothing_is_drawn(controller: Controller) -> None:
    event = controller.step("Pass", renderImage=False, renderInstanceSegmentation=True)
    assert event.frame is None
    assert event.depth_frame is None
    assert event.instance_segmentation_frame is None
    assert controller.step("Pass").depth_frame is not None


def test_what_was_hidden_is_seen_again_at_once(controller: Controller) -> None:
    seen = [name for name, thing in objects(controller).items() if thing["visible"]][:2]
    before = controller.step("Pass").frame
    for name in seen:
        controller.step("HideObject", objectId=name)
    assert (controller.step("Pass").frame != before).any()
    assert (controller.step("UnhideAllObjects").frame == before).all()


def test_arguments_of_earlier_versions_are_taken(controller: Controller) -> None:
    controller.reset("FloorPlan405")
    for action, arguments in (
        ("PausePhysicsAutoSim", {"autoSyncTransforms": False}),
        ("OpenVisibleObjects", {"openness": 0.5, "simplifyPhysics": True}),
        ("CloseVisibleObjects", {}),
    ):
        assert controller.step(action, **arguments).metadata["lastActionSuccess"], action
    name = next(name for name, thing in objects(controller).items() if thing["objectType"] == "SoapBar")
    for action, arguments in (
        ("TeleportObjectToFloor", {"x": -1.5, "z": 0.5, "y": 0.1, "allowTeleportOutOfHand": True}),
        ("PickupObject", {"forceAction": True}),
    ):
        event = controller.step(action, objectId=name, **arguments)
        assert event.metadata["lastActionSuccess"], event.metadata["errorMessage"]
    sink = next(name for name, thing in objects(controller).items() if thing["objectType"] == "CounterTop")
    controller.step("PlaceHeldObject", objectId=sink, maxDistance=1.5, forceAction=True)
    assert controller.last_event.metadata["lastActionSuccess"], controller.last_event.metadata["errorMessage"]
    controller.step("PickupObject", objectId=name, forceAction=True)
    assert controller.step("DropHeldObjectAhead", forceAction=True, autoSimulation=False).metadata["lastActionSuccess"]
    assert not controller.last_event.metadata["inventoryObjects"]


def test_time_goes_on_step_by_step_only_while_it_is_paused(controller: Controller) -> None:
    controller.reset("FloorPlan405")
    assert not controller.step("AdvancePhysicsStep")
    assert controller.step("AdvancePhysicsStep", allowAutoSimulation=True)
    assert controller.step("PausePhysicsAutoSim")
    assert controller.step("AdvancePhysicsStep", timeStep=0.05, simSeconds=1.0)
    for wrong in ({"timeStep": 0.0}, {"timeStep": 0.06}, {"simSeconds": -1.0}):
        assert not controller.step("AdvancePhysicsStep", **wrong)
    assert controller.step("UnpausePhysicsAutoSim")
    assert not controller.step("AdvancePhysicsStep")


def test_visible_things_open_as_far_as_is_asked() -> None:
    kitchen = Controller(scene="FloorPlan2", width=64, height=64)
    drawer = next(name for name, thing in objects(kitchen).items() if thing["objectType"] == "Drawer")
    pose = kitchen.step("GetInteractablePoses", objectId=drawer).metadata["actionReturn"][0]
    kitchen.step("TeleportFull", **pose)
    kitchen.step("OpenVisibleObjects", openness=0.5)
    opened = [thing["openness"] for thing in objects(kitchen).values() if thing["isOpen"]]
    kitchen.stop()
    assert opened
    assert max(opened) == 0.5


def test_a_hand_is_told_as_the_camera_sees_it(controller: Controller) -> None:
    controller.reset("FloorPlan405")
    for action in ("LookDown", "LookUp", "LookUp"):
        told = controller.step(action).metadata
        tilt = told["heldObjectPose"]["localRotation"]["x"] + told["agent"]["cameraHorizon"]
        assert tilt % 360.0 == pytest.approx(0.0, abs=1e-4) or tilt % 360.0 == pytest.approx(360.0, abs=1e-4)


def test_points_of_what_is_not_seen_are_refused_unless_from_anywhere(controller: Controller) -> None:
    controller.reset("FloorPlan405")
    behind = next(
        name
        for name, thing in objects(controller).items()
        if thing["receptacle"] and not thing["visible"] and not thing["openable"]
    )
    event = controller.step("GetSpawnCoordinatesAboveReceptacle", objectId=behind, anywhere=False)
    assert event.metadata["errorMessage"] == "No valid Receptacle found in view"
    assert controller.step("GetSpawnCoordinatesAboveReceptacle", objectId=behind, anywhere=True).metadata[
        "lastActionSuccess"
    ]


@pytest.mark.parametrize("house", [{"rooms": []}, ["FloorPlan1"], 7])
def test_a_house_is_refused_in_one_line(controller: Controller, house: Any) -> None:
    with pytest.raises(ValueError, match="houses of ProcTHOR are not supported"):
        controller.reset(house)
    assert controller.step("Pass").metadata["lastActionSuccess"]


@pytest.mark.slow
def test_events_are_read_in_one_thread_while_another_steps(controller: Controller) -> None:
    controller.reset("FloorPlan405")
    wrong: list[object] = []
    is_over = threading.Event()

    def read() -> None:
        try:
            while not is_over.is_set():
                for thing in controller.last_event.metadata["objects"]:
                    away = thing["position"]
                    assert len(away) == 3
        except Exception as error:
            wrong.append(error)

    readers = [threading.Thread(target=read) for _ in range(3)]
    for reader in readers:
        reader.start()
    for _ in range(150):
        controller.step("RotateRight", renderImage=False)
    is_over.set()
    for reader in readers:
        reader.join()
    assert not wrong
