"""Jobs for tests of executors; in a module of their own, so that other processes find them."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

from remqa_data.errors import ArrangementError, UnknownNameError


def square(number: int) -> int:
    return number * number


def process_id(number: int) -> int:
    time.sleep(0.1)
    return os.getpid()


def die_the_first_time(flag: Path) -> str:
    """Kills its own process, unless it has done so before."""
    if not flag.exists():
        flag.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return flag.name


def die(number: int) -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def refuse(number: int) -> int:
    if number == 3:
        raise UnknownNameError("scene", "FloorPlan0", ["FloorPlan1"])
    return number


def refuse_at_a_place(number: int) -> int:
    raise ArrangementError("no room in the drawer", "Drawer|1", "in", ["Mug"])


def write_slowly(path: Path) -> str:
    """Writes where it ran; returns the node."""
    import ray

    time.sleep(0.5)
    node = ray.get_runtime_context().get_node_id()
    path.write_text(node)
    return str(node)
