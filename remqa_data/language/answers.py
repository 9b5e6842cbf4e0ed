"""The answer to a question, found by executing its program on the graph of a room.

A question's program is that of a referring expression (see `remqa_data.language.referring`) with one more step, the last, which
turns the set of objects that the others give into an answer:

- ``("exist",)`` answers yes or no.
- ``("count",)`` answers with a number, in digits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from remqa_data.errors import ProgramError
from remqa_data.language.referring import AnyProgram, candidates, resolve
from remqa_data.scene_graph.graph import SceneGraph


@dataclass(frozen=True)
class Answer:
    """What a question's program says of one state of a room.

    Attributes
    ----------
    text : str
        "yes", "no", or a number in digits.
    ids : tuple of str
        The objects that make the answer, sorted; empty for "no" and "0".
    """

    text: str
    ids: tuple[str, ...]


def execute(program: AnyProgram, graph: SceneGraph) -> Answer:
    """The answer in a room, given the graph of all its objects.

    Raises
    ------
    ProgramError
        If the program is not understood.
    """
    evidence, last = _parts(program)
    ids = tuple(resolve(evidence, graph))
    if last == "count":
        return Answer(str(len(ids)), ids)
    return Answer("yes" if ids else "no", ids)


def is_clear(program: AnyProgram, graph: SceneGraph, loose_graph: SceneGraph) -> bool:
    """Whether a person in a hurry would find the same evidence: nothing else comes near to being it.

    Parameters
    ----------
    program : program
        Of a question.
    graph : SceneGraph
        Of all objects of the room.
    loose_graph : SceneGraph
        Of the same objects, with `RelationRules.loosened`; see `remqa_data.language.referring.candidates`.
    """
    evidence, _ = _parts(program)
    return candidates(evidence, loose_graph) == resolve(evidence, graph)


def _parts(program: AnyProgram) -> tuple[Sequence[Sequence[Any]], str]:
    """The steps that find the evidence, and the name of the last step."""
    match list(program):
        case [*evidence, [("exist" | "count") as last]] if evidence:
            return evidence, str(last)
    raise ProgramError(f"a question's program ends with exist or count after steps that find objects, not {program!r}")
