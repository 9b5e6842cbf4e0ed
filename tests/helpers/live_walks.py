"""The cached environment beside the live one: every state, every action, whole walks.

`python -m tests.helpers.live_walks DATASET VIEWS` compares all rooms of a cache and prints what was compared. Each
comparison raises an AssertionError where the two differ.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from remqa_data.env import RemqaEnv
from remqa_data.env.actions import Command
from remqa_data.env.cached import CachedRemqaEnv
from remqa_data.env.cached.walk import ACTIONS
from remqa_data.env.record import EpisodeRecord
from remqa_data.sim.agent.actions import DONE, NAVIGATION, WALKING, parse_action, perform
from remqa_data.storage.shards import read_table
from remqa_data.views.reader import Views

SHARED = {"rgb", "pose", "question", "question_tokens"}
"""What both observe, at least."""
MAX_STEPS = 30


@dataclass
class Both:
    """The same question in both environments."""

    live: RemqaEnv
    cached: CachedRemqaEnv
    counts: Counter[str] = field(default_factory=Counter)

    @classmethod
    def of(cls, root: Path, views: Path, split: str) -> Both:
        cached = CachedRemqaEnv(root, views, split, max_steps=MAX_STEPS)
        size = cached.tasks.views.size_px
        live = RemqaEnv(
            root, split, width=size, height=size, max_steps=MAX_STEPS, vocabulary=cached.tasks.vocabulary, hands="near"
        )
        return cls(live, cached)

    def begin(self, question_id: str) -> None:
        options = {"episode": question_id}
        (seen, info), (shown, said) = self.live.reset(options=options), self.cached.reset(options=options)
        check_observation(seen, shown)
        assert info == said

    def place(self, state: int) -> None:
        """Put both agents in a state, as if the episode began there."""
        walk, agent = self.cached.walk, self.live.agent
        walk.room.states.place(agent, state)
        walk.begin(walk.task.question_id)
        walk.state = state
        self.live.steps, self.live.record = 0, EpisodeRecord(positions=[(agent.x, agent.y)])

    def step(self, action: str) -> bool:
        """Do the same in both; whether the episode is over. Who is done answers rightly in the live environment."""
        task = self.live.episode.task
        assert task is not None
        live = self.live.step(Command(answer=task.answer) if action == DONE else action)
        cached = self.cached.step(action)
        check_observation(live[0], cached[0])
        assert live[1:4] == cached[1:4], (action, live[1:4], cached[1:4])
        shared = [key for key in cached[4] if not (action == DONE and key == "action")]
        assert {key: live[4][key] for key in shared} == {key: cached[4][key] for key in shared}
        self.counts["steps"] += 1
        self.counts["refused"] += not cached[4]["success"]
        self.counts["rewarded"] += cached[1] == 1.0
        if cached[2] or cached[3]:
            assert {"S_N", "SPL", "distance_to_goal_m", "path_length_m", "steps"} <= set(cached[4])
            self.counts["episodes"] += 1
            self.counts["truncated"] += cached[3]
            self.counts["navigated"] += cached[4]["S_N"]
        return cached[2] or cached[3]

    def compare_states(self) -> None:
        """All frames and poses of the room that is played, and where every action leads from every state."""
        agent, room = self.live.agent, self.cached.walk.room
        size = self.cached.tasks.views.size_px
        reachable = np.flatnonzero(room.is_reachable).tolist()
        cells = {agent.grid.position(cell) for cell in agent.grid.cells}
        assert {room.states.pose(state)[:2] for state in reachable} == cells
        for state in reachable:
            room.states.place(agent, state)
            pose = [agent.x, agent.y, agent.yaw_deg, agent.horizon_deg, float(agent.is_standing)]
            assert room.poses[state].tolist() == np.array(pose, dtype=np.float32).tolist()
            shown = room.frame(state)
            assert np.array_equal(shown, agent.view.render(agent.camera(size, size)).rgb), room.states.pose(state)
            self.counts["frames"] += 1
            self.counts["frames with patches"] += shown.flags.owndata
            for column, name in enumerate(WALKING):
                room.states.place(agent, state)
                result = perform(agent, parse_action(name))
                after = int(room.transitions.table[state, column])
                assert room.states.state_of(agent) == after, (room.states.pose(state), name)
                assert room.is_reachable[after]
                assert result.success == (after != state)
                assert result.without_name().error == room.transitions.reasons[room.transitions.refusals[state, column]]
                self.counts["transitions"] += 1

    def compare_steps(self, question_ids: list[str], rng: np.random.Generator, count: int) -> None:
        """So many steps of the environments from states that are drawn; the end of an episode is one of the actions."""
        states = np.flatnonzero(self.cached.walk.room.is_reachable)
        for state, action in zip(rng.choice(states, count), rng.choice(ACTIONS, count), strict=True):
            self.place(int(state))
            if self.step(str(action)):
                self.begin(str(rng.choice(question_ids)))

    def compare_walks(self, question_id: str, rng: np.random.Generator) -> None:
        """The oracle's walk, one without aim that ends by chance, and one that is cut off."""
        self.begin(question_id)
        task = self.live.episode.task
        assert task is not None
        oracle = [str(action) for action in task.actions if action.name in NAVIGATION]
        walking = [*WALKING, *["MoveAhead"] * 8]
        aimless, endless = (rng.choice(choice, MAX_STEPS).tolist() for choice in ([*walking, DONE], walking))
        for words in ([*oracle[: MAX_STEPS - 1], DONE], aimless, endless):
            self.begin(question_id)
            for word in words:
                if self.step(word):
                    break

    def close(self) -> None:
        self.live.close()
        self.cached.close()


