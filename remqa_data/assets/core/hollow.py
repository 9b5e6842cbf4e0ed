"""The hollow below what can be lifted or pushed aside: what lies in it is covered, and nothing holds the cover up.

How deep it is, `templates/objects.yaml` says by type. Physics sees it; drawings stay closed below, where nobody looks.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from remqa_data.assets.core.fitting import box_of, vec
from remqa_data.assets.core.model import Asset, CollisionBox
from remqa_data.assets.mesh.cutting import solid_around
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import rotation_of
from remqa_data.geometry.types import F64, Box

RIM_M = 0.015
"""An asset stands on a rim that is at least so wide."""
GROUND_M = 0.003
"""What reaches down so near to the lowest point stands on the ground."""
NARROWER, LEAST_SIDE_M = 0.95, 0.06
"""Where walls stand askew the hollow is made narrower by this factor, but not narrower than this."""
MOST_SHARE = 0.35
"""Of an asset's height a hollow is no more than this share deep."""


def with_hollow(asset: Asset, depth_m: float | None) -> Asset:
    """The asset with a hollow below its base; as it is, if it is to have none or its base is too narrow."""
    base = asset.links[0]
    if depth_m is None or not base.boxes:
        return asset
    depth_m = min(depth_m, MOST_SHARE * asset.spec.size[2])
    ends = [_ends(box) for box in base.boxes]
    ground = min(float(low[2]) for low, _ in ends)
    standing = [(low, high) for low, high in ends if low[2] < ground + GROUND_M]
    low = np.min([low for low, _ in standing], axis=0)[:2] + RIM_M
    high = np.max([high for _, high in standing], axis=0)[:2] - RIM_M
    middle, half = (low + high) / 2, (high - low) / 2
    askew = [box for box in base.boxes if not _is_straight(box)]
    while half.min() * 2 >= LEAST_SIDE_M:
        hollow = box_of((*(middle - half), ground, *(middle + half), ground + depth_m))
        if not any(_meet(box, hollow) for box in askew):
            boxes = tuple(piece for box in base.boxes for piece in _around(box, hollow))
            return replace(asset, links=(replace(base, boxes=boxes), *asset.links[1:]), hollow=hollow)
        half = half * NARROWER
    return asset


def _is_straight(box: CollisionBox) -> bool:
    return abs(box.quaternion[3]) > 1.0 - 1e-9


def _ends(box: CollisionBox) -> tuple[F64, F64]:
    """Least and greatest corner of an oriented box."""
    reach = arithmetic.turned(box.size, np.abs(rotation_of(box.quaternion))) / 2
    return np.asarray(box.centre) - reach, np.asarray(box.centre) + reach


def _meet(box: CollisionBox, hollow: Box) -> bool:
    """Whether an oriented box reaches into the hollow: no axis of either tells them apart."""
    low, high = np.asarray(hollow[:3]), np.asarray(hollow[3:])
    turn, half = rotation_of(box.quaternion), np.asarray(box.size) / 2
    between, room = np.asarray(box.centre) - (low + high) / 2, (high - low) / 2
    for axis in (*np.eye(3), *turn.T):
        reach = arithmetic.dot(np.abs(arithmetic.turned_back(axis, turn)), half) + arithmetic.dot(np.abs(axis), room)
        if abs(arithmetic.dot(between, axis)) >= reach:
            return False
    return True


def _around(box: CollisionBox, hollow: Box) -> Sequence[CollisionBox]:
    """What is left of a box."""
    if not _is_straight(box) or not _meet(box, hollow):
        return [box]
    low, high = _ends(box)
    pieces = []
    for part in solid_around(box_of((*low, *high)), [hollow]):
        start, end = np.asarray(part[:3]), np.asarray(part[3:])
        pieces.append(CollisionBox(vec((start + end) / 2), vec(end - start)))
    return pieces
