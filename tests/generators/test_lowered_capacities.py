from remqa_data.generators.lowered_capacities import lowered
from remqa_data.generators.questions.allotment import allot
from remqa_data.generators.questions.capacity_table import capacities


def test_rooms_that_had_less_than_they_were_asked_for_can_take_no_more() -> None:
    rooms = capacities(["FloorPlan2", "FloorPlan3"])
    asked = allot(rooms, {"train": {"EXISTENCE": 40, "COUNTING": 24, "SPATIAL": 24}})
    two, three = ({kind: quota.total(kind) for kind in quota.answers} for quota in asked)
    had = {("FloorPlan2", kind): n for kind, n in two.items()} | {("FloorPlan3", kind): n for kind, n in three.items()}
    assert lowered(rooms, asked, had) == rooms
    assert three["EXISTENCE"] > 9
    second = lowered(rooms, asked, had | {("FloorPlan3", "EXISTENCE"): 9})
    assert second[0] == rooms[0]
    assert (second[1].most["EXISTENCE"], second[1].lots["EXISTENCE"]) == (2, 2)
    assert second[1].most["COUNTING"] == rooms[1].most["COUNTING"]
