"""What is asked, and in which words, counted from the columns of questions and expressions."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Hashable, Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from typing import Any

import numpy as np
import pandas as pd

from remqa_data.catalog import object_type
from remqa_data.errors import DatasetError, ProgramError, one_line
from remqa_data.language.referring import Program
from remqa_data.language.stored import stored_program
from remqa_data.storage.manifest import load_manifest, question_splits
from remqa_data.storage.shards import read_table

QUESTION_COLUMNS = [
    *("question_id", "kind", "split", "scene", "configuration", "group", "question", "expression", "program"),
    *("target_id", "target_type", "answer_type", "manipulation"),
]
BETWEEN_THINGS = ("on", "next to", "behind", "between")
"""Relations that are asked of two things in one place, both of which are there whatever the answer."""
EXPRESSION_COLUMNS = ["expression_id", "frame_id", "target_id", "target_type", "anchor_id"]


def asked(root: str | os.PathLike[str]) -> pd.DataFrame:
    """The questions of a dataset without their pictures.

    Returns
    -------
    pandas.DataFrame
        The columns `QUESTION_COLUMNS`, and `words` (of the question), `relation` (of the first step), `has_landmark`,
        `same_type` (objects of the target's type in the room), `called_so` (those of types that may be called like it, too:
        a box of tissues is a box).
    """
    splits = question_splits(root)
    rows: pd.DataFrame = pd.concat(
        [read_table(root, "questions", split, QUESTION_COLUMNS).to_pandas() for split in splits], ignore_index=True
    )
    types = _types_of_rooms(root)
    columns = []
    for row in rows.to_dict("records"):
        with naming(root, f"question {row['question_id']}"):
            columns.append(_counted(row, types[row["scene"], row["configuration"]]))
    return rows.join(pd.DataFrame(columns))


@contextmanager
def naming(root: str | os.PathLike[str], row: str) -> Iterator[None]:
    """While a row is counted: one that does not fit the others is an error that names it."""
    try:
        yield
    except (LookupError, ProgramError) as error:
        raise DatasetError(
            f"{root}: {one_line(f'{row} does not fit the rest: {error}')}; see remqa-data verify"
        ) from None


def _counted(row: Mapping[Hashable, Any], room: Counter[str]) -> dict[str, Any]:
    program, kind = stored_program(row["program"]), row["target_type"]
    return {
        "words": _words(row["question"]),
        "relation": relation_of(program),
        "has_landmark": _has_landmark(program),
        "same_type": room[kind],
        "called_so": sum(count for other, count in room.items() if _may_be_called(other, kind)),
    }


@cache
def _may_be_called(type_: str, like: str) -> bool:
    """Whether the word for one type is among the words for another."""
    kind, word = object_type(type_), object_type(like).singular
    return any(f" {word} " in f" {name} " for name in (kind.singular, *kind.synonyms))


def expressions_in_frames(root: str | os.PathLike[str]) -> pd.DataFrame:
    """The referring expressions of a dataset.

    Returns
    -------
    pandas.DataFrame
        The columns `EXPRESSION_COLUMNS`, and `rivals` (objects of the target's type that the frame shows, without the
        target), `shows_anchor` (whether the frame shows the landmark; None where there is none).
    """
    shown: dict[str, list[tuple[str, str]]] = {}
    for split in load_manifest(root).splits(
        "frames"
    ):  # not those of the expressions: a frame goes by its room's questions
        frames = read_table(root, "frames", split, ["frame_id", "objects"])
        lists = frames["objects"].combine_chunks().to_pylist()
        for frame, objects in zip(frames["frame_id"].to_pylist(), lists, strict=True):
            shown[frame] = [(record["id"], record["type"]) for record in objects]
    parts: list[pd.DataFrame] = []
    for split in load_manifest(root).splits("expressions"):
        rows = read_table(root, "expressions", split, EXPRESSION_COLUMNS).to_pandas()
        with naming(root, "a frame of an expression"):
            seen = [shown[frame] for frame in rows["frame_id"]]
        rows["rivals"] = [
            sum(kind == wanted for _, kind in objects) - 1
            for objects, wanted in zip(seen, rows["target_type"], strict=True)
        ]
        rows["shows_anchor"] = [
            None if not isinstance(anchor, str) else anchor in {object_id for object_id, _ in objects}
            for objects, anchor in zip(seen, rows["anchor_id"], strict=True)
        ]
        parts.append(rows)
    if not parts:
        return pd.DataFrame(columns=[*EXPRESSION_COLUMNS, "rivals", "shows_anchor"])
    found: pd.DataFrame = pd.concat(parts, ignore_index=True)
    return found


def relation_of(program: Program) -> str:
    """The relation of a program's first step that has one; "" if none has.

    >>> relation_of((("filter_type", "Egg"), ("relate", "in", (("filter_type", "Fridge"),)), ("exist",)))
    'in'
    """
    return next((str(step[1]) for step in program if step[0] == "relate"), "")


def _words(text: str) -> int:
    return len(text.split())


def phrase_of(program: Program) -> Program:
    """The program of the phrase for the target: what the thing asked for is in or under, or what holds it and its partner.

    >>> phrase_of((("filter_type", "Egg"), ("relate", "in", (("filter_type", "Fridge"),)), ("exist",)))
    (('filter_type', 'Fridge'),)
    """
    relates = [step[1:] for step in program if step[0] == "relate"]
    if not relates:
        return ()
    relation, phrase = relates[0]
    holder = phrase[-1][-1] if relation in BETWEEN_THINGS else phrase
    return holder if isinstance(holder, tuple) else ()


def _has_landmark(program: Program) -> bool:
    """Whether the phrase for the target leans on something else."""
    return any(step[0] in ("relate", "closest") for step in phrase_of(program))


def _types_of_rooms(root: str | os.PathLike[str]) -> dict[tuple[str, int], Counter[str]]:
    found = {}
    for split in load_manifest(root).splits("scenes"):
        for row in read_table(root, "scenes", split, ["scene", "configuration", "objects"]).to_pylist():
            found[row["scene"], row["configuration"]] = Counter(record["type"] for record in row["objects"])
    return found


def largest_share(values: pd.Series) -> float:
    """Share of the most frequent value; 0 of none."""
    return float(values.value_counts(normalize=True).max()) if len(values) else 0.0


def percentile(values: pd.Series, share: float) -> float:
    """A percentile of what is no NaN; NaN if nothing is."""
    known = values.dropna()
    return float(np.percentile(known, share)) if len(known) else float("nan")
