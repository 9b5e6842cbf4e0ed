"""The hiding places of recorded rooms, found once for all tests of a process; a kitchen takes seconds."""

from functools import cache

from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.generators.arrangement.hiding_place import HidingPlace
from remqa_data.generators.arrangement.hiding_places import hiding_places


@cache
def places_of(room: str) -> tuple[HidingPlace, ...]:
    """Not to be changed."""
    return tuple(hiding_places(load_scene(room)))
