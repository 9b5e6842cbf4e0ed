"""The rows of the four tables, as typed records with the documentation of every field.

`remqa_data.tables.schema` derives the Arrow types from these classes, and the dataset card its field tables, so a field is
described once: here, as the `Column` in its annotation. The order of the fields is the order of the columns.

World frame: right-handed, z up, metres; yaw in degrees counter-clockwise from +x. Image frame: pixels, x to the right
and y down from the top left corner; boxes are [x1, y1, x2, y2), half open.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal, NamedTuple, get_args

import numpy as np
import numpy.typing as npt

from remqa_data.catalog import Manipulation
from remqa_data.geometry.types import Vec3
from remqa_data.limits import MOST_OBJECTS, MOST_SCENE_JSON_BYTES, MOST_VOXELS
from remqa_data.scene_graph.relations import Edge
from remqa_data.sim.metadata import AgentState, Box2D, ObjectMetadata, VisibleObject
from remqa_data.tables.fields import Column
from remqa_data.tables.images import StoredImage

Split = Literal["train", "val", "test"]
QuestionKind = Literal["EXISTENCE", "COUNTING", "SPATIAL"]
KINDS: tuple[QuestionKind, ...] = get_args(QuestionKind)
"""Of questions, as the paper has them."""


def configuration_name(scene: str, configuration: int) -> str:
    """What people are told that one configuration of a room is called.

    >>> configuration_name("FloorPlan1", 2)
    'FloorPlan1, configuration 2'
    """
    return f"{scene}, configuration {configuration}"


class GridCell(NamedTuple):
    """A cell of the navigation grid."""

    i: Annotated[int, Column("Cell along x: the cell's centre is at i * step_m.", frame="grid")]
    j: Annotated[int, Column("Cell along y: the cell's centre is at j * step_m.", frame="grid")]


@dataclass(frozen=True)
class EmbodimentRow:
    """The agent's body and eye."""

    camera_height_m: Annotated[float, Column("Camera above the floor.", "m", within=(0.1, 10.0))]
    fov_deg: Annotated[float, Column("Vertical field of view.", "deg", within=(1.0, 170.0))]
    step_m: Annotated[
        float, Column("Length of one step, the spacing of the navigation grid.", "m", within=(0.01, 10.0))
    ]
    reach_m: Annotated[float, Column("How far the arm reaches from its shoulder.", "m", within=(0.0, 10.0))]


@dataclass(frozen=True, eq=False)
class SemanticMap:
    """Which voxels of the room hold what, as the walk has seen it; `remqa_data.tables.map_columns` makes and reads it."""

    origin: Annotated[Vec3, Column("Low corner of voxel (0, 0, 0): x, y, z.", "m", "world")]
    voxel_m: Annotated[float, Column("Edge of a voxel.", "m", within=(0.01, 10.0))]
    corner: Annotated[tuple[int, int], Column("x, y of the voxel column in map_2d's lower left pixel.", frame="voxels")]
    labels: Annotated[tuple[str, ...], Column("What voxels are labelled with: structure, or a type of object.")]
    voxels: Annotated[
        npt.NDArray[np.int16],
        Column(
            "Occupied voxels: x, y, z counted from the origin, and an index into labels.",
            frame="voxels",
            arrow="int16",
            columns=("x", "y", "z", "label"),
            most=MOST_VOXELS,
        ),
    ]
    """(n, 4)."""

    def __eq__(self, other: object) -> bool:
        """Equal fields."""
        return (
            isinstance(other, SemanticMap)
            and (self.origin, self.voxel_m, self.corner) == (other.origin, other.voxel_m, other.corner)
            and self.labels == other.labels
            and np.array_equal(self.voxels, other.voxels)
        )

    __hash__ = None  # type: ignore[assignment]


