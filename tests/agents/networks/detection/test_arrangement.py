import numpy as np
import pytest
import torch

from remqa_data.agents.networks.detection.arrangement import COUNTS, MOST, Arrangement, arrangement_of
from remqa_data.agents.networks.detection.regions import ALIKE, AROUND, PLACE, Regions, levelled, places_of

DRAWERS = np.array([[10, 20, 30, 40], [40, 20, 60, 40], [70, 20, 90, 40], [10, 60, 30, 80]], dtype=np.float32)
"""Three in a row, and one below the first."""
FRIDGE = np.array([[92, 10, 99, 90]], dtype=np.float32)


def lie(boxes: np.ndarray, types: list[int], scores: list[float] | None = None) -> Arrangement:
    """Objects of some types, two metres before a camera that looks straight ahead."""
    places, count = places_of(boxes, np.full((100, 100), 2.0, dtype=np.float32)), len(boxes)
    return arrangement_of(
        Regions(
            boxes,
            torch.zeros((count, 1, 1, 1)),
            torch.zeros((count, 3, 1, 1)),
            torch.eye(3)[types],
            places,
            torch.zeros((count, ALIKE, PLACE)),
            torch.zeros((count, AROUND), dtype=torch.int64),
            torch.zeros((count, AROUND, PLACE)),
            torch.zeros((count, AROUND), dtype=torch.bool),
            places,
            torch.ones(count) if scores is None else torch.tensor(scores),
            (100, 100),
            scores is None,
        )
    )


def counted(found: Arrangement) -> list[list[int]]:
    """Of each object the numbers that its ranks stand for; here they are whole."""
    ranks = found.ranks.reshape(-1, COUNTS, MOST + 1)
    assert ranks.amax(2).tolist() == torch.ones(ranks.shape[:2]).tolist()
    return ranks.argmax(2).tolist()


def test_ranks_count_those_of_the_kind_to_each_side_in_the_row_in_the_column_and_all() -> None:
    assert counted(lie(np.concatenate([DRAWERS, FRIDGE]), [0, 0, 0, 0, 1])) == [
        [
            0,
            2,
            0,
            1,
            0,
            2,
            0,
            1,
            3,
        ],  # left, right, above, below; left, right in the row; above, below in the column; all
        [2, 1, 0, 1, 1, 1, 0, 0, 3],
        [3, 0, 0, 1, 2, 0, 0, 0, 3],
        [0, 2, 3, 0, 0, 0, 1, 0, 3],
        [0] * COUNTS,
    ]


def test_what_is_found_twice_and_what_is_hardly_there_is_not_counted() -> None:
    twice = np.concatenate([DRAWERS[:2], DRAWERS[1:2] + 1])
    assert counted(lie(twice, [0, 0, 0]))[1][-1] == 1  # the first, and not itself again
    assert lie(DRAWERS[:2], [0, 0], [1.0, 0.0]).ranks.reshape(2, COUNTS, -1)[0, -1].tolist() == [1, 0, 0, 0]
    half = lie(DRAWERS[:2], [0, 0], [1.0, 0.15]).ranks.reshape(2, COUNTS, -1)[0, -1]
    assert half.tolist() == pytest.approx([0.5, 0.5, 0, 0])


def test_pairs_tell_how_many_of_the_kind_are_nearer_to_the_second() -> None:
    found = lie(np.concatenate([DRAWERS, FRIDGE]), [0, 0, 0, 0, 1])
    nearer = found.pairs[:, 4, -(MOST + 1) :].argmax(1).tolist()
    assert nearer == [2, 1, 0, 2, 0]  # the two of a column are as near, seen from above
    metres = found.pairs[:, 4, PLACE].tolist()
    assert metres[2] * 2 == pytest.approx((95.5 - 80) / 100 * 4, abs=1e-5)
    assert found.is_other.tolist() == (~torch.eye(5, dtype=torch.bool)).tolist()


def test_what_a_tilted_camera_sees_straight_ahead_is_ahead_and_below() -> None:
    metres = torch.tensor([[0.5, 0.0, 2.0], [0.0, -1.0, 1.0]])
    level = levelled(torch.cat([torch.full((2, 5), 0.1), metres], 1), 30.0)
    assert torch.equal(level[:, :5], torch.full((2, 5), 0.1))
    level = level[:, 5:]
    assert level[0].tolist() == pytest.approx([0.5, 1.0, 3**0.5])
    assert level[1].tolist() == pytest.approx([0.0, 0.5 - 3**0.5 / 2, 3**0.5 / 2 + 0.5])
