"""The types of arrays, points and boxes, named once for all of the library."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

F32 = npt.NDArray[np.float32]
F64 = npt.NDArray[np.float64]
I16 = npt.NDArray[np.int16]
I32 = npt.NDArray[np.int32]
I64 = npt.NDArray[np.int64]
U8 = npt.NDArray[np.uint8]
U64 = npt.NDArray[np.uint64]
Flags = npt.NDArray[np.bool_]
"""Truth values."""

Vec2 = tuple[float, float]
"""x, y in metres."""
Vec3 = tuple[float, float, float]
"""x, y, z in metres."""
Rect = tuple[float, float, float, float]
"""x0, y0, x1, y1 in metres."""
Box = tuple[float, float, float, float, float, float]
"""x0, y0, z0, x1, y1, z1 in metres."""
