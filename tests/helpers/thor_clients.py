"""What clients of AI2-THOR's interface look up and do again and again."""

from remqa_data.thor import Controller


def first(controller: Controller, type_name: str) -> dict:
    """The metadata of the first object of a type."""
    return next(o for o in controller.last_event.metadata["objects"] if o["objectType"] == type_name)


def first_id(controller: Controller, type_name: str) -> str:
    return first(controller, type_name)["objectId"]


def stands_at(event) -> tuple[float, float]:
    """Where the agent of an event stands: x and z."""
    position = event.metadata["agent"]["position"]
    return position["x"], position["z"]


def act(controller: Controller, action: str, object_id: str, **arguments) -> None:
    event = controller.step(action, objectId=object_id, forceAction=True, **arguments)
    assert event, event.metadata["errorMessage"]
