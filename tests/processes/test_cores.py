import os
from pathlib import Path

import pytest

from remqa_data.errors import ConfigError
from remqa_data.processes import cores
from remqa_data.processes.cores import MOST_WORKERS_PER_CORE, usable_cores, worker_count


def written(root: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    return root


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="no affinity here")
def test_cores_are_those_that_the_process_is_bound_to():
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(before)})
    try:
        assert usable_cores() == 1
    finally:
        os.sched_setaffinity(0, before)


@pytest.mark.parametrize(
    ("files", "share"),
    [
        ({}, float("inf")),
        ({"sys/fs/cgroup/cpu.max": "max 100000\n"}, float("inf")),
        ({"sys/fs/cgroup/cpu.max": "150000 100000\n"}, 1.5),
        ({"proc/self/cgroup": "0::/a/b\n", "sys/fs/cgroup/a/b/cpu.max": "200000 100000\n"}, 2.0),
        ({"proc/self/cgroup": "0::/a/b\n", "sys/fs/cgroup/a/cpu.max": "50000 100000\n"}, 0.5),
        (
            {"sys/fs/cgroup/cpu/cpu.cfs_quota_us": "-1\n", "sys/fs/cgroup/cpu/cpu.cfs_period_us": "100000\n"},
            float("inf"),
        ),
        ({"sys/fs/cgroup/cpu/cpu.cfs_quota_us": "300000\n", "sys/fs/cgroup/cpu/cpu.cfs_period_us": "100000\n"}, 3.0),
        ({"sys/fs/cgroup/cpu.max": "nonsense"}, float("inf")),
    ],
)
def test_a_control_group_gives_so_many_cores(files, share, tmp_path):
    assert cores._quota_of_cores(written(tmp_path, files)) == share


def test_a_quota_of_less_than_a_core_is_one_worker(monkeypatch):
    monkeypatch.setattr(cores, "_quota_of_cores", lambda root: 0.3)
    assert worker_count(None) == 1


def test_more_workers_than_are_of_use_are_refused():
    most = MOST_WORKERS_PER_CORE * usable_cores()
    assert worker_count(most) == most
    with pytest.raises(ConfigError, match=f"give at most {most}"):
        worker_count(1_000_000)
