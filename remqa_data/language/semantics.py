"""What the steps of a program mean: exactly, and as a person in a hurry might take them."""

from __future__ import annotations

from itertools import pairwise

from remqa_data.catalog import object_type
from remqa_data.geometry import arithmetic
from remqa_data.geometry import boxes as geometry
from remqa_data.geometry.rotations import degrees_apart
from remqa_data.language.rules import STEPS, RowPlace, StackPlace, expression_rules, may_be_called, similar_words
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.scene_graph.order import is_ordered
from remqa_data.scene_graph.relations import OrderRelation, Relation, relation_rules
from remqa_data.sim.metadata import ObjectMetadata


class ExactSemantics:
    """Words mean what they say."""

    def type(self, record: ObjectMetadata, name: str) -> bool:
        """Whether the word for a type fits an object."""
        return record.type == name

    def word(self, actual: str, said: str) -> bool:
        """Whether a colour or a material fits."""
        return actual == said

    def related(self, graph: SceneGraph, source: str, relation: Relation | OrderRelation, anchors: set[str]) -> bool:
        """Whether an object is in a relation to one of some others, or between two of them."""
        if relation == "behind" or relation == "between":
            return is_ordered(graph, source, relation, anchors)
        return any(graph.relation(source, anchor) == relation for anchor in anchors)

    def closest(self, graph: SceneGraph, found: set[str], anchors: set[str]) -> set[str]:
        """Those of some objects that are closest to any of some others, seen from above."""
        rules = expression_rules()
        pairs = _plan_distances(graph, found, anchors)
        if not pairs or (least := min(apart for apart, _ in pairs.values())) > rules.closest_max_m:
            return set()
        return {i for i, (apart, _) in pairs.items() if apart <= least + rules.closest_tie_m}

    def in_stack(self, graph: SceneGraph, found: set[str], place: StackPlace) -> set[str]:
        """The highest or lowest of a stack; the one in the middle of a stack or a row of three."""
        heights = {i: _height(graph, i) for i in found}
        ranked = sorted(found, key=lambda i: (heights[i], i))
        same = expression_rules().same_height_m
        if place == "middle":
            if len(found) != 3:
                return set()
            if heights[ranked[2]] - heights[ranked[0]] < same:
                return found - self.in_row(graph, found, "leftmost") - self.in_row(graph, found, "rightmost")
            return {ranked[1]} if min(heights[b] - heights[a] for a, b in pairwise(ranked)) >= same else set()
        if not ranked or heights[ranked[-1]] - heights[ranked[0]] < same:
            return set()  # not over one another
        end = heights[ranked[-1] if place == "highest" else ranked[0]]
        return {i for i in found if abs(heights[i] - end) < same}

    def in_row(self, graph: SceneGraph, found: set[str], place: RowPlace) -> set[str]:
        """The one at an end of a row that faces one way: left or right of two, leftmost or rightmost of any; or near it."""
        if not (len(found) == 2 if place in ("left", "right") else len(found) > 2 * _steps_in(place) + 1):
            return set()
        if not all(_same_way(graph, a, b) for a in found for b in found):
            return set()
        return _row_end(graph, found, place)


class LooseSemantics(ExactSemantics):
    """Words mean what a person who is in a hurry might take them to mean."""

    def type(self, record: ObjectMetadata, name: str) -> bool:
        """Also types that the word may mean."""
        return record.type in may_be_called(name)

    def word(self, actual: str, said: str) -> bool:
        """Also words that look alike."""
        return actual in similar_words(said)

    def related(self, graph: SceneGraph, source: str, relation: Relation | OrderRelation, anchors: set[str]) -> bool:
        """Also relations that sound alike, what holds the object's holder, what is near, and stacks of which one is beside."""
        if relation == "behind" or relation == "between":
            return super().related(graph, source, relation, anchors)
        if relation in ("in", "on") and anchors.intersection(graph.holders(source)):
            return True
        if relation == "next to" and any(_near(graph, source, anchor) for anchor in anchors):
            return True
        near = {source, *_neighbours_in_column(graph, source)} if relation == "next to" else {source}
        alike = {relation, *relation_rules().sounds_like.get(relation, ())}
        return any(graph.relation(i, anchor) in alike for i in near for anchor in anchors)

    def closest(self, graph: SceneGraph, found: set[str], anchors: set[str]) -> set[str]:
        """Also what is nearly as close, between the centres or between the boxes."""
        rules = expression_rules()
        pairs = _plan_distances(graph, found, anchors)
        near: set[str] = set()
        for measure in (0, 1):  # between the centres, between the boxes
            least = min((pair[measure] for pair in pairs.values()), default=0.0)
            limit = least * rules.closest_margin_factor + rules.closest_margin_m
            near |= {i for i, pair in pairs.items() if pair[measure] <= limit}
        return near

    def in_stack(self, graph: SceneGraph, found: set[str], place: StackPlace) -> set[str]:
        """The ends of all columns; the middle only of one column or one row."""
        columns = {i: {j for j in found if _in_column(graph, i, j)} for i in found}
        ends = super().in_stack
        if place == "middle":
            row = all(_same_way(graph, i, j) and _same_level(graph, i, j) for i in found for j in found)
            return ends(graph, found, place) if row or all(c == found for c in columns.values()) else found
        return {i for i in found if len(columns[i]) == 1 or i in ends(graph, columns[i], place)}

    def in_row(self, graph: SceneGraph, found: set[str], place: RowPlace) -> set[str]:
        """The ends of all rows, whatever their lengths."""
        rows = {i: {j for j in found if _same_way(graph, i, j) and _same_level(graph, i, j)} for i in found}
        return {i for i in found if i in _row_end(graph, rows[i], place)}


