"""What objects are in besides where they are: clients find it in the metadata, and some of it happens by itself."""

import pytest

from tests.helpers.thor_clients import first, first_id

pytestmark = pytest.mark.slow

KNOB_AND_BURNER_APART_M = 0.6


def forced(controller, action: str, type_name: str, **arguments):
    return controller.step(action, objectId=first_id(controller, type_name), forceAction=True, **arguments)


def put(controller, type_name: str, into: str) -> None:
    assert forced(controller, "PickupObject", type_name), controller.last_event.metadata["errorMessage"]
    assert forced(controller, "PutObject", into), controller.last_event.metadata["errorMessage"]


@pytest.mark.parametrize(
    ("action", "type_name", "field", "back"),
    [
        ("BreakObject", "Plate", "isBroken", None),
        ("CookObject", "Potato", "isCooked", None),
        ("DirtyObject", "Plate", "isDirty", "CleanObject"),
        ("FillObjectWithLiquid", "Mug", "isFilledWithLiquid", "EmptyLiquidFromObject"),
    ],
)
def test_a_condition_is_given_and_taken(kitchen, action, type_name, field, back) -> None:
    assert not first(kitchen, type_name)[field]
    assert forced(kitchen, action, type_name)
    assert first(kitchen, type_name)[field]
    assert not forced(kitchen, action, type_name)
    assert " is already " in kitchen.last_event.metadata["errorMessage"]
    if back is not None:
        assert forced(kitchen, back, type_name)
        assert not first(kitchen, type_name)[field]
        assert not forced(kitchen, back, type_name)
    kitchen.reset("FloorPlan1")
    assert not first(kitchen, type_name)[field]


def test_what_it_is_filled_with(kitchen) -> None:
    assert first(kitchen, "Mug")["fillLiquid"] is None
    assert forced(kitchen, "FillObjectWithLiquid", "Mug", fillLiquid="wine")
    assert first(kitchen, "Mug")["fillLiquid"] == "wine"
    assert not forced(kitchen, "FillObjectWithLiquid", "Cup", fillLiquid="oil")
    assert kitchen.last_event.metadata["errorMessage"] == "fillLiquid 'oil' is none of water, coffee, wine"


@pytest.mark.parametrize(("action", "word"), [("CookObject", "cookable"), ("FillObjectWithLiquid", "fillable")])
def test_what_cannot_be_in_a_condition(kitchen, action, word) -> None:
    assert not forced(kitchen, action, "Fork")
    assert kitchen.last_event.metadata["errorMessage"].endswith(f"is not {word}")


def test_what_is_not_seen_is_not_changed_unless_forced(kitchen) -> None:
    hidden = next(o for o in kitchen.last_event.metadata["objects"] if o["dirtyable"] and not o["visible"])
    assert not kitchen.step("DirtyObject", objectId=hidden["objectId"])
    assert kitchen.step("DirtyObject", objectId=hidden["objectId"], forceAction=True)
    with pytest.raises(ValueError, match="objectId"):
        kitchen.step("DirtyObject")


def test_a_fridge_cools_and_a_microwave_cooks(kitchen) -> None:
    assert first(kitchen, "Potato")["temperature"] == "RoomTemp"
    assert forced(kitchen, "OpenObject", "Fridge")
    put(kitchen, "Potato", "Fridge")
    assert first(kitchen, "Potato")["temperature"] == "Cold"
    assert forced(kitchen, "OpenObject", "Microwave")
    put(kitchen, "Potato", "Microwave")
    assert not forced(kitchen, "ToggleObjectOn", "Microwave")
    assert kitchen.last_event.metadata["errorMessage"] == "Target must be closed to Toggle On!"
    assert forced(kitchen, "CloseObject", "Microwave")
    assert first(kitchen, "Potato")["temperature"] == "Cold"
    assert forced(kitchen, "ToggleObjectOn", "Microwave")
    potato = first(kitchen, "Potato")
    assert (potato["temperature"], potato["isCooked"]) == ("Hot", True)
    assert not forced(kitchen, "OpenObject", "Microwave")
    assert kitchen.last_event.metadata["errorMessage"] == "Target must be OFF to open!"
    assert forced(kitchen, "ToggleObjectOff", "Microwave")
    assert forced(kitchen, "OpenObject", "Microwave")


