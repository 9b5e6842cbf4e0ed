"""How the four parts play together; the parts and the room are stood in for."""

from dataclasses import dataclass, field

import numpy as np
import pytest

from remqa_data.agents.agent import Agent
from remqa_data.agents.knowledge.reading import read_question
from remqa_data.agents.parts.interfaces import Percept, Sighting
from remqa_data.env.actions import Command, Shares
from remqa_data.sim.agent.actions import Action
from remqa_data.sim.navigation.viewpoints import AgentPose
from tests.helpers.walked_rooms import memory_of, percept_of

ASKED = read_question("Is there a CD under the garbage can?")
MEMORY = memory_of([], (0.0, 0.0, 1.0, 1.0))
FIRST = percept_of(AgentPose((0, 0), 0))
SIGHTING = Sighting((0.1, 0.2, 0.3, 0.4), (0.2, 0.3))


@dataclass
class Parts:
    """Walks ahead, sees, tries two things and answers with the number of commands before."""

    steps: int
    sighting: Sighting | None = SIGHTING

    def begin(self, asked, memory, rng):
        return self

    def next_action(self, percept):
        self.steps -= 1
        return "MoveAhead" if self.steps >= 0 else None

    def locate(self, asked, memory, percept, rng):
        return self.sighting

    def actions(self, asked, memory, percept, sighting):
        return (Action("PushObject", sighting.point), Action("PullObject", sighting.point)) if sighting else ()

    def answer(self, asked, before, after, sighting):
        return "yes" if after is not before else "no"


@dataclass
class Room:
    """Refuses some actions."""

    refused: tuple[str, ...] = ()
    commands: list[Command] = field(default_factory=list)

    def act(self, command: Command) -> Percept:
        self.commands.append(command)
        name = command.action.name if command.action else "Answer"
        return percept_of(AgentPose((0, 0), 0), succeeded=name not in self.refused)


def played(parts: Parts, room: Room, **others) -> list[str]:
    agent = Agent(parts, parts, parts, parts, **others)
    agent.play(ASKED, MEMORY, FIRST, room.act, np.random.default_rng(0))
    return [str(command) for command in room.commands]


def test_an_episode_is_a_walk_a_manipulation_and_an_answer() -> None:
    room = Room()
    assert played(Parts(2), room) == ["MoveAhead", "MoveAhead", "PushObject @0.2,0.3", "Answer yes"]
    assert [command.box for command in room.commands] == [None, None, SIGHTING.box, SIGHTING.box]


def test_where_one_manipulation_is_refused_the_next_is_tried() -> None:
    assert played(Parts(0), Room(("PushObject",))) == ["PushObject @0.2,0.3", "PullObject @0.2,0.3", "Answer yes"]


def test_what_is_not_seen_is_not_acted_on() -> None:
    assert played(Parts(1, None), Room()) == ["MoveAhead", "Answer no"]


def test_after_so_many_steps_the_agent_stops() -> None:
    assert played(Parts(9), Room(), most_steps=2)[:3] == ["MoveAhead", "MoveAhead", "PushObject @0.2,0.3"]


def test_without_the_other_parts_it_only_walks() -> None:
    room = Room()
    Agent(Parts(1)).play(ASKED, MEMORY, FIRST, room.act, np.random.default_rng(0))
    assert [str(command) for command in room.commands] == ["MoveAhead", "Done"]


@dataclass
class Persistent(Parts):
    """The same, and it knows of more places, each a step away."""

    places: int = 1

    def leave(self, percept):
        self.places -= 1
        self.steps = 1 if self.places >= 0 else 0


@dataclass
class Corridor(Room):
    """Steps lead to other cells, and nothing can be done before the last of them."""

    at: int = 0
    last: int = 1

    def act(self, command: Command) -> Percept:
        self.commands.append(command)
        name = command.action.name if command.action else "Answer"
        self.at += name == "MoveAhead"
        return percept_of(AgentPose((self.at, 0), 0), succeeded=self.at >= self.last or name == "MoveAhead")


def test_where_nothing_can_be_done_it_is_tried_elsewhere() -> None:
    tries = ["PushObject @0.2,0.3", "PullObject @0.2,0.3"]
    assert played(Persistent(0), Corridor()) == [*tries, "MoveAhead", tries[0], "Answer yes"]
    assert played(Persistent(0, places=0), Corridor()) == [*tries, "Answer yes"]  # there is nowhere to go
    everywhere = [*tries, "MoveAhead", *tries, "MoveAhead", *tries, "Answer yes"]
    assert played(Persistent(0, places=9), Corridor(last=9)) == everywhere  # it has tried three times
    assert played(Persistent(0, places=9), Corridor(last=9), most_steps=1) == [
        *tries,
        "MoveAhead",
        *tries,
        "Answer yes",
    ]


@dataclass
class Inspecting(Parts):
    """It knows of more places to look in from, each a step away; it sees `shown` pixels of it, and `sure` a yes."""

    shown: tuple[int, ...] = ()
    sure: tuple[float, ...] = ()
    boxes: list[Shares | None] = field(default_factory=list)

    def look_inside(self, percept):
        self.steps = 1

    def inside_of(self, percept):
        mask = np.zeros(percept.depth.shape, dtype=bool)
        mask.flat[: self.shown[percept.pose.cell[0]]] = True
        return mask

    def chances(self, asked, before, after, sighting):
        self.boxes.append(sighting and sighting.box)
        yes = self.sure[after.pose.cell[0]]
        return {"no": 1 - yes, "yes": yes}


OPENED = read_question("Is there a mug in the fridge?")


@pytest.mark.parametrize(
    ("looks", "shown", "sure", "answered"),
    [
        (1, (7, 9), (0.1, 0.8), "no"),  # 8 * 0.1 + 10 * 0.8 of 18
        (1, (7, 30), (0.1, 0.8), "yes"),
        (2, (7, 3, 30), (0.1, 0.1, 0.8), "yes"),
        (2, (99, 0, 30), (0.1, 0.9, 0.9), "no"),  # where it has opened it sees most
    ],
)
def test_into_what_is_open_it_looks_from_elsewhere_and_answers_by_what_shows_most(looks, shown, sure, answered) -> None:
    room, parts = Corridor(last=0), Inspecting(0, shown=shown, sure=sure)
    Agent(parts, parts, parts, parts, looks=looks).play(OPENED, MEMORY, FIRST, room.act, np.random.default_rng(0))
    steps = ["MoveAhead"] * looks
    assert [str(command) for command in room.commands] == ["PushObject @0.2,0.3", *steps, f"Answer {answered}"]
    assert room.commands[-1].box == SIGHTING.box  # where the target was
    assert parts.boxes == [SIGHTING.box, *((0.0, 0.0, n / 300, 1 / 300) if n else None for n in shown[1:])]


def test_it_looks_into_nothing_that_it_has_not_opened_and_no_more_than_it_is_told() -> None:
    parts = Inspecting(0, shown=(1, 9), sure=(0.9, 0.9))
    assert played(parts, Corridor(last=0), looks=1) == ["PushObject @0.2,0.3", "Answer yes"]  # it was to look under it
    room = Corridor(last=0)
    Agent(parts, parts, parts, parts).play(OPENED, MEMORY, FIRST, room.act, np.random.default_rng(0))
    assert [str(command) for command in room.commands] == ["PushObject @0.2,0.3", "Answer yes"]
    assert parts.boxes == []
