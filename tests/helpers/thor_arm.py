"""What tests of the Controller's arm share: an apple to take, and where the hand is."""

import math

APPLE = "Apple|-00.47|+01.15|+00.48"
BEFORE_APPLE = {"x": -1.0, "y": 0.9, "z": 0.5, "rotation": 90, "horizon": 30, "standing": True}


def stand_before(controller, point) -> None:
    """Stand as near as one can, face a point, and bring the shoulder a little above it."""
    places = controller.step("GetReachablePositions").metadata["actionReturn"]
    near = min(places, key=lambda place: math.hypot(place["x"] - point["x"], place["z"] - point["z"]))
    yaw = math.degrees(math.atan2(point["x"] - near["x"], point["z"] - near["z"]))
    assert controller.step("Teleport", position=near, rotation=yaw)
    assert controller.step("MoveArmBase", y=point["y"] + 0.1, normalizedY=False)


def hand(event) -> dict[str, float]:
    return event.metadata["arm"]["handSphereCenter"]


def from_shoulder(event) -> dict[str, float]:
    return event.metadata["arm"]["joints"][3]["rootRelativePosition"]
