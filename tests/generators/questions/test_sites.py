from remqa_data.generators.arrangement.wished_things import has_room
from remqa_data.generators.questions.sites import takes
from tests.generators.test_distractors import DRAWER, FITS


def fits(*names: str):
    return lambda place: [pair for pair in FITS if pair[0] in names]


def test_a_place_takes_things_only_with_so_many_others_that_they_do_not_tell_the_answer() -> None:
    """By hand: phones are 8 x 16 cm and the drawer 60 x 40 cm, so that it holds three of each; plates are 24 cm wide."""
    phones = ("CellPhone",) * 3
    assert takes(has_room, fits("Apple"))(DRAWER, phones, ("CellPhone",), 0)
    assert takes(has_room, fits("Apple"))(DRAWER, (), ("CellPhone",), 3)
    assert takes(has_room, fits("Plate"))(DRAWER, (), ("CellPhone",), 2)
    assert not takes(has_room, fits("Plate"))(DRAWER, (), ("CellPhone",), 3)
    assert takes(has_room, fits("Plate", "Potato"))(DRAWER, (), ("CellPhone",), 3)


def test_a_place_takes_nothing_where_all_that_fits_is_taken_for_what_is_asked_for() -> None:
    assert not takes(has_room, fits("Cup"))(DRAWER, ("Mug",), ("Mug",), 0)
    assert not takes(has_room, fits())(DRAWER, (), ("CellPhone",), 0)
