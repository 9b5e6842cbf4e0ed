"""Which rooms come first when fewer than all are asked for."""

from __future__ import annotations

from remqa_data.errors import QuotaError
from remqa_data.floorplans.splits import ROOMS_OF_A_TYPE, TEST_ROOMS_OF_A_TYPE
from remqa_data.generators.questions.capacity_table import recorded_capacities
from remqa_data.published import QUESTIONS
from remqa_data.tables.rows import KINDS

ROOM_OFFSETS = (0, 200, 300, 400)
"""iTHOR's numbers: kitchens 1 to 30, living rooms 201 to 230, bedrooms 301 to 330, bathrooms 401 to 430."""
TEST_TURNS = (0, 1, 2, 3)
"""Room types by index, in the order in which they get a test room that is one too many: those first that can be asked most."""


def choose_scenes(count: int) -> tuple[str, ...]:
    """So many rooms, of all types alike, a sixth of them for testing, in iTHOR's order.

    Those come first of which most can be asked, as few rooms must take their share of all kinds of question.

    >>> choose_scenes(4)
    ('FloorPlan27', 'FloorPlan213', 'FloorPlan325', 'FloorPlan421')

    Raises
    ------
    QuotaError
        If there are not so many.
    """
    most = len(ROOM_OFFSETS) * ROOMS_OF_A_TYPE
    if not 1 <= count <= most:
        raise QuotaError(f"{count} scenes: iTHOR has {most} rooms; ask for 1 to {most}")
    tests = round(count * TEST_ROOMS_OF_A_TYPE / ROOMS_OF_A_TYPE)
    if count > 1:
        tests = max(tests, 1)
    numbers: list[int] = []
    for index, offset in enumerate(ROOM_OFFSETS):
        rooms, tested = _share(count, index), _share(tests, TEST_TURNS.index(index))
        first_test = offset + ROOMS_OF_A_TYPE - TEST_ROOMS_OF_A_TYPE + 1
        for first, last, wanted in (
            (offset + 1, first_test, rooms - tested),
            (first_test, offset + 1 + ROOMS_OF_A_TYPE, tested),
        ):
            order = sorted(range(first, last), key=_what_can_be_asked, reverse=True)
            numbers += sorted(order[:wanted])
    return tuple(f"FloorPlan{number}" for number in numbers)


def _what_can_be_asked(number: int) -> float:
    """How much of a room's share of each kind of question it takes, of the kind of which it takes least."""
    most, wanted = recorded_capacities()[f"FloorPlan{number}"].most, QUESTIONS["test"]
    return min(most[kind] / wanted[kind] for kind in KINDS)


def _share(count: int, turn: int) -> int:
    """How many of some things the room type gets whose turn it is, when they are dealt out in turns."""
    return count // len(ROOM_OFFSETS) + (turn < count % len(ROOM_OFFSETS))
