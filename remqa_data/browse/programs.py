"""A question's program step by step, in words, with what each step finds in the room."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from remqa_data.catalog import catalog
from remqa_data.errors import RemqaError
from remqa_data.language.referring import resolve
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.sim.metadata import ObjectMetadata

_ANSWERS = {"exist": "Is there one?", "count": "How many are there?"}
_FILTERS = {
    "filter_color": "Keep what is {}",
    "filter_substance": "Keep what is made of {}",
    "row": "Of the row, keep the {} one",
    "stack": "Of the stack, keep the {} one",
}


@dataclass(frozen=True)
class Step:
    """A step of a program.

    Attributes
    ----------
    words : str
    depth : int
        How deep it is inside other steps, from 0.
    found : tuple of str or None
        Ids of what is left after it; None of the last step, and where it cannot be told.
    """

    words: str
    depth: int
    found: tuple[str, ...] | None


def steps_in_words(program: Sequence[Any], graph: SceneGraph | None, depth: int = 0) -> list[Step]:
    """The steps of a program in order; those of what it leans on come first, one deeper."""
    steps: list[Step] = []
    for place, step in enumerate(program):
        name, *rest = step if isinstance(step, list | tuple) and step else (str(step),)
        inner = next((part for part in rest if isinstance(part, list | tuple)), None)
        if inner is not None:
            steps += steps_in_words(inner, graph, depth + 1)
        found = None if name in _ANSWERS or graph is None else _found(program[: place + 1], graph)
        steps.append(Step(_words(name, rest), depth, found))
    return steps


def graph_of(objects: Sequence[ObjectMetadata]) -> SceneGraph | None:
    """The graph of all that is in a room; None if it has types that this version does not know."""
    try:
        return SceneGraph.from_objects(objects)
    except RemqaError:
        return None


def _words(name: str, rest: Sequence[Any]) -> str:
    value = str(rest[0]) if rest and isinstance(rest[0], str) else ""
    if name == "filter_type":
        return f"Find every {noun(value)}"
    if name == "relate":
        return f"Keep what is {value} {'them' if value == 'between' else 'it'}"
    if name == "closest":
        return "Keep what is closest to it"
    if name in _FILTERS:
        return _FILTERS[name].format(value)
    return _ANSWERS.get(name, f"{name} {value}".strip())


def noun(type_: str) -> str:
    """The word for an object type; of an unknown one its name."""
    kinds = catalog()
    return kinds[type_].singular if type_ in kinds else type_


def _found(program: Sequence[Any], graph: SceneGraph) -> tuple[str, ...] | None:
    try:
        return tuple(resolve(program, graph))
    except RemqaError:  # a program of another version
        return None
