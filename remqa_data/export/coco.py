"""Frames as COCO, which detection code reads as it is, and the expressions about them as RefCOCO's records.

`annotations/instances_SPLIT.json` is COCO's format, with masks as compressed run lengths; `annotations/refs_SPLIT.json` is
the list that RefCOCO pickles, as JSON; `images/SPLIT` has the pictures. Ids count from 1 through all splits. REFER, RefCOCO's
own code, wants splits joined and masks in lists: docs/EXPORT.md does that.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

from remqa_data.catalog import catalog, object_type
from remqa_data.errors import DatasetError, OutputError
from remqa_data.export.rle import compressed, run_lengths
from remqa_data.files import atomic_path, check_beside, check_empty, is_remote
from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.shards import read_rows
from remqa_data.tables.images import PNG_SIGNATURE, decode_instances
from remqa_data.tables.rows import ExpressionRow, FrameRow, Split
from remqa_data.version import __version__

Entry = dict[str, Any]
"""An object of the JSON."""


@dataclass(frozen=True)
class Written:
    """How much was written."""

    images: int
    annotations: int
    refs: int
    sentences: int


def write_coco(root: Path, out: Path, with_images: bool = True) -> Written:
    """Write the frames and expressions of a finished dataset.

    Parameters
    ----------
    root : Path
        The dataset.
    out : Path
        Folder to write into.
    with_images : bool
        Whether the pictures are written, too, and not only their names.

    Raises
    ------
    DatasetError
        If this is not a finished dataset, a frame is there twice, or an expression is about what its frame does not show.
    UnknownNameError
        If an object's type is not in the catalog.
    OutputError
        If the folder is the dataset's own, or in it, holds anything, or is no folder of this machine.
    """
    check_beside(out, root)
    if is_remote(out):
        raise OutputError(f"{out}: give a folder of this machine with --out")
    check_empty(out, "--out")
    manifest, writer = load_manifest(root), _Writer(root, out, with_images)
    for table, write in (("frames", writer.write_instances), ("expressions", writer.write_refs)):
        for split in get_args(Split):
            if split in manifest.splits(table):
                write(split)
    return Written(writer.images, writer.annotations, writer.refs, writer.sentences)


def categories() -> list[Entry]:
    """All object types in the catalog's order; the supercategory is what questions do with one: Open, Move, Pickup or none."""
    return [
        {"id": number, "name": name, "supercategory": kind.manipulation or "none"}
        for number, (name, kind) in enumerate(catalog().items(), start=1)
    ]


class _Writer:
    """Counts through the splits; holds what expressions need, and no pictures or masks.

    The split "val" of expressions is about rooms whose frames are in the split "train".
    """

    def __init__(self, root: Path, out: Path, with_images: bool) -> None:
        self.images = self.annotations = self.refs = self.sentences = 0
        self._root, self._out, self._with_images = root, out, with_images
        self._category = {entry["name"]: entry["id"] for entry in categories()}
        self._image_of: dict[str, Entry] = {}
        self._ids: dict[tuple[str, str], tuple[int, int]] = {}

    def write_instances(self, split: str) -> None:
        """Write the pictures of a split, and what they show."""
        before = len(self._image_of)
        path = self._out / "annotations" / f"instances_{split}.json"
        with atomic_path(path) as temporary, temporary.open("w", encoding="utf-8") as file:
            file.write('{"annotations": [\n')
            file.writelines(_separated(self._annotations(split)))
            images = list(self._image_of.values())[before:]
            rest = {"images": images, "categories": categories(), "licenses": []}
            file.write("],\n" + json.dumps({"info": _info(split), **rest})[1:] + "\n")

    def write_refs(self, split: str) -> None:
        """Write what the expressions of a split say about the pictures, all of which have been written."""
        path = self._out / "annotations" / f"refs_{split}.json"
        with atomic_path(path) as temporary, temporary.open("w", encoding="utf-8") as file:
            file.write("[\n")
            file.writelines(_separated(self._refs(split)))
            file.write("]\n")

    def _annotations(self, split: str) -> Iterator[Entry]:
        for frame in read_rows(self._root, FrameRow, split):
            instances = decode_instances(frame.instances.bytes)
            image = self._image(frame, instances.shape)
            masks = run_lengths(instances)
            for number, thing in enumerate(frame.objects, start=1):
                self.annotations += 1
                x1, y1, x2, y2 = thing.box_2d
                category = self._category[object_type(thing.type).name]
                self._ids[frame.frame_id, thing.id] = self.annotations, category
                yield {
                    "id": self.annotations,
                    "image_id": image["id"],
                    "category_id": category,
                    "bbox": [x1, y1, x2 - x1, y2 - y1],
                    "area": thing.pixels,
                    "segmentation": {
                        "size": list(instances.shape),
                        "counts": compressed(masks.get(number, [instances.size])),
                    },
                    "iscrowd": 0,
                    "object_id": thing.id,
                }

    def _image(self, frame: FrameRow, shape: tuple[int, ...]) -> Entry:
        if frame.frame_id in self._image_of:
            raise DatasetError(f"{self._root}: frame {frame.frame_id} is there twice")
        self.images += 1
        is_png = frame.rgb.bytes.startswith(PNG_SIGNATURE)
        name = f"{self.images:012d}.{'png' if is_png else 'jpg'}"  # a frame's own name may be anything
        if self._with_images:
            with atomic_path(self._out / "images" / frame.split / name) as temporary:
                temporary.write_bytes(frame.rgb.bytes)
        height, width = shape
        self._image_of[frame.frame_id] = {
            "id": self.images,
            "file_name": name,
            "height": height,
            "width": width,
            "frame_id": frame.frame_id,
            "scene": frame.scene,
            "configuration": frame.configuration,
        }
        return self._image_of[frame.frame_id]

    def _refs(self, split: str) -> Iterator[Entry]:
        """One for each object of a frame that something is said about, in the order of the annotations."""
        said: dict[tuple[str, str], list[ExpressionRow]] = {}
        for row in read_rows(self._root, ExpressionRow, split):
            if (row.frame_id, row.target_id) not in self._ids:
                raise DatasetError(
                    f"{self._root}: expression {row.expression_id}: frame {row.frame_id} does not show its target"
                )
            said.setdefault((row.frame_id, row.target_id), []).append(row)
        for place in sorted(said, key=lambda key: self._ids[key][0]):
            annotation, category = self._ids[place]
            image = self._image_of[place[0]]
            sentences = [self._sentence(row) for row in said[place]]
            self.refs += 1
            yield {
                "ref_id": self.refs,
                "ann_id": annotation,
                "image_id": image["id"],
                "category_id": category,
                "split": split,
                "file_name": image["file_name"],
                "sent_ids": [sentence["sent_id"] for sentence in sentences],
                "sentences": sentences,
            }

    def _sentence(self, row: ExpressionRow) -> Entry:
        self.sentences += 1
        tokens = re.findall(r"[\w']+", row.text.lower())
        return {
            "sent_id": self.sentences,
            "raw": row.text,
            "sent": " ".join(tokens),
            "tokens": tokens,
            "expression_id": row.expression_id,
        }


def _separated(entries: Iterable[Entry]) -> Iterator[str]:
    """JSON, one entry a line, a comma before each but the first."""
    before = ""
    for entry in entries:
        yield before + json.dumps(entry)
        before = ",\n"


def _info(split: str) -> Entry:
    return {"description": f"REMQA, {split}", "version": __version__, "contributor": f"remqa-data {__version__}"}
