"""Pictures to learn from, each with what is in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import pyarrow.compute as pc
from scipy import ndimage

from remqa_data.catalog import catalog
from remqa_data.datasets.random_access import SplitReader
from remqa_data.geometry.types import F32, U8
from remqa_data.opencv import cv2
from remqa_data.tables.images import decode_instances, decode_rgb

Which = Literal["rgb", "start_rgb", "end_rgb"]
UNKNOWN = -1

LEAST_CUT, MOST_CUT = 110 / 192, 330 / 192
"""Squares that are cut out of pictures for training, in sides of what is made of them.

Not in sides of the picture: what is looked at later is not enlarged to one size either, so that pixels stay about as large.
"""

LIGHTER, COLOURED = 0.2, 0.06
"""How much brightness, and each colour by itself, is changed at most."""


def detector_types() -> tuple[str, ...]:
    """All types that are looked for: the catalogue's, but for the floor."""
    return tuple(name for name in catalog() if name != "Floor")


@dataclass(frozen=True, eq=False)
class Picture:
    """A picture and what it shows.

    Attributes
    ----------
    rgb : (h, w, 3) uint8
    instances : (h, w) int32
        0, or the number of an object, from 1.
    types : (objects,) int64
        Index into the types that are asked for; -1 for others.
    """

    rgb: U8
    instances: np.ndarray
    types: np.ndarray


class Pictures:
    """Pictures of a table of one split, in some rooms.

    Parameters
    ----------
    root, split : path, str
        Of the dataset.
    which : {"rgb", "start_rgb", "end_rgb"}
        Frames of walks, or views before or after the manipulation of questions.
    rooms : collection of str, optional
        Only these rooms.
    types : sequence of str
        What is asked for.
    """

    def __init__(
        self, root: Path, split: str, which: Which, types: Sequence[str], rooms: frozenset[str] | None = None
    ) -> None:
        table = "frames" if which == "rgb" else "questions"
        self._reader = SplitReader(root, table, split)
        self._names = (which, which.replace("rgb", "instances"))
        numbers = {name: number for number, name in enumerate(types)}
        columns = self._reader.columns(["scene", "objects" if which == "rgb" else "object_ids"])
        is_in = [rooms is None or scene in rooms for scene in columns["scene"].to_pylist()]
        self.rows = np.flatnonzero(is_in)
        if which == "rgb":
            lists = columns["objects"]
            flat = pc.struct_field(pc.list_flatten(lists), "type").to_pylist()
        else:
            lists = columns["object_ids"]
            flat = [name.partition("|")[0] for name in pc.list_flatten(lists).to_pylist()]
        lengths = pc.list_value_length(lists).to_numpy()
        found = np.array([numbers.get(name, UNKNOWN) for name in flat], dtype=np.int64)
        self._types = np.split(found, np.cumsum(lengths)[:-1])

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, index: int) -> Picture:
        row = int(self.rows[index])
        rgb, instances = self._reader.images(row, self._names)
        return Picture(decode_rgb(rgb), decode_instances(instances).astype(np.int32), self._types[row])


def shown_in(instances: np.ndarray, count: int) -> tuple[np.ndarray, F32]:
    """What (h, w) numbers of objects, from 1, show of each: (count,) pixels, and (count, 4) boxes, 0 where nothing shows."""
    pixels = np.bincount(instances.ravel(), minlength=count + 1)[1:]
    boxes = np.zeros((count, 4), dtype=np.float32)
    for box, place in zip(boxes, ndimage.find_objects(instances, max_label=count), strict=True):
        if place is not None:
            rows, columns = place
            box[:] = columns.start, rows.start, columns.stop, rows.stop
    return pixels, boxes


def varied(picture: Picture, side: int, rng: np.random.Generator) -> Picture:
    """A part of a picture, enlarged or reduced to a square, perhaps mirrored, in a somewhat other light.

    Every second part has an object in its middle that is drawn from those that are seen.
    """
    height, width = picture.instances.shape
    cut = float(np.exp(rng.uniform(np.log(LEAST_CUT * side), np.log(MOST_CUT * side))))
    centre = rng.uniform(0, (width, height))
    seen = np.unique(picture.instances)
    if rng.random() < 0.5 and len(seen) > 1:
        rows, columns = np.nonzero(picture.instances == rng.choice(seen[seen > 0]))
        centre = np.array([columns.mean(), rows.mean()]) + rng.normal(0, cut / 6, 2)
    half = np.array([width, height]) / 2
    centre = np.clip(centre, np.minimum(cut / 2, half), np.maximum(2 * half - cut / 2, half))
    zoom, mirror = side / cut, -1.0 if rng.random() < 0.5 else 1.0
    across = [mirror * zoom, 0.0, side / 2 - mirror * zoom * centre[0]]
    matrix = np.array([across, [0.0, zoom, side / 2 - zoom * centre[1]]])
    return Picture(
        relit(np.asarray(cv2.warpAffine(picture.rgb, matrix, (side, side), flags=cv2.INTER_LINEAR), np.uint8), rng),
        cv2.warpAffine(picture.instances.astype(np.float32), matrix, (side, side), flags=cv2.INTER_NEAREST).astype(
            np.int32
        ),
        picture.types,
    )


def relit(rgb: U8, rng: np.random.Generator) -> U8:
    """A picture in a somewhat other light."""
    gain = rng.uniform(1 - LIGHTER, 1 + LIGHTER) * rng.uniform(1 - COLOURED, 1 + COLOURED, 3)
    offset = rng.uniform(-15, 15)
    table = np.clip(np.arange(256)[:, None] * gain + offset, 0, 255).astype(np.uint8)
    return np.stack([table[rgb[..., channel], channel] for channel in range(3)], axis=-1)
