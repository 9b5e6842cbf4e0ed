"""What a step of the environment costs beside the frame that it draws, and two environments beside one.

Run it alone on an idle machine with two cores: `python benchmarks/env.py`. The figures are printed and stored in
out/benchmarks/env.json.
"""

from __future__ import annotations

import json
import platform
import time
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from rich.console import Console
from rich.table import Table

from remqa_data.env import ENV_ID, RemqaEnv
from remqa_data.env_actions import DISCRETE
from remqa_data.sim.actions import NAVIGATION

OUTPUT = Path("out/benchmarks/env.json")
ROOMS = ("FloorPlan1", "FloorPlan201", "FloorPlan301", "FloorPlan401")
STEPS, SECONDS = 200, 8.0
SIZE_PX = 300
WALKING = [number for number, action in enumerate(DISCRETE) if action in NAVIGATION]


def main() -> None:
    """Measure, print and store."""
    console = Console()
    table = Table("room", "frame, ms", "step, ms", "ratio", title=f"{SIZE_PX} x {SIZE_PX}, medians of {STEPS} steps")
    results: dict[str, Any] = {"machine": platform.processor() or platform.machine(), "rooms": {}}
    for room in ROOMS:
        frame_ms, step_ms = step_and_frame_ms(room)
        table.add_row(room, f"{frame_ms:.2f}", f"{step_ms:.2f}", f"{step_ms / frame_ms:.2f}")
        results["rooms"][room] = {"frame_ms": frame_ms, "step_ms": step_ms, "ratio": step_ms / frame_ms}
    console.print(table)
    alone, together = steps_per_s(1), steps_per_s(2)
    results["async"] = {"one_per_s": alone, "two_per_s": together, "ratio": together / alone}
    console.print(f"AsyncVectorEnv: {alone:.0f} steps/s with one, {together:.0f} with two: {together / alone:.2f} x")
    OUTPUT.parent.mkdir(parents=True, exist_ok=True)
    OUTPUT.write_text(json.dumps(results, indent=1))


def step_and_frame_ms(room: str) -> tuple[float, float]:
    """Median time of drawing a frame, and of the walking step that drew it, turn by turn."""
    env = RemqaEnv(scenes=[room], width=SIZE_PX, height=SIZE_PX, max_steps=10 * STEPS)
    env.reset(seed=0)
    rng = np.random.default_rng(0)
    frames, steps = [], []
    for _ in range(STEPS):
        action = int(rng.choice(WALKING))
        begin = time.perf_counter()
        env.step(action)
        middle = time.perf_counter()
        env.agent.view.renderer.render(env.agent.camera(SIZE_PX, SIZE_PX))
        frames.append(time.perf_counter() - middle)
        steps.append(middle - begin)
    env.close()
    return 1e3 * float(np.median(frames)), 1e3 * float(np.median(steps))


def steps_per_s(count: int) -> float:
    """Steps in a second, of all of `count` environments in processes of their own."""
    envs = gymnasium.make_vec(
        ENV_ID,
        num_envs=count,
        vectorization_mode="async",
        scenes=[ROOMS[0]],
        width=SIZE_PX,
        height=SIZE_PX,
        max_steps=10**9,
    )
    envs.reset(seed=0)
    rng = np.random.default_rng(0)
    for _ in range(20):
        envs.step(rng.choice(WALKING, count))
    done, begin = 0, time.perf_counter()
    while time.perf_counter() - begin < SECONDS:
        envs.step(rng.choice(WALKING, count))
        done += count
    taken = time.perf_counter() - begin
    envs.close()
    return done / taken


if __name__ == "__main__":
    main()
