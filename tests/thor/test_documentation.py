import re
from pathlib import Path

import pytest

from remqa_data.thor.session import ACTIONS, ARM_ACTIONS

ROWS = [
    [cell.strip() for cell in line.split("|")[1:4]]
    for line in (Path(__file__).parents[2] / "docs" / "AI2THOR.md").read_text().split("## Actions")[1].splitlines()
    if line.startswith("| ")
]


def test_the_table_names_every_action() -> None:
    cells = " ".join(names for names, supported, _ in ROWS if supported in ("yes", "approximated", "refused"))
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
