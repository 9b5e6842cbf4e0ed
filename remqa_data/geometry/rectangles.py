"""Rectangles in rasters."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt


def edge_rectangles(kept: npt.NDArray[np.bool_], least: tuple[int, int], most: int) -> list[tuple[int, int, int, int]]:
    """Large empty rectangles that touch the edge of a raster, the largest first.

    Parameters
    ----------
    kept : (n, m) array of bool
        What is not empty.
    least : (int, int)
        How many cells a rectangle has at least along each side.
    most : int
        How many rectangles at most; they do not overlap.

    Returns
    -------
    Cell ranges i0, j0, i1, j1.

    Examples
    --------
    >>> edge_rectangles(np.array([[False, False, True], [False, False, True]]), (1, 1), 3)
    [(0, 0, 2, 2)]
    """
    blocked = kept.copy()
    holes = []
    for _ in range(most):
        best, best_area = None, 0
        filled = np.pad(blocked.astype(int).cumsum(0).cumsum(1), ((1, 0), (1, 0)))
        n, m = blocked.shape
        for i0 in range(n):
            for i1 in range(i0 + least[0], n + 1):
                columns = filled[i1] - filled[i0]
                empty = np.diff(columns) == 0
                start = 0
                for j in range(m + 1):
                    if j < m and empty[j]:
                        continue
                    if j - start >= least[1] and (i0 == 0 or i1 == n or start == 0 or j == m):
                        area = (i1 - i0) * (j - start)
                        if area > best_area:
                            best, best_area = (i0, start, i1, j), area
                    start = j + 1
        if best is None:
            break
        holes.append(best)
        blocked[best[0] : best[2], best[1] : best[3]] = True
    return holes
