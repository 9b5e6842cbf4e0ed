"""OpenCV, or one line that says how to get it to work: `from remqa_data.opencv import cv2`; and pictures as files.

The distributions opencv-python and opencv-python-headless both install a package called cv2, and the last one wins.
AI2-THOR (extra `thor`) brings the former, which needs the libraries of a screen.
"""

from pathlib import Path

import numpy as np
import numpy.typing as npt

from remqa_data.errors import OpenCVError, OutputError
from remqa_data.files import atomic_path

try:
    import cv2
except ImportError as error:
    raise OpenCVError(error) from error

__all__ = ["check_png", "cv2", "write_png"]


def check_png(path: Path) -> None:
    """Refuse a name of which programs would think that it is of something else than a PNG.

    Raises
    ------
    OutputError
        If it does not end with .png.
    """
    if path.suffix.lower() != ".png":
        raise OutputError(f"{path}: the picture is a PNG: give a name that ends with .png")


def write_png(path: Path, image: npt.NDArray[np.uint8]) -> None:
    """Write an (h, w, 3) RGB picture; OutputError as of `check_png`."""
    check_png(path)
    with atomic_path(path) as temporary:
        temporary.write_bytes(cv2.imencode(".png", image[..., ::-1])[1].tobytes())
