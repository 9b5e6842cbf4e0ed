"""What the steps of a program mean: exactly, and as a person in a hurry might take them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from remqa_data import geometry
from remqa_data.expression_rules import StackPlace, expression_rules, may_be_called, similar_words
from remqa_data.metadata import ObjectMetadata
from remqa_data.relations import Relation
from remqa_data.scene_graph import SceneGraph


class Exactly:
    """Words mean what they say."""

    def type(self, record: ObjectMetadata, name: str) -> bool:
        """Whether the word for a type fits an object."""
        return record.type == name

    def word(self, actual: str, said: str) -> bool:
        """Whether a colour or a material fits."""
        return actual == said

    def related(self, graph: SceneGraph, source: str, relation: Relation, anchors: set[str]) -> bool:
        """Whether an object is in a relation to one of some others."""
        return any(graph.relation(source, anchor) == relation for anchor in anchors)

    def closest(self, graph: SceneGraph, found: set[str], anchors: set[str]) -> set[str]:
        """Those of some objects that are closest to any of some others, seen from above."""
        rules = expression_rules()
        pairs = _plan_distances(graph, found, anchors)
        if not pairs or (least := min(apart for apart, _ in pairs.values())) > rules.closest_max_m:
            return set()
        return {i for i, (apart, _) in pairs.items() if apart <= least + rules.closest_tie_m}

    def in_stack(self, graph: SceneGraph, found: set[str], place: StackPlace) -> set[str]:
        """The one of a stack that is highest, lowest or, of three, in the middle."""
        heights = {i: _height(graph, i) for i in found}
        ranked = sorted(found, key=lambda i: heights[i])
        if place == "middle":
            return {ranked[1]} if len(ranked) == 3 else set()
        best = ranked[-1:] if place == "highest" else ranked[:1]
        return {i for i in found for b in best if abs(heights[i] - heights[b]) < expression_rules().same_height_m}


class Roughly(Exactly):
    """Words mean what a person who is in a hurry might take them to mean."""

    def type(self, record: ObjectMetadata, name: str) -> bool:
        return record.type in may_be_called(name)

    def word(self, actual: str, said: str) -> bool:
        return actual in similar_words(said)

    def related(self, graph: SceneGraph, source: str, relation: Relation, anchors: set[str]) -> bool:
        if relation in ("in", "on") and anchors.intersection(graph.holders(source)):
            return True
        return any(graph.relation(source, anchor) in _SOUNDS_LIKE[relation] for anchor in anchors)

    def closest(self, graph: SceneGraph, found: set[str], anchors: set[str]) -> set[str]:
        rules = expression_rules()
        pairs = _plan_distances(graph, found, anchors)
        near: set[str] = set()
        for measure in (0, 1):  # between the centres, between the boxes
            least = min((pair[measure] for pair in pairs.values()), default=0.0)
            limit = least * rules.closest_margin_factor + rules.closest_margin_m
            near |= {i for i, pair in pairs.items() if pair[measure] <= limit}
        return near

    def in_stack(self, graph: SceneGraph, found: set[str], place: StackPlace) -> set[str]:
        # The highest of each column may be meant by "top", and nothing is in the middle of several columns.
        columns = {i: {j for j in found if _in_column(graph, i, j)} for i in found}
        if place == "middle":
            one_column = all(column == found for column in columns.values())
            return super().in_stack(graph, found, place) if one_column else found
        return {i for i in found if i in super(Roughly, self).in_stack(graph, columns[i], place)}


def _plan_distances(graph: SceneGraph, found: set[str], anchors: set[str]) -> dict[str, tuple[float, float]]:
    """Distance of each object to the nearest of some others in the plan: between centres, and between boxes; metres."""
    distances = {}
    for i in found:
        others = sorted(anchors - {i})
        if others:
            box, boxes = graph.node(i).box, [graph.node(other).box for other in others]
            apart = np.linalg.norm(geometry.centres(boxes)[:, :2] - geometry.centres(box)[:, :2], axis=1)
            distances[i] = float(apart.min()), float(geometry.horizontal_gap(box, boxes).min())
    return distances


def _height(graph: SceneGraph, object_id: str) -> float:
    box = graph.node(object_id).box
    return (box[2] + box[5]) / 2


def _in_column(graph: SceneGraph, a: str, b: str) -> bool:
    """Whether one of two objects is over the other, or they are the same."""
    one, two, least = graph.node(a).box, graph.node(b).box, expression_rules().column_min_share
    return all(float(geometry.overlap_share(one, two, axes=(axis,))[0, 0]) >= least for axis in (0, 1))


_SOUNDS_LIKE: Mapping[Relation, frozenset[Relation]] = {
    "in": frozenset({"in", "on"}),
    "on": frozenset({"in", "on"}),
    "under": frozenset({"under", "below"}),
    "above": frozenset({"above", "on"}),
    "below": frozenset({"under", "below"}),
    "next to": frozenset({"next to"}),
}
