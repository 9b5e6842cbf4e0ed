"""A second stage for the detector (Ren et al. 2015; He et al. 2017): each box is looked at again, by itself and from close by.

The first stage says where objects may be. The second one has a backbone of its own, which begins with what the first one's
knows, and proposes boxes, too. Of each box, and of a margin around it, it sees its features and the pixels, and says what it
is, where its sides truly are, and which parts of it are the object. It looks at a picture twice, as it is and from closer
by, where small things are seen better; what counts is the mean of what both looks say of a box.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, cast

import numpy as np
import torch
from torch import Tensor, nn

from remqa_data.agents.networks.detection.detector import (
    ENLARGED,
    Detections,
    Detector,
    FeatureMaps,
    Peaks,
    enlarged,
    kept_objects,
    likeliest_types,
)
from remqa_data.agents.networks.detection.proposer import SAME_PLACE_IOU, Proposer
from remqa_data.agents.networks.detection.pyramid import (
    CHANNELS,
    STRIDE,
    Pyramid,
    Residual,
    conv_block,
    features_in,
    normalised,
    zero_linear,
)
from remqa_data.geometry.types import F32, Flags
from remqa_data.opencv import cv2

MARGIN = 1.6
"""What is looked at is so many times as wide and high as the box."""

GRID = 12
"""Features are taken at so many points across and down, and pixels at four times as many."""

PIXELS = 4 * GRID

LEAST_SIDE_PX = 8.0
"""Boxes count as at least so wide and high when they are moved."""

PIXEL_WIDTHS = (24, 48)
"""Channels of the pixels at half and a quarter of PIXELS."""

WIDTHS = (96, 128, 160)
"""Channels at GRID, half of it and a quarter of it."""

KNOWN = 256
"""Numbers of what is known of a box in the end."""

LEAST_VOTES = 0.02
"""What the first stage thinks less likely an object at all is not looked at again."""

CLOSER = 1.75
"""A picture is looked at as it is, and so many times as wide and high."""

AT_ONCE = 40
"""Boxes that are looked at together."""


class Refined(NamedTuple):
    """What is said of m boxes.

    Attributes
    ----------
    boxes : (m, 4)
        x1, y1, x2, y2 in pixels.
    kinds : (m, 1 + types)
        Logits of what each is: 0 is nothing, or something else.
    shapes : (m, GRID, GRID)
        Logits that a point of the box with its margin is the object.
    """

    boxes: Tensor
    kinds: Tensor
    shapes: Tensor


class Judged(NamedTuple):
    """What both looks say of m boxes.

    Attributes
    ----------
    boxes : (m, 4)
        x1, y1, x2, y2 in pixels.
    kinds : (m, 1 + types)
        How likely each is what: 0 is nothing, or something else.
    looked_at : (2, m, 4)
        Boxes with their margins, as they were looked at; thin ones got more of it in the first look.
    shapes : (2, m, GRID, GRID)
        How likely a point of those is the object.
    """

    boxes: Tensor
    kinds: Tensor
    looked_at: Tensor
    shapes: Tensor


@dataclass(frozen=True, eq=False)
class RefinedDetections(Detections):
    """Objects that were found in one picture, and which parts of their boxes they are.

    Attributes
    ----------
    looked_at : (2, m, 4) float32
        Boxes with their margins, in which the shapes lie, in either look.
    shapes : (2, m, GRID, GRID) float32
        How likely each point is the object.
    """

    looked_at: F32
    shapes: F32

    def mask(self, place: int, size: tuple[int, int]) -> Flags:
        """(h, w) pixels of the object at a place of the list, in a picture of a size; all of its box if they are none."""
        looks = zip(self.looked_at[:, place], self.shapes[:, place], strict=True)
        shown = np.mean([drawn(shape, box, size) for box, shape in looks], axis=0)
        x1, y1, x2, y2 = np.rint(self.boxes[place]).astype(int)
        is_inside = np.zeros(size, dtype=bool)
        is_inside[max(y1, 0) : max(y2, y1 + 1), max(x1, 0) : max(x2, x1 + 1)] = True
        found = is_inside & (shown > 0.5)
        return found if found.any() else is_inside


def drawn(shape: F32, box: F32, size: tuple[int, int]) -> F32:
    """(h, w) how likely the pixels of a picture of a size are an object, of (GRID, GRID) shares of a box."""
    height, width = size
    x1, y1, x2, y2 = box
    columns = ((np.arange(width, dtype=np.float32) + 0.5 - x1) / (x2 - x1) * GRID - 0.5)[None].repeat(height, 0)
    rows = ((np.arange(height, dtype=np.float32) + 0.5 - y1) / (y2 - y1) * GRID - 0.5)[:, None].repeat(width, 1)
    return np.asarray(cv2.remap(shape, columns, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE))


class Refiner(nn.Module):
    """Looks at boxes again.

    Parameters
    ----------
    types : int
        How many types of objects it knows.
    """

    def __init__(self, types: int) -> None:
        super().__init__()
        self.types = types
        fine, coarse = PIXEL_WIDTHS
        whole, half, quarter = WIDTHS
        self.backbone = Pyramid()
        self.proposer = Proposer()
        self.pixels = nn.Sequential(conv_block(3, fine, stride=2), conv_block(fine, coarse, stride=2))
        self.near = nn.Sequential(
            nn.Conv2d(CHANNELS + coarse, whole, 1, bias=False), nn.BatchNorm2d(whole), nn.ReLU(), Residual(whole)
        )
        self.all = nn.Sequential(
            conv_block(whole, half, stride=2),
            Residual(half),
            conv_block(half, quarter, stride=2),
            nn.Flatten(),
            nn.Linear(quarter * (GRID // 4) ** 2, KNOWN),
            nn.ReLU(),
        )
        self.shape = nn.Conv2d(whole, 1, 3, padding=1)
        self.kind = nn.Linear(KNOWN, 1 + types)
        self.sides = zero_linear(KNOWN, 4)

    def see(self, rgb: Tensor) -> Tensor:
        """(n, CHANNELS, h', w') features of (n, 3, h, w) uint8 pictures, enlarged."""
        return cast("Tensor", self.backbone(enlarged(rgb)))

    def forward(self, rgb: Tensor, features: Tensor, boxes: Tensor) -> Refined:
        """Look at k boxes in each of n pictures.

        Parameters
        ----------
        rgb : (n, 3, h, w) uint8
            Pictures.
        features : (n, CHANNELS, h', w')
            What `see` gives for them.
        boxes : (n, k, 4)
            x1, y1, x2, y2 in pixels of the pictures.

        Returns
        -------
        What it says of the n * k boxes, picture by picture.
        """
        rough = boxes.flatten(0, 1)
        seen = with_margin(rough).view_as(boxes)
        pixels = features_in(normalised(rgb), seen, PIXELS, cell_px=1).flatten(0, 1)
        looks = features_in(features, seen, GRID, STRIDE / ENLARGED).flatten(0, 1)
        near = self.near(torch.cat([looks, self.pixels(pixels.contiguous(memory_format=torch.channels_last))], 1))
        known = self.all(near)
        return Refined(moved(rough, self.sides(known)), self.kind(known), self.shape(near)[:, 0])


class TwoStageDetector:
    """A detector with a second stage, for who asks where objects are; see `Detector` for what its methods give.

    Attributes
    ----------
    first, second
        Trained networks.
    """

    candidates = 100
    """Detections of a picture among which one is chosen; not all that are right have the highest scores."""

    def __init__(self, first: Detector, second: Refiner) -> None:
        self.first, self.second = first.eval(), second.eval()

    @property
    def types(self) -> int:
        """How many types of objects it knows."""
        return self.first.types

    def to(self, device: str) -> TwoStageDetector:
        """The same, computing elsewhere."""
        return TwoStageDetector(self.first.to(device), self.second.to(device))

    def eval(self) -> TwoStageDetector:
        """The same: it never learns."""
        return self

    @torch.no_grad()
    def detect(self, rgb: Tensor) -> list[Detections]:
        """Objects in (n, 3, h, w) uint8 pictures."""
        return self.look(rgb)[1]

    @torch.no_grad()
    def look(self, rgb: Tensor) -> tuple[FeatureMaps, list[Detections]]:
        """What the second stage keeps of pictures, and the objects that both find in them."""
        voted = self.first.vote(rgb, LEAST_VOTES)
        seen = self._seen(rgb)._replace(closely=self._seen(enlarged(rgb, CLOSER)))
        each = (seen.of(image) for image in range(len(rgb)))
        return seen, [self._found(*one) for one in zip(each, voted.peaks, voted.cells, strict=True)]

    @torch.no_grad()
    def looks_in(self, seen: FeatureMaps, boxes: Tensor, size: int) -> Tensor:
        """(m, CHANNELS, size, size) the second stage's features in each of (m, 4) boxes in the one picture that was seen."""
        return features_in(seen.features, boxes[None], size, STRIDE / ENLARGED)[0]

    @torch.no_grad()
    def types_of(self, seen: FeatureMaps, boxes: Tensor) -> Tensor:
        """(m, types) how likely each of (m, 4) boxes in the one picture that was seen is of each type, by the second stage."""
        return self._judged(seen, boxes).kinds[:, 1:]

    def _seen(self, rgb: Tensor) -> FeatureMaps:
        return FeatureMaps(rgb, self.second.see(rgb))

    def _found(self, seen: FeatureMaps, peaks: Peaks, cells: np.ndarray) -> Detections:
        """The objects at the peaks of one picture, and where else they are proposed, as the second stage sees them."""
        features = [(look.features, times) for look, times in looks_of(seen)]
        boxes = torch.from_numpy(self.second.proposer.propose(features, peaks, LEAST_VOTES)).to(seen.rgb.device)
        found = self._judged(seen, boxes)
        height, width = seen.rgb.shape[-2:]
        limits = np.array([width, height, width, height], dtype=np.float32)
        better = np.clip(found.boxes.numpy(force=True), 0, limits)
        places, types, scores = likeliest_types(found.kinds[:, 1:].numpy(force=True))
        kept = kept_objects(better[places], types, scores, SAME_PLACE_IOU)
        of = places[kept]
        looked_at, shapes = (part[:, of].numpy(force=True) for part in (found.looked_at, found.shapes))
        return RefinedDetections(better[of], types[kept], scores[kept], cells, looked_at, shapes)

    def _judged(self, seen: FeatureMaps, boxes: Tensor) -> Judged:
        """What is said of (m, 4) boxes in the one picture that was seen: the mean of both looks."""
        said = []
        for look, times in looks_of(seen):
            asked = boxes * times
            refined = self._refined(look, asked)
            own = refined.boxes / times, refined.kinds.softmax(1), with_margin(asked) / times, refined.shapes.sigmoid()
            said.append(Judged(*own))
        both = Judged(*(torch.stack(parts) for parts in zip(*said, strict=True)))
        return both._replace(boxes=both.boxes.mean(0), kinds=both.kinds.mean(0))

    def _refined(self, seen: FeatureMaps, boxes: Tensor) -> Refined:
        said = [
            self.second(seen.rgb, seen.features, some[None])
            for some in torch.split(boxes, AT_ONCE)  # type: ignore[no-untyped-call]
        ]
        return Refined(*(torch.cat(parts) for parts in zip(*said, strict=True)))


def looks_of(seen: FeatureMaps) -> list[tuple[FeatureMaps, float]]:
    """What was kept of each look at pictures, and how many times as wide and high as they these were shown."""
    assert seen.closely is not None
    return [(seen, 1.0), (seen.closely, CLOSER)]


def with_margin(boxes: Tensor) -> Tensor:
    """(m, 4) boxes, MARGIN times as wide and high."""
    middles = (boxes[:, :2] + boxes[:, 2:]) / 2
    halves = sizes_of(boxes) * MARGIN / 2
    return torch.cat([middles - halves, middles + halves], 1)


def moved(boxes: Tensor, shares: Tensor) -> Tensor:
    """(m, 4) boxes whose sides were moved by (m, 4) shares of their width and height."""
    return boxes + shares.clamp(-0.6, 0.6) * sizes_of(boxes).repeat(1, 2)


def sizes_of(boxes: Tensor) -> Tensor:
    """(m, 2) width and height of boxes, at least LEAST_SIDE_PX."""
    return (boxes[:, 2:] - boxes[:, :2]).clamp(min=LEAST_SIDE_PX)
