"""How the objects of a picture lie among those of their own kind, and to each other.

Words such as "the top left drawer" and "the one closest to the fridge" do not say where a thing is, but how many like it are
farther in some direction. That is counted here, so that a network need not learn to count.
"""

from __future__ import annotations

from typing import NamedTuple

import torch
from torch import Tensor

from remqa_data.agents.networks.detection.detector import iou
from remqa_data.agents.networks.detection.regions import PLACE, Regions, compared, likeness

MOST = 3
"""So many others, and not more, are told from one fewer."""

COUNTS = 9
"""What is counted of an object, see `Arrangement.ranks`."""

RANKS, PAIR = COUNTS * (MOST + 1), PLACE + 2 + MOST + 1

UNLIKE_COSINE, ALIKE_COSINE = 0.3, 0.7
"""Cosines of the probabilities of types up to which two objects are not of one kind, and from which they are."""

SURE = 0.3
"""What is less likely an object counts less among those of its kind."""

OVERLAP_IOU = 0.5
"""Boxes that overlap more are taken for the same object."""

ASIDE = 0.25
"""Share of the narrower one's width by which the middles of two are apart that are beside each other."""

OVER_M, LEVEL_M, COLUMN_M = 0.08, 0.12, 0.25
"""What is higher by so much is above, what differs by less in height in one row, what is so near in the plan in a column."""

NEARER_M = 0.1
"""What is nearer by less is as near."""

FARTHEST_M = 4.0
"""What is farther is as far."""


class Arrangement(NamedTuple):
    """How m objects lie.

    Attributes
    ----------
    ranks : (m, RANKS)
        How near it is to 0, 1, ... MOST, the number of others of its kind to the left, to the right, above and below; to the
        left and right in its row, above and below in its column; and everywhere.
    pairs : (m, m, PAIR)
        How each object, second, lies as seen from each, first: see `compared`; distance in the plan and its logarithm; and how
        near to 0, 1, ... MOST the number is of others of the first one's kind that are nearer to the second.
    is_other : (m, m) bool
        Whether they are two objects.
    """

    ranks: Tensor
    pairs: Tensor
    is_other: Tensor


def arrangement_of(regions: Regions) -> Arrangement:
    """How the objects of a picture lie."""
    x1, _, x2, _, _, right, down, ahead = regions.level.unbind(1)
    is_same = torch.from_numpy(iou(regions.boxes, regions.boxes) > OVERLAP_IOU).to(x1.device)
    is_same.fill_diagonal_(True)
    alike = _alike(regions).masked_fill(is_same, 0.0)

    def less_and_more(apart: Tensor, least: Tensor | float) -> list[Tensor]:
        return [(apart < -least).to(alike.dtype), (apart > least).to(alike.dtype)]

    widths, middles = x2 - x1, (x1 + x2) / 2
    lower = _from_each(down)
    aside = less_and_more(_from_each(middles), ASIDE * torch.minimum(widths[None], widths[:, None]))
    over = less_and_more(lower, OVER_M)
    plan = torch.stack([right, ahead], 1)
    metres = torch.cdist(plan, plan)
    row, column = (lower.abs() < LEVEL_M).to(alike.dtype), (metres < COLUMN_M).to(alike.dtype)
    counted = [*aside, *over, *(side * row for side in aside), *(side * column for side in over), torch.ones_like(row)]
    ranks = _near_most(torch.stack([(alike * each).sum(1) for each in counted], 1)).flatten(1)
    is_nearer = (metres[None] + NEARER_M < metres[:, None]).to(alike.dtype)  # the second than the first, to the third
    nearer = torch.einsum("ik,ikj->ij", alike, is_nearer)
    distances = torch.stack([metres.clamp(max=FARTHEST_M) / 2, (metres + 0.05).log()], 2)
    return Arrangement(ranks, torch.cat([compared(regions.level), distances, _near_most(nearer)], 2), ~is_same)


def _alike(regions: Regions) -> Tensor:
    """(m, m) how far each object, second, counts as one of the kind of each, first; 0 to 1."""
    alike = ((likeness(regions.types) - UNLIKE_COSINE) / (ALIKE_COSINE - UNLIKE_COSINE)).clamp(0, 1)
    return alike * (regions.scores / SURE).clamp(max=1)[None]


def _from_each(places: Tensor) -> Tensor:
    """(m, m) by how much each of (m,) places, second, is more than each, first."""
    return places[None] - places[:, None]


def _near_most(counts: Tensor) -> Tensor:
    return near_numbers(counts.clamp(max=MOST), MOST)


def near_numbers(counts: Tensor, most: int) -> Tensor:
    """(..., most + 1) how near (...) counts are to 0, 1, ... most: 1 where they are it, 0 where they differ by one or more."""
    numbers = torch.arange(most + 1, device=counts.device)
    return (1 - (counts[..., None] - numbers).abs()).clamp(min=0)
