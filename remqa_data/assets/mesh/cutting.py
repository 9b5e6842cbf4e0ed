"""Cutting a box into boxes that leave others free: how carcasses, walls and worktops are made."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from remqa_data.geometry.types import Box


def solid_around(box: Box, pockets: Sequence[Box]) -> list[Box]:
    """Cut a box into boxes that fill it except for the pockets; few and large, and never overlapping.

    >>> solid_around((0, 0, 0, 3, 1, 1), [(1, 0, 0, 2, 1, 1)])
    [(0.0, 0.0, 0.0, 1.0, 1.0, 1.0), (2.0, 0.0, 0.0, 3.0, 1.0, 1.0)]
    """
    whole = np.asarray(box, float).reshape(2, 3)
    cuts = []
    for axis in range(3):
        values = [whole[0, axis], whole[1, axis]]
        values += [min(max(p[axis + 3 * end], whole[0, axis]), whole[1, axis]) for p in pockets for end in (0, 1)]
        cuts.append(np.unique(np.round(values, 5)))
    middles = [(c[1:] + c[:-1]) / 2 for c in cuts]
    full = np.ones([len(along) for along in middles], dtype=bool)
    for pocket in pockets:
        sides = zip(middles, pocket[:3], pocket[3:], strict=True)
        full[np.ix_(*((along > low) & (along < high) for along, low, high in sides))] = False
    boxes: list[Box] = []
    while full.any():
        start = np.array(np.unravel_index(full.argmax(), full.shape))
        end = start + 1
        for axis in (2, 0, 1):  # tall panels first: that is how furniture is built
            while end[axis] < full.shape[axis]:
                grown = [slice(s, e) for s, e in zip(start, end, strict=True)]
                grown[axis] = slice(end[axis], end[axis] + 1)
                if not full[tuple(grown)].all():
                    break
                end[axis] += 1
        full[tuple(slice(s, e) for s, e in zip(start, end, strict=True))] = False
        corners = [cuts[i][start[i]] for i in range(3)] + [cuts[i][end[i]] for i in range(3)]
        x0, y0, z0, x1, y1, z1 = (float(corner) for corner in corners)
        boxes.append((x0, y0, z0, x1, y1, z1))
    return boxes
