"""Let an agent that does anything play one question in the environment, and keep what it sees as a picture that moves.

python examples/random_agent_film.py out/tiny [OUT]
"""

# %% The dataset, and a question of it
import sys
from pathlib import Path

import gymnasium
import numpy as np

import remqa_data.env  # registers remqa_data/Remqa-v0
from remqa_data.opencv import cv2
from remqa_data.storage.manifest import load_manifest

arguments = [] if "ipykernel" in sys.modules else sys.argv[1:]
data = Path(arguments[0] if arguments else "out/tiny")
out = Path(arguments[1] if arguments[1:] else "out/examples")
out.mkdir(parents=True, exist_ok=True)

SIZE_PX = 240
FRAME_MS = 250
STEPS = 24
ACTIONS = ("MoveAhead", "MoveAhead", "RotateLeft", "RotateRight", "LookDown", "LookUp", "OpenObject @0.5,0.5")
"""As texts; `@0.5,0.5` is what lies in the middle of the view."""

split = load_manifest(data).splits("questions")[-1]
env = gymnasium.make(
    "remqa_data/Remqa-v0", root=data, split=split, render_mode="rgb_array", width=SIZE_PX, height=SIZE_PX
)

# %% Play: what the agent sees, and the agent from outside, side by side
observation, info = env.reset(seed=0)
print(info["episode_id"], "|", observation["question"])
rng = np.random.default_rng(0)
frames = []
for step in range(STEPS):
    action = str(rng.choice(ACTIONS))
    observation, reward, terminated, truncated, info = env.step(action)
    frames.append(np.hstack([observation["rgb"], np.asarray(env.render())]))
    print(f"{step + 1:2} {action:20}", "done" if info["success"] else f"refused: {info['error']}")

# %% An answer ends the episode; `info` then has the measures
observation, reward, terminated, truncated, info = env.step("Answer yes")
print(
    {name: info[name] for name in ("S_N", "S_QA", "answer_accuracy")}, f"{info['distance_to_goal_m']:.2f} m from a goal"
)
env.close()

# %% Write the film: .webp, which browsers show as a picture
film = cv2.Animation()
film.frames = [np.ascontiguousarray(frame[..., ::-1]) for frame in frames]
film.durations = [FRAME_MS] * len(frames)
cv2.imwriteanimation(str(out / "random_agent.webp"), film)
print("wrote", out / "random_agent.webp", f"({len(frames)} frames); the oracle's film: remqa-data play {data} QUESTION")
