"""Masks as COCO's compressed run lengths."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt


def run_lengths(labels: npt.NDArray[np.integer[Any]]) -> dict[int, list[int]]:
    """The mask of each label of an (h, w) image: lengths of its runs down the columns and from left to right.

    The first run is of what has not the label, and may be empty.

    >>> run_lengths(np.array([[7, 0], [7, 7]]))
    {0: [2, 1, 1], 7: [0, 2, 1, 1]}
    """
    flat = labels.ravel(order="F")
    starts = np.concatenate([[0], np.flatnonzero(np.diff(flat)) + 1])
    runs = np.column_stack([starts, [*starts[1:], flat.size]])
    found = {}
    for label in np.unique(flat).tolist():
        ends = runs[flat[starts] == label].ravel()
        rest = [] if ends[-1] == flat.size else [flat.size]
        found[label] = np.diff([0, *ends.tolist(), *rest]).tolist()
    return found


def compressed(lengths: list[int]) -> str:
    """Run lengths as text: from the fourth on, each is told by its difference from the one two before it.

    A letter holds five bits of a number, the lowest first, and a sixth that says whether more follow.

    >>> compressed([5, 2, 93])
    '52m2'
    """
    letters = []
    for place, length in enumerate(lengths):
        rest = length - lengths[place - 2] if place > 2 else length
        while True:
            bits, rest = rest & 31, rest >> 5
            is_last = rest == (-1 if bits & 16 else 0)  # the highest bit is the sign
            letters.append(chr(48 + bits + (0 if is_last else 32)))
            if is_last:
                break
    return "".join(letters)
