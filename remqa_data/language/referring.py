"""What a phrase such as "the cabinet above the sink" picks out, found by executing its program on a scene graph.

A program is a pipeline over sets of objects, as in CLEVR: it starts with all objects, and each step keeps some of them.

- ``("filter_type", "Cabinet")``, ``("filter_color", "red")``, ``("filter_substance", "wooden")``
- ``("relate", "above", program)`` keeps what is above at least one of the objects that the inner program gives; so does
  ``"behind"``, and ``"between"`` keeps what is between two of them.
- ``("closest", program)`` keeps what is closest to the objects that the inner program gives.
- ``("stack", "highest")``, ``"lowest"`` or ``"middle"`` keeps one of a stack.
- ``("row", "left")``, ``"right"``, ``"leftmost"`` or ``"rightmost"`` keeps one end of a row; so do
  ``"second from the left"`` and the like with what is nearly there.

Programs are tuples of strings and tuples, so they can be compared and hashed; JSON turns them into lists, which are
understood as well. All but behind and between can be said in a phrase.

>>> program_of("the red mug on the dining table")
(('filter_type', 'Mug'), ('filter_color', 'red'), ('relate', 'on', (('filter_type', 'DiningTable'),)))
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any, get_args

from remqa_data.catalog import catalog
from remqa_data.errors import ProgramError, nearest_names
from remqa_data.language.rules import RowPlace, StackPlace, expression_rules
from remqa_data.language.semantics import ExactSemantics, LooseSemantics
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.scene_graph.relations import OrderRelation, Relation, relation_rules

Step = tuple[Any, ...]
Program = tuple[Step, ...]
AnyProgram = Sequence[Sequence[Any]]
"""A program, or what JSON made of it."""
RELATIONS = (*get_args(Relation), *get_args(OrderRelation))


def resolve(text_or_program: str | AnyProgram, graph: SceneGraph) -> list[str]:
    """Ids of all objects that a phrase, or a program, picks out, sorted.

    Raises
    ------
    ProgramError
        If the phrase or the program is not understood.

    See Also
    --------
    candidates : also what nearly fits.
    """
    program = program_of(text_or_program) if isinstance(text_or_program, str) else text_or_program
    return sorted(_execute(program, graph, ExactSemantics()))


def candidates(text_or_program: str | AnyProgram, loose_graph: SceneGraph) -> list[str]:
    """Ids of all objects that a person might take a phrase to mean, sorted: a superset of what `resolve` gives.

    Types whose names are mistaken for one another, and words that look alike, count as the same; what is in a bowl on a
    table counts as in and on the table; above counts as on, and under as below.

    Parameters
    ----------
    text_or_program : str or program
        The phrase.
    loose_graph : SceneGraph
        A graph of the same objects, built with `RelationRules.loosened`, in which relations that nearly hold do.
    """
    program = program_of(text_or_program) if isinstance(text_or_program, str) else text_or_program
    return sorted(_execute(program, loose_graph, LooseSemantics()))


def program_of(text: str) -> Program:
    """The program of a phrase, whose words are those of `templates/`.

    What is behind or between other things is asked of programs alone: no phrase says it.

    Raises
    ------
    ProgramError
        Naming the words that are not understood.
    """
    words = text.strip().rstrip("?.")
    between: dict[str, str] = {str(relation): word for relation, word in relation_rules().words.items()}
    between["closest to"] = expression_rules().closest_word
    found = {relation: words.find(f" {word} the ") for relation, word in between.items()}
    at, relation = min(((index, relation) for relation, index in found.items() if index >= 0), default=(-1, ""))
    if at < 0:
        return _noun_program(words, text, None)
    anchor = program_of(words[at + len(between[relation]) + 2 :])
    step = ("closest", anchor) if relation == "closest to" else ("relate", relation, anchor)
    return _noun_program(words[:at], text, step)


# ---- reading phrases


def _noun_program(words: str, text: str, relation: Step | None) -> Program:
    """Type, colours and materials, then the relation, then the place in a stack or a row of what is left."""
    article, _, rest = words.partition(" ")
    names, rules = _types_by_word(), expression_rules()
    side = next((side for side in rules.row_sides if rest.endswith(f" {side}")), "")
    rest = rest.removesuffix(f" {side}") if side else rest
    parts = rest.split(" ")
    if article.lower() != "the" or not rest:
        raise ProgramError(f"{text!r}: expected a phrase that starts with 'the', found {words!r}")
    if "the" in parts[1:]:
        said = ", ".join((*relation_rules().words.values(), rules.closest_word))
        raise ProgramError(
            f"{text!r}: {parts[parts.index('the', 1) - 1]!r} is no relation that phrases say; they say {said}"
        )
    for start in range(len(parts)):
        noun = " ".join(parts[start:])
        if noun in names:
            attributes = [_attribute_step(word, side, text) for word in parts[:start]]
            filters = [step for step in attributes if step[0].startswith("filter")]
            places = [step for name in ("stack", "row") for step in attributes if step[0] == name]
            if side and not any(step[1].endswith(rules.row_sides[side]) for step in places):
                ordinals = " or ".join(rules.row_ordinals)
                raise ProgramError(f"{text!r}: {side!r} is said of the {ordinals} of a row, and no such word is there")
            return (("filter_type", names[noun]), *filters, *([relation] if relation else []), *places)
    hint = "".join(f"; did you mean {near!r}?" for near in nearest_names(rest, names, 1))
    raise ProgramError(f"{text!r}: no object type is called {rest!r}{hint}")


def _attribute_step(word: str, side: str, text: str) -> Step:
    rules = expression_rules()
    if word in rules.row_ordinals and side:
        return ("row", f"{rules.row_ordinals[word]} {rules.row_sides[side]}")
    if word in rules.stack_words:
        return ("stack", rules.stack_words[word])
    if word in rules.row_words:
        return ("row", rules.row_words[word])
    if word in rules.substances:
        return ("filter_substance", word)
    if any(word in group for group in rules.similar_words):
        return ("filter_color", word)
    raise ProgramError(f"{text!r}: {word!r} is no colour, material or place that expressions use")


@lru_cache(maxsize=1)
def _types_by_word() -> dict[str, str]:
    return {kind.singular: name for name, kind in catalog().items()}


# ---- executing


def _execute(program: AnyProgram, graph: SceneGraph, meaning: ExactSemantics) -> frozenset[str]:
    """What is left after all steps; found once for each graph, as questions share most of their steps."""
    if not program:
        return frozenset(graph.objects)
    steps = _hashable(program)
    key = (type(meaning), steps)
    if key not in graph.memo:
        graph.memo[key] = frozenset(_step(steps, set(_execute(steps[:-1], graph, meaning)), graph, meaning))
    return graph.memo[key]


def _hashable(program: AnyProgram) -> Program:
    """The same with tuples for JSON's lists."""
    return tuple(tuple(_hashable_part(part, step) for part in step) for step in program)


