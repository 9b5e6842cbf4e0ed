"""Everything that reads a dataset, and what comes of it when the dataset is forged: in how much time and memory."""

from __future__ import annotations

import os
import resource
import tempfile
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path

from remqa_data.errors import RemqaError
from tests.helpers.fork_server import FORK_SERVER

CPU_S, WALL_S = 20, 120
MEMORY_BYTES = 2 << 30


def read_questions(root: Path) -> None:
    from remqa_data.datasets.torch_datasets import RemqaDataset, collate

    rows = RemqaDataset(root, "test")
    collate([rows[i] for i in range(min(4, len(rows)))])


def read_frames(root: Path) -> None:
    from remqa_data.datasets.torch_datasets import FrameDataset, collate

    rows = FrameDataset(root, "test")
    collate([rows[i] for i in range(min(4, len(rows)))])


def read_expressions(root: Path) -> None:
    from remqa_data.datasets.torch_datasets import ExpressionDataset, collate

    rows = ExpressionDataset(root, "test", images=("rgb", "depth", "instances"))
    collate([rows[i] for i in range(min(4, len(rows)))])


def read_rows_(root: Path) -> None:
    from remqa_data.tables.schema import TABLES

    for table in TABLES:
        read_rows_of(table, root)


def read_rows_of(table: str, root: Path) -> None:
    from remqa_data.storage.manifest import load_manifest
    from remqa_data.storage.shards import read_rows
    from remqa_data.tables.schema import TABLES

    for split in load_manifest(root).splits(table):
        for _ in read_rows(root, TABLES[table].row_type, split):
            pass


def play_in_env(root: Path) -> None:
    from remqa_data.datasets.vocabulary import Vocabulary
    from remqa_data.env import RemqaEnv
    from remqa_data.env.oracle import oracle_commands

    vocabulary = Vocabulary.build((), ())  # there may be no train split
    env = RemqaEnv(root, "test", privileged=True, render_mode="rgb_array", vocabulary=vocabulary)
    try:
        env.reset(seed=0, options={"episode": env.episode_ids[0]})
        assert env.episode.task is not None
        for command in oracle_commands(env.episode.task)[-4:]:
            env.step(command)
        env.render()
    finally:
        env.close()


def evaluate(root: Path, track: str = "remqa") -> None:
    """As `remqa-eval` does: the oracle's submission, its scores, and the report."""
    import numpy as np

    from remqa_data.evaluation.report.html import write_report
    from remqa_data.evaluation.scoring.ground_truth import load_ground_truth
    from remqa_data.evaluation.scoring.results import make_results
    from remqa_data.evaluation.scoring.scoring import score
    from remqa_data.evaluation.submission.reader import Header, open_submission, write_submission
    from remqa_data.evaluation.submission.reference import reference_rows

    path = root / "oracle.jsonl"
    rows = reference_rows("oracle", root, track, "test", np.random.default_rng(0))  # type: ignore[arg-type]
    write_submission(path, Header(track=track, split="test"), rows[:2])  # type: ignore[arg-type]
    submission = open_submission(path)
    truth = load_ground_truth(root, track, "test")  # type: ignore[arg-type]
    results = make_results(submission, truth, score(submission, truth))
    write_report(root / "report.html", results, submission, truth)


def evaluate_expressions(root: Path) -> None:
    evaluate(root, "rec")


def show(root: Path) -> None:
    from remqa_data.generators.figures.sample_picture import write_sample_picture
    from remqa_data.storage.shards import read_table

    first = read_table(root, "questions", "test", ["question_id"])["question_id"][0].as_py()
    write_sample_picture(root, first, root / "sample.png")


def film(root: Path) -> None:
    from remqa_data.env.video import write_film
    from remqa_data.storage.shards import read_table

    first = read_table(root, "questions", "test", ["question_id"])["question_id"][0].as_py()
    write_film(root, first, root / "film.mp4")


def check(root: Path) -> None:
    from remqa_data.generators.audit.verify import verify

    verify(root, sample=1)


