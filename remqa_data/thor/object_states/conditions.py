"""What objects are in besides where they are: on, full, dirty, warm, broken; and how one does that to another.

As in AI2-THOR some of it happens by itself: what lies on a burner that is on gets hot, what is in the fridge cold. No time
passes here, so it has happened when the action is over, and stays.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from remqa_data.catalog import object_type, types_with
from remqa_data.geometry.types import F64
from remqa_data.sim.physics.world import World

BASINS = types_with("basin")
BASIN_REACH_M = 0.8
"""Water runs into the basin whose middle is nearest, and at most so far, from the faucet's."""


class Condition(NamedTuple):
    """Something that objects can be in.

    Attributes
    ----------
    able : str
        What of the catalog's `can` an object needs for it.
    word : str
        What it then is.
    """

    able: str
    word: str


BROKEN, FILLED = "isBroken", "isFilledWithLiquid"
CONDITIONS = {
    BROKEN: Condition("breakable", "broken"),
    "isCooked": Condition("cookable", "cooked"),
    "isDirty": Condition("dirtyable", "dirty"),
    FILLED: Condition("fillable", "filled"),
    "isUsedUp": Condition("used_up", "used up"),
}
"""What an action can bring about and take away, by AI2-THOR's names."""

SEEN = (BROKEN, "isCooked", "isDirty", FILLED, "fillLiquid", "isToggled")
"""What one sees of what an object is in."""
UNCHANGED: Mapping[str, Any] = {}
COFFEE = "coffee"
LIQUIDS = ("water", COFFEE, "wine")


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
        Which burner a knob is for.
    """

    def __init__(self, world: World) -> None:
        self._world = world
        self.changed: dict[str, dict[str, Any]] = {}
        self._has_spread_in: Mapping[str, Sequence[str]] | None = None
        self.controlled = _pairs(world, _all(world, types_with("burner_knob")), _all(world, types_with("burner")))
        self._runs_into = _nearest(world, _all(world, types_with("fills_basin")), _all(world, BASINS))
        self._heats = self.controlled | {o: o for o in _all(world, types_with("heats_contents"))}
        self._brews = _all(world, types_with("brews_coffee"))
        self._cools = _all(world, types_with("cools_contents"))

    def take_over(self, before: Conditions) -> None:
        """Let all that `before` knows of be in what it is in there."""
        self.changed = before.changed

    def of(self, object_id: str) -> Mapping[str, Any]:
        """What is no longer as it was at first, by AI2-THOR's names."""
        return self.changed.get(object_id, UNCHANGED)

    def is_on(self, object_id: str) -> bool:
        """Whether an object is switched on."""
        return bool(self.of(object_id).get("isToggled"))

    def shown(self) -> dict[str, dict[str, Any]]:
        """What one sees of the objects of which something has changed, by AI2-THOR's names; burners are on as their knobs."""
        seen = {
            object_id: values
            for object_id, changed in self.changed.items()
            if (values := {name: changed[name] for name in SEEN if name in changed})
        }
        for burner in self.lit_burners():
            seen[burner] = {**seen.get(burner, {}), "isToggled": True}
        return seen

    def lit_burners(self) -> set[str]:
        """Ids of the burners of which the knob is turned on."""
        return {burner for knob, burner in self.controlled.items() if self.is_on(knob)}

    def change(self, object_id: str, **values: Any) -> None:
        """Say what an object is in, by AI2-THOR's names."""
        self.changed.setdefault(object_id, {}).update(values)
        self._has_spread_in = None

    def pass_on(self, whole: str, piece: str) -> None:
        """Let a piece be as warm and as done as the whole one is."""
        kept = {name: value for name, value in self.of(whole).items() if name in ("isCooked", "temperature")}
        if kept:
            self.change(piece, **kept)

    def put(self, object_id: str, condition: str, is_so: bool, liquid: str = "water") -> None:
        """Say that an object is in one of the `CONDITIONS`, or is not; what is filled is so with a liquid.

        What is broken holds none: it runs out; and nothing that is broken is on. Coffee is hot.
        """
        if condition == FILLED and is_so and self.of(object_id).get(BROKEN):
            return
        self.change(object_id, **{condition: is_so})
        if condition == FILLED:
            self.change(object_id, fillLiquid=liquid if is_so else None)
            if is_so and liquid == COFFEE:
                self.change(object_id, temperature="Hot")
        elif condition == BROKEN and is_so:
            if self.of(object_id).get(FILLED):
                self.put(object_id, FILLED, False)
            if self.is_on(object_id):
                self.change(object_id, isToggled=False)

    def switch_refusal(self, object_id: str) -> str | None:
        """Why an object cannot be switched on as it is, in AI2-THOR's words, or None."""
        if self.of(object_id).get(BROKEN):
            return "Target is broken and cannot be Toggled On!"
        if self._is_shut_when_on(object_id) and self._world.state(object_id).openness > 0:
            return "Target must be closed to Toggle On!"
        return None

    def opening_refusal(self, object_id: str) -> str | None:
        """Why an object cannot be opened as it is, in AI2-THOR's words, or None."""
        is_kept_shut = self._is_shut_when_on(object_id) and self.is_on(object_id)
        return "Target must be OFF to open!" if is_kept_shut else None

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
                if self._world.type_of(thing) in types_with("takes_coffee") and not self.of(thing).get(FILLED):
                    self.put(thing, FILLED, True, COFFEE)
        for faucet, basin in self._runs_into.items():
            for thing in _within(contents, basin) if self.is_on(faucet) else ():
                self._wet(thing)
        self._has_spread_in = contents

    def _wet(self, thing: str) -> None:
        if self._kind_can(thing, "dirtyable"):
            self.change(thing, isDirty=False)
        if self._kind_can(thing, "fillable") and not self.of(thing).get(FILLED):
            self.put(thing, FILLED, True)
        if self._world.type_of(thing) in types_with("burns_with_flame"):
            self.change(thing, isToggled=False)

    def _is_shut_when_on(self, object_id: str) -> bool:
        return self._world.type_of(object_id) in types_with("shut_when_on")

    def _kind_can(self, thing: str, what: str) -> bool:
        return what in object_type(self._world.type_of(thing)).can


def _all(world: World, types: Collection[str]) -> list[str]:
    """Ids of the objects of some types, type by type."""
    return [object_id for name in sorted(types) for object_id in world.ids if world.type_of(object_id) == name]


def _within(contents: Mapping[str, Sequence[str]], place: str) -> Iterator[str]:
    """What is in or on an object, and in or on that."""
    for thing in contents.get(place, ()):
        yield thing
        yield from _within(contents, thing)


def _nearest(world: World, switches: Sequence[str], places: Sequence[str]) -> dict[str, str]:
    """The nearest place to each switch, if one is near enough."""
    if not (switches and places):
        return {}
    distances = _distances_m(world, switches, places)
    nearest = zip(switches, distances.argmin(axis=1).tolist(), distances.min(axis=1).tolist(), strict=True)
    return {switch: places[place] for switch, place, distance in nearest if distance <= BASIN_REACH_M}


def _pairs(world: World, switches: Sequence[str], places: Sequence[str]) -> dict[str, str]:
    """A place of its own for each switch, so that they are near each other in all."""
    if not (switches and places):
        return {}
    from scipy.optimize import linear_sum_assignment

    rows, columns = linear_sum_assignment(_distances_m(world, switches, places))
    return {switches[row]: places[column] for row, column in zip(rows.tolist(), columns.tolist(), strict=True)}


def _distances_m(world: World, some: Sequence[str], others: Sequence[str]) -> F64:
    """(some, others) metres in plan between the middles of their boxes."""
    here, there = (np.array([world.box(name).mean(axis=0)[:2] for name in names]) for names in (some, others))
    return np.asarray(np.linalg.norm(here[:, None] - there[None], axis=2))
