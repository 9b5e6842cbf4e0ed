"""What leaves the package for other programs: rooms as GLB, MJCF, URDF or USD, frames as COCO and RefCOCO, walks for Rerun."""

from typing import Literal

Format = Literal["glb", "mjcf", "urdf", "usd"]
"""What rooms are written as."""
