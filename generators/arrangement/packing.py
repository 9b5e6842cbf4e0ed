"""Putting things side by side on areas, turned at random, so that their outlines do not overlap."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from remqa_data.generators.arrangement.areas import Area
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import Vec3

TRIES = 30
ROUNDS = 3
"""Attempts at random before everything is set in rows."""
ROW_M = 0.01
"""In rows, places are so far apart."""
JITTER_DEG = 12.0
"""Things are turned by quarters and by up to this angle."""


@dataclass(frozen=True)
class Put:
    """A thing on an area: the middle of its bottom in the room, metres, and its turn about the vertical."""

    area: Area
    position: Vec3
    yaw_deg: float


Outline = tuple[float, float, float, float]
"""The middle, and half the sides, of a thing on an area, in the area's frame."""


def packed(
    areas: Sequence[Area],
    sizes: Sequence[Vec3],
    gap_m: float,
    rng: np.random.Generator,
    already: Mapping[int, Put] | None = None,
) -> list[Put] | None:
    """Places for things of some sizes on some areas, in the order of the sizes; None if no room was found.

    Large things choose first, at random; if there is no room for all, everything is set in tidy rows. Things that are
    there `already`, by their number, stay.
    """
    there = already or {}
    order = sorted((i for i in range(len(sizes)) if i not in there), key=lambda i: (-sizes[i][0] * sizes[i][1], i))
    for is_tidy in (False,) * ROUNDS + (True,):
        taken = {
            i: [outline_of(put, sizes[n]) for n, put in there.items() if put.area == a] for i, a in enumerate(areas)
        }
        corner = (float(rng.choice((-1, 1))), float(rng.choice((-1, 1))))
        puts: dict[int, Put] = dict(there)
        for index in order:
            size = sizes[index]
            usable = [i for i, a in enumerate(areas) if a.seen_from_m < size[2] <= a.height_m]
            put = None if is_tidy else _random_place(areas, usable, size, gap_m, taken, rng)
            if put is None:
                put = _tidy_place(areas, usable, size, gap_m, taken, corner)
            if put is None:
                break
            puts[index] = put
        else:
            return [puts[i] for i in range(len(sizes))]
    return None


def outline_of(put: Put, size: Vec3) -> Outline:
    """What a thing takes up of its area."""
    sin, cos = (float(value) for value in arithmetic.sin_cos_deg(put.area.yaw_deg))
    x, y = put.position[0] - put.area.centre[0], put.position[1] - put.area.centre[1]
    return (cos * x + sin * y, cos * y - sin * x, *turned_half(size, put.yaw_deg - put.area.yaw_deg))


def _random_place(
    areas: Sequence[Area],
    usable: Sequence[int],
    size: Vec3,
    gap_m: float,
    taken: dict[int, list[Outline]],
    rng: np.random.Generator,
) -> Put | None:
    if not usable:
        return None
    weights = np.array([4 * areas[i].half[0] * areas[i].half[1] for i in usable])
    # As `rng.choice` does it, which reckons the same sums anew for every draw.
    up_to = np.cumsum(weights / weights.sum())
    up_to /= up_to[-1]
    for _ in range(TRIES):
        which = usable[int(up_to.searchsorted(rng.random(), side="right"))]
        yaw = 90.0 * int(rng.integers(4)) + float(rng.uniform(-JITTER_DEG, JITTER_DEG))
        u, v = (float(value) for value in rng.uniform(-1, 1, 2))
        half = turned_half(size, yaw)
        room = (areas[which].half[0] - half[0], areas[which].half[1] - half[1])
        if min(room) < 0:
            continue
        put = free_put(areas[which], u * room[0], v * room[1], half, yaw, gap_m, taken[which])
        if put is not None:
            return put
    return None


def _tidy_place(
    areas: Sequence[Area],
    usable: Sequence[int],
    size: Vec3,
    gap_m: float,
    taken: dict[int, list[Outline]],
    corner: tuple[float, float],
) -> Put | None:
    """The first free place in rows that begin in one corner of an area."""
    for which in usable:
        area = areas[which]
        for yaw in (0.0, 90.0):
            half = turned_half(size, yaw)
            room = (area.half[0] - half[0], area.half[1] - half[1])
            if min(room) < 0:
                continue
            x, y = (corner[axis] * np.arange(-room[axis], room[axis] + 1e-9, ROW_M) for axis in (0, 1))
            is_free = np.ones((len(y), len(x)), dtype=np.bool_)
            for ox, oy, hx, hy in taken[which]:
                near_x, near_y = abs(x - ox) < half[0] + hx + gap_m, abs(y - oy) < half[1] + hy + gap_m
                is_free &= ~(near_y[:, None] & near_x)
            if is_free.any():
                row, column = divmod(int(is_free.argmax()), len(x))
                return free_put(area, float(x[column]), float(y[row]), half, yaw, gap_m, taken[which])
    return None


def free_put(
    area: Area,
    x: float,
    y: float,
    half: tuple[float, float],
    yaw: float,
    gap_m: float,
    taken: list[Outline],
) -> Put | None:
    """The thing at a place of the area, if it keeps its distance from all others there; then the place is taken."""
    for ox, oy, hx, hy in taken:
        if abs(x - ox) < half[0] + hx + gap_m and abs(y - oy) < half[1] + hy + gap_m:
            return None
    taken.append((x, y, *half))
    return put_at(area, x, y, yaw)


def put_at(area: Area, x: float, y: float, yaw: float) -> Put:
    """A thing at a place of the area and turned, both in the area's frame."""
    px, py, pz = area.to_room([(x, y, 0.0)])[0]
    return Put(area, (float(px), float(py), float(pz)), yaw + area.yaw_deg)


def turned_half(size: Vec3, yaw_deg: float) -> tuple[float, float]:
    """Half the sides of the outline of a thing that is turned."""
    sin, cos = (abs(float(share)) for share in arithmetic.sin_cos_deg(yaw_deg))
    return (size[0] * cos + size[1] * sin) / 2, (size[0] * sin + size[1] * cos) / 2
