"""How many processes are of use: the cores of this machine that this process may use."""

from __future__ import annotations

import math
import os
from contextlib import suppress
from pathlib import Path

from remqa_data.errors import ConfigError

MOST_WORKERS_PER_CORE = 32
"""More only wait for one another, and each takes half a gigabyte."""


def usable_cores() -> int:
    """How many cores this process may use: those it is bound to, and no more than its control group has time on."""
    bound = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return max(1, math.ceil(min(bound, _quota_of_cores(Path("/")))))


def worker_count(wanted: int | None) -> int:
    """How many processes to use: as many as wanted, by default one for each core.

    Raises
    ------
    ConfigError
        If so many are of no use.
    """
    cores = usable_cores()
    if wanted is not None and wanted > MOST_WORKERS_PER_CORE * cores:
        raise ConfigError(
            f"--workers {wanted}: there are {cores} cores to use; give at most {MOST_WORKERS_PER_CORE * cores}"
        )
    return wanted or cores


def _quota_of_cores(root: Path) -> float:
    """The cores that control groups, version 1 or 2, give this process time on; inf if they do not limit it."""
    groups = root / "sys/fs/cgroup"
    own = ""
    with suppress(OSError):
        lines = (root / "proc/self/cgroup").read_text().splitlines()
        own = next((line.removeprefix("0::/") for line in lines if line.startswith("0::/")), "")
    folders = [groups / own, *(groups / own).parents]
    quotas = [_share(folder / "cpu.max") for folder in folders[: len(folders) - len(groups.parents)]]
    return min([*quotas, _share(groups / "cpu/cpu.cfs_quota_us", groups / "cpu/cpu.cfs_period_us")])


def _share(*files: Path) -> float:
    """Quota by period: two numbers of one file or of two; inf if there are none."""
    try:
        quota, period = " ".join(file.read_text() for file in files).split()
        return float(quota) / float(period) if float(quota) > 0 else math.inf
    except (OSError, ValueError, ZeroDivisionError):  # "max" is no number
        return math.inf
