"""How many questions a room may have, and in which order rows come."""

import pytest

from remqa_data.generators.audit.row_order import Key, _expression_rows, _question_rows
from remqa_data.generators.config import load_config
from remqa_data.generators.questions.allotment import SceneQuota

QUOTA = SceneQuota("FloorPlan1", "kitchen", "train", {"EXISTENCE": {"yes": 2, "no": 2}})


def rows(*answers: str) -> list[Key]:
    """Questions of one room, each about another place, with these answers in configurations 0 and 1."""
    return [
        {
            **{"question_id": f"FloorPlan1-EXISTENCE-{index // 2:02d}-c{index % 2}", "scene": "FloorPlan1"},
            **{"room_type": "kitchen", "configuration": index % 2, "split": "train", "file_split": "train"},
            **{"group": f"FloorPlan1-EXISTENCE-{index // 2:02d}", "kind": "EXISTENCE", "answer": answer},
        }
        for index, answer in enumerate(answers)
    ]


@pytest.mark.parametrize(
    ("answers", "may_fall_short", "wrong"),
    [
        (("yes", "no", "no", "yes"), False, 0),
        (("yes", "no"), False, 2),  # one yes and one no are missing
        (("yes", "no"), True, 0),  # others stepped in
        (("yes", "no", "yes", "no", "yes", "no"), True, 2),  # nobody has more than was asked for
    ],
)
def test_a_room_has_what_it_was_asked_for(answers: tuple[str, ...], may_fall_short: bool, wrong: int) -> None:
    failures = list(_question_rows(rows(*answers), [QUOTA], may_fall_short=may_fall_short))
    assert [failure.truth for failure in failures] == ["unbiased"] * wrong


def test_groups_of_a_kind_come_in_the_order_of_their_numbers() -> None:
    asked = rows("yes", "no", "no", "yes")
    failures = _question_rows([*asked[2:], *asked[:2]], [QUOTA], may_fall_short=False)
    assert [(failure.where, failure.truth) for failure in failures] == [("FloorPlan1", "complete")]


def said(*targets: str) -> list[Key]:
    """One expression for each of these targets, of one frame of a room."""
    return [
        {
            **{"expression_id": f"FloorPlan1-c0-{target}-e0", "scene": "FloorPlan1", "configuration": 0},
            **{"split": "train", "file_split": "train", "frame_id": "FloorPlan1-c0-f00", "target_id": target},
        }
        for target in targets
    ]


@pytest.mark.parametrize(("targets", "is_right"), [("AB", True), ("BA", False)])
def test_expressions_come_in_the_order_of_their_targets(targets: str, is_right: bool) -> None:
    frames = [{"frame_id": "FloorPlan1-c0-f00", "scene": "FloorPlan1", "configuration": 0}]
    failures = list(_expression_rows(said(*targets), frames, load_config("paper")))
    assert [(failure.where, failure.truth) for failure in failures] == [("FloorPlan1, configuration 0", "complete")] * (
        not is_right
    )
