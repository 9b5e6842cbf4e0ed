"""The semantic map, to and from the columns of a scene row."""

from __future__ import annotations

import numpy as np

from remqa_data.geometry.types import I16
from remqa_data.mapping.semantic_map import SemanticPlan, SparseVoxels
from remqa_data.tables.images import StoredImage, decode_instances, encode_labels
from remqa_data.tables.rows import SemanticMap


def map_columns(voxels: SparseVoxels, plan: SemanticPlan) -> tuple[SemanticMap, StoredImage]:
    """What a scene row stores of a map: the columns `semantic_map` and `map_2d`.

    Parameters
    ----------
    voxels : SparseVoxels
        What `VoxelMap.to_sparse` gave.
    plan : SemanticPlan
        What `VoxelMap.plan` gave for the same map.
    """
    stored = SemanticMap(
        origin=(0.0, 0.0, float(plan.floor_z)),
        voxel_m=float(plan.voxel_m),
        corner=(int(plan.corner[0]), int(plan.corner[1])),
        labels=voxels.names,
        voxels=np.column_stack([voxels.coordinates, voxels.labels]).astype(np.int16),
    )
    # The plan's rows go along x and start at the lowest y; an image's rows go down from the highest.
    return stored, encode_labels((plan.labels.T[::-1] + 1).astype(np.uint16))


def sparse_voxels(stored: SemanticMap) -> SparseVoxels:
    """The voxels of a scene row, for `VoxelMap.from_sparse`."""
    return SparseVoxels(stored.voxels[:, :3], stored.voxels[:, 3], stored.labels)


def plan_labels(map_2d: StoredImage) -> I16:
    """`SemanticPlan.labels` of a scene row: (nx, ny) int16, -1 where nothing was seen."""
    return np.asarray(decode_instances(map_2d.bytes)[::-1].T.astype(np.int16) - 1, dtype=np.int16)
