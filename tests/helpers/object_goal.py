"""An agent as one writes it for AI2-THOR, from its documentation alone: it looks for an object and fetches it.

Nothing here knows of this package; `controller` may be any `ai2thor.controller.Controller`.
"""


class ObjectGoalAgent:
    """Walks through the reachable positions until it sees what it wants, opening what may hide it."""

    def __init__(self, controller):
        self.controller = controller

    def fetch(self, object_type):
        """Find an object of a type and pick it up; returns its metadata, or None."""
        seen = self.search(object_type)
        if seen is None:
            for receptacle in self.openable_receptacles():
                if self.go_to(receptacle) and self.open(receptacle):
                    seen = self.search(object_type, near=receptacle["position"])
                if seen is not None:
                    break
        if seen is None:
            return None
        event = self.controller.step(action="PickupObject", objectId=seen["objectId"])
        if not event.metadata["lastActionSuccess"]:
            return None
        return event.get_object(seen["objectId"])

    def search(self, object_type, near=None):
        """Teleport from place to place, look around everywhere; returns the first such object that is visible."""
        positions = self.controller.step(action="GetReachablePositions").metadata["actionReturn"]
        if near is not None:
            positions = sorted(positions, key=lambda p: (p["x"] - near["x"]) ** 2 + (p["z"] - near["z"]) ** 2)[:20]
        for position in positions[:: 1 if near else 3]:
            for rotation in (0, 90, 180, 270):
                for horizon in (30, 0) if near is None else (0, 30, 60):
                    event = self.controller.step(
                        action="Teleport",
                        position=position,
                        rotation={"x": 0, "y": rotation, "z": 0},
                        horizon=horizon,
                        standing=True,
                    )
                    if not event.metadata["lastActionSuccess"]:
                        continue
                    for candidate in event.objects_by_type(object_type):
                        if candidate["visible"] and candidate["pickupable"]:
                            return candidate
        return None

    def openable_receptacles(self):
        objects = self.controller.last_event.metadata["objects"]
        return [o for o in objects if o["openable"] and o["receptacle"] and not o["isOpen"]]

    def go_to(self, target):
        poses = self.controller.step(
            action="GetInteractablePoses", objectId=target["objectId"], horizons=[0, 30, 60], maxPoses=1
        ).metadata["actionReturn"]
        return bool(poses) and bool(self.controller.step("TeleportFull", **poses[0]))

    def open(self, target):
        event = self.controller.step(action="OpenObject", objectId=target["objectId"])
        return event.metadata["lastActionSuccess"] and event.get_object(target["objectId"])["isOpen"]
