"""What is known of the objects in a picture that an expression may mean: how they look, and where they are."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from remqa_data.agents.networks.detection.detector import Detections, Detector, FeatureMaps, apart
from remqa_data.agents.networks.detection.pyramid import features_in
from remqa_data.agents.networks.detection.refiner import TwoStageDetector
from remqa_data.geometry.types import F32

GRID = 3
"""Features are taken at so many points across and down a box."""

SHADES, SHADE_POINTS = 3, 4
"""Numbers of a colour; it is the mean of so many points across and down around each of these points."""

PLACE = 8
"""Numbers of a place, see `places_of`."""

ALIKE, AROUND = 5, 10
"""How many objects of its type, and how many of any, an object is compared with: the nearest ones."""

SAME_TYPE = 0.5
"""Cosine of the probabilities of two objects that are of one type."""

SAME_BOX_IOU = 0.9

UNSEEN_M = 4.0
"""Where depth has nothing."""

AnyDetector = Detector | TwoStageDetector


@dataclass(frozen=True, eq=False)
class Regions:
    """Objects in one picture.

    Attributes
    ----------
    boxes : (m, 4) float32
        x1, y1, x2, y2 in pixels.
    looks : (m, channels, GRID, GRID)
        Features in the boxes.
    colors : (m, SHADES, GRID, GRID)
        Red, green and blue in the boxes, from -2 to 2.
    types : (m, types)
        Probabilities by the detector.
    places : (m, PLACE) float32
        See `places_of`.
    from_alike : (m, ALIKE, PLACE)
        Where each is as seen from the nearest ones of its type, see `compared`; 0 where there are fewer.
    around : (m, AROUND) int64
        The nearest ones.
    from_around : (m, AROUND, PLACE)
        Where those are as seen from it.
    is_around : (m, AROUND) bool
        False where there are fewer.
    level : (m, PLACE) float32
        The places, with metres as of a camera that looks straight ahead.
    scores : (m,) float32
        How likely there is an object; 1 for those that are known to be there.
    size : tuple of int
        Height and width of the picture.
    are_known : bool
        Whether they are the objects that are there, and not what was found.
    """

    boxes: F32
    looks: Tensor
    colors: Tensor
    types: Tensor
    places: Tensor
    from_alike: Tensor
    around: Tensor
    from_around: Tensor
    is_around: Tensor
    level: Tensor
    scores: Tensor
    size: tuple[int, int]
    are_known: bool


def candidates(found: Detections, most: int) -> list[int]:
    """Which detections to choose from: each box once, the likeliest first."""
    return apart(found.boxes, found.scores, 0.0, SAME_BOX_IOU)[:most]


@torch.no_grad()
def regions_of(
    detector: AnyDetector,
    seen: FeatureMaps,
    boxes: F32,
    depth: F32,
    horizon_deg: float,
    scores: F32 | None = None,
) -> Regions:
    """What is known of objects in a picture.

    Parameters
    ----------
    detector, seen
        What has seen the picture, and what it keeps of it.
    boxes : (m, 4) float32
        x1, y1, x2, y2 in pixels.
    depth : (h, w) float32
        Metres, 0 where nothing is.
    horizon_deg : float
        How far down the camera looks.
    scores : (m,) float32, optional
        How likely an object is there; by default it is known to be.
    """
    device = seen.rgb.device
    at = torch.from_numpy(np.asarray(boxes, dtype=np.float32)).to(device)
    looks = detector.looks_in(seen, at, GRID)
    types = detector.types_of(seen, at)
    places = places_of(boxes, depth).to(device)
    others = ~torch.eye(len(boxes), dtype=torch.bool, device=device)
    offsets = compared(places)
    alike, is_alike = nearest(places, others & (likeness(types) > SAME_TYPE), ALIKE)
    around, is_around = nearest(places, others, AROUND)
    return Regions(
        boxes,
        looks,
        colors_of(seen.rgb, at),
        types,
        places,
        _offsets(offsets, alike) * is_alike[..., None],
        around,
        _offsets(offsets, around),
        is_around,
        levelled(places, horizon_deg),
        torch.ones_like(places[:, 0]) if scores is None else torch.from_numpy(scores).to(places),
        (depth.shape[0], depth.shape[1]),
        scores is None,
    )


def colors_of(rgb: Tensor, boxes: Tensor) -> Tensor:
    """(m, SHADES, GRID, GRID) red, green and blue, from -2 to 2, in each of (m, 4) boxes in a (1, 3, h, w) uint8 picture."""
    points = features_in(rgb.float() / 255, boxes[None], GRID * SHADE_POINTS, 1)[0]
    return 4 * functional.avg_pool2d(points, SHADE_POINTS) - 2


def levelled(places: Tensor, horizon_deg: float) -> Tensor:
    """(m, PLACE) places of a camera that looks straight ahead, of (m, PLACE) of one that looks down so far; in metres alone."""
    *shares, down, ahead = places.unbind(1)
    sine, cosine = math.sin(math.radians(horizon_deg)), math.cos(math.radians(horizon_deg))
    return torch.stack([*shares, down * cosine + ahead * sine, ahead * cosine - down * sine], 1)


def likeness(types: Tensor) -> Tensor:
    """(m, m) cosines of (m, types) probabilities."""
    direction = types / types.norm(dim=1, keepdim=True).clamp(min=1e-6)
    return direction @ direction.T


def _offsets(offsets: Tensor, chosen: Tensor) -> Tensor:
    """(m, k, PLACE) offsets to (m, k) chosen ones, of (m, m, PLACE) to all."""
    return offsets.gather(1, chosen[..., None].expand(-1, -1, PLACE))


def places_of(boxes: F32, depth: F32) -> Tensor:
    """(m, PLACE) left, upper, right and lower side and area as shares of the picture; right, down and ahead in metres.

    Metres are those of the middle of the box, by the median depth within it, as the camera sees (90 degrees).
    """
    height, width = depth.shape
    places = np.zeros((len(boxes), PLACE), dtype=np.float32)
    for place, (x1, y1, x2, y2) in zip(places, boxes, strict=True):
        left, up = min(int(x1), width - 1), min(int(y1), height - 1)
        within = depth[up : max(int(np.ceil(y2)), up + 1), left : max(int(np.ceil(x2)), left + 1)]
        seen = within[within > 0]
        ahead = float(np.median(seen)) if len(seen) else UNSEEN_M
        right = ((x1 + x2) / width - 1) * ahead
        down = ((y1 + y2) / height - 1) * ahead
        share = (x2 - x1) * (y2 - y1) / (width * height)
        place[:] = x1 / width, y1 / height, x2 / width, y2 / height, share, right, down, ahead
    return torch.from_numpy(places)


def compared(places: Tensor) -> Tensor:
    """(m, m, PLACE) how each object, second, lies as seen from each, first: offsets in its own sizes and in metres."""
    x1, y1, x2, y2, area, *metres = places.unbind(-1)
    wide, high = (x2 - x1).clamp(min=1e-3)[:, None], (y2 - y1).clamp(min=1e-3)[:, None]
    middles_x, middles_y = ((x1 + x2) / 2)[:, None], ((y1 + y2) / 2)[:, None]
    across, down = (
        ((side[None] - middles_x) / wide for side in (x1, x2)),
        ((side[None] - middles_y) / high for side in (y1, y2)),
    )
    sides = [*across, *down]
    ratio = (area[None].clamp(min=1e-6) / area[:, None].clamp(min=1e-6)).log()
    offsets = [at[None] - at[:, None] for at in metres]
    return torch.stack([*(side.clamp(-10, 10) / 5 for side in sides), ratio / 5, *offsets], dim=-1)


def nearest(places: Tensor, allowed: Tensor, count: int) -> tuple[Tensor, Tensor]:
    """For each of m objects the nearest in metres of those that (m, m) are allowed: (m, count), and if there are so many."""
    metres = places[:, 5:]
    distances = torch.cdist(metres, metres).masked_fill(~allowed, torch.inf)
    least, found = distances.topk(min(count, len(places)), dim=1, largest=False)
    missing = count - found.shape[1]
    found = functional.pad(found, (0, missing))
    return found, functional.pad(least.isfinite(), (0, missing))
