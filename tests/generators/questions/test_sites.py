from remqa_data.generators.arrangement.wished_things import has_room
from remqa_data.generators.questions.sites import takes
from tests.generators.test_distractors import DRAWER, FITS


def fits(*names: str):
    return lambda place: [pair for pair in FITS if pair[0] in names]


PHONES = ("CellPhone",) * 3


def test_a_place_takes_things_only_with_so_many_others_that_their_number_does_not_tell_the_answer() -> None:
    """By hand: phones and remotes are about 8 x 16 and 7 x 22 cm, and the drawer 60 x 40 cm."""
    take = takes(has_room, fits("RemoteControl"))
    assert take(DRAWER, PHONES, ("CellPhone",), 0)
    assert take(DRAWER, (), ("CellPhone",), 3)
    assert not take(DRAWER, PHONES, ("CellPhone",), 12)


def test_others_are_about_as_large_so_that_pixels_do_not_tell_the_answer() -> None:
    assert not takes(has_room, fits("Plate"))(DRAWER, (), ("CellPhone",), 1)
    assert takes(has_room, fits("Plate", "RemoteControl"))(DRAWER, (), ("CellPhone",), 1)
    assert not takes(has_room, fits("Plate", "RemoteControl"))(DRAWER, (), ("CellPhone", "Egg"), 1)


def test_a_place_takes_nothing_where_all_that_fits_is_taken_for_what_is_asked_for() -> None:
    assert not takes(has_room, fits("Cup"))(DRAWER, ("Mug",), ("Mug",), 0)
    assert not takes(has_room, fits())(DRAWER, (), ("CellPhone",), 0)
