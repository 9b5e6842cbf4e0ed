"""A program as datasets store it: JSON, which may be anybody's."""

from __future__ import annotations

import json
from typing import Any, get_args

from remqa_data.errors import ProgramError, one_line
from remqa_data.language.referring import RELATIONS, Program, Step
from remqa_data.language.rules import RowPlace, StackPlace


def stored_program(text: str) -> Program:
    """The program of a stored question or expression: steps that there are, with what each of them needs.

    Raises
    ------
    ProgramError
        If the text is no program.

    Examples
    --------
    >>> stored_program('[["filter_type", "Egg"], ["relate", "in", [["filter_type", "Fridge"]]], ["exist"]]')
    (('filter_type', 'Egg'), ('relate', 'in', (('filter_type', 'Fridge'),)), ('exist',))
    >>> stored_program('[["relate", "in"]]')
    Traceback (most recent call last):
    remqa_data.errors.ProgramError: no step of a program: ['relate', 'in']
    """
    try:
        steps = _steps(json.loads(text))
    except (ValueError, RecursionError) as error:  # ProgramError is a ValueError
        raise ProgramError(one_line(error)) from None
    if not steps:
        raise ProgramError("a program without steps")
    return tuple(steps)


def _steps(program: Any) -> list[Step]:
    match program:
        case [*before, ["exist" | "count" as last]]:
            return [*map(_step, before), (last,)]
        case [*steps]:
            return [*map(_step, steps)]
    raise ProgramError(f"no list of steps: {program!r:.100}")


def _step(step: Any) -> Step:
    match step:
        case ["filter_type" | "filter_color" | "filter_substance" as name, str(value)]:
            return (name, value)
        case ["relate", str(relation), [_, *_] as inner] if relation in RELATIONS:
            return ("relate", relation, tuple(map(_step, inner)))
        case ["closest", [_, *_] as inner]:
            return ("closest", tuple(map(_step, inner)))
        case ["row", str(place)] if place in get_args(RowPlace):
            return ("row", place)
        case ["stack", str(place)] if place in get_args(StackPlace):
            return ("stack", place)
    raise ProgramError(f"no step of a program: {step!r:.100}")
