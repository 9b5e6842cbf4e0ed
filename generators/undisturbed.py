"""Whether acting on a thing leaves the rest as it was, and the answer, counted again afterwards, is the stored one."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from remqa_data.geometry.types import I32
from remqa_data.sim.metadata import ObjectMetadata, scaled_pixels

MOVED_M = 0.001
"""What has moved by no more than this is where it was."""
NOTICED_PX = 10
"""Of a thing that comes to light elsewhere, so many pixels of 300 x 300 may be noticed and counted."""

Records = Mapping[str, ObjectMetadata]
"""`object_metadata` of a world."""


def disturbed(before: Records, after: Records, target_id: str, manipulation: str) -> list[str]:
    """Ids of what has moved, and is neither the target nor held by it.

    Parameters
    ----------
    before, after : mapping of str to ObjectMetadata
        The room before and after the manipulation.
    target_id : str
        What was acted on.
    manipulation : str
        "Open" takes along what is in the target, "Move" and "Pickup" also what is on it.
    """
    return [
        name
        for name, record in before.items()
        if name != target_id
        and _has_moved(record, after[name])
        and not _goes_along(before, name, target_id, manipulation)
    ]


def _goes_along(records: Records, object_id: str, target_id: str, manipulation: str) -> bool:
    held = records[object_id]
    for _ in records:
        if held.support is None:
            return False
        if held.support == target_id:
            return manipulation != "Open" or held.support_kind == "in"
        held = records[held.support]
    return False


def counted_again(
    before: Records,
    after: Records,
    images: tuple[I32, I32],
    ids: tuple[str, ...],
    type_: str,
    inside: str | None,
    evidence: Collection[str],
) -> set[str]:
    """Ids of the things of a type that a person would count from what is seen after the manipulation.

    Parameters
    ----------
    before, after : mapping of str to ObjectMetadata
        The room before and after the manipulation.
    images : pair of (h, w) arrays
        Indices of the objects that the goal pose shows before and after, -1 for none.
    ids : tuple of str
        What the indices mean.
    type_ : str
        What is counted.
    inside : str, optional
        The target, where the question is what is in it.
    evidence : collection of str
        What makes the stored answer: it counts while it still is in the target, or else lies where it lay. Whatever else
        of the type comes to light counts too: nobody could tell it from evidence.
    """
    least = scaled_pixels(NOTICED_PX, images[1].shape)
    counted = set()
    for index, name in enumerate(ids):
        if after[name].type != type_ or after[name].is_picked_up or (images[0] == index).any():
            continue
        if np.count_nonzero(images[1] == index) >= least:
            if inside is None:
                is_there = not _has_moved(before[name], after[name])
            else:
                is_there = (after[name].support, after[name].support_kind) == (inside, "in")
            counted |= {name} if is_there or name not in evidence else set()
    return counted


def _has_moved(before: ObjectMetadata, after: ObjectMetadata) -> bool:
    return bool(np.abs(np.subtract(before.box, after.box)).max() > MOVED_M)
