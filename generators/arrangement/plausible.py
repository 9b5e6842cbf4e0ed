"""What people keep in which things, and what comes to lie under them; the lists are in `templates/plausible.yaml`."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator

from remqa_data.catalog import Room, TypeName, object_type
from remqa_data.yaml_files import template_rules

SOURCE = "plausible.yaml"
DEFAULT = "default"
ByRoom = Mapping[Room, frozenset[str]]


class PlausibleTypes(BaseModel):
    """All of `plausible.yaml`: types that can be picked up, by relation, what hides them, and kind of room."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    inside: Mapping[str, ByRoom] = Field(alias="in")
    under: Mapping[str, ByRoom]
    nothing_else_in: frozenset[TypeName]

    @field_validator("inside", "under")
    @classmethod
    def _types_are_known(cls, table: Mapping[str, ByRoom]) -> Mapping[str, ByRoom]:
        hidden = {name for by_room in table.values() for names in by_room.values() for name in names}
        unfit = sorted(name for name in hidden if not object_type(name).pickupable)
        if unfit:
            raise ValueError(f"{unfit[0]} cannot be picked up, and is hidden nowhere")
        for name in table.keys() - {DEFAULT}:
            object_type(name)
        return table


def plausible_types(place_type: str, relation: Literal["in", "under"], room_type: str) -> frozenset[str]:
    """The types that are found in or under a type of thing in a kind of room.

    >>> "Egg" in plausible_types("Fridge", "in", "kitchen"), "Book" in plausible_types("Fridge", "in", "kitchen")
    (True, False)
    """
    table = _plausible().inside if relation == "in" else _plausible().under
    by_room: Mapping[str, frozenset[str]] = table.get(place_type, table.get(DEFAULT, {}))  # type: ignore[assignment]
    return by_room.get(room_type, frozenset())


def types_beside(place_type: str, relation: Literal["in", "under"], room_type: str) -> frozenset[str]:
    """The types that may lie beside those: what is found in or under anything in such a room, but for what nobody would do.

    >>> types = types_beside("Fridge", "in", "kitchen"), types_beside("Drawer", "in", "kitchen")
    >>> ["CellPhone" in those for those in types]
    [False, True]
    """
    if relation == "in" and place_type in _plausible().nothing_else_in:
        return plausible_types(place_type, relation, room_type)
    return _kept_in_rooms(room_type)


@lru_cache(maxsize=8)
def _kept_in_rooms(room_type: str) -> frozenset[str]:
    """The types that are found in or under anything in a kind of room."""
    tables = (_plausible().inside, _plausible().under)
    lists = [dict(by_room).get(room_type) for table in tables for by_room in table.values()]  # type: ignore[call-overload]
    return frozenset().union(*(names for names in lists if names))


@lru_cache(maxsize=1)
def _plausible() -> PlausibleTypes:
    return template_rules(PlausibleTypes, SOURCE)
