"""Images as tables store them: encoded bytes that any viewer opens, and the arrays they stand for.

RGB is JPEG or PNG. Depth is a 16-bit PNG of millimetres. Instances are a 16-bit PNG of numbers from 1 into a row's list
of objects; 0 is everything else. Equal arrays give equal bytes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from remqa_data.errors import ImageFormatError, one_line
from remqa_data.limits import MOST_IMAGE_PX
from remqa_data.opencv import cv2

RgbFormat = Literal["jpeg", "png"]

JPEG_QUALITY = 95
PNG_COMPRESSION = 1
"""zlib level; higher ones gain little and cost time."""
MAX_DEPTH_MM = 65535

PNG_SIGNATURE, JPEG_SIGNATURE = b"\x89PNG\r\n\x1a\n", b"\xff\xd8"
_MARKER = 0xFF
_JPEG_FRAMES = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
"""Markers that tell the size: of frames, baseline and progressive; the three are tables."""
_MOST_SEGMENTS = 1000
"""Of a JPEG file before its frame; usual are five."""


@dataclass(frozen=True)
class StoredImage:
    """An encoded image: Hugging Face's `Image` as it lies in Arrow.

    Attributes
    ----------
    bytes : bytes
        A whole JPEG or PNG file.
    path : str or None
        A file name for it, with the right suffix; the image is not there, but in `bytes`.
    """

    bytes: bytes
    path: str | None = None


def encode_rgb(rgb: npt.NDArray[np.uint8], name: str | None = None, *, form: RgbFormat = "jpeg") -> StoredImage:
    """Encode an (h, w, 3) uint8 image; JPEG has quality 95, PNG keeps every bit."""
    if rgb.dtype != np.uint8 or rgb.ndim != 3 or rgb.shape[2] != 3:
        raise ImageFormatError(f"an RGB image is (h, w, 3) uint8, not {rgb.shape} {rgb.dtype}")
    bgr = cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR)
    if form == "png":
        return _encoded(".png", bgr, _PNG_OPTIONS, name)
    return _encoded(".jpg", bgr, _JPEG_OPTIONS, name)


def encode_depth(depth_m: npt.NDArray[np.floating[Any]], name: str | None = None) -> StoredImage:
    """Encode an (h, w) depth image in metres, rounded to millimetres.

    What is not finite becomes 0 (nothing is seen) and what is beyond 65.535 m becomes 65.535 m.
    """
    if depth_m.ndim != 2 or not np.issubdtype(depth_m.dtype, np.floating):
        raise ImageFormatError(f"a depth image is (h, w) in metres, not {depth_m.shape} {depth_m.dtype}")
    finite = np.where(np.isfinite(depth_m), depth_m, 0)
    return _encoded(".png", np.clip(np.rint(finite * 1000), 0, MAX_DEPTH_MM).astype(np.uint16), _PNG_OPTIONS, name)


def encode_instances(
    objects: npt.NDArray[np.integer[Any]], scene_ids: Sequence[str], row_ids: Sequence[str], name: str | None = None
) -> StoredImage:
    """Encode which object each pixel shows.

    Parameters
    ----------
    objects : (h, w) array of int
        Index into `scene_ids`, -1 for no object: `Observation.objects`.
    scene_ids : sequence of str
        Ids of all objects of the scene, in its order.
    row_ids : sequence of str
        Ids of the objects that the row lists; a pixel of `row_ids[k]` is stored as k + 1 and all others as 0, so that a
        mask never shows an object that the row calls invisible.
    name : str, optional
        Stored as the image's path.
    """
    if objects.ndim != 2:
        raise ImageFormatError(f"an instance image is (h, w), not {objects.shape}")
    number_of = {object_id: number for number, object_id in enumerate(row_ids, start=1)}
    # One entry more than there are objects: index -1 finds it, and it says 0.
    numbers = np.array([number_of.get(object_id, 0) for object_id in scene_ids] + [0], dtype=np.uint16)
    return _encoded(".png", numbers[objects], _PNG_OPTIONS, name)


def encode_labels(labels: npt.NDArray[np.uint16]) -> StoredImage:
    """Encode an (h, w) uint16 image of numbers, such as a semantic map, as it is."""
    if labels.dtype != np.uint16 or labels.ndim != 2:
        raise ImageFormatError(f"a label image is (h, w) uint16, not {labels.shape} {labels.dtype}")
    return _encoded(".png", labels, _PNG_OPTIONS, None)


def decode_rgb(data: bytes | memoryview) -> npt.NDArray[np.uint8]:
    """The (h, w, 3) uint8 image that `encode_rgb` was given; exactly so for PNG.

    Raises
    ------
    ImageFormatError
        If the bytes are not an image that OpenCV reads.
    """
    return np.asarray(_decoded(data, cv2.IMREAD_COLOR_RGB), dtype=np.uint8)


def decode_depth(data: bytes | memoryview) -> npt.NDArray[np.float32]:
    """The (h, w) float32 depth in metres, 0 where nothing is seen; to the millimetre what `encode_depth` was given."""
    depth_m = _decoded_16_bit(data).astype(np.float32)
    depth_m *= np.float32(0.001)
    return depth_m


def decode_instances(data: bytes | memoryview) -> npt.NDArray[np.uint16]:
    """The (h, w) uint16 numbers: 0 for no listed object, k + 1 for the k-th of the row's list."""
    return _decoded_16_bit(data)


