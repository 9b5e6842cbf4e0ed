"""What lies about the target in the scene graph, laid out for a drawing."""

from __future__ import annotations

from dataclasses import dataclass

from remqa_data.browse.dataset import Arrangement

MOST = 12
"""On either side."""


@dataclass(frozen=True)
class Neighbour:
    """A thing in relation to another.

    Attributes
    ----------
    id : str
    relation : str
        Of the left thing to the right one.
    is_hidden : bool
        Whether the walk has not found it, but it is there.
    """

    id: str
    relation: str
    is_hidden: bool


@dataclass(frozen=True)
class Neighbourhood:
    """What is related to a thing (on the left of a drawing), and what it is related to (on the right)."""

    left: tuple[Neighbour, ...]
    right: tuple[Neighbour, ...]
    left_out: int


def neighbourhood(room: Arrangement, target: str) -> Neighbourhood:
    """The graph around a thing: the walk's edges, and what is in or on it that no walk shows; each pair once."""
    known = set(room.nodes)
    right = [Neighbour(edge.target, edge.relation, False) for edge in room.edges if edge.source == target]
    shown = {(one.id, one.relation) for one in right}
    left = [
        Neighbour(edge.source, edge.relation, False)
        for edge in room.edges
        if edge.target == target and not (edge.relation == "next to" and (edge.source, "next to") in shown)
    ]
    found = {one.id for one in left}
    left += [
        Neighbour(thing.id, thing.support_kind or "on", thing.id not in known)
        for thing in room.objects
        if thing.support == target and thing.id not in found
    ]
    extra = max(len(left) - MOST, 0) + max(len(right) - MOST, 0)
    return Neighbourhood(tuple(left[:MOST]), tuple(right[:MOST]), extra)
