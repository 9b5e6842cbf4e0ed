import random

import pytest

TOASTER = "Toaster|-01.84|+00.90|+00.13"
STEPS = ("MoveAhead", "MoveRight", "MoveBack", "RotateRight", "RotateLeft", "LookDown", "LookUp", "Crouch", "Stand")


def flags(event) -> list[str]:
    return [record["objectId"] for record in event.metadata["objects"] if record["visible"]]


def in_plain_sight(controller) -> list[str]:
    """What a whole picture shows, object by object, near enough."""
    agent = controller.server.session._simulator.agent
    shown = agent.seen_in(agent.view.instances(agent.camera()))
    return [name for name in shown if agent.plan_distance(name) <= 1.5]


@pytest.mark.slow
@pytest.mark.parametrize("size", [(300, 300), (400, 130)])
def test_a_step_without_pictures_sees_what_a_picture_shows(kitchen, size) -> None:
    kitchen.reset(width=size[0], height=size[1])
    rng, seen = random.Random(0), 0
    places = kitchen.step("GetReachablePositions").metadata["actionReturn"]
    for _ in range(40):
        kitchen.step("Teleport", position=rng.choice(places), rotation=rng.choice((0, 45, 90, 180, 270)))
        event = kitchen.step(rng.choice(STEPS), renderImage=False)
        assert flags(event) == in_plain_sight(kitchen)
        seen += len(flags(event))
    assert seen > 40


def test_what_was_seen_from_a_pose_is_forgotten_when_the_room_changes(kitchen) -> None:
    (pose, *_) = kitchen.step("GetInteractablePoses", objectId=TOASTER, maxPoses=1).metadata["actionReturn"]
    before = flags(kitchen.step("TeleportFull", **pose, renderImage=False))
    assert TOASTER in before
    kitchen.step("RemoveFromScene", objectId=TOASTER, renderImage=False)
    gone = flags(kitchen.step("Pass", renderImage=False))
    assert TOASTER not in gone
    assert gone == in_plain_sight(kitchen)
    assert kitchen.step("EnableObject", objectId=TOASTER, renderImage=False)
    assert flags(kitchen.step("Pass", renderImage=False)) == before


def test_who_changes_an_event_changes_no_later_one(kitchen) -> None:
    first = kitchen.last_event.metadata["objects"]
    for record in first:
        record["axisAlignedBoundingBox"]["center"]["x"] = record["axisAlignedBoundingBox"]["cornerPoints"][0][0] = 99.0
        record["position"]["x"] = record["rotation"]["x"] = 99.0
        for name in ("salientMaterials", "receptacleObjectIds", "parentReceptacles"):
            if record[name]:
                record[name].append(99.0)
        if record["objectOrientedBoundingBox"]:
            record["objectOrientedBoundingBox"]["cornerPoints"][0][0] = 99.0
    assert "99.0" not in str(kitchen.step("Pass", renderImage=False).metadata["objects"])
