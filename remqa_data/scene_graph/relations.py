"""What one object is to another: the words, the thresholds of `templates/relations.yaml`, and how they decide.

Two measures decide, together with what holds what: the distance between the centres and the 3D IoU of the boxes. They
bound which pairs can be related at all; gaps and shares of the same boxes then tell above from below from beside.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, ClassVar, Literal, Self, get_args

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from remqa_data.catalog import TypeName, catalog, object_type
from remqa_data.geometry import arithmetic
from remqa_data.geometry import boxes as geometry
from remqa_data.geometry.types import F64, Flags
from remqa_data.sim.metadata import ObjectMetadata
from remqa_data.yaml_files import Word, check_told_apart, entry_for_each, template_rules

Relation = Literal["in", "on", "under", "above", "below", "next to"]
"""What one object is to another, by their boxes and by what holds them: the edges of the scene graph."""
OrderRelation = Literal["behind", "between"]
"""How things lie in what holds them all: it takes more than two objects to tell, so these are no edges."""

SOURCE = "relations.yaml"


class _Rules(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class _Thresholds(_Rules):
    """Of one relation. A name says what a number is: `min_` what must be reached, `max_` and `gap_` what may not be passed."""

    exact: ClassVar[frozenset[str]] = frozenset()
    """What stays as it is when the others are loosened."""

    def scaled(self, more: float) -> Self:
        """Limits times a factor, and what must be reached divided by it; what is a share of one thing stays one."""
        changed = {}
        for name, field in type(self).model_fields.items():
            value = getattr(self, name)
            if name in self.exact or not name.startswith(("min_", "max_", "gap_")):
                continue
            value = value / more if name.startswith("min_") else value * more
            is_share = any(getattr(limit, "le", None) == 1 for limit in field.metadata)
            changed[name] = min(value, 1.0) if is_share else value
        return self.model_copy(update=changed)


class PartRules(_Thresholds):
    """When a drawer is in a dresser."""

    min_share: float = Field(gt=0, le=1)
    parts: dict[TypeName, frozenset[TypeName]]


class FloorRules(_Thresholds):
    """When a thing is on the floor."""

    max_gap_m: float = Field(ge=0)


class UnderRules(_Thresholds):
    """When a thing is under another: beneath what can be lifted, or beneath furniture on legs."""

    min_plan_share: float = Field(gt=0, le=1)
    max_contact_gap_m: float = Field(ge=0)
    max_sunk_m: float = Field(ge=0)
    max_area_ratio: float = Field(gt=0)
    min_head_room_m: float = Field(ge=0)
    legs: frozenset[TypeName]


class PileRules(_Thresholds):
    """When a thing lies on another that is in the same thing as it."""

    min_plan_share: float = Field(gt=0, le=1)
    max_gap_m: float = Field(ge=0)
    max_sunk_m: float = Field(ge=0)


class OrderRules(_Thresholds):
    """When a thing is behind another, or between two others, in what holds them all."""

    max_gap_m: float = Field(ge=0)
    max_sunk_m: float = Field(ge=0)
    min_side_share: float = Field(gt=0, le=1)
    min_height_share: float = Field(gt=0, le=1)
    min_part: float = Field(gt=0, lt=0.5)
    max_off_share: float = Field(gt=0)
    max_distance_m: float = Field(gt=0)


class StackedRules(_Thresholds):
    """When a thing is above or below another."""

    exact = frozenset({"max_sunk_share"})

    min_side_share: float = Field(gt=0, le=1)
    wall_depth_m: float = Field(ge=0)
    on_walls: frozenset[TypeName]
    max_gap_m: float = Field(ge=0)
    max_sunk_m: float = Field(ge=0)
    max_sunk_share: float = Field(ge=0, le=1)
    sunk_in: frozenset[TypeName]
    max_distance_m: float = Field(gt=0)
    max_iou: float = Field(ge=0, le=1)
    never: frozenset[TypeName]


class NextToRules(_Thresholds):
    """When a thing is next to another."""

    max_gap_m: float = Field(ge=0)
    gap_per_size: float = Field(gt=0)
    min_height_share: float = Field(gt=0, le=1)
    max_distance_m: float = Field(gt=0)
    max_iou: float = Field(ge=0, le=1)
    max_shared_volume: float = Field(gt=0, le=1)
    never: frozenset[TypeName]


class RelationRules(_Rules):
    """All of `relations.yaml`.

    Attributes
    ----------
    words, order_words : mapping of relation to str
        What stands between the two nouns of a phrase.
    sounds_like : mapping of relation to set of relations
        What it may be taken to mean besides.
    inverses : mapping of relation to relation or None
        What the second object is to the first: the relation of the edge that goes back.
    floor, part, under, pile, stacked, next_to, order
        Thresholds of the relations.
    near_miss_factor : float
        How much `loosened` loosens, and `tightened` tightens.
    """

    words: Annotated[dict[Relation, Word], entry_for_each(get_args(Relation))]
    sounds_like: dict[Relation, frozenset[Relation]]
    order_words: Annotated[dict[OrderRelation, Word], entry_for_each(get_args(OrderRelation))]
    inverses: Annotated[dict[Relation, Relation | None], entry_for_each(get_args(Relation))]
    floor: FloorRules
    part: PartRules
    under: UnderRules
    pile: PileRules
    stacked: StackedRules
    next_to: NextToRules
    order: OrderRules
    near_miss_factor: float = Field(ge=1)

    @field_validator("inverses")
    @classmethod
    def _both_ways(cls, inverses: dict[Relation, Relation | None]) -> dict[Relation, Relation | None]:
        for relation, back in inverses.items():
            if back is not None and inverses[back] != relation:
                raise ValueError(f"that of {relation!r} is {back!r}, so that of {back!r} is {relation!r}")
        return inverses

    @model_validator(mode="after")
    def _are_told_apart(self) -> RelationRules:
        said = [*self.words.values(), *self.order_words.values()]
        check_told_apart(said, "relations", "words")
        for name, kind in catalog().items():
            for noun in kind.words:
                if inside := [word for word in said if f" {word} " in noun]:
                    raise ValueError(f"words: {inside[0]!r} is said in {noun!r}, too, which is a word of {name}")
        return self

    def loosened(self) -> RelationRules:
        """Rules with limits times the factor, and shares to be reached divided by it.

        By these more pairs are related, but not each pair as by the strict rules: a rule that fits now may come before the
        one that fitted. `remqa_data.language.referring.candidates` allows for that.
        """
        return self._with_limits_times(self.near_miss_factor)

    def tightened(self) -> RelationRules:
        """Rules under which fewer pairs are related, by the same factor: what is related by these too, clearly is."""
        return self._with_limits_times(1.0 / self.near_miss_factor)

    def said(self, relation: Relation | OrderRelation) -> str:
        """The words for a relation."""
        if relation == "behind" or relation == "between":
            return self.order_words[relation]
        return self.words[relation]

    def _with_limits_times(self, more: float) -> RelationRules:
        thresholds = {name: rules.scaled(more) for name, rules in self if isinstance(rules, _Thresholds)}
        return self.model_copy(update=thresholds)


@lru_cache(maxsize=1)
def relation_rules() -> RelationRules:
    """The rules that come with the package, read once."""
    return template_rules(RelationRules, SOURCE)


@dataclass(frozen=True, order=True)
class Edge:
    """A relation: `source` is `relation` (to) `target`.

    Attributes
    ----------
    source, target : str
        Object ids.
    relation : str
        "in", "on", "under", "above", "below" or "next to".
    distance_m : float
        Between the centres of the two boxes.
    iou : float
        3D intersection over union of the two boxes.
    """

    source: str
    target: str
    relation: Relation
    distance_m: float
    iou: float


def edges_between(
    sources: Sequence[ObjectMetadata], targets: Sequence[ObjectMetadata], rules: RelationRules
) -> Iterator[Edge]:
    """The edges from each of some objects to each of some others; an object has none to itself."""
    if not sources or not targets:
        return
    a, b = _Objects.of(sources), _Objects.of(targets)
    measured = _Measured(geometry.centre_distance(a.boxes, b.boxes), geometry.iou_3d(a.boxes, b.boxes))
    relation = np.full(measured.iou.shape, None, dtype=np.object_)
    free = a.ids[:, None] != b.ids[None]
    beside = _next_to(a, b, rules, measured)
    both_ways: tuple[tuple[Relation, Flags, Flags], ...] = (
        ("on", _held(a, b, rules, "on"), _held(b, a, rules, "on").T),
        ("in", _held(a, b, rules, "in"), _held(b, a, rules, "in").T),
        ("under", _under(a, b, rules), _under(b, a, rules).T),
        ("above", _above(a, b, rules, measured), _above(b, a, rules, measured.swapped()).T),
        ("next to", beside, beside),
    )
    # Earlier rules win over later ones, in both directions: what is in a thing is not next to it, nor it to that.
    for name, there, back in both_ways:
        relation[back & free] = rules.inverses[name]
        relation[there & free] = name
        free &= ~(there | back)
    for i, j in np.argwhere(relation != None):  # noqa: E711  (an array compares element by element)
        distance, iou = float(measured.distance[i, j]), float(measured.iou[i, j])
        yield Edge(sources[i].id, targets[j].id, relation[i, j], distance, iou)


@dataclass(frozen=True)
class _Objects:
    """Some objects as columns: (n,) arrays, and (n, 6) boxes."""

    ids: npt.NDArray[np.object_]
    types: npt.NDArray[np.object_]
    support: npt.NDArray[np.object_]
    kind: npt.NDArray[np.object_]
    boxes: F64

    @classmethod
    def of(cls, objects: Sequence[ObjectMetadata]) -> _Objects:
        def column(values: Sequence[str | None]) -> npt.NDArray[np.object_]:
            return np.array(values, dtype=np.object_)

        return cls(
            ids=column([o.id for o in objects]),
            types=column([o.type for o in objects]),
            support=column([o.support for o in objects]),
            kind=column([o.support_kind for o in objects]),
            boxes=np.array([o.box for o in objects], dtype=np.float64),
        )

    def are(self, types: Collection[str]) -> Flags:
        """(n,) whether each object is of one of some types."""
        return np.array([name in types for name in self.types], dtype=np.bool_)

    def liftable(self) -> Flags:
        """(n,) whether a hand can pick each object up."""
        return np.array([object_type(name).pickupable for name in self.types], dtype=np.bool_)

    def removable(self) -> Flags:
        """(n,) whether each object can be picked up or pushed aside."""
        kinds = [object_type(name) for name in self.types]
        return np.array([kind.is_loose for kind in kinds], dtype=np.bool_)

    def sides(self) -> F64:
        """(n, 3) lengths of the boxes' sides."""
        return self.boxes[:, 3:] - self.boxes[:, :3]

    def share_support_with(self, other: _Objects) -> Flags:
        """(n, m) whether the same receptacle holds both in the same way."""
        same = (self.support[:, None] == other.support[None]) & (self.kind[:, None] == other.kind[None])
        return np.asarray(same & (self.support != None)[:, None], dtype=np.bool_)  # noqa: E711


