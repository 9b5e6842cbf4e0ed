"""What objects are in besides where they are: clients find it in the metadata, and some of it happens by itself."""

import pytest

pytestmark = pytest.mark.slow

KNOB_AND_BURNER_APART_M = 0.6


def first(controller, type_name: str) -> dict:
    return next(o for o in controller.last_event.metadata["objects"] if o["objectType"] == type_name)


def forced(controller, action: str, type_name: str, **arguments):
    return controller.step(action, objectId=first(controller, type_name)["objectId"], forceAction=True, **arguments)


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
    assert all(o[field] is False for o in kitchen.last_event.metadata["objects"])


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
    cup, egg = (first(kitchen, type_name)["objectId"] for type_name in ("Cup", "Egg"))
    assert forced(kitchen, "BreakObject", "Egg")
    assert kitchen.step("DisableObject", objectId=cup)
    assert kitchen.last_event.get_object(egg)["parentReceptacles"] is None


def test_what_is_in_the_hand_is_toggled(kitchen) -> None:
    kitchen.reset("FloorPlan301")
    assert forced(kitchen, "PickupObject", "CellPhone")
    phone = first(kitchen, "CellPhone")["objectId"]
    was_on = first(kitchen, "CellPhone")["isToggled"]
    for is_on in (not was_on, was_on):
        event = kitchen.step("ToggleObjectOn" if is_on else "ToggleObjectOff", objectId=phone)
        assert event, event.metadata["errorMessage"]
        assert event.get_object(phone)["isToggled"] == is_on
