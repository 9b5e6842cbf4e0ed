"""Places, and what fits them, guessed from the boxes of a room as recorded: for tests that plan questions without physics.

The true ones come from `remqa_data.generators.arrangement.hiding_places`, which needs a simulated room.
"""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Literal

from remqa_data.assets.core.sizes import typical_size
from remqa_data.catalog import object_type, question_types
from remqa_data.sim.metadata import ObjectMetadata

SPOTS = {"Cabinet": 6, "Drawer": 4, "Fridge": 6, "Microwave": 2, "Safe": 4, "Box": 3, "LaundryHamper": 3}
# fmt: off
LIFTED = frozenset([
    "AlarmClock", "Book", "Bowl", "Box", "Bread", "Laptop", "Lettuce", "Newspaper", "Pan", "Pillow", "Plate", "Pot",
    "TeddyBear", "TissueBox", "Vase",
])
MOVED = frozenset([
    "CoffeeMachine", "DeskLamp", "GarbageCan", "HousePlant", "Microwave", "SideTable", "Television", "Toaster", "ArmChair",
    "Chair",
])
# fmt: on
UNDER_SPOTS = 2
EPSILON = 0.02


@dataclass(frozen=True)
class StandIn:
    object_id: str
    type: str
    manipulation: Literal["Open", "Pickup", "Move"]
    relation: Literal["in", "under"]
    spots: Sequence[int]
    size: tuple[float, float, float]


def stand_in_places(objects: Mapping[str, ObjectMetadata]) -> list[StandIn]:
    places = []
    for record in objects.values():
        box = record.box
        size = (box[3] - box[0], box[4] - box[1], box[5] - box[2])
        inside = record.support is not None and objects[record.support].type in SPOTS
        if record.type in SPOTS:
            places.append(StandIn(record.id, record.type, "Open", "in", range(SPOTS[record.type]), size))
        if record.type in LIFTED and min(size[:2]) >= 0.08 and not inside:
            places.append(StandIn(record.id, record.type, "Pickup", "under", range(UNDER_SPOTS), size))
        if record.type in MOVED and min(size[:2]) >= 0.1 and max(size[:2]) <= 0.8:
            places.append(StandIn(record.id, record.type, "Move", "under", range(UNDER_SPOTS), size))
    return places


def stand_in_types(place: StandIn, room_type: str) -> list[tuple[str, float]]:
    found = []
    for name in question_types():
        size = sorted(typical_size(name))
        prior = _priors().get((name, place.type, room_type), 0.0) + EPSILON * (room_type in object_type(name).rooms)
        thin = size[0] <= 0.03 and size[2] <= max(place.size[:2]) if place.relation == "under" else True
        fits = thin and size[1] <= min(place.size[:2]) * 0.9 and size[2] <= 0.9 * max(place.size)
        if object_type(name).pickupable and fits and name != place.type and prior > 0:
            found.append((name, prior))
    return found


@cache
def _priors() -> dict[tuple[str, str, str], float]:
    with (resources.files("remqa_data.templates") / "placements.csv").open(encoding="utf-8") as file:
        rows = csv.DictReader(file)
        return {(r["object_type"], r["receptacle_type"], r["room"]): float(r["probability"]) for r in rows}
