"""Which split a room is of: it follows from its name, in all datasets."""

from __future__ import annotations

from typing import Literal, get_args

from remqa_data.errors import UnknownNameError
from remqa_data.floorplans.ithor.table import scene_names
from remqa_data.floorplans.sampled.naming import is_sampled, sampled_split
from remqa_data.tables.rows import Split

QuestionSplit = Literal["train", "test"]
QUESTION_SPLITS: tuple[QuestionSplit, ...] = get_args(QuestionSplit)

ROOMS_OF_A_TYPE, VAL_ROOMS_OF_A_TYPE, TEST_ROOMS_OF_A_TYPE = 30, 5, 5


def split_of(scene: str) -> QuestionSplit:
    """The split of a room: the last five of each room type are for testing; of sampled rooms, one in six.

    Which rooms REMQA tests on is not published. AI2-THOR's own convention, kept by AllenAct and others, takes rooms 1 to 20
    of each type for training, 21 to 25 for validation and 26 to 30 for testing; so nothing that was trained in the usual
    way has seen our test rooms.

    >>> split_of("FloorPlan25"), split_of("FloorPlan226")
    ('train', 'test')

    Raises
    ------
    UnknownNameError
        If there is no such room.
    """
    if not is_sampled(scene) and scene not in scene_names():
        raise UnknownNameError("scene", scene, scene_names())
    return "test" if expression_split(scene) == "test" else "train"


def expression_split(scene: str) -> Split:
    """The split of a room's referring expressions: AI2-THOR's usual one, 1-20 train, 21-25 val, 26-30 test of each type.

    >>> [expression_split(f"FloorPlan{n}") for n in (20, 221, 430)]
    ['train', 'val', 'test']
    """
    if is_sampled(scene):
        return sampled_split(scene)
    before_test = ROOMS_OF_A_TYPE - TEST_ROOMS_OF_A_TYPE
    number = _number(scene) % 100
    if number > before_test:
        return "test"
    return "val" if number > before_test - VAL_ROOMS_OF_A_TYPE else "train"


def _number(scene: str) -> int:
    return int(scene.removeprefix("FloorPlan"))
