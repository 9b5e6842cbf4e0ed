"""Both executors do the same jobs with the same results, whatever dies meanwhile. The Ray cluster is one of three nodes."""

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest

from remqa_data.errors import ArrangementError, ClusterError, ConfigError, UnknownNameError, WorkersLostError
from remqa_data.generators.config import load_config
from remqa_data.generators.pipeline import generate, make_part
from remqa_data.processes.executors import Executor, LocalExecutor, RayExecutor, make_executor
from tests.helpers import executor_jobs as jobs
from tests.helpers.crash_run import made_up_part, run_here
from tests.helpers.damaged_files import files_of

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    """A head without CPUs, and two nodes with one CPU each."""
    ray = pytest.importorskip("ray")
    from ray.cluster_utils import Cluster

    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[2]))
        monkeypatch.setenv("RAY_USAGE_STATS_ENABLED", "0")
        # Whether a node lives is asked every .3 s, not every 3 s; five times nothing, and it counts as dead.
        monkeypatch.setenv("RAY_health_check_period_ms", "300")
        cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 0})
        for _ in range(2):
            cluster.add_node(num_cpus=1)
        yield cluster
        ray.shutdown()
        cluster.shutdown()


@pytest.fixture(params=["one process", "two processes", "ray"])
def executor(request: pytest.FixtureRequest) -> Executor:
    if request.param == "ray":
        return make_executor("ray", ray_address=request.getfixturevalue("cluster").address)
    return make_executor("local", 1 if request.param == "one process" else 2)


def test_every_job_is_done(executor: Executor) -> None:
    assert dict(executor.run(jobs.square, range(40))) == {n: n * n for n in range(40)}
    assert list(executor.run(jobs.square, [])) == []


def test_an_error_of_a_job_is_raised_as_it_is(executor: Executor) -> None:
    with pytest.raises(UnknownNameError, match=r"unknown scene 'FloorPlan0'; did you mean 'FloorPlan1'\?"):
        list(executor.run(jobs.refuse, range(10)))
    with pytest.raises(ArrangementError) as caught:
        list(executor.run(jobs.refuse_at_a_place, [0]))
    assert (caught.value.place_id, caught.value.relation, caught.value.types) == ("Drawer|1", "in", ("Mug",))


def test_a_run_can_be_given_up(executor: Executor) -> None:
    results = executor.run(jobs.square, range(1000))
    assert next(results) is not None
    results.close()  # type: ignore[attr-defined]
    assert dict(executor.run(jobs.square, [3])) == {3: 9}


def test_a_single_worker_is_this_process() -> None:
    assert dict(LocalExecutor(1).run(jobs.process_id, [0])) == {0: os.getpid()}
    others = {pid for _, pid in LocalExecutor(2).run(jobs.process_id, range(10))}
    assert len(others) == 2
    assert os.getpid() not in others


@pytest.mark.parametrize("name", ["local", "ray"])
def test_what_a_dead_process_was_doing_is_done_again(name: str, cluster: Any, tmp_path: Path) -> None:
    flags = [tmp_path / str(n) for n in range(6)]
    for flag in flags[:2] + flags[3:]:
        flag.touch()  # only the third dies
    executor = make_executor("ray", None, cluster.address) if name == "ray" else make_executor("local", 2)
    assert {result for _, result in executor.run(jobs.die_the_first_time, flags)} == set("012345")


def test_a_process_that_always_dies_is_an_error() -> None:
    with pytest.raises(WorkersLostError, match="died 3 times with 2 jobs to do"):
        list(LocalExecutor(2).run(jobs.die, range(2)))


def test_a_node_that_dies_loses_nothing(cluster: Any, tmp_path: Path) -> None:
    executor = RayExecutor(cluster.address)
    paths = [tmp_path / str(number) for number in range(8)]
    done = executor.run(jobs.write_slowly, paths)
    nodes = [next(done)[1] for _ in range(4)]
    victim = next(node for node in cluster.list_all_nodes() if node.node_id == nodes[-1])
    cluster.remove_node(victim, allow_graceful=False)
    try:
        nodes += [node for _, node in done]
    finally:
        cluster.add_node(num_cpus=1)
    assert len(nodes) == 8
    assert all(path.read_text() for path in paths)


class MadeUpRooms(RayExecutor):
    """Does all jobs as they are, but for rooms."""

    def run(self, work: Any, jobs: Sequence[Any]) -> Iterator[tuple[Any, Any]]:
        return super().run(made_up_part if work is make_part else work, jobs)


def test_a_cluster_makes_the_same_bytes_though_a_node_dies(cluster: Any, tmp_path: Path) -> None:
    code, text = run_here(tmp_path / "here", "--config", "tiny", scenes=4)
    assert code == 0, text
    config = load_config("tiny").with_scenes(4)
    victim = next(node for node in cluster.list_all_nodes() if node is not cluster.head_node)
    told: list[str] = []

    def on_room(scene: str, report: object) -> None:
        told.append(scene)
        if len(told) == 1:
            cluster.remove_node(victim, allow_graceful=False)

    try:
        generate(tmp_path / "cluster", config, MadeUpRooms(cluster.address), on_room)
    finally:
        cluster.add_node(num_cpus=1)
    assert sorted(told) == sorted(config.scene_names)
    assert files_of(tmp_path / "cluster") == files_of(tmp_path / "here")


@pytest.mark.parametrize(
    ("name", "workers", "address", "message"),
    [
        ("locl", None, None, "no executor 'locl'; use local or ray"),
        ("local", 1, "auto", "--ray-address is for --executor ray"),
        ("ray", 2, None, "--workers is for --executor local"),
        ("local", 10**6, None, "--workers 1000000: there are"),
    ],
)
def test_what_cannot_be_is_told(name: str, workers: int | None, address: str | None, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        make_executor(name, workers, address)


def test_a_cluster_that_is_not_there_is_told() -> None:
    import ray

    ray.shutdown()
    with pytest.raises(ClusterError, match=r"Ray cluster 127\.0\.0\.1:1: "):
        RayExecutor("127.0.0.1:1")