@dataclass(frozen=True)
class _Measured:
    """(n, m) the two measures that every edge carries."""

    distance: F64
    iou: F64

    def swapped(self) -> _Measured:
        return _Measured(self.distance.T, self.iou.T)


def _held(a: _Objects, b: _Objects, rules: RelationRules, kind: str) -> Flags:
    """A rests in or on b, or is a part of it."""
    held = np.asarray((a.support[:, None] == b.ids[None]) & (a.kind == kind)[:, None], dtype=np.bool_)
    if kind == "on":
        above_floor = geometry.vertical_gap(a.boxes, b.boxes) > rules.floor.max_gap_m
        held &= ~(above_floor & b.are({"Floor"})[None])
        held |= _piled(a, b, rules)
    if kind == "in":
        shared = geometry.intersection_volume(a.boxes, b.boxes)
        inside = shared >= rules.part.min_share * np.maximum(geometry.volume(a.boxes), _TINY)[:, None]
        for part, wholes in rules.part.parts.items():
            held |= (a.types == part)[:, None] & b.are(wholes)[None] & inside
    return held


def _piled(a: _Objects, b: _Objects, rules: RelationRules) -> Flags:
    """A lies on b, and both are in the same thing."""
    pile = rules.pile
    area = np.maximum(np.prod(a.sides()[:, :2], axis=1), _TINY)
    covered = geometry.overlap_share(a.boxes, b.boxes) * np.minimum(
        area[:, None], np.prod(b.sides()[:, :2], axis=1)[None]
    )
    between = geometry.vertical_gap(a.boxes, b.boxes)
    over = (
        (covered >= pile.min_plan_share * area[:, None]) & (between <= pile.max_gap_m) & (between >= -pile.max_sunk_m)
    )
    inside = np.array([kind == "in" for kind in a.kind], dtype=np.bool_)[:, None] & a.share_support_with(b)
    higher = geometry.centres(a.boxes)[:, 2][:, None] > geometry.centres(b.boxes)[:, 2][None]
    return np.asarray(over & higher & inside & a.liftable()[:, None] & b.liftable()[None])


