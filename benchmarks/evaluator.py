"""The evaluator's speed: a million navigation rows without replay, IoU beside pycocotools, questions replayed per second.

`python benchmarks/evaluator.py [DATASET]`, on an idle machine; replays are timed only if a dataset is given.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from measure import Benchmark, Facts, Headline, Table, median_ms, number

from remqa_data.evaluation.scoring.ground_truth import GroundTruth, load_ground_truth
from remqa_data.evaluation.scoring.scoring import score
from remqa_data.evaluation.submission.parquet_rows import METADATA_KEY
from remqa_data.evaluation.submission.reader import Header, open_submission, write_submission
from remqa_data.evaluation.submission.reference import reference_rows
from remqa_data.metrics import box_iou
from remqa_data.storage.manifest import make_manifest

ROWS, JSON_ROWS, POSES, BOXES, REPEATS = 1_000_000, 100_000, 8, 1000, 15
SCORE = "--score"


def measure(arguments: list[str]) -> Facts:
    """Score rows, compare boxes, and replay if there is a dataset."""
    facts: Facts = {"rows": rows_without_replay(), "iou_ms": iou_beside_pycocotools()}
    return facts | ({"replay": replay(Path(arguments[0]))} if arguments else {})


def table(facts: Facts) -> Table:
    """All figures."""
    rows = []
    for form, scored in facts["rows"].items():
        what = f"{scored['rows']:,} navigation rows of {POSES} poses, {form}"
        rows.append((f"{what}: s of one core", number(scored["seconds"])))
        rows.append((f"{what}: peak memory, GB", number(scored["peak_gb"])))
    for whose, ms in facts["iou_ms"].items():
        rows.append((f"IoU of {BOXES:,} x {BOXES:,} boxes, {whose}: ms", number(ms)))
    if "replay" in facts:
        replayed = facts["replay"]
        rows.append((f"{replayed['questions']} questions replayed by 2 workers: s", number(replayed["seconds"])))
    return Table("The evaluator", ("what", "measured"), rows)


def headlines(facts: Facts) -> list[Headline]:
    """Rows without replay, IoU, replays."""
    rows, iou_ms = facts["rows"]["Parquet"], facts["iou_ms"]
    found = [
        Headline("a million navigation rows, no replay", rows["seconds"], "s of one core", at_most=5),
        Headline("the same, peak memory", rows["peak_gb"], "GB", at_most=1),
        Headline("the same, rows", rows["rows"] / rows["seconds"], "rows/s"),
        Headline("pycocotools, IoU of boxes", iou_ms["pycocotools"] / iou_ms["ours"], "x our time", at_least=1),
    ]
    if "replay" in facts:
        replayed = facts["replay"]
        what = f"replay of {replayed['questions']} test questions, 2 workers"
        found.append(Headline(what, replayed["seconds"], "s", at_most=60))
    return found


def rows_without_replay() -> dict[str, dict[str, float]]:
    """Cost of scoring a million rows of Parquet, or fewer of JSON, in a fresh process on one core."""
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        asked, claimed = million_rows()
        pq.write_table(asked, Path(folder) / "asked.parquet")
        about = Header(track="nav", split="test").model_dump_json(exclude_none=True)
        pq.write_table(claimed.replace_schema_metadata({METADATA_KEY: about}), Path(folder) / "rows.parquet")
        with (Path(folder) / "rows.jsonl").open("w") as lines:
            lines.write(about + "\n")
            for batch in claimed.slice(0, JSON_ROWS).to_batches(10_000):
                lines.writelines(json.dumps(row) + "\n" for row in batch.to_pylist())
        for form, file, rows in (("Parquet", "rows.parquet", ROWS), ("JSON", "rows.jsonl", JSON_ROWS)):
            command = [sys.executable, __file__, SCORE, f"{folder}/asked.parquet", f"{folder}/{file}"]
            done = subprocess.run(command, check=True, capture_output=True, text=True)
            found[form] = {"rows": rows, **json.loads(done.stdout)}
    return found


def million_rows() -> tuple[pa.Table, pa.Table]:
    """Questions as `GroundTruth` has them, and claimed walks."""
    rng = np.random.default_rng(0)
    ids = pa.array([f"FloorPlan{i // 1000}-EXISTENCE-{i % 1000:03}-c0" for i in range(ROWS)])
    starts = np.round(rng.uniform(-3, 3, (ROWS, 2)) * 4) / 4
    goals = starts + rng.integers(-8, 9, (ROWS, 2)) / 4
    angles = {"yaw_deg": pa.array(np.zeros(ROWS)), "horizon_deg": pa.array(np.zeros(ROWS))}
    asked = pa.table(
        {
            "question_id": ids,
            "initial_pose": poses(starts, angles),
            "goal_poses": pa.ListArray.from_arrays(np.arange(ROWS + 1, dtype=np.int32), poses(goals, angles)),
            "path_length_m": np.abs(goals - starts).sum(axis=1),
        }
    )
    share = np.linspace(0, 1, POSES)[:, None]
    ways = starts[:, None] + share * (goals - starts)[:, None]
    numbers = np.concatenate([ways, np.zeros((ROWS, POSES, 2))], axis=2)
    of_four = pa.ListArray.from_arrays(np.arange(0, numbers.size + 1, 4, dtype=np.int32), pa.array(numbers.ravel()))
    boxes = np.tile([10.0, 10.0, 50.0, 50.0], ROWS)
    claimed = pa.table(
        {
            "question_id": ids,
            "poses": pa.ListArray.from_arrays(np.arange(0, ROWS * POSES + 1, POSES, dtype=np.int32), of_four),
            "target_box": pa.ListArray.from_arrays(np.arange(0, 4 * ROWS + 1, 4, dtype=np.int32), pa.array(boxes)),
        }
    )
    return asked, claimed.take(rng.permutation(ROWS))


def poses(positions: np.ndarray, angles: dict[str, pa.Array]) -> pa.StructArray:
    """Agent states on a floor at 0."""
    flat = np.column_stack([positions, np.zeros(len(positions))]).ravel()
    lists = pa.ListArray.from_arrays(np.arange(0, len(flat) + 1, 3, dtype=np.int32), pa.array(flat))
    return pa.StructArray.from_arrays([lists, *angles.values()], ["position", *angles])


def score_rows(asked: Path, rows: Path) -> dict[str, float]:
    """Score a file; the questions are in memory before the clock starts."""
    manifest = make_manifest((), seed=0, config={}, questions={}, refused={})
    truth = GroundTruth(Path("."), "nav", "test", manifest, pq.read_table(asked))
    started = time.process_time()
    scores = score(open_submission(rows), truth, replay=False)
    seconds = time.process_time() - started
    assert scores.measures["success@25"].sum() == scores.answered.sum() > 0
    status = Path("/proc/self/status").read_text()  # getrusage would give the parent's peak if that is higher
    return {"seconds": seconds, "peak_gb": int(status.split("VmHWM:")[1].split()[0]) / 1e6}


def iou_beside_pycocotools() -> dict[str, float]:
    """Milliseconds for all pairs of a thousand boxes with a thousand others."""
    from pycocotools import mask

    rng = np.random.default_rng(0)
    corners = rng.uniform(0, 300, (2, BOXES, 2))
    sizes = rng.uniform(0, 150, (2, BOXES, 2))
    first, second = np.concatenate([corners, corners + sizes], axis=2)
    widths, others = np.concatenate([corners, sizes], axis=2)
    crowd = [0] * BOXES
    ours, theirs = box_iou(first[:, None], second), mask.iou(widths, others, crowd)
    assert np.abs(ours - theirs).max() < 1e-12
    return {
        "ours": median_ms([lambda: box_iou(first[:, None], second)] * REPEATS),
        "pycocotools": median_ms([lambda: mask.iou(widths, others, crowd)] * REPEATS),
    }


def replay(root: Path) -> dict[str, float]:
    """Seconds to replay the oracle on the test split, with two workers, from the start of the processes."""
    rows = reference_rows("oracle", root, "remqa", "test", np.random.default_rng(0))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "oracle.jsonl"
        write_submission(path, Header(track="remqa", split="test"), rows)
        truth = load_ground_truth(root, "remqa", "test")
        started = time.perf_counter()
        scores = score(open_submission(path), truth, workers=2)
        seconds = time.perf_counter() - started
    assert scores.measures["S_MQA"].all()
    return {"questions": len(rows), "seconds": seconds}


BENCHMARK = Benchmark("evaluator", measure, table, headlines)

if __name__ == "__main__":
    if sys.argv[1:2] == [SCORE]:  # a process of its own, whose peak memory is that of scoring
        print(json.dumps(score_rows(Path(sys.argv[2]), Path(sys.argv[3]))))
    else:
        BENCHMARK.main()
