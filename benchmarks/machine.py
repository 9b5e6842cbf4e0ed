"""On what something was measured, and what else that machine did meanwhile."""

from __future__ import annotations

import os
import platform
import resource
import subprocess
import time
from dataclasses import dataclass, field
from importlib import metadata
from pathlib import Path

import psutil

PACKAGES = ("numpy", "numba", "pyarrow", "opencv-python-headless", "pybullet", "torch")
BUSY = ("user", "nice", "system", "irq", "softirq", "steal")
"""What psutil calls the time in which a core does not idle; "steal" is what other virtual machines took."""


@dataclass(frozen=True)
class Machine:
    """What figures depend on besides the code."""

    cpu: str
    cores: int
    """Those that this process may use."""
    memory_gb: float
    system: str
    python: str
    packages: dict[str, str]
    commit: str | None
    """None outside a checkout; ends with -dirty if files were changed since."""
    load_average: float
    """Of the minute before."""


def machine() -> Machine:
    """Describe this machine as it is now."""
    return Machine(
        cpu=_cpu(),
        cores=len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1,
        memory_gb=round(psutil.virtual_memory().total / 1e9, 1),
        system=platform.platform(),
        python=platform.python_version(),
        packages={name: metadata.version(name) for name in PACKAGES},
        commit=_commit(),
        load_average=round(os.getloadavg()[0], 2),
    )


@dataclass(frozen=True)
class OtherWork:
    """What runs on this machine besides this process and its children, from the moment when this is made."""

    since: float = field(default_factory=time.perf_counter)
    others_before_s: float = field(default_factory=lambda: _others_s())

    def cores(self) -> float:
        """How many cores it kept busy, on average."""
        return max(0.0, (_others_s() - self.others_before_s) / (time.perf_counter() - self.since))


def _others_s() -> float:
    """Core seconds since the machine was started, without those of this process and of its children that have ended."""
    times = psutil.cpu_times()
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    own = sum(usage.ru_utime + usage.ru_stime for usage in usages)
    return sum(getattr(times, name, 0.0) for name in BUSY) - own


def _cpu() -> str:
    about = Path("/proc/cpuinfo")
    if about.is_file():
        for line in about.read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


def _commit() -> str | None:
    command = ["git", "-C", str(Path(__file__).parent), "describe", "--always", "--dirty", "--exclude", "*"]
    try:
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return None
