"""The detector: objects as points (Zhou et al. 2019), each with a box (Tian et al. 2019) and a type, and a type for each cell.

A heatmap says where middles of objects are, whatever their type; at each peak a box and a type are read. Masks come from the
types of the cells within the box.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional

from remqa_data.agents.networks.detection.pyramid import CHANNELS, STRIDE, Pyramid, features_in
from remqa_data.geometry.types import F32, Flags

MOST_PEAKS = 80
"""Middles of objects that are looked at in a picture."""

TYPES_OF_A_PEAK = 2
"""A peak is reported as so many of its likeliest types."""

LEAST_SCORE = 0.02
LEAST_VOTES = 0.1
"""What is less likely an object at all gets no vote."""

SAME_OBJECT_IOU = 0.6
"""Of two boxes of a type that overlap so much, the likelier one counts."""

ENLARGED = 1.5
"""Small objects are looked for in pictures that are enlarged so many times."""

LARGE_PX, SMALL_PX = 34.0, 46.0
"""The shorter side of a box is at least so long if it is found in the picture itself, less than so long in the enlarged one."""

LEAST_MASK_SHARE = 0.1
"""Where fewer cells of a box than this have its type, the mask is the whole box."""


class Raw(NamedTuple):
    """What the detector says of (n, 3, h, w) pictures, whose features have h' = h / STRIDE, w' = w / STRIDE.

    Attributes
    ----------
    features : (n, CHANNELS, h', w')
        Of the backbone.
    middles : (n, h', w')
        Logits that the middle of an object is there.
    sides : (n, 4, h', w')
        Distances in pixels to the left, upper, right and lower side of the object whose middle is there.
    cells : (n, 1 + types, h', w')
        Logits of what the cell shows: 0 is none of the types.
    """

    features: Tensor
    middles: Tensor
    sides: Tensor
    cells: Tensor


class Peaks(NamedTuple):
    """Where objects may be in a picture, and how likely each is of each type.

    Attributes
    ----------
    boxes : (m, 4) float32
        x1, y1, x2, y2 in pixels.
    votes : (m, types) float32
        How likely it is of each type; together as likely as that it is an object at all.
    """

    boxes: F32
    votes: F32


class FeatureMaps(NamedTuple):
    """What a detector keeps of n pictures.

    Attributes
    ----------
    rgb : (n, 3, h, w) uint8
    features : (n, CHANNELS, h', w')
        Of its backbone; of the pictures enlarged, if it has two stages.
    closely : FeatureMaps, optional
        The same of the pictures from closer by, if it looks at them so, too.
    """

    rgb: Tensor
    features: Tensor
    closely: FeatureMaps | None = None

    def of(self, image: int) -> FeatureMaps:
        """What it keeps of one picture."""
        one = slice(image, image + 1)
        return FeatureMaps(self.rgb[one], self.features[one], self.closely and self.closely.of(image))


class Voted(NamedTuple):
    """Where objects may be in n pictures, for who looks at them again.

    Attributes
    ----------
    peaks : list of Peaks
        Of each picture.
    cells : (n, h', w') int64
        What each cell shows; see `Detections`.
    """

    peaks: list[Peaks]
    cells: np.ndarray


@dataclass(frozen=True, eq=False)
class Detections:
    """Objects that were found in one picture, the likeliest first.

    Attributes
    ----------
    boxes : (m, 4) float32
        x1, y1, x2, y2 in pixels.
    types : (m,) int64
        Indices into the detector's types.
    scores : (m,) float32
        0 to 1.
    cells : (h', w') int64
        What each cell of STRIDE x STRIDE pixels shows: index of its type + 1, or 0.
    """

    boxes: F32
    types: np.ndarray
    scores: F32
    cells: np.ndarray

    def mask(self, place: int, size: tuple[int, int]) -> Flags:
        """(h, w) pixels of the object at a place of the list, in a picture of a size; all of its box where few cells agree."""
        x1, y1, x2, y2 = np.rint(self.boxes[place]).astype(int)
        is_inside = np.zeros(size, dtype=bool)
        is_inside[max(y1, 0) : max(y2, 0), max(x1, 0) : max(x2, 0)] = True
        of_type = np.kron(self.cells == self.types[place] + 1, np.ones((STRIDE, STRIDE), dtype=bool))
        found = is_inside & of_type[: size[0], : size[1]]
        return found if found.sum() >= LEAST_MASK_SHARE * is_inside.sum() else is_inside


class Detector(nn.Module):
    """Finds objects.

    Parameters
    ----------
    types : int
        How many types of objects it knows.
    """

    candidates = 60
    """Detections of a picture among which one is chosen."""

    def __init__(self, types: int) -> None:
        super().__init__()
        self.types = types
        self.backbone = Pyramid()
        self.heads = nn.Conv2d(CHANNELS, 1 + 4 + 1 + types, 1)
        self.kinds = nn.Sequential(nn.Linear(CHANNELS, CHANNELS), nn.ReLU(), nn.Linear(CHANNELS, types))
        begin_with_few(self.heads)

    def forward(self, rgb: Tensor) -> Raw:
        """What it says of (n, 3, h, w) uint8 pictures."""
        features = self.backbone(rgb)
        said = self.heads(features)
        return Raw(features, said[:, 0], sides_of(said[:, 1:5]), said[:, 5:])

    def types_at(self, features: Tensor) -> Tensor:
        """(m, types) logits of the types of the objects whose middles have (m, CHANNELS) features."""
        return self.kinds(features)  # type: ignore[no-any-return]

    @torch.no_grad()
    def detect(self, rgb: Tensor) -> list[Detections]:
        """Objects in (n, 3, h, w) uint8 pictures, which are looked at twice: small things are looked for more closely."""
        return self.look(rgb)[1]

    @torch.no_grad()
    def look(self, rgb: Tensor) -> tuple[FeatureMaps, list[Detections]]:
        """What it keeps of (n, 3, h, w) uint8 pictures, and the objects that `detect` finds in them."""
        (raw, size), (closely, larger) = self._twice(rgb)
        found = zip(self.read(raw, size), self.read(closely, larger), strict=True)
        return FeatureMaps(rgb, raw.features), [_large_and_small(*both) for both in found]

    @torch.no_grad()
    def looks_in(self, seen: FeatureMaps, boxes: Tensor, size: int) -> Tensor:
        """(m, CHANNELS, size, size) features in each of (m, 4) boxes in the one picture that was seen."""
        return features_in(seen.features, boxes[None], size)[0]

    @torch.no_grad()
    def types_of(self, seen: FeatureMaps, boxes: Tensor) -> Tensor:
        """(m, types) how likely each of (m, 4) boxes in the one picture that was seen is of each type, by its middle."""
        return self.types_at(self.looks_in(seen, boxes, 1)[:, :, 0, 0]).softmax(1)

    @torch.no_grad()
    def vote(self, rgb: Tensor, least_votes: float = LEAST_VOTES) -> Voted:
        """Objects in (n, 3, h, w) uint8 pictures with all types that each may be, for who looks at them again.

        What is less likely than `least_votes` an object at all is left out.
        """
        (raw, size), (closely, larger) = self._twice(rgb)
        both = zip(self.peaks(raw, size), self.peaks(closely, larger), strict=True)
        peaks = [_peaks_of_both(whole, close, least_votes) for whole, close in both]
        return Voted(peaks, raw.cells.argmax(1).numpy(force=True))

    def _twice(self, rgb: Tensor) -> list[tuple[Raw, tuple[int, ...]]]:
        """What it says of pictures, and of the same enlarged, and how large these are."""
        closer = enlarged(rgb)
        return [(self(shown), tuple(shown.shape[-2:])) for shown in (rgb, closer)]

    @torch.no_grad()
    def peaks(self, raw: Raw, size: tuple[int, ...]) -> list[Peaks]:
        """Where objects may be by what was said of pictures of a (height, width); the likeliest first."""
        scores, rows, columns = likeliest_middles(raw.middles)
        found = []
        for image in range(len(scores)):
            row, column = rows[image], columns[image]
            types = self.types_at(raw.features[image, :, row, column].T).softmax(1)
            boxes = boxes_at(raw.sides[image, :, row, column].T, row, column, size)
            found.append(Peaks(boxes.numpy(force=True), (scores[image, :, None] * types).numpy(force=True)))
        return found

    @torch.no_grad()
    def read(self, raw: Raw, size: tuple[int, ...]) -> list[Detections]:
        """Objects in what was said of pictures of a (height, width)."""
        shown = raw.cells.argmax(1).numpy(force=True)
        found = []
        for peaks, cells in zip(self.peaks(raw, size), shown, strict=True):
            places, types, scores = likeliest_types(peaks.votes)
            found.append(_without_doubles(peaks.boxes[places], types, scores, cells))
        return found


def enlarged(rgb: Tensor, times: float = ENLARGED) -> Tensor:
    """(n, 3, h, w) uint8 pictures, so many times as wide and high."""
    larger = [round(side * times) for side in rgb.shape[-2:]]
    return functional.interpolate(rgb.to(torch.float32), size=larger, mode="bilinear").round().to(torch.uint8)


def begin_with_few(heads: nn.Conv2d) -> None:
    """Set the biases of heads whose first channel is middles, and whose next four are sides, before they learn."""
    assert heads.bias is not None
    with torch.no_grad():
        heads.bias[0] = -4.0  # few cells are middles: else the first steps are wasted on it
        heads.bias[1:5] = 3.0  # objects are some 40 pixels wide


def sides_of(said: Tensor) -> Tensor:
    """(n, 4, h', w') distances in pixels, of as many logarithms."""
    return said.clamp(max=6.0).exp()


def likeliest_middles(middles: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Of (n, h', w') logits the MOST_PEAKS highest that no neighbour exceeds: (n, m) how likely, rows and columns."""
    heat = middles.sigmoid()
    heat = torch.where(functional.max_pool2d(heat, 3, 1, 1) == heat, heat, 0.0)
    scores, places = heat.flatten(1).topk(min(MOST_PEAKS, heat[0].numel()))
    return scores, places // heat.shape[-1], places % heat.shape[-1]


