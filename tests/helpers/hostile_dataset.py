"""A dataset whose texts attack who shows them, and a page of a browser that notes every complaint."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from remqa_data.storage.card import write_card
from remqa_data.storage.manifest import make_manifest
from remqa_data.storage.parts import Parts, assemble, count_questions, finish
from tests.helpers.dataset_rows import scene_rows

HOSTILE = '<img src=x onerror="window.hacked=1"><script>window.hacked=1</script></script>"\'&{{7*7}}'
HOSTILE_ID = '../../x"><script>window.hacked=1</script>'
QUESTIONS = 60
"""More than a page of the list."""
_ATTACKED = ("question", "expression", "answer_type", "target_type", "answer", "target_id")


def write_hostile(root: Path) -> None:
    """60 questions about a room of two arrangements; number 4 attacks with all its texts, and so does the walk."""
    rows: dict[str, Any] = scene_rows("Kitchen1", "test", frames=5, questions=QUESTIONS)
    rows["questions"] = [replace(row, configuration=i % 2) for i, row in enumerate(rows["questions"])]
    rows["questions"][4] = replace(
        rows["questions"][4],
        question_id=HOSTILE_ID,
        actions=(HOSTILE,),
        object_ids=(HOSTILE, "Table|1"),
        **dict.fromkeys(_ATTACKED, HOSTILE),
    )
    rows["frames"][1] = replace(rows["frames"][1], added_nodes=("Mug|1", HOSTILE), frame_id=HOSTILE)
    parts = Parts(root, {"seed": 0})
    made = [parts.write("Kitchen1", rows, {"refused": {}})]
    manifest = make_manifest(assemble(parts, made, 1), seed=0, config={}, questions=count_questions(made), refused={})
    write_card(root, manifest)
    finish(parts.storage, manifest)


@dataclass
class Tab:
    """A page of a browser, and what it has complained about or asked other hosts for."""

    page: Any
    events: list[str]
