"""What a piece of furniture leaves free for other objects, and the heights at which things rest in it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from remqa_data.catalog import types_with
from remqa_data.floorplans.ithor.plan import HOSTS, host_of
from remqa_data.floorplans.ithor.table import RecordedObject
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Box

HANGING = types_with("hangs_on_holder")
"""What hangs on something and so does not say where its surface is."""
SEATS = types_with("seat")
LEVELS_APART_M = 0.08
STACKED, STACKED_M = types_with("built_in"), 0.04
"""Of these types are cupboards made; one lies on another when no more than this is between them."""
SUNK = types_with("sunk_in")
"""What is let into a worktop."""
THIN_M = 0.2
"""A worktop that is no thicker than this holds no cabinets and drawers."""
LET_IN = {
    "Sink": frozenset({"SinkBasin", "Cabinet"}),
    "Bathtub": frozenset({"BathtubBasin"}),
    "CounterTop": SUNK,
} | dict.fromkeys(HOSTS - {"Cabinet"}, frozenset({"Drawer", "Shelf", "Cabinet"}))
"""Fixed types that have their place inside the box of a type of furniture."""


def pockets(o: RecordedObject, objects: Sequence[RecordedObject]) -> tuple[Box, ...]:
    """Boxes in the frame of an object's asset that belong to other objects, such as the drawers of a dresser."""
    if o.type == "Cabinet":
        guests = [guest for guest in objects if guest.type in ("Sink", "SinkBasin") and _hangs_into(guest, o)]
    else:
        guests = [guest for guest in objects if guest is not o and guest.type in _let_in(o) and _is_inside(guest, o)]
    return tuple(_clipped(_in_frame(guest, o), o) for guest in guests)


def is_built_in(o: RecordedObject, objects: Sequence[RecordedObject]) -> bool:
    """Whether an object is part of a piece of furniture, or of a stack of cabinets, drawers and shelves."""
    return host_of(o, objects) is not None or any(_is_stacked(o, other) for other in objects if other is not o)


def levels(o: RecordedObject, objects: Sequence[RecordedObject]) -> tuple[float, ...]:
    """Heights above an object's bottom at which its recorded contents rest, lowest first, at least 8 cm apart."""
    if not o.receptacle or o.type in ("Floor", "CounterTop"):
        return ()
    bottoms = sorted(
        float(item.low[2] - o.low[2])
        for item in objects
        if o.id in item.parents and item.pickupable and item.type not in HANGING
    )
    bottoms = [z for z in bottoms if -0.02 < z < o.size[2] + 0.02]
    if o.type in SEATS and bottoms:
        upright = [z for z in bottoms if z < 0.8 * o.size[2]] or bottoms
        return (float(np.median(upright)),)
    found: list[float] = []
    for z in bottoms:
        if not found or z - found[-1] > LEVELS_APART_M:
            found.append(max(z, 0.004))
    return tuple(found)


def _is_stacked(o: RecordedObject, other: RecordedObject) -> bool:
    """Whether two objects of which cupboards are made lie one right above the other."""
    if not {o.type, other.type} <= STACKED:
        return False
    middle = (o.low + o.high)[:2] / 2
    over = np.all(middle > other.low[:2]) and np.all(middle < other.high[:2])
    gap = min(abs(float(o.low[2] - other.high[2])), abs(float(other.low[2] - o.high[2])))
    return bool(over and gap < STACKED_M)


def _let_in(o: RecordedObject) -> frozenset[str]:
    if o.type == "CounterTop" and o.size[2] >= THIN_M:
        return SUNK | types_with("cupboard_front")
    return LET_IN.get(o.type, frozenset())


def _is_inside(guest: RecordedObject, o: RecordedObject) -> bool:
    middle = (guest.low + guest.high) / 2
    slack = np.array([0.02, 0.02, 0.3 if o.type == "CounterTop" else 0.05])
    return bool(np.all(middle > o.low - slack) and np.all(middle < o.high + slack))


def _hangs_into(sink: RecordedObject, cabinet: RecordedObject) -> bool:
    """Whether a sink reaches into a cabinet from above."""
    meets = np.all(sink.high > cabinet.low + 0.01) and np.all(sink.low < cabinet.high - 0.01)
    return bool(meets and sink.low[2] > cabinet.low[2] + 0.3 * cabinet.size[2])


def _in_frame(guest: RecordedObject, o: RecordedObject) -> F64:
    """(2, 3) box of a guest in the host's asset frame."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2 * guest.size
    points = arithmetic.turned_back(guest.centre + arithmetic.turned(corners, guest.rotation) - o.centre, o.rotation)
    return np.stack([points.min(axis=0), points.max(axis=0)])


def _clipped(box: F64, host: RecordedObject) -> Box:
    """A pocket never takes a piece of furniture's top board away, but for a sink in a cabinet."""
    low, high = box.copy()
    if host.type in HOSTS and host.type != "Cabinet":
        high[2] = min(high[2], host.size[2] / 2 - 0.02)
        low[2] = min(low[2], high[2] - 0.01)
    x0, y0, z0, x1, y1, z1 = (float(v) for v in (*low, *high))
    return x0, y0, z0, x1, y1, z1