def boxes_at(sides: Tensor, rows: Tensor, columns: Tensor, size: tuple[int, ...]) -> Tensor:
    """(m, 4) boxes in pixels, within a (height, width), of (m, 4) distances from the cells at (m,) rows and columns."""
    x, y = (columns + 0.5) * STRIDE, (rows + 0.5) * STRIDE
    height, width = size
    left, up, right, down = sides.unbind(1)
    corners = [(x - left).clamp(0, width), (y - up).clamp(0, height), (x + right).clamp(0, width)]
    return torch.stack([*corners, (y + down).clamp(0, height)], dim=1)


def _large_and_small(whole: Detections, closely: Detections) -> Detections:
    """The large objects that were found in a picture, and the small ones that were found in the enlarged one."""
    small_boxes = closely.boxes / ENLARGED
    large, small = _shorter_sides(whole.boxes) >= LARGE_PX, _shorter_sides(small_boxes) < SMALL_PX
    return _without_doubles(
        np.concatenate([whole.boxes[large], small_boxes[small]]),
        np.concatenate([whole.types[large], closely.types[small]]),
        np.concatenate([whole.scores[large], closely.scores[small]]),
        whole.cells,
    )


def _peaks_of_both(whole: Peaks, closely: Peaks, least_votes: float) -> Peaks:
    """As `_large_and_small`; of two boxes that overlap the likelier one counts, whatever its type."""
    small_boxes = closely.boxes / ENLARGED
    large, small = _shorter_sides(whole.boxes) >= LARGE_PX, _shorter_sides(small_boxes) < SMALL_PX
    boxes = np.concatenate([whole.boxes[large], small_boxes[small]])
    votes = np.concatenate([whole.votes[large], closely.votes[small]])
    kept = apart(boxes, votes.sum(axis=1), least_votes)
    return Peaks(boxes[kept], votes[kept])


