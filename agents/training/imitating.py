"""Learning to walk by imitation of shortest ways, on cached views.

A sample is a walk to a target from somewhere in a room, near ones as often as far ones. Of its moves a share, drawn for each
walk, is one of a shortest way from there, the others are the network's own: so it learns what is right where it gets to itself
as well (Ross et al. 2011). Any move of a shortest way is right.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional

from remqa_data.agents.networks.actor_critic import DONE, MOVES, told
from remqa_data.agents.networks.answerer import likeliest
from remqa_data.agents.networks.imitation import DEEDS, DRAWS, ImitatorForm, ImitatorWalk, Lead
from remqa_data.agents.networks.planner_controller import LAST_VIEWS, PlannedWalk, PlannerController
from remqa_data.agents.networks.spatial_memory import MemoryPlanner, Planned, RememberedWalk
from remqa_data.agents.networks.view_encoder import ViewEncoder
from remqa_data.agents.networks.view_transformer import Attended, AttentiveWalk, ViewTransformer
from remqa_data.agents.training.cached_walks import Errand, Walks, check_features, learning_errands
from remqa_data.agents.training.pictures import detector_types
from remqa_data.agents.training.reinforcing import MOST_STEPS
from remqa_data.agents.training.rooms import learning_rooms
from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.env.cached.walk import ACTIONS
from remqa_data.geometry.types import Flags
from remqa_data.metrics import spl
from remqa_data.storage.shards import read_table

FARTHEST, LONGEST = 25, 30
"""Moves from where a walk to learn from begins to its target, at most; and of the walk. Of the episodes in
val rooms 90 % begin 2 to 19 away."""
NAME_WEIGHT = 0.5
"""Of the loss of which types a question names."""

DOERS: Mapping[str, type[ViewTransformer | MemoryPlanner]] = {
    "transformer": ViewTransformer,
    "spatial_memory": MemoryPlanner,
}
"""Who says what to do in the end."""

_WALKED = np.array([ACTIONS.index(name) for name in MOVES[:DONE]])


class Followed(NamedTuple):
    """n walks of at most t steps, and what was right.

    Attributes
    ----------
    features : (v, PARTS^2, CHANNELS)
        Of the views of steps of walks that are not over, step by step.
    before : (t, n, moves + 1)
    best : (t, n, moves) bool
        Moves of shortest ways.
    is_planned : (t, n) bool
        See `remqa_data.agents.networks.imitation.Chosen`.
    is_going : (t, n) bool
        Whether the walk was not over before that step.
    """

    features: Tensor
    before: Tensor
    best: Tensor
    is_planned: Tensor
    is_going: Tensor


class Sampled(NamedTuple):
    """Walks to learn from.

    Attributes
    ----------
    walks : Followed
    numbers : (n, w) int64
        Words of the questions.
    names : (n, 2) int64
        Types that they name; see `remqa_data.agents.knowledge.reading.asked_types`.
    answers : (n,) int64
        Right answers, by their place in the vocabulary.
    deeds : (n,) int64
        What is to be done to the target, by its place among DEEDS.
    """

    walks: Followed
    numbers: Tensor
    names: Tensor
    answers: Tensor
    deeds: Tensor


class ImitationTask:
    """A network learns to follow shortest ways; see `remqa_data.agents.training.trainer.Task`.

    Parameters
    ----------
    roots : sequence of path
        Datasets; the questions of the first one are walked to.
    views : path
        The cache of the first one, with features.
    form : {"planner_controller", "transformer", "spatial_memory"}
        Which network.
    encoder : ViewEncoder
        Trained: that of the cache's features.
    walks : int
        Of an epoch.
    device : str
        Where to compute.
    """

    def __init__(
        self,
        roots: Sequence[Path],
        views: Path,
        form: ImitatorForm,
        encoder: ViewEncoder,
        walks: int,
        device: str = "cpu",
    ) -> None:
        self._epoch = walks
        self.errands, self._val = learning_errands(roots[0], views, roots)
        check_features(encoder, self.errands[0])
        rows = read_table(roots[0], "questions", "train", ["question_id", "question", "answer", "scene"]).to_pylist()
        self._answers = {row["question_id"]: row["answer"] for row in rows}
        rooms = learning_rooms(roots)
        learnt = [row for row in rows if row["scene"] in rooms]
        self.vocabulary = Vocabulary.build([row["question"] for row in learnt], [row["answer"] for row in learnt])
        words, types = len(self.vocabulary.words), len(detector_types())
        self.model: PlannerController | ViewTransformer | MemoryPlanner
        if form == "planner_controller":
            self.model = PlannerController(words, len(self.vocabulary.answers), types)
        else:
            self.model = DOERS[form](words, types)
        self.model.eye.know(encoder)
        self.device = device

    def __len__(self) -> int:
        return self._epoch

    def batch(self, samples: np.ndarray, rngs: list[np.random.Generator]) -> Sampled:
        """Walks that are led in part, one drawn with each generator."""
        chosen = [self.errands[int(rng.integers(len(self.errands)))] for rng in rngs]
        starts = [errand.some_start(rng, FARTHEST) for errand, rng in zip(chosen, rngs, strict=True)]
        shares = np.array([rng.random() for rng in rngs])
        numbers = self._numbers(chosen)
        walks = followed(walk_of(self.model, numbers), Walks(chosen, starts), rngs, shares, LONGEST, self.device)
        names = torch.tensor([errand.types for errand in chosen], device=self.device)
        answers = [self.vocabulary.answers.index(self._answers[errand.task.question_id]) for errand in chosen]
        deeds = [DEEDS.index(errand.asked.manipulation) for errand in chosen]
        return Sampled(
            walks,
            numbers,
            names,
            torch.tensor(answers, device=self.device),
            torch.tensor(deeds, device=self.device),
        )

    def losses(self, batch: Sampled) -> Mapping[str, Tensor]:
        """Of the moves, of what the question names, and of what else the network says."""
        if isinstance(self.model, PlannerController):
            return planner_controller_losses(self.model, batch)
        return doer_losses(self.model, batch)

    def score(self) -> Mapping[str, float]:
        """Success and SPL within MOST_STEPS from where the episodes of val rooms begin, and steps; shares of right answers."""
        if not self._val:
            return {}
        walks = Walks(self._val, [errand.start for errand in self._val])
        rngs = [np.random.default_rng([0, place]) for place in range(len(walks))]
        walk = walk_of(self.model, self._numbers(self._val))
        made = followed(walk, walks, rngs, None, MOST_STEPS, self.device)
        ways = np.array([errand.task.path_length_m for errand in self._val])
        found = {
            "val_success": float(walks.succeeded.mean()),
            "val_spl": float(spl(walks.succeeded, ways, walks.moved_m).mean()),
            "val_steps": float(made.is_going.sum(0).float().mean()),
        }
        if isinstance(walk, PlannedWalk):
            shown = walk.model.eye.along(made.features, walk.asking.names, made.is_going)
            logits = walk.model.answers(walk.asking, *last_views(shown, made.is_going))
            said = likeliest(logits, [errand.asked.kind for errand in self._val], self.vocabulary.answers)
            right = [self._answers[errand.task.question_id] for errand in self._val]
            found["val_answers"] = float(np.mean([one == other for one, other in zip(said, right, strict=True)]))
        return found

    def _numbers(self, chosen: Sequence[Errand]) -> Tensor:
        """Words of the questions of some errands."""
        numbers, _ = self.vocabulary.encode_batch([errand.task.question for errand in chosen])
        return torch.from_numpy(numbers).to(self.device)


def walk_of(model: nn.Module, numbers: Tensor) -> ImitatorWalk:
    """Begin walks of a network for questions with (n, w) numbers of words."""
    if isinstance(model, PlannerController):
        return PlannedWalk(model, numbers)
    if isinstance(model, MemoryPlanner):
        return RememberedWalk(model, numbers)
    assert isinstance(model, ViewTransformer), "there are three forms"
    return AttentiveWalk(model, numbers)


def best_moves(walks: Walks) -> Flags:
    """(n, moves) which moves bring each walk nearer to its target; Done where it is there."""
    best = np.zeros((len(walks), len(MOVES)), dtype=np.bool_)
    for place, (errand, state) in enumerate(zip(walks.errands, walks.states.tolist(), strict=True)):
        left = errand.distances[state]
        best[place, :DONE] = errand.distances[errand.room.transitions.table[state, _WALKED]] < left
        best[place, DONE] = left == 0
    return best


def followed(
    walk: ImitatorWalk,
    walks: Walks,
    rngs: Sequence[np.random.Generator],
    shares: np.ndarray | None,
    most_steps: int,
    device: str = "cpu",
) -> Followed:
    """Walk to the end of all walks.

    Parameters
    ----------
    walk : ImitatorWalk
        A network's.
    walks : Walks
        At their beginning.
    rngs : sequence of Generator
        Of each walk.
    shares : (n,) float, optional
        Of moves that are led; and who would stop elsewhere is led, too. Nobody is, if not given.
    most_steps : int
        After so many moves a walk ends in any case.
    device : str
        Where to compute.
    """
    before = torch.zeros(len(walks), len(MOVES) + 1, device=device)
    views, steps = [], []
    for _ in range(most_steps):
        is_going = ~walks.is_over
        if not is_going.any():
            break
        features = torch.from_numpy(walks.features()).to(device)
        best = torch.from_numpy(best_moves(walks)).to(device)
        draws = np.stack([rng.random(DRAWS + 1) for rng in rngs])
        lead = None if shares is None else Lead(best, torch.from_numpy(draws[:, DRAWS] < shares).to(device))
        moves, is_planned = walk.move(features, before, torch.from_numpy(draws).float().to(device), lead)
        if lead is not None:
            is_wrong = (moves == DONE) & ~best[:, DONE] & best.any(1)
            moves = torch.where(is_wrong, best.int().argmax(1), moves)
        was_done = torch.from_numpy(walks.step(moves.numpy(force=True))).to(device)
        going = torch.from_numpy(is_going).to(device)
        views.append(features[going])
        steps.append((before, best, is_planned, going))
        before = told(moves, was_done)
    return Followed(torch.cat(views), *(torch.stack(part) for part in zip(*steps, strict=True)))


def last_views(shown: Tensor, is_going: Tensor) -> tuple[Tensor, Tensor]:
    """The LAST_VIEWS before each walk's end, (LAST_VIEWS, n, SEEN), and which of these there are, (LAST_VIEWS, n) bool.

    Parameters
    ----------
    shown : (t, n, SEEN)
        What was seen.
    is_going : (t, n) bool
        See `Followed`.
    """
    ends = is_going.sum(0)
    steps = ends[None] - LAST_VIEWS + torch.arange(LAST_VIEWS, device=ends.device)[:, None]
    walk = torch.arange(len(ends), device=ends.device)
    return shown[steps.clamp(min=0), walk], steps >= 0


def planner_controller_losses(model: PlannerController, batch: Sampled) -> dict[str, Tensor]:
    """Of the planner where it was asked, of the controller where there was a move to repeat, and of the answer."""
    walks, asking = batch.walks, model.read(batch.numbers)
    shown = model.eye.along(walks.features, asking.names, walks.is_going)
    said = model(shown, walks.before, asking, walks.is_planned)
    last = walks.before[..., :-1] > 0
    is_known = walks.is_going & walks.best.any(2)
    goes_on = (last & walks.best).any(2).float()
    repeats = functional.binary_cross_entropy_with_logits(said.goes_on, goes_on, reduction="none")
    answers = model.answers(asking, *last_views(shown, walks.is_going))
    losses = {
        "moves": -mean_where(right_moves(said.moves, walks.best), is_known & walks.is_planned),
        "repeats": mean_where(repeats, is_known & last.any(2)),
        "answers": functional.cross_entropy(answers, batch.answers),
        "names": NAME_WEIGHT * functional.cross_entropy(asking.names.flatten(0, 1), batch.names.flatten()),
    }
    return {"loss": torch.stack(list(losses.values())).sum(), **losses}


def doer_losses(model: ViewTransformer | MemoryPlanner, batch: Sampled) -> dict[str, Tensor]:
    """Of the moves, and of what is to be done: nothing on the way, the manipulation at the target; both count alike."""
    walks, reading = batch.walks, model.read(batch.numbers)
    shown = model.eye.along(walks.features, reading.names, walks.is_going)
    said: Attended | Planned = model(shown, walks.before, reading)
    is_known = walks.is_going & walks.best.any(2)
    is_there = is_known & walks.best[..., DONE]
    wanted = torch.where(is_there, batch.deeds[None], DEEDS.index(None))
    deeds = functional.cross_entropy(said.deeds.flatten(0, 1), wanted.flatten(), reduction="none").view_as(is_there)
    losses = {
        "moves": -mean_where(right_moves(said.moves, walks.best), is_known),
        "deeds": (mean_where(deeds, is_there) + mean_where(deeds, is_known & ~is_there)) / 2,
        "names": NAME_WEIGHT * functional.cross_entropy(reading.names.flatten(0, 1), batch.names.flatten()),
    }
    return {"loss": torch.stack(list(losses.values())).sum(), **losses}


def right_moves(logits: Tensor, best: Tensor) -> Tensor:
    """(t, n) logarithms of the probability that a move is one of the best; 0 where there are none."""
    shares = logits.log_softmax(2).masked_fill(~best, -torch.inf)
    return torch.where(best.any(2, keepdim=True), shares, 0.0).logsumexp(2) * best.any(2)


def mean_where(values: Tensor, is_meant: Tensor) -> Tensor:
    """Mean of (t, n) values over (t, n) flags; 0 if there are none."""
    return (values * is_meant).sum() / is_meant.sum().clamp(min=1)
