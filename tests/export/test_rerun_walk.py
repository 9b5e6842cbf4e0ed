"""What Rerun's own reader finds in the recording of a walk."""

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from remqa_data.errors import DatasetError, OutputError, RemqaError
from remqa_data.export.rerun_walk import MAP_EVERY, TIMELINE, write_walk
from remqa_data.storage.shards import read_rows
from remqa_data.tables.images import decode_rgb
from remqa_data.tables.rows import FrameRow, SceneRow

pytestmark = pytest.mark.slow

INSIDE_M = 0.05


@pytest.fixture(scope="module")
def room(one_room) -> SceneRow:
    return next(read_rows(one_room, SceneRow, "test"))


@pytest.fixture(scope="module")
def frames(one_room, room) -> list[FrameRow]:
    rows = read_rows(one_room, FrameRow, "test", scene=room.scene, configuration=room.configuration)
    return sorted(rows, key=lambda row: row.index)


@pytest.fixture(scope="module")
def written(one_room, room, frames, tmp_path_factory) -> dict[str, dict[int, dict[str, Any]]]:
    """By entity and frame the components that were logged."""
    chunk = pytest.importorskip("rerun.chunk")
    path = tmp_path_factory.mktemp("rerun") / "walk.RRD"
    assert write_walk(one_room, room.scene, path, room.configuration) == len(frames)
    logged: dict[str, dict[int, dict[str, Any]]] = {}
    for piece in chunk.RrdReader(path).stream():
        for row in piece.to_record_batch().to_pylist():
            if TIMELINE in row:
                of_frame = logged.setdefault(piece.entity_path, {}).setdefault(row[TIMELINE], {})
                of_frame.update({name: value for name, value in row.items() if ":" in name})
    return logged


def test_every_frame_is_there_and_the_map_after_some(written, frames) -> None:
    indices = [frame.index for frame in frames]
    for entity in ("/room/eye/rgb", "/room/eye/depth", "/room/eye/types", "/room/eye/boxes", "/room/path", "/room/eye"):
        assert sorted(written[entity]) == indices
    assert sorted(written["/room/map/objects"]) == sorted({*indices[::MAP_EVERY], indices[-1]})


def test_pictures_and_boxes_are_those_of_the_rows(written, frames) -> None:
    assert frames
    for frame in frames:
        blob = bytes(written["/room/eye/rgb"][frame.index]["EncodedImage:blob"][0])
        shown = cv2.imdecode(np.frombuffer(blob, np.uint8), cv2.IMREAD_COLOR)[:, :, ::-1]
        assert np.abs(shown.astype(int) - decode_rgb(frame.rgb.bytes)).mean() < 3
        boxes = written["/room/eye/boxes"][frame.index]
        low = np.array(boxes["Boxes2D:centers"]) - np.array(boxes["Boxes2D:half_sizes"])
        assert np.array_equal(low, np.array([seen.box_2d[:2] for seen in frame.objects]))


def test_the_graph_grows_to_that_of_the_room(written, frames, room) -> None:
    counts = [len(written["/room/objects"][frame.index]["Boxes3D:labels"]) for frame in frames]
    assert counts == sorted(counts)
    last = frames[-1].index
    assert set(written["/room/objects"][last]["Boxes3D:labels"]) == set(room.graph_nodes)
    assert len(written["/room/graph"][last]["LineStrips3D:strips"]) == len(room.graph_edges)


def test_the_map_lies_where_the_objects_are(written, frames) -> None:
    last = frames[-1].index
    points = np.array(written["/room/map/objects"][last]["Points3D:positions"])
    boxes = written["/room/objects"][last]
    centers, halves = (np.array(boxes[f"Boxes3D:{name}"]) for name in ("centers", "half_sizes"))
    is_near = np.abs(points[:, None] - centers[None]) <= halves[None] + INSIDE_M
    assert is_near.all(axis=2).any(axis=1).mean() > 0.95


def test_an_eye_looks_at_what_its_picture_shows(written, frames) -> None:
    checked = 0
    for frame in frames:
        eye = written["/room/eye"][frame.index]
        turn = np.array(eye["Transform3D:mat3x3"][0]).reshape(3, 3).T  # Rerun keeps columns
        focal = np.array(eye["Pinhole:image_from_camera"][0]).reshape(3, 3).T
        for seen in frame.objects:
            middle = (np.array(seen.box[:3]) + seen.box[3:]) / 2
            x, y, depth = focal @ turn.T @ (middle - np.array(eye["Transform3D:translation"][0]))
            size = max(np.array(seen.box[3:]) - seen.box[:3])
            x1, y1, x2, y2 = seen.box_2d
            if size < 0.3 and depth > 0.5 and x1 > 10 and x2 < 290 and y1 > 10 and y2 < 290:
                assert x1 - 8 <= x / depth <= x2 + 8
                assert y1 - 8 <= y / depth <= y2 + 8
                checked += 1
    assert checked > 10


def test_rooms_and_configurations_that_are_not_there(one_room, room, tmp_path: Path) -> None:
    pytest.importorskip("rerun")
    with pytest.raises(RemqaError, match="FloorPlan9"):
        write_walk(one_room, "FloorPlan9999", tmp_path / "walk.rrd")
    with pytest.raises(DatasetError, match="99"):
        write_walk(one_room, room.scene, tmp_path / "walk.rrd", configuration=99)
    assert not list(tmp_path.iterdir())


def test_a_recording_is_called_one(finished, tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"give a name that ends with \.rrd"):
        write_walk(finished[0], "Kitchen1", tmp_path / "walk.txt")
