import json
import re
from pathlib import Path

import pytest

from remqa_data.thor.session import ACTIONS, ARM_ACTIONS

PAGE = (Path(__file__).parents[2] / "docs" / "AI2THOR.md").read_text()


def rows(title: str, columns: int) -> list[list[str]]:
    """The table of a section."""
    lines = PAGE.split(f"## {title}\n")[1].split("\n## ")[0].splitlines()
    return [[cell.strip() for cell in line.split("|")[1 : columns + 1]] for line in lines if line.startswith("| ")]


ROWS = rows("Actions", 3)
SCHEMA = json.loads((Path(__file__).parent / "ai2thor_schema.json").read_text())


def test_the_table_names_every_action() -> None:
    cells = " ".join(names for names, supported, _ in ROWS if supported in ("yes", "approximated"))
    internal = {"Reset", "GetScenesInBuild"}  # AI2-THOR's Controller sends them
    assert set(ARM_ACTIONS) - set(re.findall(r"\w+", cells)) - internal == set()


def test_what_it_says_is_not_supported_is_not(kitchen) -> None:
    (notes,) = [notes for _, supported, notes in ROWS if supported == "no"]
    listed = notes.split("among others ")[1].replace(" (ProcTHOR houses)", "").split(", ")
    assert len(listed) > 3
    for action in listed:
        assert action not in ACTIONS | ARM_ACTIONS
        with pytest.raises(ValueError, match=f"Invalid action: {action}"):
            kitchen.step(action)


def test_the_table_names_every_field_of_recorded_events_once() -> None:
    named: dict[str, list[str]] = {}
    for of, fields, here, _ in rows("Fields", 4)[1:]:
        assert here in ("same", "differs", "constant")
        named.setdefault(of, []).extend(fields.split(", "))
    objects = [name for names in SCHEMA["object"].values() for name in names]
    recorded = {"event": SCHEMA["event"], "agent": SCHEMA["agent"], "arm": SCHEMA["arm"], "object": objects}
    assert {of: sorted(names) for of, names in named.items()} == {of: sorted(names) for of, names in recorded.items()}


def test_what_it_calls_constant_is(kitchen) -> None:
    constant = [
        (of, name) for of, fields, here, _ in rows("Fields", 4) if here == "constant" for name in fields.split(", ")
    ]
    seen: dict[tuple[str, str], set[str]] = {pair: set() for pair in constant}
    for action in ("MoveAhead", "RotateRight", "GetReachablePositions", "Crouch"):
        event = kitchen.step(action).metadata
        records = {"event": [event], "agent": [event["agent"]], "object": event["objects"]}
        for of, name in constant:
            seen[of, name] |= {repr(record[name]) for record in records[of]}
    assert len(constant) > 15
    assert {len(values) for values in seen.values()} == {1}
