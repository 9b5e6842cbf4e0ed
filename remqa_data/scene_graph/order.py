"""How things lie in what holds them all: behind one another, between two others.

It takes more than the boxes of two objects to tell, so these are no edges of the graph: behind depends on where the front of
the holder looks, between on a third thing.
"""

from __future__ import annotations

from itertools import combinations

from remqa_data.geometry import arithmetic
from remqa_data.geometry import boxes as geometry
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.scene_graph.relations import OrderRelation, OrderRules
from remqa_data.sim.metadata import ObjectMetadata


def is_ordered(graph: SceneGraph, source: str, relation: OrderRelation, anchors: set[str]) -> bool:
    """Whether an object is behind one of some others, or between two of them, inside the same thing."""
    thing = graph.node(source)
    holder = _inside(thing)
    near = [graph.node(i) for i in sorted(anchors - {source}) if _inside(graph.node(i)) == holder]
    if holder is None or holder not in graph.objects:
        return False
    if relation == "behind":
        facing = graph.node(holder).facing_deg
        return facing is not None and any(_is_behind(thing, other, facing, graph.rules.order) for other in near)
    return any(_is_between(thing, one, two, graph.rules.order) for one, two in combinations(near, 2))


def _inside(record: ObjectMetadata) -> str | None:
    return record.support if record.support_kind == "in" else None


def _is_behind(thing: ObjectMetadata, other: ObjectMetadata, facing_deg: float, rules: OrderRules) -> bool:
    """Whether a thing is farther from the front, with the other before it."""
    sine, cosine = (float(value) for value in arithmetic.sin_cos_deg(facing_deg))
    front = _reach(other, (-cosine, -sine))[1], _reach(thing, (-cosine, -sine))[0]
    gap = front[1] - front[0]
    (low, high), (other_low, other_high) = (_reach(record, (-sine, cosine)) for record in (thing, other))
    shared = min(high, other_high) - max(low, other_low)
    narrower = min(high - low, other_high - other_low)
    beside = shared >= rules.min_side_share * narrower
    return beside and -rules.max_sunk_m <= gap <= rules.max_gap_m and _is_level(thing, other, rules)


def _is_between(thing: ObjectMetadata, one: ObjectMetadata, two: ObjectMetadata, rules: OrderRules) -> bool:
    """Whether a thing is on the way from one to the other, and near to both."""
    start, middle, end = (geometry.centres(record.box)[0, :2] for record in (one, thing, two))
    way, off = end - start, middle - start
    length = float(arithmetic.length(way))
    if not 0.0 < length <= rules.max_distance_m:
        return False
    part = float(arithmetic.dot(way, off)) / length**2
    aside = abs(float(way[0] * off[1] - way[1] * off[0])) / length**2
    on_the_way = rules.min_part <= part <= 1.0 - rules.min_part and aside <= rules.max_off_share
    near = float(geometry.horizontal_gap(thing.box, [one.box, two.box]).max()) <= rules.max_gap_m
    return on_the_way and near and _is_level(thing, one, rules) and _is_level(thing, two, rules)


def _reach(record: ObjectMetadata, direction: tuple[float, float]) -> tuple[float, float]:
    """How far a box reaches along a direction of the plan, from its nearest to its farthest corner."""
    along = [record.box[i] * direction[0] + record.box[j] * direction[1] for i in (0, 3) for j in (1, 4)]
    return min(along), max(along)


def _is_level(one: ObjectMetadata, two: ObjectMetadata, rules: OrderRules) -> bool:
    return float(geometry.overlap_share(one.box, two.box, axes=(2,))[0, 0]) >= rules.min_height_share
