from dataclasses import replace

import numpy as np
import pytest

from remqa_data.generators.undisturbed import counted_again, disturbed
from remqa_data.sim.metadata import ObjectMetadata


def record(object_id: str, x: float, support: str | None = None, kind: str | None = None) -> ObjectMetadata:
    box = (x, 0.0, 0.0, x + 0.1, 0.1, 0.1)
    return ObjectMetadata(object_id, object_id.split("|")[0], "red", "metal", box, 0.0, False, support, kind)


DRAWER, DESK = record("Drawer|1", 0.0), record("Desk|1", 0.0)
BEFORE = {
    o.id: o
    for o in (
        DRAWER,
        DESK,
        record("Bowl|1", 0.0, "Drawer|1", "in"),
        record("Egg|1", 0.0, "Bowl|1", "in"),
        record("Mug|1", 0.0, "Drawer|1", "on"),
        record("Pen|1", 0.0, "Desk|1", "on"),
    )
}


def moved(*names: str, by: float = 0.3) -> dict[str, ObjectMetadata]:
    return {
        name: replace(o, box=(o.box[0] + by, *o.box[1:3], o.box[3] + by, *o.box[4:])) if name in names else o
        for name, o in BEFORE.items()
    }


@pytest.mark.parametrize(
    ("goes", "manipulation", "wrong"),
    [
        (("Drawer|1", "Bowl|1", "Egg|1"), "Open", []),
        (("Drawer|1", "Pen|1"), "Open", ["Pen|1"]),
        (("Drawer|1", "Mug|1"), "Open", ["Mug|1"]),
        (("Drawer|1", "Mug|1"), "Move", []),
        (("Drawer|1", "Desk|1"), "Move", ["Desk|1"]),
    ],
)
def test_what_is_in_a_target_may_move_with_it_and_what_is_on_it_unless_it_is_opened(goes, manipulation, wrong) -> None:
    assert disturbed(BEFORE, moved(*goes), "Drawer|1", manipulation) == wrong


def test_half_a_millimetre_is_no_motion() -> None:
    assert disturbed(BEFORE, moved("Pen|1", by=0.0005), "Drawer|1", "Open") == []


def picture(*names: str) -> np.ndarray:
    image = np.full((300, 300), -1, dtype=np.int32)
    for row, name in enumerate(names):
        image[row, :60] = list(BEFORE).index(name)
    return image


def recount(after, type_: str, inside: str | None, evidence: set[str], *shown: str, seen=()) -> set[str]:
    images = (picture(*seen), picture(*shown))
    return counted_again(BEFORE, after, images, tuple(BEFORE), type_, inside, evidence)


def test_what_is_still_in_the_drawer_and_seen_is_counted() -> None:
    after = moved("Drawer|1", "Bowl|1", "Egg|1")
    assert recount(after, "Bowl", "Drawer|1", {"Bowl|1"}, "Bowl|1") == {"Bowl|1"}
    assert recount(after, "Bowl", "Drawer|1", {"Bowl|1"}) == set()
    out = {**after, "Bowl|1": replace(after["Bowl|1"], support="Desk|1")}
    assert recount(out, "Bowl", "Drawer|1", {"Bowl|1"}, "Bowl|1") == set()


def test_what_was_to_lie_still_and_was_dragged_along_is_not_counted() -> None:
    assert recount(BEFORE, "Pen", None, {"Pen|1"}, "Pen|1") == {"Pen|1"}
    assert recount(moved("Pen|1"), "Pen", None, {"Pen|1"}, "Pen|1") == set()


def test_anything_else_of_the_type_that_comes_to_light_is_counted_and_what_was_seen_before_is_not() -> None:
    assert recount(BEFORE, "Pen", "Drawer|1", set(), "Pen|1") == {"Pen|1"}
    assert recount(BEFORE, "Pen", "Drawer|1", set(), "Pen|1", seen=("Pen|1",)) == set()
