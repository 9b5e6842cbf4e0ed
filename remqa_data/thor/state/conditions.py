"""What objects are in besides where they are: on, full, dirty, warm, broken; and how one does that to another.

As in AI2-THOR some of it happens by itself: what lies on a burner that is on gets hot, what is in the fridge cold. No time
passes here, so it has happened when the action is over, and stays.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from remqa_data.catalog import object_type
from remqa_data.sim.physics.world import World

BASINS = frozenset({"BathtubBasin", "SinkBasin"})
BASIN_REACH_M = 0.8
"""Water runs into the basin whose middle is nearest, and at most so far, from the faucet's."""

HEATS_WHEN_ON = frozenset({"Microwave", "Toaster"})
UNCHANGED: Mapping[str, Any] = {}
LIQUIDS = ("water", "coffee", "wine")


class Conditions:
    """The conditions of all objects of a world.

    Parameters
    ----------
    world : World
        Whose objects.

    Attributes
    ----------
    changed : dict of str to dict
        See `of`; only the objects of which something has changed.
    controlled : dict of str to str
        Which burner a knob is for, and into which basin a faucet's water runs.
    """

    def __init__(self, world: World) -> None:
        self._world = world
        self.changed: dict[str, dict[str, Any]] = {}
        self._has_spread_in: Mapping[str, Sequence[str]] | None = None
        of_type: dict[str, list[str]] = {}
        for object_id in world.ids:
            of_type.setdefault(world.type_of(object_id), []).append(object_id)
        basins = [object_id for name in sorted(BASINS) for object_id in of_type.get(name, [])]
        self.controlled = _pairs(world, of_type.get("StoveKnob", []), of_type.get("StoveBurner", []))
        self._runs_into = _nearest(world, of_type.get("Faucet", []), basins)
        self._heats = self.controlled | {o: o for name in sorted(HEATS_WHEN_ON) for o in of_type.get(name, [])}
        self._brews = of_type.get("CoffeeMachine", [])
        self._cools = of_type.get("Fridge", [])

    def of(self, object_id: str) -> Mapping[str, Any]:
        """What is no longer as it was at first, by AI2-THOR's names."""
        return self.changed.get(object_id, UNCHANGED)

    def is_on(self, object_id: str) -> bool:
        """Whether an object is switched on."""
        return bool(self.of(object_id).get("isToggled"))

    def change(self, object_id: str, **values: Any) -> None:
        """Say what an object is in, by AI2-THOR's names."""
        self.changed.setdefault(object_id, {}).update(values)
        self._has_spread_in = None

    def forget(self, object_id: str, names: Iterable[str]) -> None:
        """Bring an object back to what it was in at first."""
        for name in names:
            self.changed.get(object_id, {}).pop(name, None)
        self._has_spread_in = None

    def fill(self, object_id: str, liquid: str | None) -> None:
        """Fill an object with a liquid, or empty it."""
        self.change(object_id, isFilledWithLiquid=liquid is not None, fillLiquid=liquid)

    def spread(self, contents: Mapping[str, Sequence[str]]) -> None:
        """Let what is on or cold do to what is in or on it what it does; `contents` says what each object holds.

        What has been done in the same contents, and since when nothing has changed, is not done again.
        """
        if self._has_spread_in is contents:
            return
        for place in self._cools:
            for thing in _within(contents, place):
                self.change(thing, temperature="Cold")
        for switch, place in self._heats.items():
            for thing in _within(contents, place) if self.is_on(switch) else ():
                self.change(thing, temperature="Hot")
                if self._kind_can(thing, "cookable"):
                    self.change(thing, isCooked=True)
        for machine in self._brews:
            for thing in contents.get(machine, ()) if self.is_on(machine) else ():
                if self._world.type_of(thing) == "Mug" and not self.of(thing).get("isFilledWithLiquid"):
                    self.fill(thing, "coffee")
        for faucet, basin in self._runs_into.items():
            for thing in _within(contents, basin) if self.is_on(faucet) else ():
                self._wet(thing)
        self._has_spread_in = contents

    def _wet(self, thing: str) -> None:
        if self._kind_can(thing, "dirtyable"):
            self.change(thing, isDirty=False)
        if self._kind_can(thing, "fillable") and not self.of(thing).get("isFilledWithLiquid"):
            self.fill(thing, "water")
        if self._world.type_of(thing) == "Candle":
            self.change(thing, isToggled=False)

    def _kind_can(self, thing: str, what: str) -> bool:
        return what in object_type(self._world.type_of(thing)).can


def _within(contents: Mapping[str, Sequence[str]], place: str) -> Iterator[str]:
    """What is in or on an object, and in or on that."""
    for thing in contents.get(place, ()):
        yield thing
        yield from _within(contents, thing)


def _nearest(world: World, switches: Sequence[str], places: Sequence[str]) -> dict[str, str]:
    """The nearest place to each switch, if one is near enough."""
    found = {}
    for switch in switches:
        distances = [_distance_m(world, switch, place) for place in places]
        if distances and min(distances) <= BASIN_REACH_M:
            found[switch] = places[distances.index(min(distances))]
    return found


def _pairs(world: World, switches: Sequence[str], places: Sequence[str]) -> dict[str, str]:
    """A place of its own for each switch, so that they are near each other in all."""
    from scipy.optimize import linear_sum_assignment

    if not (switches and places):
        return {}
    cost = [[_distance_m(world, switch, place) for place in places] for switch in switches]
    rows, columns = linear_sum_assignment(cost)
    return {switches[row]: places[column] for row, column in zip(rows.tolist(), columns.tolist(), strict=True)}


def _distance_m(world: World, one: str, other: str) -> float:
    offset = world.box(one).mean(axis=0) - world.box(other).mean(axis=0)
    return float(np.linalg.norm(offset[:2]))
