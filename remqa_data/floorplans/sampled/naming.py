"""Names, types and splits of sampled rooms: all of it follows from a room's index."""

from __future__ import annotations

import re

from remqa_data.errors import UnknownNameError
from remqa_data.tables.rows import Split

ROOM_TYPES = ("kitchen", "living_room", "bedroom", "bathroom")
"""Room types take turns, in this order."""
PREFIX = "Sampled-"
TEST_INDICES, VAL_INDICES, PERIOD = (4, 10, 15, 21), (1, 8, 14, 19), 24
"""Of 24 rooms, one of each six is for testing and one for validation; together they are of all four types."""


def sampled_name(index: int) -> str:
    """The name of a room.

    >>> sampled_name(1)
    'Sampled-living_room-000001'
    """
    return f"{PREFIX}{room_type_of(index)}-{index:06d}"


def sampled_index(name: str) -> int:
    """The index of a room.

    Raises
    ------
    UnknownNameError
        If no room has that name.
    """
    match = re.fullmatch(PREFIX + r"[a-z_]+-(\d{6,})", name)
    if match is None or sampled_name(int(match[1])) != name:
        raise UnknownNameError("sampled room", name, [sampled_name(index) for index in range(len(ROOM_TYPES))])
    return int(match[1])


def is_sampled(name: str) -> bool:
    """Whether a name is meant for a sampled room and not for a recorded one."""
    return name.startswith(PREFIX)


def room_type_of(index: int) -> str:
    """The type of a room."""
    return ROOM_TYPES[index % len(ROOM_TYPES)]


def sampled_split(name: str) -> Split:
    """The split of a room: in every six rooms, four are for training.

    >>> [sampled_split(sampled_name(index)) for index in range(6)]
    ['train', 'val', 'train', 'train', 'test', 'train']
    """
    turn = sampled_index(name) % PERIOD
    if turn in TEST_INDICES:
        return "test"
    return "val" if turn in VAL_INDICES else "train"
