import numpy as np
import pytest

from remqa_data.generators.audit.recount import views
from remqa_data.generators.audit.recount.views import measured_views
from remqa_data.storage.manifest import load_manifest
from remqa_data.tables.images import encode_depth

IDS = ["Drawer|1", "Mug|1", "Book|1"]


def room(**support: str) -> views._Room:
    objects = {
        object_id: {"id": object_id, "type": object_id[:-2], "support": support.get(object_id[:-2])}
        for object_id in IDS
    }
    return views._Room(objects, views._carried(objects))


def seen(mug_column: int, mug_m: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Instances and depth: a wall 3 m away, and a mug."""
    instances, depth = np.zeros((20, 20), np.uint16), np.full((20, 20), 3.0, np.float32)
    instances[5:12, mug_column : mug_column + 5], depth[5:12, mug_column : mug_column + 5] = 2, mug_m
    return instances, depth


def moved(before: tuple[np.ndarray, np.ndarray], after: tuple[np.ndarray, np.ndarray], **support: str) -> list[str]:
    row = {"object_ids": IDS, "target_id": "Drawer|1"}
    row |= {
        "start_depth": {"bytes": encode_depth(before[1]).bytes},
        "end_depth": {"bytes": encode_depth(after[1]).bytes},
    }
    return list(views._moved(row, before[0], after[0], room(**support)))


def test_what_stays_has_not_moved() -> None:
    assert moved(seen(3), seen(3)) == []


def test_what_left_its_pixels_has_moved() -> None:
    assert moved(seen(3), seen(11)) == ["Mug|1"]


def test_what_came_nearer_has_moved() -> None:
    assert moved(seen(3), seen(3, mug_m=0.9)) == ["Mug|1"]


def test_what_lies_in_the_target_may_move_with_it() -> None:
    assert moved(seen(3), seen(11), Mug="Drawer|1") == []
    assert moved(seen(3), seen(11), Mug="Book|1", Book="Drawer|1") == []


def test_what_is_covered_by_something_nearer_has_not_moved() -> None:
    instances, depth = seen(3)
    instances[:, 2:9], depth[:, 2:9] = 1, 0.5
    assert moved(seen(3), (instances, depth)) == []
    assert moved((instances, depth), seen(3)) == []


@pytest.mark.slow
def test_a_real_dataset_is_measured_row_by_row(one_room) -> None:
    found = measured_views(one_room)
    told = load_manifest(one_room).questions
    assert len(found) == sum(n for kinds in told.values() for n in kinds.values()) > 0
    positives = ~found["answer"].isin(["no", "0"])
    assert 0 < positives.sum() < len(found)
    assert (found.loc[positives, "evidence_px"] >= 50).all()
    assert found.loc[~positives, "evidence_px"].isna().all()
    counts = found.loc[found["kind"] == "COUNTING"]
    assert len(counts) > 0
    assert (counts["newly_seen"] == counts["answer"].astype(int)).all()
