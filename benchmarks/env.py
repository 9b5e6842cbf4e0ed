"""What a step of the environment costs beside the frame that it draws, and two environments beside one.

`python benchmarks/env.py`, on an idle machine with two cores.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import partial

import gymnasium
import numpy as np
from measure import Benchmark, Facts, Headline, Table, times_ms

from remqa_data.env import ENV_ID, RemqaEnv
from remqa_data.env.actions import DISCRETE
from remqa_data.sim.agent.actions import WALKING

ROOMS = ("FloorPlan1", "FloorPlan201", "FloorPlan301", "FloorPlan401")
STEPS, WALK_STEPS, WARM_UP_STEPS = 200, 800, 20
SIZE_PX = 300


def measure(arguments: list[str]) -> Facts:
    """Time steps and frames in each room, and two environments beside one after the other.

    In lockstep a step takes as long as the slower of two, so two different walks gain less than the same walk twice.
    """
    return {
        "rooms": {room: step_and_frame_ms(room) for room in ROOMS},
        "two_beside_one": {"the same walk": steps_per_s((0, 0)), "different walks": steps_per_s((0, 1))},
    }


def table(facts: Facts) -> Table:
    """Steps and frames by room."""
    rows = [
        (room, *(f"{ms:.2f}" for ms in (times["frame_ms"], times["step_ms"], times["step_ms"] / times["frame_ms"])))
        for room, times in facts["rooms"].items()
    ]
    title = f"Steps and the {SIZE_PX} x {SIZE_PX} frames that they draw, medians of {STEPS}"
    return Table(title, ("room", "frame, ms", "step, ms", "ratio"), rows)


def headlines(facts: Facts) -> list[Headline]:
    """The room where a step costs most beside its frame; two environments beside one."""
    rooms = facts["rooms"].values()
    same, different = (facts["two_beside_one"][walks] for walks in ("the same walk", "different walks"))
    return [
        Headline("env.step", max(times["step_ms"] / times["frame_ms"] for times in rooms), "x a frame", at_most=1.4),
        Headline("AsyncVectorEnv, one environment", same["alone"], "steps/s"),
        Headline("AsyncVectorEnv, two, same walk", same["together"] / same["alone"], "x one", at_least=1.7),
        Headline("AsyncVectorEnv, two, different walks", different["together"] / different["alone"], "x one"),
    ]


def step_and_frame_ms(room: str) -> dict[str, float]:
    """Median time of drawing a frame, and of the walking step that drew it, turn by turn."""
    env = RemqaEnv(scenes=[room], width=SIZE_PX, height=SIZE_PX, max_steps=10 * STEPS)
    env.reset(seed=0)
    turns = [times_ms([partial(env.step, action), partial(draw, env)]) for action in walk(0, STEPS)]
    env.close()
    step_ms, frame_ms = np.median(turns, axis=0).tolist()
    return {"frame_ms": frame_ms, "step_ms": step_ms}


def draw(env: RemqaEnv) -> None:
    """Draw once more what the agent sees."""
    env.agent.view.renderer.render(env.agent.camera(SIZE_PX, SIZE_PX))


def steps_per_s(seeds: Sequence[int]) -> dict[str, float]:
    """Steps in a second, of environments one after the other and of all together: each time the same walks."""
    alone = sum(walking_s([seed]) for seed in seeds)
    steps = len(seeds) * WALK_STEPS
    return {"alone": steps / alone, "together": steps / walking_s(seeds)}


def walking_s(seeds: Sequence[int]) -> float:
    """Seconds in which environments, each in a process of its own, walk as their seeds say."""
    envs = gymnasium.make_vec(
        ENV_ID,
        num_envs=len(seeds),
        vectorization_mode="async",
        scenes=[ROOMS[0]],
        width=SIZE_PX,
        height=SIZE_PX,
        max_steps=10**9,
    )
    envs.reset(seed=list(seeds))
    steps = np.transpose([walk(seed, WARM_UP_STEPS + WALK_STEPS) for seed in seeds])
    for actions in steps[:WARM_UP_STEPS]:
        envs.step(actions)
    start = time.perf_counter()
    for actions in steps[WARM_UP_STEPS:]:
        envs.step(actions)
    taken = time.perf_counter() - start
    envs.close()
    return taken


def walk(seed: int, steps: int) -> list[int]:
    """Numbers of walking actions."""
    walking = [DISCRETE.index(name) for name in WALKING]
    return np.random.default_rng(seed).choice(walking, steps).tolist()


BENCHMARK = Benchmark("env", measure, table, headlines)

if __name__ == "__main__":
    BENCHMARK.main()
