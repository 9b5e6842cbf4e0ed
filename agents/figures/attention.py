"""Which words a matcher looks at, and which object it means: the frame with boxes, the words as a table of shades."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import torch

from remqa_data.agents.networks.detection.regions import AnyDetector
from remqa_data.agents.networks.matcher import PARTS, Match, ModularMatcher
from remqa_data.agents.training.matching import FrameExpressions, frames_with_expressions, referred
from remqa_data.agents.training.weights import load_trained, trained_detector
from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.errors import ConfigError, UnknownNameError
from remqa_data.geometry.types import U8
from remqa_data.opencv import check_png, cv2, write_png
from remqa_data.storage.manifest import load_manifest
from remqa_data.tables.images import decode_rgb

TRUE_COLOR, CHOSEN_COLOR = (40, 170, 70), (230, 30, 30)
SHADE_COLOR, TEXT_COLOR = (30, 90, 220), (20, 20, 20)
VIEW_PX = 300
"""Smaller views are enlarged to at least that."""
TABLE_PX, NAME_PX, ROW_PX, FONT = 760, 190, 34, cv2.FONT_HERSHEY_SIMPLEX


def write_attention_picture(
    root: Path,
    expression_ids: Sequence[str],
    path: Path,
    network: str = "language_attention",
    weights: Path | None = None,
    *,
    force: bool = False,
) -> None:
    """Draw some referring expressions of a dataset below each other, as PNG.

    Parameters
    ----------
    root : path
        The dataset.
    expression_ids : sequence of str
        Of any split.
    path : path
        The picture.
    network : str
        A language attention network, by its name or file.
    weights : path, optional
        Weights that come before those of the package.
    force : bool
        Use weights on another dataset than that they have learnt from.

    Raises
    ------
    UnknownNameError
        If the dataset has no such expression; names the nearest.
    ConfigError
        If the network is none, or has learnt from another dataset.
    """
    check_png(path)
    matcher, about = load_trained(network, weights, root, force=force)
    if not isinstance(matcher, ModularMatcher):
        raise ConfigError(f"{network} has no attention over words; language_attention has")
    detector = trained_detector(about.network.network, weights, root, force=force).eval()
    frames = _frames_of(root, expression_ids)
    rows = [attention_picture(frames[name], name, detector, matcher, about.vocabulary) for name in expression_ids]
    write_png(path, np.vstack(rows))


@torch.no_grad()
def attention_picture(
    frame: FrameExpressions,
    expression_id: str,
    detector: AnyDetector,
    matcher: ModularMatcher,
    vocabulary: Vocabulary,
) -> U8:
    """The frame with the box that is meant and the one that is chosen, and how much each word counts, (h, w, 3) RGB."""
    number = [row["expression_id"] for row in frame.rows].index(expression_id)
    row: dict[str, Any] = frame.rows[number]
    regions = referred(frame, detector, "cpu").found
    stored = decode_rgb(frame.reader.images(frame.place, ["rgb"])[0])
    scale = math.ceil(VIEW_PX / stored.shape[0])
    view = stored.repeat(scale, axis=0).repeat(scale, axis=1)
    _draw_box(view, scale * np.array(row["box_2d"]), TRUE_COLOR)
    match = matcher(torch.from_numpy(vocabulary.encode_batch([row["text"]])[0]), regions)
    if len(regions.boxes):
        _draw_box(view, scale * match.meant_in(regions)[0], CHOSEN_COLOR)
    table = _table(row["text"].split(), match, view.shape[0])
    return np.vstack([np.hstack([view, table]), np.full((6, view.shape[1] + TABLE_PX, 3), 255, np.uint8)])


def _frames_of(root: Path, expression_ids: Sequence[str]) -> dict[str, FrameExpressions]:
    known: dict[str, FrameExpressions] = {}
    for split in load_manifest(root).splits("expressions"):
        for frame in frames_with_expressions(root, split):
            known |= {row["expression_id"]: frame for row in frame.rows}
    for name in expression_ids:
        if name not in known:
            raise UnknownNameError("expression", name, list(known))
    return known


def _draw_box(view: U8, box: npt.NDArray[np.generic], color: tuple[int, int, int]) -> None:
    x1, y1, x2, y2 = (round(float(side)) for side in box)
    cv2.rectangle(view, (x1, y1), (x2 - 1, y2 - 1), color, 2)


def _table(words: Sequence[str], match: Match, height: int) -> U8:
    """A row for each part of the expression with its weight, a column for each word, the darker the more it counts.

    An anchor has no weight of its own: it belongs to the relationship.
    """
    names = [f"{part} {float(weight):.2f}" for part, weight in zip(PARTS, match.weights[0], strict=True)]
    names += ["its anchor"] * (match.attention.shape[1] - len(PARTS))
    table = np.full((height, TABLE_PX, 3), 255, np.uint8)
    width = min((TABLE_PX - NAME_PX - 10) // len(words), 110)
    top = (height - ROW_PX * (len(names) + 1)) // 2
    for column, word in enumerate(words):
        _write(table, word, (NAME_PX + column * width + 4, top + 22), 0.45)
    for number, name in enumerate(names):
        y = top + ROW_PX * (number + 1)
        _write(table, name, (12, y + 22), 0.5)
        for column in range(len(words)):
            share = float(match.attention[0, number, column])
            x = NAME_PX + column * width
            shade = [round(255 - (255 - channel) * share) for channel in SHADE_COLOR]
            cv2.rectangle(table, (x, y), (x + width - 3, y + ROW_PX - 4), shade, -1)
            _write(table, f"{share:.2f}", (x + 6, y + 21), 0.4, (255, 255, 255) if share > 0.5 else TEXT_COLOR)
    return table


def _write(
    picture: U8, text: str, place: tuple[int, int], scale: float, color: tuple[int, int, int] = TEXT_COLOR
) -> None:
    cv2.putText(picture, text, place, FONT, scale, color, 1, cv2.LINE_AA)