def _under(a: _Objects, b: _Objects, rules: RelationRules) -> Flags:
    """A lies beneath b, which can be lifted or pushed off it; or a stands beneath b, which stands on legs."""
    under = rules.under
    area_a, area_b = (np.prod(side.sides()[:, :2], axis=1) for side in (a, b))
    shared = geometry.overlap_share(a.boxes, b.boxes) * np.minimum(area_a[:, None], area_b[None])
    covered = shared >= under.min_plan_share * np.maximum(area_a, _TINY)[:, None]
    covered &= area_a[:, None] <= under.max_area_ratio * area_b[None]
    between = geometry.vertical_gap(b.boxes, a.boxes).T
    lower = geometry.centres(a.boxes)[:, 2][:, None] < geometry.centres(b.boxes)[:, 2][None]
    touching = (between <= under.max_contact_gap_m) & (between >= -under.max_sunk_m)
    beneath = b.removable()[None] & touching & lower
    top_a, top_b = a.boxes[:, 5][:, None], b.boxes[:, 5][None]
    on_floor = np.array([kind == "on" for kind in a.kind], dtype=np.bool_)[:, None]
    sheltered = b.are(under.legs)[None] & (top_a <= top_b - under.min_head_room_m) & on_floor
    return np.asarray(covered & (beneath | sheltered) & a.share_support_with(b))


