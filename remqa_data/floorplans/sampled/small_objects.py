"""Puts small things on and into a room's furniture, on the types of furniture where they were recorded."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np

from remqa_data.catalog import types_with
from remqa_data.floorplans.ithor.placements import receptacle_weights
from remqa_data.floorplans.ithor.table import RecordedObject, axes_facing
from remqa_data.floorplans.sampled.canvas import Canvas
from remqa_data.floorplans.sampled.furniture_sets import UNEVEN
from remqa_data.floorplans.sampled.statistics import RecordedRooms
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64

TRIES = 40
GAP_M, CARRIED_M = 0.015, 0.002
"""Between things side by side, and how deep a thing may be in what carries it."""
EDGE_M = 0.02
"""Things stay this far from the edge of what they lie on."""
LONG = 1.3
"""Things longer than this times their width lie turned any way; others would not look different."""
ROOM_WITHIN = {"Fridge": 0.72, "Cabinet": 0.7, "Drawer": 0.75, "Shelf": 0.9, "Bed": 0.85, "Sofa": 0.6, "ArmChair": 0.5}
"""Share of the sides of a receptacle's box that is room for things; of others all of it."""
LEVELS = {"Fridge": (0.2, 0.5, 0.8), "Cabinet": (0.25,), "Drawer": (0.25,), "Shelf": (0.25,)}
LEVELS |= dict.fromkeys(("Bed", "Sofa", "ArmChair"), (0.5,))
"""What holds things below its top, and at which quantiles of the recorded heights."""
LID_M = {"Fridge": 0.02, "Cabinet": 0.02, "Drawer": 0.02, "Shelf": 0.005}
"""What things must not stick out of: they end this far below its top."""
SUNK, OVER_SUNK_M = types_with("kept_clear_above"), 0.1
"""Nothing stands over these that is not in or on them."""
NO_PLACES = types_with("never_laid_on")
NOT_ON = {"Television": types_with("amid_room")}
"""Tables amid the room, where one would see the back of it."""
FLAT = types_with("flat_top")
"""Where things lie for which there is no room where such things were recorded."""
AT_BACK = types_with("stands_at_back")
"""What stands at the back of what it stands on."""


def put_small_objects(
    canvas: Canvas, types: Counter[str], rooms: RecordedRooms, rng: np.random.Generator
) -> Counter[str]:
    """Put things of some types into a room, the large ones first; returns those for which there was no place."""
    wanted = [(type_, rooms.things[type_]) for type_ in types.elements() if type_ in rooms.things]
    chosen = [(type_, found[int(rng.integers(len(found)))]) for type_, found in wanted]
    chosen.sort(key=lambda pair: (-float(np.prod(pair[1].size[:2])), pair[0]))
    surfaces = _Surfaces(canvas, rooms, rng)
    left: Counter[str] = Counter()
    for type_, pattern in chosen:
        row = surfaces.put(pattern)
        if row is None:
            left[type_] += 1
        else:
            canvas.add([row])
    return left


class _Surfaces:
    """Where things can lie."""

    def __init__(self, canvas: Canvas, rooms: RecordedRooms, rng: np.random.Generator) -> None:
        self.rooms, self.rng = rooms, rng
        self.receptacles: dict[str, list[RecordedObject]] = {}
        for row in canvas.rows:
            self.receptacles.setdefault(row.type, []).append(row)
        self.around = list(canvas.rows)
        self.spots = canvas.spots
        self.placed: list[RecordedObject] = []

    def put(self, pattern: RecordedObject) -> RecordedObject | None:
        """A thing after a pattern, on something where such things are."""
        hosts_here = self.receptacles.keys() - NO_PLACES - NOT_ON.get(pattern.type, frozenset())
        usual = receptacle_weights(pattern.type, pattern.room, hosts_here)
        anything = dict.fromkeys(FLAT & hosts_here, 1.0)
        for chances in (usual, anything):
            names = sorted(chances)
            shares = np.array([chances[name] for name in names])
            for _ in range(TRIES if names else 0):
                hosts = self.receptacles[names[int(self.rng.choice(len(names), p=shares / shares.sum()))]]
                row = self._on(pattern, hosts[int(self.rng.integers(len(hosts)))])
                if row is not None:
                    self.placed.append(row)
                    return row
        return None

    def _on(self, pattern: RecordedObject, host: RecordedObject) -> RecordedObject | None:
        """A thing somewhere on or in a receptacle, if it happens to fit there."""
        size, front = pattern.size, host.front
        is_turned = max(size[:2]) > LONG * min(size[:2]) and pattern.pickupable and host.type not in LID_M
        if is_turned:
            angle = self.rng.uniform(0, 2 * np.pi)
            sine, cosine = arithmetic.sin_cos(angle)
            front = np.array([cosine, sine, 0.0])
        rotation = axes_facing(front)
        half = arithmetic.turned(size, np.abs(rotation)) / 2
        foot = self._foot(pattern, host, half)
        if foot is None:
            return None
        centre = np.add(foot, [0.0, 0.0, half[2]])
        low, high = centre - half, centre + half
        if host.type in LID_M and high[2] > host.high[2] - LID_M[host.type]:
            return None
        # what a receptacle is made of is no obstacle in it
        others = self.placed if host.type in LEVELS else [*self.placed, *self.around]
        if any(_meet(low, high, other) for other in others if other is not host):
            return None
        return replace(
            pattern,
            pivot=centre.copy(),
            low=low,
            high=high,
            centre=centre,
            rotation=rotation,
            is_oriented=is_turned,
            parents=(host.id,),
        )

    def _foot(self, pattern: RecordedObject, host: RecordedObject, half: F64) -> F64 | None:
        """A point on a receptacle for the middle of a thing's underside, (3,); None if the thing is too large."""
        if host.type in UNEVEN:
            spots = [spot for spot in self.spots if spot.host == host.id and max(half[:2]) < spot.half_m]
            return spots[int(self.rng.integers(len(spots)))].point if spots else None
        middle = (host.low + host.high)[:2] / 2
        if host.type == "StoveBurner":
            return np.array([*middle, self._height(host)])
        room = (host.high - host.low)[:2] / 2 * ROOM_WITHIN.get(host.type, 1.0) - half[:2] - EDGE_M
        if np.any(room < 0):
            return None
        offset = self.rng.uniform(-1, 1, 2) * room
        if pattern.type in AT_BACK:
            axis = int(np.abs(host.front[:2]).argmax())
            offset[axis] = -np.sign(host.front[axis]) * room[axis] * self.rng.uniform(0.6, 1.0)
        return np.array([*(middle + offset), self._height(host)])

    def _height(self, host: RecordedObject) -> float:
        """At which things lie on something, metres above the floor."""
        shares = self.rooms.heights.get(host.type)
        if host.type not in LEVELS or shares is None:
            return float(host.high[2])
        quantiles = LEVELS[host.type]
        share = np.quantile(shares, quantiles[int(self.rng.integers(len(quantiles)))])
        return float(host.low[2] + max(share, 0.01) * (host.high - host.low)[2])


def _meet(low: F64, high: F64, other: RecordedObject) -> bool:
    """Whether a thing would be in another or over a sink."""
    top = np.add(other.high, [0.0, 0.0, OVER_SUNK_M if other.type in SUNK else 0.0])
    return bool(np.all(high + GAP_M > other.low) and np.all(np.add(low, [-GAP_M, -GAP_M, CARRIED_M]) < top))
