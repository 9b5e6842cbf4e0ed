"""OpenCV, or one line that says how to get it to work: `from remqa_data.opencv import cv2`.

The distributions opencv-python and opencv-python-headless both install a package called cv2, and the last one wins.
AI2-THOR (extra `thor`) brings the former, which needs the libraries of a screen.
"""

from remqa_data.errors import OpenCVError

try:
    import cv2
except ImportError as error:
    raise OpenCVError(error) from error

__all__ = ["cv2"]
