"""Agents that have learnt to walk by imitation of shortest ways, without a map: EQA, IQA and a transformer."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import torch
from torch import Tensor

from remqa_data.agents.knowledge.memory import WalkMemory
from remqa_data.agents.knowledge.reading import Question
from remqa_data.agents.networks.actor_critic import DONE, MOVES, told
from remqa_data.agents.networks.answerer import likeliest
from remqa_data.agents.networks.imitation import DEEDS, DRAWS, ImitatorWalk
from remqa_data.agents.networks.planner_controller import LAST_VIEWS, PlannedWalk, PlannerController
from remqa_data.agents.networks.spatial_memory import MemoryPlanner, RememberedWalk
from remqa_data.agents.networks.threads import one_thread
from remqa_data.agents.networks.view_encoder import ViewEncoder
from remqa_data.agents.networks.view_transformer import AttentiveWalk, ViewTransformer
from remqa_data.agents.parts.interfaces import Percept, Sighting
from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.geometry.types import U8
from remqa_data.sim.agent.actions import OPEN, PICK_UP, PULL, PUSH, Action

ACTIONS = {"Open": (OPEN,), "Pickup": (PICK_UP,), "Move": (PUSH, PULL)}
"""What is tried: who remembers no size does not know where to put a thing, but can push it away, or pull it near."""


class ImitatorWalker:
    """Walks in one episode by a network.

    Parameters
    ----------
    encoder : ViewEncoder
        That through which the network has learnt to see.
    walk : ImitatorWalk
        The network's, at its beginning.
    rng : numpy.random.Generator
        Moves are drawn.
    """

    def __init__(self, encoder: ViewEncoder, walk: ImitatorWalk, rng: np.random.Generator) -> None:
        self._encoder, self._walk, self._rng = encoder, walk, rng
        self._last: int | None = None
        self.frames: list[U8] = []

    def next_action(self, percept: Percept) -> str | None:
        """See `remqa_data.agents.parts.interfaces.Walker`; keeps the last LAST_VIEWS frames."""
        self.frames = [*self.frames, percept.rgb][-LAST_VIEWS:]
        before = torch.zeros(1, len(MOVES) + 1)
        if self._last is not None:
            before = told(torch.tensor([self._last]), torch.tensor([percept.succeeded]))
        draws = torch.from_numpy(self._rng.random((1, DRAWS))).float()
        with one_thread():
            chosen = self._walk.move(self._encoder.encode(percept.rgb[None]), before, draws)
        self._last = int(chosen.moves)
        return None if self._last == DONE else MOVES[self._last]


@dataclass(eq=False)
class EqaAgent:
    """EQA (Das et al. 2018): a navigator that also answers, from the last views of its walk. It manipulates nothing.

    Attributes
    ----------
    network : PlannerController
        Trained.
    encoder : ViewEncoder
        That through which it has learnt to see.
    vocabulary : Vocabulary
        Its words and answers.
    """

    network: PlannerController
    encoder: ViewEncoder
    vocabulary: Vocabulary
    _walk: PlannedWalk | None = field(default=None, init=False)
    _walker: ImitatorWalker | None = field(default=None, init=False)

    def begin(self, asked: Question, memory: WalkMemory, rng: np.random.Generator) -> ImitatorWalker:
        """Begin an episode; each move is drawn."""
        self._walk = PlannedWalk(self.network, numbers_of(self.vocabulary, asked))
        self._walker = ImitatorWalker(self.encoder, self._walk, rng)
        return self._walker

    @torch.no_grad()
    def answer(self, asked: Question, before: Percept, after: Percept, sighting: Sighting | None) -> str | None:
        """See `remqa_data.agents.parts.interfaces.Answerer`: from the last LAST_VIEWS frames of the walk that was begun."""
        assert self._walk is not None, "who answers has begun an episode"
        assert self._walker is not None, "a walk has a walker"
        frames = self._walker.frames
        if not frames or frames[-1] is not before.rgb:  # the agent was stopped after its last step
            frames = [*frames, before.rgb][-LAST_VIEWS:]
        asking = self._walk.asking
        with one_thread():
            shown = self.network.eye(self.encoder.encode(np.stack(frames)), asking.names.expand(len(frames), -1, -1))
            logits = self.network.answers(asking, shown[:, None], torch.ones(len(frames), 1, dtype=torch.bool))
        return likeliest(logits, [asked.kind], self.vocabulary.answers)[0]


@dataclass(eq=False)
class DoingAgent:
    """A transformer, or a planner with a memory (IQA), that has cloned shortest ways: it also says what to do to the target.

    Attributes
    ----------
    network : ViewTransformer or MemoryPlanner
        Trained.
    encoder : ViewEncoder
        That through which it has learnt to see.
    vocabulary : Vocabulary
        Its words.
    """

    network: ViewTransformer | MemoryPlanner
    encoder: ViewEncoder
    vocabulary: Vocabulary
    _walk: AttentiveWalk | RememberedWalk | None = field(default=None, init=False)

    def begin(self, asked: Question, memory: WalkMemory, rng: np.random.Generator) -> ImitatorWalker:
        """Begin an episode; each move is drawn."""
        numbers, network = numbers_of(self.vocabulary, asked), self.network
        if isinstance(network, MemoryPlanner):
            self._walk = RememberedWalk(network, numbers)
        else:
            self._walk = AttentiveWalk(network, numbers)
        return ImitatorWalker(self.encoder, self._walk, rng)

    def actions(
        self, asked: Question, memory: WalkMemory, percept: Percept, sighting: Sighting | None
    ) -> tuple[Action, ...]:
        """See `remqa_data.agents.parts.interfaces.Manipulator`: what it thought likeliest at the last view of its walk."""
        assert self._walk is not None, "who manipulates has begun an episode"
        deed = DEEDS[int(self._walk.deeds.argmax())]
        if sighting is None or deed is None:
            return ()
        return tuple(Action(name, sighting.point) for name in ACTIONS[deed])


def numbers_of(vocabulary: Vocabulary, asked: Question) -> Tensor:
    """(1, w) int64 numbers of the words of a question."""
    return torch.from_numpy(vocabulary.encode_batch([asked.text])[0])
