"""The map that a detector makes: with one that tells the truth it is the room."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from remqa_data.agents.knowledge.memory import Look, WalkMemories, WalkMemory
from remqa_data.agents.knowledge.predicted_memory import RoomMap
from remqa_data.agents.knowledge.reading import read_question
from remqa_data.agents.networks.detection.detector import Detector, Peaks, Voted
from remqa_data.agents.networks.detection.pyramid import STRIDE
from remqa_data.agents.parts.predicted_navigator import PredictedMapNavigator
from remqa_data.geometry.boxes import iou_3d
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.render.camera import Camera
from remqa_data.storage.shards import read_rows
from remqa_data.tables.images import decode_instances, decode_rgb
from remqa_data.tables.rows import FrameRow


class Truthful(Detector):
    """Says what the dataset knows of its frames."""

    def __init__(self, root: Path, types: tuple[str, ...]) -> None:
        super().__init__(len(types))
        self.known: dict[bytes, tuple[Peaks, np.ndarray]] = {}
        for row in read_rows(root, FrameRow, "test"):
            shown = decode_instances(row.instances.bytes)[::STRIDE, ::STRIDE].astype(int)
            kinds = np.array([0, *(types.index(thing.type) + 1 for thing in row.objects)])
            boxes = np.array([thing.box_2d for thing in row.objects], dtype=np.float32)
            votes = np.eye(len(types), dtype=np.float32)[kinds[1:] - 1]
            self.known[decode_rgb(row.rgb.bytes).tobytes()] = Peaks(boxes, votes), kinds[shown]

    def vote(self, rgb: torch.Tensor) -> Voted:
        (picture,) = rgb
        peaks, cells = self.known[picture.permute(1, 2, 0).numpy().tobytes()]
        return Voted([peaks], cells[None])


@pytest.fixture(scope="module")
def walked(one_room: Path) -> tuple[Path, WalkMemory, tuple[str, ...]]:
    types = sorted({thing.type for row in read_rows(one_room, FrameRow, "test") for thing in row.objects})
    return one_room, WalkMemories(one_room, "test").memory("FloorPlan27", 0), tuple(types)


@pytest.mark.slow
def test_objects_are_where_they_are(walked: tuple[Path, WalkMemory, tuple[str, ...]]) -> None:
    root, memory, types = walked
    room = RoomMap(Truthful(root, types), types, memory.body, memory.plan.floor_z)
    assert memory.looks is not None
    for look in memory.looks():
        room.add(look)
    found = room.memory()
    large = [one for one in memory.graph.objects.values() if min(np.subtract(one.box[3:], one.box[:3])) > 0.2]
    assert len(large) >= 8
    others = list(found.graph.objects.values())
    is_alike = np.array([[one.type == other.type for other in others] for one in large])
    ious = np.where(is_alike, iou_3d([one.box for one in large], [other.box for other in others]), 0.0).max(axis=1)
    assert np.mean(ious > 0.3) > 0.6, dict(zip([one.id for one in large], ious.tolist(), strict=True))
    both = _both(memory, found)
    assert np.mean(both[0] == both[1]) > 0.98  # geometry comes from depth


def _both(memory: WalkMemory, found: WalkMemory) -> tuple[np.ndarray, np.ndarray]:
    """Whether the columns that both know are occupied."""
    corner = np.maximum(memory.plan.corner, found.plan.corner)
    end = np.minimum(*(np.add(one.plan.corner, one.plan.known.shape) for one in (memory, found)))
    first, second = (
        tuple(slice(a, b) for a, b in zip(corner - one.plan.corner, end - one.plan.corner, strict=True))
        for one in (memory, found)
    )
    is_known = memory.plan.known[first] & found.plan.known[second]
    assert is_known.sum() > 100
    return memory.plan.occupied[first][is_known], found.plan.occupied[second][is_known]


@pytest.mark.slow
def test_who_makes_its_map_itself_needs_no_labels_of_the_walk(walked: tuple[Path, WalkMemory, tuple[str, ...]]) -> None:
    root, memory, types = walked
    unlabelled = replace(
        memory,
        graph=SceneGraph(),
        labels=np.full_like(memory.labels, -1),
        plan=replace(memory.plan, labels=np.full_like(memory.plan.labels, -1), names=("structure",)),
    )
    asked, rng = read_question("Is there a mug in the fridge?"), np.random.default_rng(0)
    walkers = [
        PredictedMapNavigator(Truthful(root, types), types).begin(asked, one, rng) for one in (memory, unlabelled)
    ]
    assert walkers[0].instance == walkers[1].instance
    assert walkers[0].instance is not None
    assert walkers[0].memory.graph.objects == walkers[1].memory.graph.objects


def test_a_map_grows_to_what_is_seen_and_keeps_what_it_knew() -> None:
    room = RoomMap(Detector(2), ("Fridge", "Mug"), AGENT, 0.0)
    for yaw in (0.0, 90.0, 180.0):
        camera = Camera((0.0, 0.0, 1.5), yaw)
        rows = np.arange(300)[:, None] + np.zeros((1, 300))
        floor = 1.5 * camera.focal_px / np.maximum(rows - 149.5, 1e-3)
        room.add_shape(Look(np.zeros((300, 300, 3), np.uint8), np.minimum(floor, 3.0).astype(np.float32), camera))
    plan = room.memory([(0, 0)]).plan

    def column(x: float, y: float) -> tuple[int, int]:
        return round(x / plan.voxel_m) - plan.corner[0], round(y / plan.voxel_m) - plan.corner[1]

    walls = [(3.0, 0.0), (0.0, 3.0), (-3.0, 0.0)]
    for place in [(2.0, 0.0), (0.2, 0.2), *walls]:
        assert plan.known[column(*place)], place
        assert bool(plan.occupied[column(*place)]) == (place in walls), place
    behind = column(0.0, -1.5)
    assert behind[1] < 0 or not plan.known[behind]