def _above(a: _Objects, b: _Objects, rules: RelationRules, measured: _Measured) -> Flags:
    """A is over b with air or a worktop between them, both built in, hanging or standing."""
    stacked = rules.stacked
    between = geometry.vertical_gap(a.boxes, b.boxes)
    wide_a, wide_b = _thickened(a, stacked), _thickened(b, stacked)
    over = np.ones_like(between, dtype=np.bool_)
    for axis in (0, 1):
        over &= geometry.overlap_share(wide_a, wide_b, axes=(axis,)) >= stacked.min_side_share
    hangs_in = a.are(stacked.sunk_in)[:, None] * stacked.max_sunk_share * b.sides()[:, 2][None]
    over &= (between >= -np.maximum(stacked.max_sunk_m, hangs_in)) & (between <= stacked.max_gap_m)
    over &= geometry.centres(a.boxes)[:, 2][:, None] > geometry.centres(b.boxes)[:, 2][None]
    over &= (measured.distance <= stacked.max_distance_m) & (measured.iou <= stacked.max_iou)
    fit_a, fit_b = (~side.liftable() & ~side.are(stacked.never) for side in (a, b))
    return np.asarray(over & fit_a[:, None] & fit_b[None])


def _next_to(a: _Objects, b: _Objects, rules: RelationRules, measured: _Measured) -> Flags:
    """A and b stand side by side at the same height."""
    beside = rules.next_to
    size_a, size_b = (arithmetic.length(side.sides()[:, :2]) for side in (a, b))
    reach = np.minimum(beside.max_gap_m, beside.gap_per_size * (size_a[:, None] + size_b[None]) / 2)
    near = geometry.gap(a.boxes, b.boxes) <= reach
    near &= geometry.overlap_share(a.boxes, b.boxes, axes=(2,)) >= beside.min_height_share
    near &= (measured.distance <= beside.max_distance_m) & (measured.iou <= beside.max_iou)
    smaller = np.minimum(geometry.volume(a.boxes)[:, None], geometry.volume(b.boxes)[None])
    near &= geometry.intersection_volume(a.boxes, b.boxes) <= beside.max_shared_volume * smaller
    fit_a, fit_b = (~side.are(beside.never) for side in (a, b))
    near &= fit_a[:, None] & fit_b[None]
    # What is inside something is beside only what is inside it too, and what lies on a table is beside what lies there
    # too or is part of the building: a pencil is not next to the back of a chair.
    together = a.share_support_with(b)
    unsupported_a, unsupported_b = (np.array([s is None for s in side.support], dtype=np.bool_) for side in (a, b))
    near &= together | (~a.liftable()[:, None] | unsupported_b[None]) & (unsupported_a[:, None] | ~b.liftable()[None])
    inside_a, inside_b = (np.array([kind == "in" for kind in side.kind], dtype=np.bool_) for side in (a, b))
    return np.asarray(near & (together | ~(inside_a[:, None] | inside_b[None])))


_TINY = 1e-12
"""Stands in for the volume or the area of a box that has none: nothing is a share of it."""


def _thickened(side: _Objects, stacked: StackedRules) -> F64:
    """(n, 6) boxes, of which those of things on a wall reach into the room as far as what stands at the wall."""
    low, high = side.boxes[:, :3], side.boxes[:, 3:]
    length = high - low
    thin = np.zeros_like(length, dtype=np.bool_)
    thin[np.arange(len(length)), length[:, :2].argmin(axis=1)] = True
    thin &= side.are(stacked.on_walls)[:, None]
    more = np.where(thin, np.maximum(stacked.wall_depth_m - length, 0.0) / 2, 0.0)
    return np.concatenate([low - more, high + more], axis=1)
