"""The loops of the voxel map: each pixel votes for a type in the voxel that it shows, and most votes win.

`first` holds the first entry of each voxel, -1 without any; an entry is a type, its votes, and the next entry of the
same voxel. So votes are exact for any number of types, and a voxel that shows only one, as most do, costs one entry.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from remqa_data.compiled import exact
from remqa_data.geometry.types import F32, F64, I16, I32
from remqa_data.sim.render.camera import View


@exact
def vote(
    depth: F32,
    objects: I32,
    type_of: I32,
    view: View,
    corner: F64,
    voxels_per_m: float,
    shape: npt.NDArray[np.int64],
    first: I32,
    entries: I32,
    used: int,
) -> int:
    """Count every pixel of a frame for its type in its voxel.

    Parameters
    ----------
    depth, objects : (h, w) float32 and int32
        Metres along the camera's forward axis, 0 where nothing is; and object index, -1 for the structure.
    type_of : (objects + 1,) int32
        Type of each object; the last entry is that of the structure.
    view : View
        The camera.
    corner : (3,) float64
        Where voxel (0, 0, 0) begins, in voxels from the world's origin.
    voxels_per_m : float
        How many voxels lie along a metre.
    shape : (3,) int64
        Voxels along each axis; pixels outside are not counted.
    first, entries : (voxels,) and (n, 3) int32
        The votes so far; changed in place. There must be room for an entry for each pixel.
    used : int
        How many entries are in use.

    Returns
    -------
    How many entries are in use now.
    """
    height, width = depth.shape
    inverse = view.inverse * voxels_per_m
    x_start = view.eye[0] * voxels_per_m - corner[0]
    y_start = view.eye[1] * voxels_per_m - corner[1]
    z_start = view.eye[2] * voxels_per_m - corner[2]
    nx, ny, nz = shape[0], shape[1], shape[2]
    last_voxel, last_type, last_entry = -1, -1, -1
    for row in range(height):
        v = row + 0.5 - 0.5 * height
        for column in range(width):
            distance = float(depth[row, column])
            if not distance > 0.0:
                continue
            u = column + 0.5 - 0.5 * width
            scale = distance if view.pinhole else 1.0
            x = x_start + (inverse[0, 0] * u + inverse[0, 1] * v) * scale + inverse[0, 2] * distance
            y = y_start + (inverse[1, 0] * u + inverse[1, 1] * v) * scale + inverse[1, 2] * distance
            z = z_start + (inverse[2, 0] * u + inverse[2, 1] * v) * scale + inverse[2, 2] * distance
            if not (0.0 <= x < nx and 0.0 <= y < ny and 0.0 <= z < nz):
                continue
            voxel = (int(x) * ny + int(y)) * nz + int(z)
            kind = type_of[objects[row, column]]
            if voxel != last_voxel or kind != last_type:  # neighbouring pixels mostly agree
                last_voxel, last_type = voxel, kind
                last_entry = first[voxel]
                while last_entry >= 0 and entries[last_entry, 0] != kind:
                    last_entry = entries[last_entry, 2]
                if last_entry < 0:
                    last_entry = used
                    entries[used, 0] = kind
                    entries[used, 1] = 0
                    entries[used, 2] = first[voxel]
                    first[voxel] = used
                    used += 1
            entries[last_entry, 1] += 1
    return used


@exact
def elect(first: I32, entries: I32, rank: I16) -> I16:
    """(voxels,) rank of the type with most votes in each voxel, -1 without votes.

    Of equally many votes the least rank wins, but rank 0 (the structure) against no other.
    """
    labels = np.full(len(first), -1, dtype=np.int16)
    for voxel in range(len(first)):
        most = 0
        entry = first[voxel]
        while entry >= 0:
            label, votes = rank[entries[entry, 0]], entries[entry, 1]
            best = labels[voxel]
            is_tie_won = votes == most and label != 0 and (best == 0 or label < best)
            if votes > most or is_tie_won:
                most = votes
                labels[voxel] = label
            entry = entries[entry, 2]
    return labels
