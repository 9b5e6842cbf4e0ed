"""The graph of a room: objects are nodes, relations between them are edges; it grows frame by frame.

Whether two objects are related depends on these two alone. So the graph does not depend on the order in which objects
were seen, and once all have been seen it equals the graph of the whole room.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable, Iterator
from dataclasses import dataclass, fields, replace
from typing import ClassVar, get_args

import networkx as nx
from pydantic import ConfigDict, TypeAdapter, ValidationError

from remqa_data.errors import SceneGraphError, UnknownNameError, what_is_invalid
from remqa_data.scene_graph.relations import Edge, Relation, RelationRules, edges_between, relation_rules
from remqa_data.sim.metadata import FrameMetadata, ObjectMetadata


@dataclass(frozen=True)
class GraphUpdate:
    """What a frame added to a graph: nodes in the order in which they were added, and edges sorted."""

    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(extra="forbid", allow_inf_nan=False)

    nodes: tuple[ObjectMetadata, ...]
    edges: tuple[Edge, ...]

    def to_json(self) -> bytes:
        """The update as JSON; every float keeps all its bits."""
        return _UPDATE.dump_json(self)

    @classmethod
    def from_json(cls, text: str | bytes, where: str = "graph update") -> GraphUpdate:
        """Read what `to_json` wrote.

        Raises
        ------
        SceneGraphError
            Naming the place, the field and what is wrong with it.
        """
        try:
            return _UPDATE.validate_json(text)
        except ValidationError as error:
            raise SceneGraphError(f"{where}: {what_is_invalid(error)}") from None


_UPDATE = TypeAdapter(GraphUpdate)


class SceneGraph:
    """Objects and their relations.

    Parameters
    ----------
    rules : RelationRules, optional
        What decides the relations; by default those of `templates/relations.yaml`.

    Attributes
    ----------
    graph : networkx.DiGraph
        Nodes are object ids with the fields of `ObjectMetadata` as attributes; edges have the attributes `relation`,
        `distance_m` and `iou`. Read it as you like; change it through this class. Boxes are tuples, which GraphML and GML
        do not have: write it with `networkx.node_link_data`.
    memo : dict
        For `remqa_data.language.referring`, which keeps here what it has found; empty again whenever the graph grows.
    """

    def __init__(self, rules: RelationRules | None = None) -> None:
        self.rules = rules or relation_rules()
        self.graph: nx.DiGraph[str] = nx.DiGraph()
        self._objects: dict[str, ObjectMetadata] = {}
        self.memo: dict[Hashable, frozenset[str]] = {}

    @classmethod
    def from_objects(cls, objects: Iterable[ObjectMetadata], rules: RelationRules | None = None) -> SceneGraph:
        """The graph of all of some objects: with `object_metadata(world).values()`, the ground truth."""
        scene_graph = cls(rules)
        scene_graph.add_objects(objects)
        return scene_graph

    @classmethod
    def replay(cls, updates: Iterable[GraphUpdate]) -> SceneGraph:
        """The graph that some updates, in their order, built.

        Raises
        ------
        SceneGraphError
            If an update adds a node twice, or an edge between unknown nodes: the updates are not those of one graph.
        """
        scene_graph = cls()
        for update in updates:
            scene_graph._apply(update)
        return scene_graph

    # ---- growing

    def add_frame(self, frame: FrameMetadata) -> GraphUpdate:
        """Add the objects of a frame that were not seen before, with their relations to all that was.

        Returns
        -------
        Exactly what was added. An object that is known already keeps its first state.
        """
        return self.add_objects(frame.objects)

    def add_objects(self, objects: Iterable[ObjectMetadata]) -> GraphUpdate:
        """Add objects that are not known yet; what the agent holds is nowhere in the room and is left out.

        Raises
        ------
        SceneGraphError
            If a box is not six finite numbers.
        """
        new: dict[str, ObjectMetadata] = {}
        for record in objects:
            if record.id not in self._objects and not record.is_picked_up:
                new.setdefault(record.id, _with_checked_box(without_frame(record)))
        update = GraphUpdate(tuple(new.values()), tuple(sorted(self._edges_of(list(new.values())))))
        self._apply(update)
        return update

    # ---- reading

    @property
    def objects(self) -> dict[str, ObjectMetadata]:
        """All nodes by id, in the order in which they were added."""
        return dict(self._objects)

    @property
    def edges(self) -> tuple[Edge, ...]:
        """All edges, sorted."""
        return tuple(sorted(Edge(source, target, **data) for source, target, data in self.graph.edges(data=True)))

    def node(self, object_id: str) -> ObjectMetadata:
        """One node.

        Raises
        ------
        UnknownNameError
            If there is none of that id.
        """
        if object_id not in self._objects:
            raise UnknownNameError("object", object_id, self._objects)
        return self._objects[object_id]

    def relation(self, source: str, target: str) -> Relation | None:
        """What the source is to the target, if anything.

        Raises
        ------
        UnknownNameError
            If there is no object of one of the ids.
        """
        if not self.graph.has_edge(source, target):
            self.node(source)
            self.node(target)
            return None
        relation: Relation = self.graph.edges[source, target]["relation"]
        return relation

    def related(self, source: str, relation: Relation) -> list[str]:
        """Ids of all targets to which an object has a relation, sorted.

        Raises
        ------
        UnknownNameError
            If there is no object of that id, or no such relation between two objects.
        """
        self.node(source)
        if relation not in get_args(Relation):
            raise UnknownNameError("relation", relation, get_args(Relation))
        return sorted(target for target in self.graph.successors(source) if self.relation(source, target) == relation)

    def holders(self, object_id: str) -> list[str]:
        """Ids of what holds an object, what holds that, and so on, as far as they are known; nearest first."""
        chain: list[str] = []
        support = self.node(object_id).support
        while support is not None and support in self._objects and support not in chain:
            chain.append(support)
            support = self._objects[support].support
        return chain

    def contents(self, receptacle_id: str) -> list[str]:
        """Ids of all that is in or on a receptacle, or in or on something that is; in the order of the nodes."""
        self.node(receptacle_id)
        return [object_id for object_id in self._objects if receptacle_id in self.holders(object_id)]

    def __eq__(self, other: object) -> bool:
        """The same nodes and the same edges; the order in which they were added does not matter."""
        if not isinstance(other, SceneGraph):
            return NotImplemented
        return self._objects == other._objects and self.edges == other.edges

    __hash__ = None  # type: ignore[assignment]  # it grows

    def __repr__(self) -> str:
        return f"SceneGraph({len(self._objects)} objects, {self.graph.number_of_edges()} edges)"

    # ---- inside

    def _apply(self, update: GraphUpdate) -> None:
        self.memo.clear()
        for record in update.nodes:
            if record.id in self._objects:
                raise SceneGraphError(f"node {record.id!r} is added twice; replay the updates of one walk only")
            self._objects[record.id] = record
            self.graph.add_node(record.id, **{field.name: getattr(record, field.name) for field in fields(record)})
        for edge in update.edges:
            for end in (edge.source, edge.target):
                if end not in self._objects:
                    msg = f"edge {edge.source!r} -> {edge.target!r}: node {end!r} was never added; replay all updates"
                    raise SceneGraphError(msg)
            self.graph.add_edge(
                edge.source, edge.target, relation=edge.relation, distance_m=edge.distance_m, iou=edge.iou
            )

    def _edges_of(self, new: list[ObjectMetadata]) -> Iterator[Edge]:
        """Edges between new objects, and between new and known ones, both ways."""
        known = list(self._objects.values())
        yield from edges_between(new, new, self.rules)
        yield from edges_between(new, known, self.rules)
        yield from edges_between(known, new, self.rules)


def without_frame(record: ObjectMetadata) -> ObjectMetadata:
    """The record without what one frame says about it."""
    return ObjectMetadata(**{field.name: getattr(record, field.name) for field in fields(ObjectMetadata)})


def _with_checked_box(record: ObjectMetadata) -> ObjectMetadata:
    """The record with its box as a tuple, which a list would never equal."""
    box = tuple(record.box)
    if len(box) != 6 or not all(map(math.isfinite, box)):
        raise SceneGraphError(f"node {record.id!r}: its box is {box}; expected six finite numbers")
    return record if isinstance(record.box, tuple) else replace(record, box=box)
