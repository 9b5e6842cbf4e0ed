"""What the PyTorch datasets yield: the keys of each sample, with shapes, dtypes and ranges.

A sample has the keys of the columns and images that its dataset was asked for. H and W are the height and width of the
frames; n differs from sample to sample. An agent's pose is (x, y, z, yaw_deg, horizon_deg): metres in the world frame,
degrees counter-clockwise from +x, degrees down.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypedDict

from remqa_data.tables.rows import QuestionKind

if TYPE_CHECKING:
    from torch import Tensor

RAGGED = frozenset({"goal_poses", "boxes_2d", "boxes_3d", "pixels", "distances_m", "openness"})
"""Tensors whose first dimension differs from sample to sample: `collate` keeps them in a list."""


class QuestionSample(TypedDict, total=False):
    """A row of the table questions."""

    question_id: str
    kind: QuestionKind
    question: str
    expression: str
    answer: str
    """"yes" or "no"; a number in digits for COUNTING."""
    program: str
    """JSON."""
    scene: str
    room_type: str
    configuration: int
    split: str
    group: str
    initial_pose: Tensor
    """(5,) float32: a pose."""
    goal_poses: Tensor
    """(n, 5) float32: poses."""
    target_id: str
    target_type: str
    start_target_box_2d: Tensor
    """(4,) int64: x1, y1, x2, y2 in pixels of I_start, half open; all -1 where there is none."""
    answer_type: str
    answer_ids: list[str]
    manipulation: Literal["Open", "Move", "Pickup"]
    manipulation_object_id: str
    path_length_m: float
    path_steps: int
    actions: list[str]
    object_ids: list[str]
    """The instance number k + 1 means object_ids[k]."""
    start_rgb: Tensor
    """I_start, before the manipulation: (3, H, W) uint8, 0 to 255; channels last in memory. So is end_rgb, I_end."""
    start_depth: Tensor
    """(H, W) float32, metres along the camera's forward axis, 0 to 65.535; 0 where nothing is seen."""
    start_instances: Tensor
    """(H, W) int32, 0 (no object) to len(object_ids)."""
    end_rgb: Tensor
    end_depth: Tensor
    end_instances: Tensor


class FrameSample(TypedDict, total=False):
    """A row of the table frames; the visible objects come as parallel lists and tensors."""

    frame_id: str
    scene: str
    configuration: int
    split: str
    index: int
    agent: Tensor
    """(5,) float32: a pose."""
    added_nodes: list[str]
    added_edges: list[dict[str, str | float]]
    object_ids: list[str]
    """The instance number k + 1 means object_ids[k]."""
    object_types: list[str]
    boxes_2d: Tensor
    """(n, 4) int64: x1, y1, x2, y2 in pixels, half open."""
    boxes_3d: Tensor
    """(n, 6) float32: x0, y0, z0, x1, y1, z1 in metres, world frame."""
    pixels: Tensor
    """(n,) int64."""
    distances_m: Tensor
    """(n,) float32: metres from the camera to the nearest point of the 3D box."""
    openness: Tensor
    """(n,) float32, 0 (closed) to 1 (open)."""
    rgb: Tensor
    """(3, H, W) uint8, 0 to 255; channels last in memory."""
    depth: Tensor
    """(H, W) float32, metres along the camera's forward axis, 0 to 65.535; 0 where nothing is seen."""
    instances: Tensor
    """(H, W) int32, 0 (no object) to n."""


class ExpressionSample(TypedDict, total=False):
    """A row of the table expressions, with the images of its frame."""

    expression_id: str
    scene: str
    configuration: int
    split: str
    frame_id: str
    text: str
    kind: str
    target_id: str
    target_type: str
    anchor_id: str | None
    relation: str | None
    box_2d: Tensor
    """(4,) int64: x1, y1, x2, y2 in pixels of the frame, half open."""
    program: str
    """JSON."""
    rgb: Tensor
    """(3, H, W) uint8, 0 to 255; channels last in memory."""
    depth: Tensor
    """(H, W) float32, metres, 0 where nothing is seen."""
    instances: Tensor
    """(H, W) int32, an index into the frame's objects + 1, or 0."""
