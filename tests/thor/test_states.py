import pytest

pytestmark = pytest.mark.slow

SWITCH = "LightSwitch|+02.33|+01.31|-00.16"


def test_toggles_all_objects_of_a_type(kitchen) -> None:
    stove = ("StoveKnob", "StoveBurner")
    burners = [o["objectId"] for o in kitchen.last_event.metadata["objects"] if o["objectType"] in stove]
    assert len(burners) > 2
    event = kitchen.step("SetObjectToggles", objectToggles=[{"objectType": "StoveKnob", "isOn": True}])
    on = {o["objectId"] for o in event.metadata["objects"] if o["isToggled"]}
    assert on == set(burners)
    toggles = [{"objectType": "StoveKnob", "isOn": False}, {"objectType": "LightSwitch", "isOn": "true"}]
    event = kitchen.step("SetObjectToggles", objectToggles=toggles)
    assert [o["objectId"] for o in event.metadata["objects"] if o["isToggled"]] == [SWITCH]


def test_what_is_seen_is_opened_and_closed(kitchen) -> None:
    fridge = "Fridge|-02.10|+00.00|+01.07"
    assert kitchen.step("Teleport", position={"x": -0.75, "y": 0.9, "z": 1.5}, rotation=270, horizon=30)
    before = {r["objectId"]: r for r in kitchen.last_event.metadata["objects"] if r["openable"]}
    seen = {name for name, record in before.items() if record["visible"]}
    assert fridge in seen
    assert len(seen) < len(before)
    after = {r["objectId"]: r for r in kitchen.step("OpenVisibleObjects").metadata["objects"] if r["openable"]}
    assert {name for name, record in after.items() if record["isOpen"]} == seen
    hidden = {name for name in seen if not after[name]["visible"]}  # by what is open
    event = kitchen.step("CloseVisibleObjects", simplifyPhysics=True)
    assert {record["objectId"] for record in event.metadata["objects"] if record["isOpen"]} == hidden
    assert fridge not in hidden


def test_types_without_a_switch_are_passed_over_and_what_is_no_type_is_refused(kitchen) -> None:
    toggles = [{"objectType": name, "isOn": True} for name in ("Apple", "Candle", "LightSwitch")]
    event = kitchen.step("SetObjectToggles", objectToggles=toggles)
    assert event, event.metadata["errorMessage"]
    assert [o["objectId"] for o in event.metadata["objects"] if o["isToggled"]] == [SWITCH]
    kitchen.reset()
    toggles = [{"objectType": "LightSwitch", "isOn": True}, {"objectType": "Aple", "isOn": True}]
    event = kitchen.step("SetObjectToggles", objectToggles=toggles)
    assert not event
    assert not event.get_object(SWITCH)["isToggled"]
    with pytest.raises(ValueError, match=r"objectToggles\.0\.isOn"):
        kitchen.step("SetObjectToggles", objectToggles=[{"objectType": "Apple"}])


@pytest.mark.parametrize("name", ["stateChange", "StateChange"])
def test_all_is_switched(kitchen, name) -> None:
    event = kitchen.step("SetStateOfAllObjects", **{name: "CanToggleOnOff"}, forceAction=True)
    records = event.metadata["objects"]
    assert {o["isToggled"] for o in records if o["toggleable"]} == {True}
    assert {o["objectType"] for o in records if not o["toggleable"] and o["isToggled"]} == {"StoveBurner"}
    event = kitchen.step("SetStateOfAllObjects", **{name: "CanToggleOnOff"}, forceAction=False)
    assert not any(o["isToggled"] for o in event.metadata["objects"])


@pytest.mark.parametrize("scene", ["FloorPlan1", "FloorPlan303"])
def test_all_is_opened_and_shut_again(kitchen, scene) -> None:
    start = kitchen.reset(scene)
    world = kitchen.server.session._simulator.room.world
    event = kitchen.step("SetStateOfAllObjects", stateChange="CanOpen", forceAction=True)
    opened = [o for o in event.metadata["objects"] if o["openable"]]
    assert len(opened) > 5
    assert sum(o["isOpen"] for o in opened) > len(opened) / 2
    checked = 0
    for record in opened:
        depths = world.depths_when_open(record["objectId"], record["openness"])
        shut = world.depths_when_open(record["objectId"], 0.0)
        assert all(depth <= max(0.005, shut.get(other, 0.0)) for other, depth in depths.items()), record["objectId"]
        checked += len(depths)
    assert checked > 0
    event = kitchen.step("SetStateOfAllObjects", stateChange="CanOpen", forceAction=False)
    assert not any(o["isOpen"] for o in event.metadata["objects"])
    places = {o["objectId"]: o["position"] for o in event.metadata["objects"]}
    assert all(places[o["objectId"]] == pytest.approx(o["position"], abs=0.01) for o in start.metadata["objects"])


def test_all_is_sliced_and_states_that_there_are_not(kitchen) -> None:
    start = kitchen.last_event.metadata["objects"]
    event = kitchen.step("SetStateOfAllObjects", stateChange="CanBeSliced", forceAction=False)
    assert event  # all is whole anyway
    assert event.metadata["objects"] == start
    assert kitchen.step("SetStateOfAllObjects", stateChange="CanBeSliced", forceAction=True)
    whole = [o for o in kitchen.last_event.metadata["objects"] if o["sliceable"]]
    assert len(whole) > 3
    assert all(o["isSliced"] for o in whole)
    assert "CanOpen" in kitchen.step("SetStateOfAllObjects", stateChange="CanFly").metadata["errorMessage"]
    with pytest.raises(ValueError, match="missing the following arguments: stateChange"):
        kitchen.step("SetStateOfAllObjects", forceAction=True)


@pytest.mark.parametrize(
    ("action", "arguments"),
    [
        ("SetRandomSeed", {"seed": 5}),
        ("MakeAllObjectsMoveable", {}),
        ("ChangeOpenSpeed", {"openSpeed": 2.0}),
        ("SetDecayTemperatureBool", {"allowDecayTemperature": False}),
    ],
)
def test_what_sets_nothing_is_accepted(kitchen, action, arguments) -> None:
    before = kitchen.step("Pass").metadata
    assert kitchen.step(action, **arguments).metadata == {**before, "lastAction": action}


@pytest.mark.slow
def test_all_objects_of_a_type_get_a_state(kitchen) -> None:
    def are(event, kind: str, flag: str) -> set[bool]:
        return {o[flag] for o in event.metadata["objects"] if o["objectType"] == kind}

    for kind, change, flag in (("Fridge", "openable", "isOpen"), ("Mug", "dirtyable", "isDirty")):
        before = kitchen.last_event
        asked = {"objectType": kind, "stateChange": change, flag: True}
        event = kitchen.step("SetObjectStates", SetObjectStates=asked)
        assert event, event.metadata["errorMessage"]
        assert are(before, kind, flag) == {False}
        assert are(event, kind, flag) == {True}
        others = [o for o in event.metadata["objects"] if o["objectType"] != kind]
        assert [o[flag] for o in others] == [o[flag] for o in before.metadata["objects"] if o["objectType"] != kind]
        event = kitchen.step("SetObjectStates", SetObjectStates={**asked, flag: False})
        assert are(event, kind, flag) == {False}
    wrong = kitchen.step("SetObjectStates", SetObjectStates={"stateChange": "burning"})
    assert "choose one of openable" in wrong.metadata["errorMessage"]