def test_a_knob_lights_its_own_burner(kitchen) -> None:
    records = {o["objectId"]: o for o in kitchen.last_event.metadata["objects"]}
    knobs = [o for o in records.values() if o["objectType"] == "StoveKnob"]
    burners = [records[burner] for knob in knobs for burner in knob["controlledObjects"]]
    assert len({o["objectId"] for o in burners}) == len(knobs) > 1
    assert {o["objectType"] for o in burners} == {"StoveBurner"}
    for knob, burner in zip(knobs, burners, strict=True):
        gaps = [knob["position"][axis] - burner["position"][axis] for axis in "xz"]
        assert sum(gap**2 for gap in gaps) < KNOB_AND_BURNER_APART_M**2
    on, pan = burners[0]["objectId"], next(o for o in records.values() if o["objectType"] == "Pan")["objectId"]
    assert kitchen.step("PickupObject", objectId=pan, forceAction=True)
    assert kitchen.step("PutObject", objectId=on, forceAction=True)
    for knob in knobs[1:]:
        assert kitchen.step("ToggleObjectOn", objectId=knob["objectId"], forceAction=True)
    assert first(kitchen, "Pan")["temperature"] == "RoomTemp"
    assert kitchen.step("ToggleObjectOn", objectId=knobs[0]["objectId"], forceAction=True)
    assert first(kitchen, "Pan")["temperature"] == "Hot"


def test_water_cleans_and_fills(kitchen) -> None:
    assert forced(kitchen, "DirtyObject", "Mug")
    put(kitchen, "Mug", "SinkBasin")
    assert first(kitchen, "Mug")["isDirty"]
    assert forced(kitchen, "ToggleObjectOn", "Faucet")
    mug = first(kitchen, "Mug")
    assert (mug["isDirty"], mug["isFilledWithLiquid"], mug["fillLiquid"]) == (False, True, "water")


def test_a_coffee_machine_fills_a_mug(kitchen) -> None:
    put(kitchen, "Mug", "CoffeeMachine")
    assert first(kitchen, "Mug")["fillLiquid"] is None
    assert forced(kitchen, "ToggleObjectOn", "CoffeeMachine")
    assert first(kitchen, "Mug")["fillLiquid"] == "coffee"


@pytest.mark.parametrize(
    ("change", "able", "field"),
    [
        ("CanBeDirty", "dirtyable", "isDirty"),
        ("CanBeFilled", "canFillWithLiquid", "isFilledWithLiquid"),
        ("CanBeCooked", "cookable", "isCooked"),
        ("CanBreak", "breakable", "isBroken"),
    ],
)
def test_all_objects_at_once(kitchen, change, able, field) -> None:
    kitchen.step("SetStateOfAllObjects", stateChange=change, forceAction=True)
    listed = kitchen.last_event.metadata["objects"]
    assert any(o[able] for o in listed)
    assert all(o[field] is o[able] for o in listed)
    kitchen.step("SetStateOfAllObjects", stateChange=change, forceAction=False)
    assert all(o[field] is False for o in kitchen.last_event.metadata["objects"] if not o["isSliced"])


def test_what_is_broken_holds_nothing(kitchen) -> None:
    assert forced(kitchen, "FillObjectWithLiquid", "Mug")
    assert forced(kitchen, "BreakObject", "Mug")
    assert (first(kitchen, "Mug")["isFilledWithLiquid"], first(kitchen, "Mug")["fillLiquid"]) == (False, None)
    assert not forced(kitchen, "FillObjectWithLiquid", "Mug")
    assert kitchen.last_event.metadata["errorMessage"].endswith("is broken and holds nothing")
    assert kitchen.step("SetStateOfAllObjects", stateChange="CanBeFilled", forceAction=True)
    assert not first(kitchen, "Mug")["isFilledWithLiquid"]
    assert first(kitchen, "Cup")["isFilledWithLiquid"]


def test_what_is_out_of_the_scene_holds_nothing(kitchen) -> None:
    cup, egg = (first_id(kitchen, type_name) for type_name in ("Cup", "Egg"))
    assert forced(kitchen, "BreakObject", "Egg")
    assert kitchen.step("DisableObject", objectId=cup)
    assert kitchen.last_event.get_object(egg)["parentReceptacles"] is None


def test_what_is_in_the_hand_is_toggled(kitchen) -> None:
    kitchen.reset("FloorPlan301")
    assert forced(kitchen, "PickupObject", "CellPhone")
    phone = first_id(kitchen, "CellPhone")
    was_on = first(kitchen, "CellPhone")["isToggled"]
    for is_on in (not was_on, was_on):
        event = kitchen.step("ToggleObjectOn" if is_on else "ToggleObjectOff", objectId=phone)
        assert event, event.metadata["errorMessage"]
        assert event.get_object(phone)["isToggled"] == is_on


