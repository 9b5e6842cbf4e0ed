"""Agents that have learnt by imitation, before they have learnt anything: what they look at, and what they do in the end."""

import pickle
from pathlib import Path

import numpy as np
import pytest
import torch

from remqa_data.agents.agent import Agent
from remqa_data.agents.config import load_system
from remqa_data.agents.knowledge.reading import read_question
from remqa_data.agents.networks.actor_critic import DONE, MOVES
from remqa_data.agents.networks.imitation import DEEDS
from remqa_data.agents.networks.planner_controller import LAST_VIEWS, Asking, PlannerController
from remqa_data.agents.networks.spatial_memory import MemoryPlanner
from remqa_data.agents.networks.view_encoder import ViewEncoder
from remqa_data.agents.networks.view_transformer import ViewTransformer
from remqa_data.agents.parts.imitators import DoingAgent, EqaAgent
from remqa_data.agents.parts.interfaces import Answerer, Manipulator, Percept, Sighting
from remqa_data.agents.systems import make_agent
from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.env.actions import Command
from remqa_data.errors import ConfigError
from remqa_data.sim.agent.actions import MANIPULATION
from remqa_data.sim.navigation.viewpoints import AgentPose
from tests.helpers.walked_rooms import memory_of, percept_of

MEMORY = memory_of([], (0.0, 0.0, 1.0, 1.0))
ASKED = read_question("Is there a mug in the fridge?")
SIGHTING = Sighting((0.1, 0.2, 0.3, 0.4), (0.2, 0.3))
VOCABULARY = Vocabulary.build([ASKED.text], ["0", "1", "no", "yes"])
TYPES = 3


def encoder() -> ViewEncoder:
    torch.manual_seed(0)
    return ViewEncoder(TYPES).eval()


class Listened(PlannerController):
    """Keeps how many views it answered from, and what it said."""

    def answers(self, asking: Asking, shown: torch.Tensor, is_view: torch.Tensor) -> torch.Tensor:
        self.views, self.said = len(shown), super().answers(asking, shown, is_view)
        return self.said


def eqa(done: float) -> EqaAgent:
    """One that is so eager to stop."""
    torch.manual_seed(0)
    network = Listened(len(VOCABULARY.words), len(VOCABULARY.answers), TYPES).eval()
    with torch.no_grad():
        network.plan.bias[DONE] = done
    return EqaAgent(network, encoder(), VOCABULARY)


def seen(number: int) -> Percept:
    percept = percept_of(AgentPose((0, 0), 0))
    rng = np.random.default_rng(number)
    percept.rgb[:] = rng.integers(0, 256, percept.rgb.shape)
    return percept


class Room:
    """Shows something else after each command, and keeps them."""

    def __init__(self) -> None:
        self.commands: list[Command] = []

    def act(self, command: Command) -> Percept:
        self.commands.append(command)
        return seen(len(self.commands))

    def names(self) -> list[str]:
        return [command.action.name for command in self.commands if command.action]


def test_eqa_answers_and_manipulates_nothing() -> None:
    agent = eqa(-50.0)
    assert isinstance(agent, Answerer)
    assert not isinstance(agent, Manipulator)
    assert load_system("eqa").manipulator is None
    room = Room()
    Agent(agent, None, None, agent, most_steps=12).play(ASKED, MEMORY, seen(0), room.act, np.random.default_rng(0))
    assert len(room.names()) == 12
    assert set(room.names()) <= set(MOVES)
    assert not set(room.names()) & set(MANIPULATION)
    assert room.commands[-1].answer in ("yes", "no")  # no number, as none is asked for


def said_after(numbers: list[int]) -> torch.Tensor:
    """Logits of the answers of a walk whose percepts are these."""
    agent = eqa(-50.0)
    walker = agent.begin(ASKED, MEMORY, np.random.default_rng(0))
    percepts = [seen(number) for number in numbers]
    for percept in percepts[:-1]:
        walker.next_action(percept)
    agent.answer(ASKED, percepts[-1], percepts[-1], None)  # stopped after its last step, as if it could do no more
    assert isinstance(agent.network, Listened)
    return agent.network.said


@pytest.mark.slow
def test_eqa_answers_from_the_question_and_the_last_five_views() -> None:
    assert LAST_VIEWS == 5
    said = said_after([0, 1, 2, 3, 4, 5, 6, 7])
    assert torch.equal(said, said_after([9, 8, 0, 3, 4, 5, 6, 7]))
    for place in range(5):
        others = [0, 1, 2, *(20 if place == number else 3 + number for number in range(5))]
        assert not torch.equal(said, said_after(others)), others


def test_a_view_at_which_eqa_has_stopped_is_not_seen_twice() -> None:
    agent = eqa(50.0)
    walker = agent.begin(ASKED, MEMORY, np.random.default_rng(0))
    first = seen(0)
    assert walker.next_action(first) is None
    assert isinstance(agent.network, Listened)
    agent.answer(ASKED, first, first, None)
    assert agent.network.views == 1
    agent.answer(ASKED, seen(1), seen(1), None)
    assert agent.network.views == 2


@pytest.mark.slow
def test_the_same_generator_walks_the_same_way_and_the_agent_goes_to_other_processes() -> None:
    def walked(agent: EqaAgent, seed: int) -> list[str | None]:
        walker = agent.begin(ASKED, MEMORY, np.random.default_rng(seed))
        return [walker.next_action(seen(number)) for number in range(10)]

    agent = eqa(-50.0)
    ways = walked(agent, 1), walked(agent, 1), walked(pickle.loads(pickle.dumps(agent)), 1), walked(agent, 2)
    assert ways[0] == ways[1] == ways[2] != ways[3]
    together = pickle.loads(pickle.dumps(Agent(agent, None, None, agent)))
    assert together.navigator is together.answerer  # what was seen on the walk is what is answered from


@pytest.mark.parametrize("kind", [ViewTransformer, MemoryPlanner])
def test_who_does_something_does_what_it_thinks_likeliest_at_the_end(
    kind: type[ViewTransformer | MemoryPlanner],
) -> None:
    torch.manual_seed(0)
    network = kind(len(VOCABULARY.words), TYPES).eval()
    agent = DoingAgent(network, encoder(), VOCABULARY)
    assert isinstance(agent, Manipulator)
    assert not isinstance(agent, Answerer)
    wanted = {None: [], "Open": ["OpenObject"], "Pickup": ["PickupObject"], "Move": ["PushObject", "PullObject"]}
    for place, deed in enumerate(DEEDS):
        with torch.no_grad():
            network.deed.bias.zero_()
            network.deed.bias[place] = 50.0
        agent.begin(ASKED, MEMORY, np.random.default_rng(0)).next_action(seen(0))
        found = agent.actions(ASKED, MEMORY, seen(0), SIGHTING)
        assert [action.name for action in found] == wanted[deed]
        assert agent.actions(ASKED, MEMORY, seen(0), None) == ()


@pytest.mark.parametrize(("part", "said"), [("manipulator", "does not manipulate"), ("answerer", "does not answer")])
def test_a_navigator_that_only_walks_is_refused_as_another_part(part: str, said: str, tmp_path: Path) -> None:
    parts = {"localizer": "null", "manipulator": "null", "answerer": "null"} | {part: "{kind: navigator}"}
    path = tmp_path / "mine.yaml"
    text = "".join(f"{name}: {value}\n" for name, value in parts.items())
    path.write_text("title: mine\nseed: 0\nmost_steps: 9\nnavigator: {kind: random}\n" + text)
    with pytest.raises(ConfigError, match=f"{part}: .*{said}"):
        make_agent(load_system(path), tmp_path)