@dataclass(frozen=True)
class SceneRow:
    """One configuration of one room: everything the simulator needs, and what a walk through it has shown."""

    scene: Annotated[str, Column("Name of the room, such as FloorPlan1.")]
    room_type: Annotated[str, Column("kitchen, living_room, bedroom or bathroom.")]
    split: Annotated[Split, Column("Split of the room's questions and frames.")]
    configuration: Annotated[int, Column("Which arrangement of the room's things, from 0.")]
    seed: Annotated[int, Column("Seed of the dataset that this configuration was drawn with.", arrow="int64")]
    scene_json: Annotated[
        str,
        Column(
            "The room as JSON: remqa_data.scene.Scene.from_json loads it.",
            arrow="large_string",
            most=MOST_SCENE_JSON_BYTES,
        ),
    ]
    objects: Annotated[tuple[ObjectMetadata, ...], Column("Ground truth of every object.", most=MOST_OBJECTS)]
    graph_nodes: Annotated[tuple[str, ...], Column("Ids of the objects in the scene graph, as the walk found them.")]
    graph_edges: Annotated[tuple[Edge, ...], Column("Edges of the scene graph after the walk.")]
    semantic_map: Annotated[SemanticMap, Column("Voxels that the walk has seen, by object type.")]
    map_2d: Annotated[
        StoredImage,
        Column(
            "What is highest in each voxel column, 16-bit PNG: index into semantic_map.labels + 1, 0 where nothing was "
            "seen; image right is +x and image up is +y.",
            frame="voxels",
        ),
    ]
    navigation_cells: Annotated[tuple[GridCell, ...], Column("Cells that the agent can stand on.", frame="grid")]
    walk_start_cell: Annotated[
        GridCell,
        Column("Cell where the walk that takes the frames begins; for episodes see initial_pose.", frame="grid"),
    ]
    embodiment: Annotated[EmbodimentRow, Column("The agent's body and eye.")]


@dataclass(frozen=True)
class FrameRow:
    """One frame of a walk through a configuration."""

    frame_id: Annotated[str, Column("Unique name of the frame.")]
    scene: Annotated[str, Column("Name of the room.")]
    configuration: Annotated[int, Column("Configuration of the room.")]
    split: Annotated[Split, Column("Split of the room's questions and frames.")]
    index: Annotated[int, Column("Place in the walk, from 0.")]
    rgb: Annotated[StoredImage, Column("What the camera sees, 8-bit RGB.")]
    depth: Annotated[
        StoredImage,
        Column("Depth along the camera's forward axis, 16-bit PNG, 0 where nothing is seen.", "mm"),
    ]
    instances: Annotated[StoredImage, Column("16-bit PNG: index into objects + 1, 0 where no such object is seen.")]
    agent: Annotated[AgentState, Column("Where the agent is.")]
    objects: Annotated[
        tuple[VisibleObject, ...], Column("The visible objects, in the scene's order.", most=MOST_OBJECTS)
    ]
    added_nodes: Annotated[tuple[str, ...], Column("Ids of objects that this frame adds to the scene graph.")]
    added_edges: Annotated[tuple[Edge, ...], Column("Edges that this frame adds to the scene graph.")]


@dataclass(frozen=True)
class ExpressionRow:
    """One referring expression, tied to a frame in which its target is visible."""

    expression_id: Annotated[str, Column("Unique name of the row.")]
    scene: Annotated[str, Column("Name of the room.")]
    configuration: Annotated[int, Column("Configuration of the room.")]
    split: Annotated[Split, Column("Split by room.")]
    frame_id: Annotated[str, Column("The frame, in the table frames.")]
    text: Annotated[str, Column("The expression, such as: the mug on the table.")]
    kind: Annotated[str, Column("How it is built: from a relation, or from attributes too (an extension).")]
    target_id: Annotated[str, Column("Id of the one object that it means.")]
    target_type: Annotated[str, Column("Type of that object.")]
    anchor_id: Annotated[str | None, Column("Id of the object that it is told by, if there is one.")]
    relation: Annotated[str | None, Column("Relation of the target to that object, if there is one.")]
    box_2d: Annotated[Box2D, Column("Box of the target's pixels in the frame, [x1, y1, x2, y2).", "px", "image")]
    program: Annotated[str, Column("JSON: the functional program that finds the target.")]