def check_observation(live: dict[str, Any], cached: dict[str, Any]) -> None:
    shared = live.keys() & cached.keys()
    assert shared >= SHARED
    for key in sorted(shared):
        assert np.array_equal(live[key], cached[key]), key


def questions_by_place(cached: CachedRemqaEnv) -> dict[tuple[str, int], list[str]]:
    """Ids of the questions about each configuration that is cached."""
    found: dict[tuple[str, int], list[str]] = {}
    for name in cached.episode_ids:
        task = cached.tasks.task(name)
        found.setdefault((task.scene, task.configuration), []).append(name)
    return found


def compare(
    root: Path, views: Path, split: str, steps: int, scenes: Sequence[str] = (), seed: int = 0
) -> Iterator[tuple[tuple[str, int], Counter[str]]]:
    """Compare all that is cached of a split, or of some scenes; yields each configuration with what was compared."""
    both = Both.of(root, views, split)
    for place, question_ids in sorted(questions_by_place(both.cached).items()):
        if scenes and place[0] not in scenes:
            continue
        rng = np.random.default_rng(seed)
        both.counts = Counter()
        both.begin(question_ids[0])
        both.compare_states()
        both.compare_steps(question_ids, rng, steps)
        for question_id in question_ids:
            both.compare_walks(question_id, rng)
        yield place, both.counts
    both.close()


def main() -> None:
    """Compare a whole cache."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("root", type=Path)
    parser.add_argument("views", type=Path)
    parser.add_argument("--steps", type=int, default=4000, help="drawn steps of each configuration")
    parser.add_argument("--scenes", nargs="*", default=[])
    parser.add_argument("--splits", default="train,test")
    asked = parser.parse_args()
    total, began = Counter[str](), time.monotonic()
    cached = {room.scene for room in Views(asked.views, asked.root).manifest.rooms}
    for split in asked.splits.split(","):
        if cached.isdisjoint(read_table(asked.root, "questions", split, ["scene"])["scene"].to_pylist()):
            continue
        for place, counts in compare(asked.root, asked.views, split, asked.steps, asked.scenes):
            print(*place, dict(counts), f"{time.monotonic() - began:.0f} s", flush=True)
            total += counts
    print("in all", dict(total))


if __name__ == "__main__":
    main()
