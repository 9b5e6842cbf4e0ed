"""How well a detector detects: mean average precision as COCO measures it."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import torch

from remqa_data.agents.networks.detection.detector_loss import LEAST_PIXELS
from remqa_data.agents.networks.detection.regions import AnyDetector
from remqa_data.agents.training.pictures import Picture, Pictures
from remqa_data.agents.training.rooms import rooms_of
from remqa_data.errors import DatasetError
from remqa_data.extras import require
from remqa_data.storage.manifest import load_manifest

SECTIONS = ("bbox", "segm")
AP, AP50 = 0, 1
"""Places in COCO's list of figures."""


def score_detector(
    detector: AnyDetector,
    types: tuple[str, ...],
    root: Path,
    split: str,
    device: str = "cpu",
    progress: Callable[[int], None] | None = None,
) -> dict[str, Any]:
    """Average precision on the frames of the rooms of a split, "val" or "test".

    Raises
    ------
    DatasetError
        If the dataset has no such split.

    Returns
    -------
    "frames", and for "bbox" and "segm": "AP" (mean over types and IoU .5 to .95), "AP50", and "by_type" ("AP50", "objects").
    """
    coco, evaluator = (require(f"pycocotools.{name}", "agents") for name in ("coco", "cocoeval"))
    masks = require("pycocotools.mask", "agents")
    rooms = rooms_of(root, split)
    if not rooms:
        known = ", ".join(load_manifest(root).splits("expressions"))
        raise DatasetError(f"{root} has no rooms of a split {split!r}; it has: {known}")
    pictures = Pictures(root, "test" if split == "test" else "train", "rgb", types, rooms)
    truth: dict[str, list[Any]] = {
        "images": [],
        "annotations": [],
        "categories": [{"id": number, "name": name} for number, name in enumerate(types)],
    }
    found: list[dict[str, Any]] = []
    detector = detector.to(device).eval()
    for place in range(len(pictures)):
        picture = pictures[place]
        height, width = picture.instances.shape
        truth["images"].append({"id": place, "height": height, "width": width})
        truth["annotations"] += _annotations(picture, place, len(truth["annotations"]), masks)
        seen = detector.detect(torch.from_numpy(picture.rgb).permute(2, 0, 1)[None].to(device))[0]
        for number in range(len(seen.boxes)):
            x1, y1, x2, y2 = seen.boxes[number].tolist()
            found.append(
                {
                    "image_id": place,
                    "category_id": int(seen.types[number]),
                    "score": float(seen.scores[number]),
                    "bbox": [x1, y1, x2 - x1, y2 - y1],
                    "segmentation": masks.encode(np.asfortranarray(seen.mask(number, (height, width)), dtype=np.uint8)),
                }
            )
        if progress is not None:
            progress(1)
    scores: dict[str, Any] = {"frames": len(truth["images"])}
    with contextlib.redirect_stdout(io.StringIO()):  # it talks
        known = coco.COCO()
        known.dataset = truth
        known.createIndex()
        said = known.loadRes(found) if found else None
        for section in SECTIONS if said else ():
            evaluation = evaluator.COCOeval(known, said, section)
            evaluation.evaluate()
            evaluation.accumulate()
            evaluation.summarize()
            scores[section] = _figures(evaluation, types, truth)
    return scores


def _annotations(picture: Picture, image: int, first: int, masks: Any) -> list[dict[str, Any]]:
    """The objects of a picture; those too small to be asked for count neither as right nor as wrong."""
    made: list[dict[str, Any]] = []
    for number, kind in enumerate(picture.types, start=1):
        mask = picture.instances == number
        if kind < 0 or not mask.any():
            continue
        rows, columns = np.nonzero(mask)
        x, y = int(columns.min()), int(rows.min())
        made.append(
            {
                "id": first + len(made) + 1,
                "image_id": image,
                "category_id": int(kind),
                "area": int(mask.sum()),
                "bbox": [x, y, int(columns.max()) + 1 - x, int(rows.max()) + 1 - y],
                "segmentation": masks.encode(np.asfortranarray(mask, dtype=np.uint8)),
                "iscrowd": int(mask.sum() < LEAST_PIXELS),
            }
        )
    return made


def _figures(evaluation: Any, types: tuple[str, ...], truth: dict[str, list[Any]]) -> dict[str, Any]:
    counts = np.bincount(
        [item["category_id"] for item in truth["annotations"] if not item["iscrowd"]], minlength=len(types)
    )
    precision = evaluation.eval["precision"][0, :, :, 0, -1]  # at IoU .5, all areas, 100 detections
    by_type = {
        name: {
            "AP50": round(float(precision[:, place][precision[:, place] > -1].mean()), 4),
            "objects": int(counts[place]),
        }
        for place, name in enumerate(types)
        if counts[place]
    }
    return {"AP": float(evaluation.stats[AP]), "AP50": float(evaluation.stats[AP50]), "by_type": by_type}
