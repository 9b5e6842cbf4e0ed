"""Steps over cached views, one by one and in batches, beside the live environment that draws each frame; all on one core.

Time is what the processor spends on it, whatever else it does meanwhile.

`python benchmarks/cached.py [DIR]` caches a room of a finished dataset; without one, two rooms are generated first.
"""

from __future__ import annotations

import tempfile
import time
from functools import partial
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from dataset import ROOMS_DATASET, two_rooms
from measure import Benchmark, Facts, Headline, Table, number

from remqa_data.env import RemqaEnv
from remqa_data.env.cached import CachedRemqaEnv, CachedRemqaVectorEnv
from remqa_data.sim.agent.actions import WALKING
from remqa_data.storage.manifest import load_manifest
from remqa_data.storage.shards import read_table
from remqa_data.views import SIZE_PX
from remqa_data.views.build import Wanted, cache_views

CONFIGURATIONS = (0, 1)
STEPS, LIVE_STEPS, MAX_STEPS, BATCH = 100_000, 1000, 50, 16


def measure(arguments: list[str]) -> Facts:
    """Cache one room and walk in it at random."""
    root = Path(arguments[0]) if arguments else two_rooms(ROOMS_DATASET)
    split = load_manifest(root).splits("questions")[0]
    scene = read_table(root, "scenes", split, ["scene"])["scene"][0].as_py()
    with tempfile.TemporaryDirectory() as folder:
        start = time.process_time()
        wanted = Wanted(scenes=(scene,), configurations=CONFIGURATIONS)
        room = cache_views(root, Path(folder) / "views", wanted).rooms[0]
        seconds = time.process_time() - start
        options: dict[str, Any] = {
            "root": root,
            "views": Path(folder) / "views",
            "split": split,
            "max_steps": MAX_STEPS,
        }
        cached = partial(CachedRemqaEnv, **options)
        speeds = {
            "CachedRemqaEnv": steps_per_s(cached(), STEPS),
            "CachedRemqaEnv, copy=False": steps_per_s(cached(copy=False), STEPS),
            f"CachedRemqaVectorEnv of {BATCH}": batch_steps_per_s(CachedRemqaVectorEnv(BATCH, **options)),
            f"SyncVectorEnv of {BATCH}": batch_steps_per_s(gymnasium.vector.SyncVectorEnv([cached] * BATCH)),
            "RemqaEnv": steps_per_s(
                RemqaEnv(root, split, width=SIZE_PX, height=SIZE_PX, max_steps=MAX_STEPS, hands="near"), LIVE_STEPS
            ),
        }
    size = sum(file.bytes for file in room.files)
    return {"room": scene, "frames": room.frames, "seconds": seconds, "bytes": size, "steps_per_s": speeds}


def table(facts: Facts) -> Table:
    """Steps in a second, and what the cache costs."""
    rows = [(f"{what}: steps/s", number(speed)) for what, speed in facts["steps_per_s"].items()]
    rows.append(("making the cache: frames/s", number(facts["frames"] / facts["seconds"])))
    rows.append(("size of the cache: kB a frame", number(facts["bytes"] / facts["frames"] / 1e3)))
    title = (
        f"Navigation in {facts['room']}, {len(CONFIGURATIONS)} configurations, {SIZE_PX} x {SIZE_PX} pixels, one core"
    )
    return Table(title, ("what", "measured"), rows)


def headlines(facts: Facts) -> list[Headline]:
    """Steps of one environment, and of many."""
    speeds = facts["steps_per_s"]
    batch = speeds[f"CachedRemqaVectorEnv of {BATCH}"]
    return [
        Headline("cached views, env.step", speeds["CachedRemqaEnv"], "steps/s", at_least=20_000),
        Headline(f"the same, {BATCH} in a batch", batch, "steps/s", at_least=20_000),
        Headline(
            "cached views beside the live environment", speeds["CachedRemqaEnv"] / speeds["RemqaEnv"], "x its steps"
        ),
    ]


def steps_per_s(env: gymnasium.Env[Any, Any], steps: int) -> float:
    """Steps in a second, with the resets among them."""
    env.reset(seed=0)
    actions = np.random.default_rng(0).integers(len(WALKING), size=steps).tolist()
    start = time.process_time()
    for action in actions:
        *_, terminated, truncated, _ = env.step(action)
        if terminated or truncated:
            env.reset()
    taken = time.process_time() - start
    env.close()
    return steps / taken


def batch_steps_per_s(envs: gymnasium.vector.VectorEnv[Any, Any, Any]) -> float:
    """Steps in a second of all environments of a batch together."""
    envs.reset(seed=0)
    actions = np.random.default_rng(0).integers(len(WALKING), size=(STEPS // BATCH, BATCH))
    start = time.process_time()
    for action in actions:
        envs.step(action)
    taken = time.process_time() - start
    envs.close()
    return actions.size / taken


BENCHMARK = Benchmark("cached", measure, table, headlines)

if __name__ == "__main__":
    BENCHMARK.main()