_PNG_OPTIONS = [
    *(cv2.IMWRITE_PNG_COMPRESSION, PNG_COMPRESSION),
    # Of all filters the best for rooms: depth takes 11 KB, 0.6 ms to encode and 0.5 ms to decode, as against 27, 0.8 and
    # 0.9 with OpenCV's default.
    *(cv2.IMWRITE_PNG_FILTER, cv2.IMWRITE_PNG_FILTER_UP),
]
_JPEG_OPTIONS = [
    *(cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY),
    # Written down, so that another default of another OpenCV cannot change the bytes.
    *(cv2.IMWRITE_JPEG_SAMPLING_FACTOR, cv2.IMWRITE_JPEG_SAMPLING_FACTOR_420),
    *(cv2.IMWRITE_JPEG_PROGRESSIVE, 0, cv2.IMWRITE_JPEG_OPTIMIZE, 0),
]


def _encoded(suffix: str, image: npt.NDArray[Any], options: list[int], name: str | None) -> StoredImage:
    done, data = cv2.imencode(suffix, np.ascontiguousarray(image), options)
    if not done:
        raise ImageFormatError(f"OpenCV cannot encode a {image.shape} {image.dtype} image as {suffix}")
    return StoredImage(data.tobytes(), None if name is None else name + suffix)


def _decoded_16_bit(data: bytes | memoryview) -> npt.NDArray[np.uint16]:
    image = _decoded(data, cv2.IMREAD_UNCHANGED)
    if image.dtype != np.uint16 or image.ndim != 2:
        raise ImageFormatError(f"expected a 16-bit grey PNG, found {image.shape} {image.dtype}")
    return np.asarray(image, dtype=np.uint16)


def _decoded(data: bytes | memoryview, flags: int) -> npt.NDArray[Any]:
    size = image_size(data)
    if size is None:
        raise ImageFormatError(f"{len(data)} bytes that are not an image (a JPEG or PNG file was expected)")
    if not (min(size) > 0 and max(size) <= MOST_IMAGE_PX):
        raise ImageFormatError(f"an image of {size[0]} x {size[1]} pixels; at most {MOST_IMAGE_PX} each way")
    try:
        image = cv2.imdecode(np.frombuffer(data, dtype=np.uint8), flags)
    except cv2.error as error:
        raise ImageFormatError(f"an image that OpenCV cannot decode: {one_line(error)}") from None
    if image is None:
        raise ImageFormatError(f"{len(data)} bytes that begin like an image and are none")
    return image


def image_size(data: bytes | memoryview) -> tuple[int, int] | None:
    """Width and height that a JPEG or PNG file claims, from its first bytes; None if it is neither.

    Decoding asks for memory for so many pixels before it looks at any of them.
    """
    data = memoryview(data).cast("B")
    if bytes(data[:8]) == PNG_SIGNATURE:
        return (_number(data, 16, 4), _number(data, 20, 4)) if len(data) >= 24 else None
    if bytes(data[:2]) != JPEG_SIGNATURE:
        return None
    place = 2
    for _ in range(_MOST_SEGMENTS):
        if place + 9 > len(data) or data[place] != _MARKER:
            return None
        if data[place + 1] in _JPEG_FRAMES:
            return _number(data, place + 7, 2), _number(data, place + 5, 2)
        place += (
            1 if data[place + 1] == _MARKER else 2 + _number(data, place + 2, 2)
        )  # a marker may begin with many 0xff
    return None


def _number(data: memoryview, place: int, count: int) -> int:
    return int.from_bytes(data[place : place + count], "big")