def _plan_distances(graph: SceneGraph, found: set[str], anchors: set[str]) -> dict[str, tuple[float, float]]:
    """Distance of each object to the nearest of some others in the plan: between centres, and between boxes; metres."""
    distances = {}
    for i in found:
        others = sorted(anchors - {i})
        if others:
            box, boxes = graph.node(i).box, [graph.node(other).box for other in others]
            apart = arithmetic.length(geometry.centres(boxes)[:, :2] - geometry.centres(box)[:, :2])
            distances[i] = float(apart.min()), float(geometry.horizontal_gap(box, boxes).min())
    return distances


def _height(graph: SceneGraph, object_id: str) -> float:
    box = graph.node(object_id).box
    return (box[2] + box[5]) / 2


def _in_column(graph: SceneGraph, a: str, b: str) -> bool:
    """Whether one of two objects is over the other, or they are the same."""
    one, two, least = graph.node(a).box, graph.node(b).box, expression_rules().column_min_share
    return all(geometry.side_share(one, two, axis) >= least for axis in (0, 1))


def _near(graph: SceneGraph, a: str, b: str) -> bool:
    """Whether two objects are so near that either may be called next to the other; not what holds the other.

    In a fridge all is near: of what a hand puts there, the rules alone decide.
    """
    rules, one, two = expression_rules(), graph.node(a).box, graph.node(b).box
    if a in graph.holders(b) or b in graph.holders(a) or _put_together(graph.node(a), graph.node(b)):
        return False
    over = max(one[2] - two[5], two[2] - one[5])
    return over <= rules.near_height_m and float(geometry.horizontal_gap(one, two).min()) <= rules.near_m


def _put_together(one: ObjectMetadata, two: ObjectMetadata) -> bool:
    """Whether two loose things are inside the same thing."""
    together = one.support == two.support and one.support_kind == two.support_kind == "in"
    return together and object_type(one.type).pickupable and object_type(two.type).pickupable


def _neighbours_in_column(graph: SceneGraph, object_id: str) -> list[str]:
    """Objects of the same type in one unbroken stack with an object: a column of drawers is beside a sink as a whole."""
    column, waiting = [object_id], [object_id]
    while waiting:
        record = graph.node(waiting.pop())
        for other in graph.graph.successors(record.id):
            apart = max(graph.node(other).box[2] - record.box[5], record.box[2] - graph.node(other).box[5])
            stacked = graph.relation(record.id, other) in ("above", "below")
            touching = apart <= expression_rules().same_height_m
            if stacked and touching and graph.node(other).type == record.type and other not in column:
                column.append(other)
                waiting.append(other)
    return column[1:]


def _same_way(graph: SceneGraph, a: str, b: str) -> bool:
    """Whether two objects face the same way, as far as is known."""
    one, two = graph.node(a).facing_deg, graph.node(b).facing_deg
    if one is None or two is None:
        return False
    return degrees_apart(one, two) <= expression_rules().row_max_turn_deg


def _same_level(graph: SceneGraph, a: str, b: str) -> bool:
    """Whether two objects are side by side rather than one over the other."""
    share = geometry.side_share(graph.node(a).box, graph.node(b).box, 2)
    return share >= expression_rules().row_min_height_share


def _row_end(graph: SceneGraph, row: set[str], place: RowPlace) -> set[str]:
    """Those at or near one end of a row, as who stands before it sees it; several if they are not clearly apart."""
    places: dict[str, float] = {}
    for i in sorted(row):
        sine, cosine = arithmetic.sin_cos_deg(graph.node(i).facing_deg or 0.0)
        centre = geometry.centres(graph.node(i).box)[0]
        # The viewer looks against the facing; its right is the facing turned counter-clockwise by 90 degrees.
        places[i] = float(-sine * centre[0] + cosine * centre[1])
    sign = -1.0 if place.endswith("left") or place == "leftmost" else 1.0
    end: set[str] = set()
    for _ in range(_steps_in(place) + 1):
        places = {i: x for i, x in places.items() if i not in end}
        furthest = max((sign * x for x in places.values()), default=0.0)
        end = {i for i, x in places.items() if sign * x > furthest - expression_rules().row_min_step_m}
    return end


def _steps_in(place: RowPlace) -> int:
    """How many steps a place is from the end of its row."""
    return next((steps for ordinal, steps in STEPS.items() if place.startswith(ordinal)), 0)
