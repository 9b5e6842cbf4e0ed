"""Pictures that people can read, made of stored ones: depth in colours, objects in colours, maps."""

from __future__ import annotations

import colorsys

import numpy as np

from remqa_data.geometry.types import U8
from remqa_data.mapping.map_picture import paint_plan
from remqa_data.mapping.semantic_map import UNKNOWN, SemanticPlan
from remqa_data.opencv import cv2
from remqa_data.tables.images import PNG_SIGNATURE, decode_depth, decode_instances, decode_rgb

FARTHEST_M = 3.0
"""What is farther has the last colour."""
JPEG_QUALITY = 88
VEIL = 0.55
"""How much of an object its colour covers."""


def media_type(picture: bytes) -> str:
    """What kind of picture some bytes are."""
    return "image/png" if picture.startswith(PNG_SIGNATURE) else "image/jpeg"


def depth_picture(depth: bytes) -> bytes:
    """Depth as a JPEG: near is bright, `FARTHEST_M` is dark, and what was not seen is black."""
    metres = decode_depth(depth)
    nearness = (255 * (1 - np.clip(metres / FARTHEST_M, 0, 1))).astype(np.uint8)
    colored = cv2.applyColorMap(nearness, cv2.COLORMAP_INFERNO)
    colored[metres == 0] = 0
    return _jpeg(np.asarray(colored, dtype=np.uint8))


def objects_picture(rgb: bytes, instances: bytes) -> bytes:
    """A view as a JPEG with each object in its colour, see `object_color`."""
    seen, numbers = decode_rgb(rgb).astype(np.float32), decode_instances(instances)
    colors = np.array([(0, 0, 0), *(object_color(i) for i in range(1, int(numbers.max(initial=0)) + 1))], np.float32)
    share = np.where(numbers > 0, VEIL, 0.0)[..., None].astype(np.float32)
    mixed = (seen * (1 - share) + colors[numbers] * share).astype(np.uint8)
    edges = cv2.morphologyEx(numbers, cv2.MORPH_GRADIENT, np.ones((2, 2), np.uint8)) > 0
    mixed[edges] = 255
    return _jpeg(mixed[..., ::-1])


def objects_shown(instances: bytes) -> list[int]:
    """The numbers of the objects that a picture of instances shows, the largest first."""
    numbers, pixels = np.unique(decode_instances(instances), return_counts=True)
    ordered = numbers[np.argsort(-pixels, kind="stable")]
    return [int(number) for number in ordered if number]


def object_color(number: int) -> tuple[int, int, int]:
    """The colour of the object with a number from 1: hues a golden ratio apart."""
    red, green, blue = colorsys.hsv_to_rgb(number * 0.6180339887 % 1.0, 0.72, (0.95, 0.75)[number % 2])
    return round(255 * red), round(255 * green), round(255 * blue)


def plan_picture(plan: SemanticPlan) -> bytes:
    """A map as a PNG, one pixel for each voxel column; what was not seen can be seen through."""
    seen = (plan.labels != UNKNOWN).T[::-1]
    bgra = np.dstack([paint_plan(plan)[..., ::-1], np.where(seen, 255, 0).astype(np.uint8)])
    return cv2.imencode(".png", bgra)[1].tobytes()


def _jpeg(bgr: U8) -> bytes:
    return cv2.imencode(".jpg", np.ascontiguousarray(bgr), [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])[1].tobytes()