def count_again(root: Path) -> None:
    from remqa_data.generators.audit.recount.report import recount

    recount(root)


def browse(root: Path) -> None:
    """Every page and picture, as files."""
    from remqa_data.browse.dataset import BrowsedDataset
    from remqa_data.browse.export import write_site
    from remqa_data.browse.site import Site

    site = Site(BrowsedDataset(root), is_static=True)
    write_site(site, Path(tempfile.mkdtemp(dir=root.parent)))


def write_for_detectors(root: Path) -> None:
    from remqa_data.export.coco import write_coco

    write_coco(root, Path(tempfile.mkdtemp(dir=root.parent)))


def record_walk(root: Path) -> None:
    from remqa_data.export.rerun_walk import write_walk
    from remqa_data.storage.shards import read_table

    scene = read_table(root, "scenes", "test", ["scene"])["scene"][0].as_py()
    write_walk(root, scene, Path(tempfile.mkdtemp(dir=root.parent)) / "walk.rrd")


QUICK: dict[str, Callable[[Path], None]] = {
    "rows": read_rows_,
    "RemqaDataset": read_questions,
    "FrameDataset": read_frames,
    "ExpressionDataset": read_expressions,
}
"""Only reading."""
SLOW: dict[str, Callable[[Path], None]] = {
    "env": play_in_env,
    "eval": evaluate,
    "eval rec": evaluate_expressions,
    "show": show,
    "play": film,
    "verify": check,
    "recount": count_again,
    "browse": browse,
    "coco": write_for_detectors,
    "rerun": record_walk,
}
"""What simulates rooms, and what shows, counts or writes for others what a real dataset holds."""
READERS = QUICK | SLOW


def read_for_ever(root: Path) -> None:
    """A reader that must be stopped."""
    while True:
        pass


def read_to_death(root: Path) -> None:
    """A reader that ends its process."""
    os._exit(7)


def read_wrongly(root: Path) -> None:
    """A reader with a mistake."""
    raise KeyError(root.name)


@dataclass(frozen=True)
class Outcome:
    """What came of one reading: "whole", "refused" (an error on purpose), "raw" (any other) or "killed"."""

    kind: str
    said: str
    cpu_s: float
    peak_bytes: int

    @property
    def held(self) -> bool:
        """Whether this is what is promised."""
        return self.kind in ("whole", "refused") and self.cpu_s < CPU_S and self.peak_bytes < MEMORY_BYTES


class ReadingProcess:
    """A process that reads one dataset after the other; where it takes too long, dies or grows, another one takes over."""

    def __init__(self) -> None:
        self._start()

    def attempt(self, reader: Callable[[Path], None], root: Path) -> Outcome:
        """Read a dataset."""
        self._pipe.send((reader, root))
        try:
            outcome = self._pipe.recv() if self._pipe.poll(WALL_S) else _KILLED
        except EOFError:
            outcome = _KILLED
        if not outcome.held:
            self.close()
            self._start()
        return outcome

    def close(self) -> None:
        """End it."""
        self._process.kill()
        self._process.join()
        self._pipe.close()

    def _start(self) -> None:
        self._pipe, other = FORK_SERVER.Pipe()
        self._process = FORK_SERVER.Process(target=_serve, args=(other,), daemon=True)
        self._process.start()
        other.close()


_KILLED = Outcome("killed", "", CPU_S, 0)


def _serve(pipe: Connection) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (6 << 30, 6 << 30))
    while True:
        reader, root = pipe.recv()
        began_s = _cpu_s()
        resource.setrlimit(resource.RLIMIT_CPU, (int(began_s) + CPU_S + 5, resource.RLIM_INFINITY))
        kind, said = "whole", ""
        try:
            reader(root)
        except (RemqaError, OSError) as error:
            kind, said = "refused", str(error)
        except BaseException:
            kind, said = "raw", traceback.format_exc()
        peak_bytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
        pipe.send(Outcome(kind, said, _cpu_s() - began_s, peak_bytes))


def _cpu_s() -> float:
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime
