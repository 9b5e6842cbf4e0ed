"""A walk as a recording for the viewer Rerun: what is seen and from where, and how the map and the scene graph grow."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import numpy as np

from remqa_data.catalog import catalog, object_type
from remqa_data.errors import DatasetError, OutputError
from remqa_data.export.rooms import find_scene
from remqa_data.extras import require
from remqa_data.files import atomic_path
from remqa_data.geometry.types import F64
from remqa_data.mapping.map_picture import type_color
from remqa_data.mapping.semantic_map import FLOOR_SLACK_M, STRUCTURE, VoxelMap
from remqa_data.scene_graph.relations import Edge
from remqa_data.sim.metadata import VisibleObject
from remqa_data.sim.render.camera import Camera
from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.shards import read_rows
from remqa_data.tables.images import decode_depth, decode_instances, decode_rgb
from remqa_data.tables.rows import FrameRow, configuration_name

TIMELINE = "frame"
MAP_EVERY = 8
"""The map is written after so many frames, and after the last."""

VIEWED_M = 0.3
"""So far before the eye the viewer draws the picture."""


def write_walk(root: Path, scene: str, path: Path, configuration: int = 0) -> int:
    """Write the walk through a configuration of a room of a dataset.

    Parameters
    ----------
    root : Path
        The dataset.
    scene : str
        A room of it.
    path : Path
        The recording to write, such as walk.rrd.
    configuration : int
        Which arrangement of the room's things.

    Returns
    -------
    Number of frames.

    Raises
    ------
    OutputError
        If the recording is called something else.
    MissingExtraError
        If Rerun is not installed.
    UnknownNameError, DatasetError
        If the dataset has no such room, or no frames of it, or types or edges of what is not there.
    """
    if path.suffix.lower() != ".rrd":
        raise OutputError(f"{path}: the recording is Rerun's: give a name that ends with .rrd")
    rerun = require("rerun", "rerun")
    room = find_scene(scene, root, configuration)
    frames = [
        row
        for split in load_manifest(root).splits("frames")
        for row in read_rows(root, FrameRow, split, scene=scene, configuration=configuration)
    ]
    if not frames:
        raise DatasetError(f"{root}: no frames of {configuration_name(scene, configuration)}")
    with atomic_path(path) as temporary:
        recording = rerun.RecordingStream(f"remqa-data {scene}", recording_id=f"{scene}-c{configuration}")
        recording.set_log_time_enabled(False)
        recording.save(temporary, default_blueprint=_views(rerun))
        _Walk(rerun, recording, VoxelMap.of_scene(room)).write(sorted(frames, key=lambda row: row.index))
        recording.flush()
        recording.disconnect()
    return len(frames)


def _views(rerun: Any) -> Any:
    """What the viewer shows at first: the room without its walls and ceiling, and what the eye sees."""
    views = importlib.import_module("rerun.blueprint")
    room = views.Spatial3DView(origin="room", contents=["$origin/**", "- $origin/map/structure", "- $origin/eye/depth"])
    eye = "$origin/"
    sight = views.Spatial2DView(origin="room/eye", name="seen", contents=[eye + "rgb", eye + "boxes"])
    depth = views.Spatial2DView(origin="room/eye", name="depth", contents=[eye + "depth"])
    types = views.Spatial2DView(origin="room/eye", name="types", contents=[eye + "types"])
    seen = views.Vertical(sight, views.Horizontal(depth, types))
    return views.Blueprint(views.Horizontal(room, seen, column_shares=[3, 2]), collapse_panels=True)


class _Walk:
    """Writes frames, one after the other; `rerun` is the package."""

    def __init__(self, rerun: Any, recording: Any, voxels: VoxelMap) -> None:
        self._rerun, self._recording, self._voxels = rerun, recording, voxels
        self._classes = {name: number for number, name in enumerate(catalog(), start=1)}
        self._objects: dict[str, VisibleObject] = {}
        self._edges: list[Edge] = []
        self._eyes: list[F64] = []

    def write(self, frames: list[FrameRow]) -> None:
        rerun = self._rerun
        names = [(number, name, type_color(name)) for name, number in self._classes.items()]
        self._log("room", rerun.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        self._log("room/eye", rerun.AnnotationContext(names), static=True)
        for place, frame in enumerate(frames):
            self._recording.set_time(TIMELINE, sequence=frame.index)
            depth = decode_depth(frame.depth.bytes)
            camera = frame.agent.pose().camera_above(frame.agent.position[2], depth.shape[0])
            self._write_sight(frame, depth, camera)
            self._write_graph(frame)
            if place % MAP_EVERY == 0 or frame is frames[-1]:
                self._write_map()

    def _write_sight(self, frame: FrameRow, depth: Any, camera: Camera) -> None:
        rerun, size = self._rerun, depth.shape[::-1]
        right, up, forward = camera.rotation()
        self._eyes.append(np.asarray(camera.position))
        axes = np.column_stack([right, -up, forward])
        self._log("room/eye", rerun.Transform3D(translation=camera.position, mat3x3=axes))
        self._log(
            "room/eye",
            rerun.Pinhole(focal_length=camera.focal_px, resolution=size, image_plane_distance=VIEWED_M),
        )
        numbers, types = decode_instances(frame.instances.bytes).astype(np.int32), [seen.type for seen in frame.objects]
        self._voxels.add(depth, numbers - 1, types, camera)
        classes = np.array([0, *(self._classes[object_type(name).name] for name in types)], dtype=np.uint16)
        self._log("room/eye/rgb", rerun.Image(decode_rgb(frame.rgb.bytes)).compress(jpeg_quality=95))
        self._log("room/eye/depth", rerun.DepthImage(np.rint(depth * 1000).astype(np.uint16), meter=1000.0))
        self._log("room/eye/types", rerun.SegmentationImage(classes[numbers]))
        boxes = np.array([seen.box_2d for seen in frame.objects], dtype=np.float32).reshape(-1, 4)
        self._log(
            "room/eye/boxes",
            rerun.Boxes2D(array=boxes, array_format=rerun.Box2DFormat.XYXY, labels=types, class_ids=classes[1:]),
        )
        self._log("room/path", rerun.LineStrips3D([np.array(self._eyes)]))

    def _write_graph(self, frame: FrameRow) -> None:
        self._objects |= {record.id: record for record in frame.objects if record.id in frame.added_nodes}
        for edge in frame.added_edges:
            for name in (edge.source, edge.target):
                if name not in self._objects:
                    raise DatasetError(f"frame {frame.frame_id}: an edge of {name!r}, which the graph has not got")
        self._edges += frame.added_edges
        rerun, found = self._rerun, list(self._objects.values())
        boxes = np.array([record.box for record in found], dtype=np.float64).reshape(-1, 6)
        middles = {record.id: (box[:3] + box[3:]) / 2 for record, box in zip(found, boxes, strict=True)}
        classes = [self._classes[record.type] for record in found]
        self._log(
            "room/objects",
            rerun.Boxes3D(
                mins=boxes[:, :3],
                sizes=boxes[:, 3:] - boxes[:, :3],
                labels=[record.id for record in found],
                colors=[type_color(record.type) for record in found],
                class_ids=classes,
                show_labels=False,
            ),
        )
        strips = [np.array([middles[edge.source], middles[edge.target]]) for edge in self._edges]
        self._log(
            "room/graph",
            rerun.LineStrips3D(strips, labels=[edge.relation for edge in self._edges], show_labels=False),
        )

    def _write_map(self) -> None:
        sparse = self._voxels.to_sparse()
        voxel_m = self._voxels.voxel_m
        low = np.array([0.0, 0.0, self._voxels.floor_z - FLOOR_SLACK_M])  # where voxel (0, 0, 0) begins
        colors = np.array([type_color(name) for name in sparse.names], dtype=np.uint8).reshape(-1, 3)
        points = low + (sparse.coordinates + 0.5) * voxel_m
        is_structure = np.array([name == STRUCTURE for name in sparse.names])[sparse.labels]
        for name, chosen in (("structure", is_structure), ("objects", ~is_structure)):
            shown = self._rerun.Points3D(points[chosen], colors=colors[sparse.labels[chosen]], radii=voxel_m / 2)
            self._log(f"room/map/{name}", shown)

    def _log(self, entity: str, what: Any, *, static: bool = False) -> None:
        self._recording.log(entity, what, static=static)