def _hashable_part(part: object, step: Sequence[Any]) -> str | Program:
    if isinstance(part, str):
        return part
    if isinstance(part, list | tuple) and all(isinstance(inner, list | tuple) for inner in part):
        return _hashable(part)
    raise ProgramError(f"cannot execute step {step!r}: a step holds words and programs, not {part!r}")


def _step(program: Program, found: set[str], graph: SceneGraph, meaning: ExactSemantics) -> set[str]:
    """What the last step of a program keeps of some objects."""
    match program[-1]:
        case ("filter_type", str(value)) if value in catalog():
            return {i for i in found if meaning.type(graph.node(i), value)}
        case ("filter_color", str(value)):
            return {i for i in found if meaning.word(graph.node(i).color, value)}
        case ("filter_substance", str(value)):
            return {i for i in found if meaning.word(graph.node(i).substance, value)}
        case ("relate", str(value), tuple() as inner) if value in RELATIONS:
            relation: Relation | OrderRelation = value  # type: ignore[assignment]  # just checked
            anchors = _execute(inner, graph, meaning)
            return {i for i in found if meaning.related(graph, i, relation, set(anchors - {i}))}
        case ("closest", tuple() as inner):
            return meaning.closest(graph, found, set(_execute(inner, graph, meaning)))
        case ("row", str(value)) if value in get_args(RowPlace):
            end: RowPlace = value  # type: ignore[assignment]  # just checked
            return meaning.in_row(graph, found, end)
        case ("stack", str(value)) if value in get_args(StackPlace):
            place: StackPlace = value  # type: ignore[assignment]  # just checked
            return meaning.in_stack(graph, found, place)
    raise ProgramError(f"cannot execute step {program[-1]!r} of the program {program!r}")
