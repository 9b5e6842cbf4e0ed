from collections import Counter

import numpy as np

from remqa_data.agents.knowledge.reading import read_question
from remqa_data.agents.parts.random_navigator import RandomNavigator
from remqa_data.sim.agent.actions import WALKING
from remqa_data.sim.navigation.viewpoints import AgentPose
from tests.helpers.walked_rooms import memory_of, percept_of

MEMORY = memory_of([], (0.0, 0.0, 1.0, 1.0))
ASKED = read_question("Is there a mug in the fridge?")


def actions(seed: int, most_steps: int = 50) -> list[str]:
    walker = RandomNavigator(most_steps).begin(ASKED, MEMORY, np.random.default_rng(seed))
    return list(iter(lambda: walker.next_action(percept_of(AgentPose((1, 1), 0))), None))


def test_all_navigation_actions_are_equally_likely() -> None:
    assert len(WALKING) == 10
    assert "Teleport" not in WALKING
    counts = Counter(action for seed in range(400) for action in actions(seed))
    mean = sum(counts.values()) / len(WALKING)
    assert all(abs(counts[name] - mean) < 5 * mean**0.5 for name in WALKING)


def test_any_number_of_steps_is_equally_likely() -> None:
    lengths = [len(actions(seed)) for seed in range(400)]
    assert (min(lengths), max(lengths)) == (0, 50)
    assert 22 < sum(lengths) / len(lengths) < 28


def test_the_same_seed_walks_the_same_way() -> None:
    assert actions(3) == actions(3) != actions(4)