def apart(boxes: F32, scores: F32, least: float, same_iou: float = SAME_OBJECT_IOU) -> list[int]:
    """Which of (m, 4) boxes with (m,) scores are of different objects, whatever their types, the likeliest first.

    What is less likely than `least` is left out, and of two boxes that overlap more than `same_iou` the less likely one.
    """
    return _first_of_each(iou(boxes, boxes) > same_iou, scores, least)


def _shorter_sides(boxes: F32) -> F32:
    return np.asarray((boxes[:, 2:] - boxes[:, :2]).min(axis=1, initial=np.inf), dtype=np.float32)


def _without_doubles(boxes: F32, types: np.ndarray, scores: F32, cells: np.ndarray) -> Detections:
    """The likelier one of every two boxes of a type that are of the same object."""
    kept = kept_objects(boxes, types, scores)
    return Detections(boxes[kept], types[kept], scores[kept], cells)


def likeliest_types(votes: F32) -> tuple[np.ndarray, np.ndarray, F32]:
    """Of (m, types) votes the likeliest TYPES_OF_A_PEAK of each row: rows, types and scores."""
    count = min(TYPES_OF_A_PEAK, votes.shape[1])
    types = np.argsort(-votes, axis=1, kind="stable")[:, :count]
    rows = np.arange(len(votes)).repeat(count)
    return rows, types.ravel(), np.take_along_axis(votes, types, axis=1).ravel()


def kept_objects(boxes: F32, types: np.ndarray, scores: F32, same_iou: float = SAME_OBJECT_IOU) -> list[int]:
    """Which of (m, 4) boxes with types and scores are reported, the likeliest first.

    Of two boxes of a type that overlap more than `same_iou` it is the likelier one.
    """
    is_same = (iou(boxes, boxes) > same_iou) & (types[:, None] == types)
    return _first_of_each(is_same, scores, LEAST_SCORE)


def _first_of_each(is_same: Flags, scores: F32, least: float) -> list[int]:
    """Of (m,) scores the places, the highest first, that are not, by (m, m), the same as one before them."""
    order = np.argsort(-scores, kind="stable")
    kept: list[int] = []
    for place in order[scores[order] >= least].tolist():
        if not is_same[place, kept].any():
            kept.append(place)
    return kept


def iou(first: F32, second: F32) -> F32:
    """(m, n) shares of (m, 4) and (n, 4) boxes in a picture: what two have in common, of what either has."""
    low = np.maximum(first[:, None, :2], second[None, :, :2])
    high = np.minimum(first[:, None, 2:], second[None, :, 2:])
    common = np.prod(np.clip(high - low, 0, None), axis=-1)
    areas = [np.prod(boxes[:, 2:] - boxes[:, :2], axis=-1) for boxes in (first, second)]
    return np.asarray(common / np.maximum(areas[0][:, None] + areas[1][None] - common, 1e-9), dtype=np.float32)