def test_an_egg_that_is_broken_in_the_hand_falls_before_the_agent(kitchen) -> None:
    kitchen.reset("FloorPlan4")
    assert forced(kitchen, "PickupObject", "Egg")
    places = kitchen.step("GetReachablePositions").metadata["actionReturn"]
    here = kitchen.last_event.metadata["agent"]["position"]
    far = max(places, key=lambda place: abs(place["x"] - here["x"]) + abs(place["z"] - here["z"]))
    assert kitchen.step("Teleport", position=far)
    assert forced(kitchen, "BreakObject", "Egg")
    cracked = first(kitchen, "EggCracked")
    assert cracked["distance"] < 1.5
    assert kitchen.last_event.metadata["inventoryObjects"] == []


@pytest.mark.parametrize("held", [True, False])
def test_eggs_are_broken_alike_by_either_action(kitchen, held) -> None:
    for action, arguments in (
        ("BreakObject", {"objectId": first_id(kitchen, "Egg"), "forceAction": True}),
        ("SetObjectStates", {"SetObjectStates": {"objectType": "Egg", "stateChange": "breakable", "isBroken": True}}),
        ("SetStateOfAllObjects", {"stateChange": "CanBreak", "forceAction": True}),
    ):
        kitchen.reset("FloorPlan1")
        if held:
            assert forced(kitchen, "PickupObject", "Egg")
        assert kitchen.step(action, **arguments)
        assert kitchen.last_event.metadata["errorMessage"] == ""
        assert first(kitchen, "Egg")["isBroken"]
        assert first(kitchen, "EggCracked")
        assert kitchen.last_event.metadata["inventoryObjects"] == []


def test_what_is_broken_goes_out_and_stays_so(kitchen) -> None:
    kitchen.reset("FloorPlan205")
    assert forced(kitchen, "ToggleObjectOn", "Laptop")
    assert forced(kitchen, "BreakObject", "Laptop")
    assert not first(kitchen, "Laptop")["isToggled"]
    kitchen.step("SetObjectToggles", objectToggles=[{"objectType": "Laptop", "isOn": True}])
    assert not first(kitchen, "Laptop")["isToggled"]
    assert not forced(kitchen, "ToggleObjectOn", "Laptop")


def test_a_microwave_is_open_or_on_whatever_is_asked(kitchen) -> None:
    def ask(is_open: bool, is_on: bool) -> None:
        changes = {"openable": {"isOpen": is_open}, "toggleable": {"isToggled": is_on}}
        for change, flags in changes.items():
            wanted = {"objectType": "Microwave", "stateChange": change, **flags}
            assert kitchen.step("SetObjectStates", SetObjectStates=wanted)

    ask(is_open=True, is_on=True)
    assert (first(kitchen, "Microwave")["isOpen"], first(kitchen, "Microwave")["isToggled"]) == (True, False)
    ask(is_open=False, is_on=True)
    ask(is_open=True, is_on=True)
    assert (first(kitchen, "Microwave")["isOpen"], first(kitchen, "Microwave")["isToggled"]) == (False, True)


def test_coffee_is_hot(kitchen) -> None:
    assert forced(kitchen, "FillObjectWithLiquid", "Mug")
    assert first(kitchen, "Mug")["temperature"] == "RoomTemp"
    kitchen.reset("FloorPlan1")
    assert forced(kitchen, "FillObjectWithLiquid", "Mug", fillLiquid="coffee")
    assert first(kitchen, "Mug")["temperature"] == "Hot"


def test_what_comes_to_lie_upside_down_is_empty(kitchen) -> None:
    assert forced(kitchen, "FillObjectWithLiquid", "Mug")
    mug = first(kitchen, "Mug")
    pose = {"objectName": mug["name"], "position": mug["position"], "rotation": mug["rotation"]}
    assert kitchen.step("SetObjectPoses", objectPoses=[pose])
    assert first(kitchen, "Mug")["isFilledWithLiquid"]
    over = {
        **pose,
        "position": {**mug["position"], "y": mug["position"]["y"] + 0.2},
        "rotation": {"x": 180, "y": 0, "z": 0},
    }
    assert kitchen.step("SetObjectPoses", objectPoses=[over])
    assert not first(kitchen, "Mug")["isFilledWithLiquid"]