@dataclass(frozen=True)
class QuestionRow:
    """One task: a question that is answered by walking to something, manipulating it and looking.

    I_start and I_end are the paper's names for the views from the goal before and after the manipulation. A column that
    begins with `start_` or `end_` is about one of them; where the episode begins is `initial_pose`.
    """

    question_id: Annotated[str, Column("Unique name of the question.")]
    kind: Annotated[QuestionKind, Column("EXISTENCE, COUNTING or SPATIAL.")]
    question: Annotated[str, Column("The question.")]
    expression: Annotated[str, Column("The referring expression in it.")]
    answer: Annotated[str, Column("yes or no; a number in digits for COUNTING.")]
    program: Annotated[str, Column("JSON: the functional program whose execution on the ground truth is the answer.")]
    scene: Annotated[str, Column("Name of the room.")]
    room_type: Annotated[str, Column("kitchen, living_room, bedroom or bathroom.")]
    configuration: Annotated[int, Column("Configuration of the room.")]
    split: Annotated[Split, Column("train or test, by room.")]
    group: Annotated[str, Column("Same for the same question about other configurations of the room.")]
    initial_pose: Annotated[AgentState, Column("Where the agent is when the episode begins.")]
    goal_poses: Annotated[
        tuple[AgentState, ...],
        Column(
            "Poses that see the target and from which the arm reaches it; I_start and I_end are seen from the first."
        ),
    ]
    target_id: Annotated[str, Column("Id of the object to manipulate first, the one the expression means.")]
    target_type: Annotated[str, Column("Type of that object.")]
    start_target_box_2d: Annotated[
        Box2D | None, Column("Box of the target's pixels in I_start, [x1, y1, x2, y2).", "px", "image")
    ]
    answer_type: Annotated[str, Column("Type of the objects asked for.")]
    answer_ids: Annotated[tuple[str, ...], Column("Ids of the objects that make the answer; empty for no and 0.")]
    manipulation: Annotated[Manipulation, Column("What must be done: Open, Move or Pickup.")]
    manipulation_object_id: Annotated[str, Column("Id of the object that it must be done to.")]
    path_length_m: Annotated[
        float, Column("Length of the shortest path from the initial pose to the nearest goal pose.", "m")
    ]
    path_steps: Annotated[int, Column("Number of moves and turns on that path.")]
    actions: Annotated[tuple[str, ...], Column("Oracle actions from the initial pose to I_end.")]
    start_rgb: Annotated[
        StoredImage, Column("I_start: the view from the first goal pose before the manipulation, 8-bit RGB.")
    ]
    start_depth: Annotated[
        StoredImage, Column("Depth of I_start along the forward axis, 16-bit PNG, 0 for nothing.", "mm")
    ]
    start_instances: Annotated[
        StoredImage, Column("Objects of I_start, 16-bit PNG: index into object_ids + 1, 0 for none.")
    ]
    end_rgb: Annotated[
        StoredImage, Column("I_end: the view from the first goal pose after the manipulation, 8-bit RGB.")
    ]
    end_depth: Annotated[StoredImage, Column("Depth of I_end along the forward axis, 16-bit PNG, 0 for nothing.", "mm")]
    end_instances: Annotated[
        StoredImage, Column("Objects of I_end, 16-bit PNG: index into object_ids + 1, 0 for none.")
    ]
    object_ids: Annotated[
        tuple[str, ...], Column("What the instance values 1, 2, ... of I_start and I_end mean.", most=MOST_OBJECTS)
    ]


Row = SceneRow | FrameRow | ExpressionRow | QuestionRow

SHARED_FIELDS: dict[type, dict[str, Column]] = {
    StoredImage: {
        "bytes": Column("A whole JPEG or PNG file."),
        "path": Column("A file name for it; the image is not there."),
    },
    AgentState: {
        "position": Column("Middle of the agent's base: x, y, z.", "m", "world"),
        "yaw_deg": Column("Heading, counter-clockwise from +x.", "deg", "world"),
        "horizon_deg": Column("Tilt of the camera, positive looks down.", "deg"),
    },
    Edge: {
        "source": Column("Id of the object that is in, on, under, above, below or next to the other."),
        "target": Column("Id of the other object."),
        "relation": Column("Relation of the source to the target."),
        "distance_m": Column("Distance between the centres of the two 3D boxes.", "m"),
        "iou": Column("Intersection over union of the two 3D boxes, 0 to 1."),
    },
    ObjectMetadata: {
        "id": Column("Id of the object, unique in the room."),
        "type": Column("Object type, such as Mug."),
        "color": Column("Word for its colour; mixed where less than half of it is of one."),
        "substance": Column("Word for what it is made of."),
        "box": Column("Axis-aligned 3D box: x0, y0, z0, x1, y1, z1.", "m", "world"),
        "openness": Column("0 (closed) to 1 (open)."),
        "is_picked_up": Column("Whether the agent holds it."),
        "support": Column("Id of the receptacle that holds it, if there is one."),
        "support_kind": Column("Whether it is in or on that receptacle."),
        "facing_deg": Column("Where its front looks, counter-clockwise from +x, if it has a front.", "deg", "world"),
    },
    VisibleObject: {
        "box_2d": Column("Box of its pixels, [x1, y1, x2, y2).", "px", "image"),
        "pixels": Column("Number of its pixels.", "px"),
        "distance_m": Column("From the camera to the nearest point of its 3D box.", "m"),
    },
}
"""Fields of records that are defined elsewhere; a class has those of its bases too."""
