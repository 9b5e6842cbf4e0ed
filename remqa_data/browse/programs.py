"""A question's program step by step, in words, with what each step finds in the room."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from remqa_data.catalog import catalog
from remqa_data.errors import ProgramError, RemqaError
from remqa_data.language.referring import Program, resolve
from remqa_data.language.stored import stored_program
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


def steps_in_words(program: str, graph: SceneGraph | None) -> list[Step]:
    """The steps of a stored program in order; those of what it leans on come first, one deeper. Nothing if it is no program."""
    try:
        return _in_words(stored_program(program), graph, 0)
    except ProgramError:
        return []


def _in_words(program: Program, graph: SceneGraph | None, depth: int) -> list[Step]:
    steps: list[Step] = []
    for place, (name, *rest) in enumerate(program):
        if rest and isinstance(rest[-1], tuple):
            steps += _in_words(rest[-1], graph, depth + 1)
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
    if name == "filter_type":
        return f"Find every {noun(rest[0])}"
    if name == "relate":
        return f"Keep what is {rest[0]} {'them' if rest[0] == 'between' else 'it'}"
    if name == "closest":
        return "Keep what is closest to it"
    return _FILTERS[name].format(rest[0]) if name in _FILTERS else _ANSWERS[name]


def noun(type_: str) -> str:
    """The word for an object type; of an unknown one its name."""
    kinds = catalog()
    return kinds[type_].singular if type_ in kinds else type_


def _found(program: Program, graph: SceneGraph) -> tuple[str, ...] | None:
    try:
        return tuple(resolve(program, graph))
    except ProgramError:  # it names a type that this version does not know
        return None
