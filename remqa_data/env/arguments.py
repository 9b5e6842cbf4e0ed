"""What environments are made with: refused in one clear line where it is no such thing."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Set
from pathlib import Path

import numpy as np

from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.errors import ActionError


def check_counts(least: int = 1, /, **counts: object) -> None:
    """ActionError for what is no whole number, or a smaller one than the least, 1 or 0."""
    for name, value in counts.items():
        if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
            raise ActionError(
                f"{name} is {value!r:.80}: give a {'positive whole number' if least else 'whole number, 0 for none'}"
            )


def check_flags(**flags: object) -> None:
    """ActionError for what is neither True nor False."""
    for name, value in flags.items():
        if not isinstance(value, bool | np.bool_):
            raise ActionError(f"{name} is {value!r:.80}: give True or False")


def check_render_mode(render_mode: object, *known: str) -> None:
    """ActionError for what is neither None nor a mode that is known."""
    if render_mode is not None and render_mode not in known:
        raise ActionError(f"render_mode is {render_mode!r:.80}: give {' or '.join(map(repr, (None, *known)))}")


def check_vocabulary(vocabulary: object) -> None:
    """ActionError for what is neither a Vocabulary nor None."""
    if not isinstance(vocabulary, Vocabulary | None):
        raise ActionError(f"vocabulary is {vocabulary!r:.80}: give a Vocabulary")


def folder(root: object) -> Path:
    """The folder of a dataset; ActionError for what is no path."""
    if not isinstance(root, str | os.PathLike):
        raise ActionError(f"root is {root!r:.80}: give the folder of a dataset")
    return Path(root)


def in_order(name: str, given: object, example: str) -> list[object]:
    """Some things in their order, on which it depends what a seed draws.

    Raises
    ------
    ActionError
        If they are one text or no things at all, or have no order of their own, as a set has none.
    """
    what = ""
    if isinstance(given, str):
        what = "a text"
    elif isinstance(given, Set):
        what = "a set, which has no order"
    elif isinstance(given, Iterable):
        return list(given)
    raise ActionError(f"{name} is {what or repr(given)[:80]}: give a list, such as [{example!r}]")


def chosen_questions(question_ids: object) -> tuple[str, ...] | None:
    """A choice of questions; None for all.

    Raises
    ------
    ActionError
        As of `in_order`; if it is empty, names a question twice, or holds something else than texts.
    """
    if question_ids is None:
        return None
    names = in_order("question_ids", question_ids, "FloorPlan1-COUNTING-00-c0")
    if not names:
        raise ActionError("question_ids is empty: leave it out, or name at least one")
    for name in names:
        if not isinstance(name, str):
            raise ActionError(f"question_ids has {name!r:.80}: give ids of questions")
    for name, count in Counter(names).items():
        if count > 1:
            raise ActionError(f"question_ids has {name!r:.80} twice: name each question once")
    return tuple(map(str, names))  # NumPy has texts of its own
