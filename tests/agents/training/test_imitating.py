"""Learning to walk by imitation, in a corridor where everything is known."""

import math

import numpy as np
import pytest
import torch

from remqa_data.agents.networks.actor_critic import DONE, MOVES
from remqa_data.agents.networks.imitation import DEEDS, ImitatorForm
from remqa_data.agents.networks.planner_controller import LAST_VIEWS, PlannerController
from remqa_data.agents.training.cached_walks import Walks
from remqa_data.agents.training.imitating import (
    DOERS,
    ImitationTask,
    best_moves,
    followed,
    last_views,
    mean_where,
    right_moves,
    walk_of,
)
from remqa_data.datasets.vocabulary import Vocabulary
from tests.helpers.corridor import QUESTION, corridor_errand

AHEAD, LEFT, RIGHT = (MOVES.index(name) for name in ("MoveAhead", "RotateLeft", "RotateRight"))
EVERYWHERE = [(cell, yaw) for cell in range(5) for yaw in (0, 90, 180, 270)]
FORMS: tuple[ImitatorForm, ...] = ("planner_controller", "transformer", "spatial_memory")


def task_in_the_corridor(form: ImitatorForm) -> ImitationTask:
    task = ImitationTask.__new__(ImitationTask)
    torch.manual_seed(0)
    task.errands = task._val = [corridor_errand(place) for place in EVERYWHERE]
    task._answers = {"q": "2"}
    task.vocabulary = Vocabulary.build([QUESTION], ["1", "2"])
    words = len(task.vocabulary.words)
    task.model = PlannerController(words, 2, 3) if form == "planner_controller" else DOERS[form](words, 3)
    task.device = "cpu"
    return task


def generators(seed: int, count: int) -> list[np.random.Generator]:
    return [np.random.default_rng([seed, place]) for place in range(count)]


def learn(task: ImitationTask, batches: int) -> None:
    optimizer = torch.optim.AdamW(task.model.parameters(), lr=0.003)
    for number in range(batches):
        optimizer.zero_grad()
        task.losses(task.batch(np.arange(32), generators(number, 32)))["loss"].backward()  # type: ignore[no-untyped-call]
        optimizer.step()


def deeds_right(task: ImitationTask) -> tuple[float, float]:
    """How often it is known that the fridge is to be opened where it is found, and how often that nothing is elsewhere."""
    batch = task.batch(np.arange(16), generators(9, 16))
    assert not isinstance(task.model, PlannerController)
    with torch.no_grad():
        reading = task.model.read(batch.numbers)
        shown = task.model.eye.along(batch.walks.features, reading.names, batch.walks.is_going)
        said = task.model(shown, batch.walks.before, reading).deeds.argmax(2)
    is_there = batch.walks.is_going & batch.walks.best[..., DONE]
    on_the_way = batch.walks.is_going & ~is_there
    opens, nothing = said[is_there] == DEEDS.index("Open"), said[on_the_way] == DEEDS.index(None)
    return float(opens.float().mean()), float(nothing.float().mean())


def test_best_moves_are_all_that_come_nearer_and_done_at_the_target() -> None:
    errands = [corridor_errand(place) for place in ((0, 90), (2, 270), (3, 0), (4, 90))]
    found = best_moves(Walks(errands, [errand.start for errand in errands]))
    assert [set(np.flatnonzero(row)) for row in found] == [{AHEAD}, {LEFT, RIGHT}, {RIGHT}, {DONE}]


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMS)
def test_who_is_led_walks_a_shortest_way_and_who_is_not_may_stop_anywhere(form: ImitatorForm) -> None:
    task = task_in_the_corridor(form)
    head = task.model.plan if isinstance(task.model, PlannerController) else task.model.policy
    with torch.no_grad():
        head.bias[DONE] = 5.0  # it is eager to stop
    errands = task.errands
    numbers = task._numbers(errands)
    walks = Walks(errands, [errand.start for errand in errands])
    made = followed(walk_of(task.model, numbers), walks, generators(0, 20), np.ones(20), 50)
    assert made.is_going.sum(0).tolist() == [1 + errand.distances[errand.start] for errand in errands]
    assert walks.succeeded.all()
    half = Walks(errands, [errand.start for errand in errands])
    followed(walk_of(task.model, numbers), half, generators(0, 20), np.zeros(20), 50)
    assert (half.succeeded == half.is_over).all()  # who learns does not stop elsewhere
    free = Walks(errands, [errand.start for errand in errands])
    followed(walk_of(task.model, numbers), free, generators(0, 20), None, 50)
    assert (free.is_over & ~free.succeeded).sum() >= 15


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMS)
def test_the_way_through_the_corridor_is_learnt(form: ImitatorForm) -> None:
    task = task_in_the_corridor(form)
    task.model.eval()
    with torch.no_grad():
        assert task.score()["val_success"] < 0.4
    task.model.train()
    learn(task, 26)
    task.model.eval()
    with torch.no_grad():
        score = task.score()
    assert score["val_success"] > 0.8
    assert score["val_steps"] < 10
    if form == "planner_controller":
        assert score["val_answers"] == 1.0
    else:
        assert min(deeds_right(task)) > 0.9


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMS)
def test_the_same_generators_make_the_same_walks(form: ImitatorForm) -> None:
    task = task_in_the_corridor(form)
    task.model.eval()
    first, again, other = (task.batch(np.arange(8), generators(seed, 8)) for seed in (0, 0, 1))
    assert torch.equal(first.walks.before, again.walks.before)
    assert first.walks.before.shape != other.walks.before.shape or not torch.equal(
        first.walks.before, other.walks.before
    )


def test_the_last_views_are_those_before_the_end_of_each_walk() -> None:
    shown = torch.arange(8.0)[:, None, None].expand(8, 2, 1)
    is_going = torch.tensor([[True, step < 3] for step in range(8)])
    views, is_view = last_views(shown, is_going)
    assert LAST_VIEWS == 5
    assert views[:, 0].flatten().tolist() == [3, 4, 5, 6, 7]
    assert is_view[:, 0].all()
    assert is_view[:, 1].tolist() == [False, False, True, True, True]
    assert views[2:, 1].flatten().tolist() == [0, 1, 2]


def test_any_of_the_best_moves_is_right() -> None:
    logits = torch.log(torch.tensor([0.1, 0.2, 0.3, 0.2, 0.1, 0.1]))[None, None].expand(1, 3, 6).requires_grad_()
    best = torch.zeros(1, 3, 6, dtype=torch.bool)
    best[0, 0, [1, 2]] = best[0, 1, 5] = True
    found = right_moves(logits, best)
    assert np.allclose(found.detach(), [[math.log(0.5), math.log(0.1), 0.0]])
    slopes = torch.autograd.grad(found.sum(), logits)[0]
    assert torch.isfinite(slopes).all()
    assert (slopes[0, 2] == 0).all()  # where nothing is known nothing is learnt
    flags = torch.tensor([[True, False, True]])
    assert float(mean_where(torch.tensor([[1.0, 5.0, 2.0]]), flags)) == 1.5
    assert float(mean_where(torch.tensor([[1.0]]), torch.tensor([[False]]))) == 0.0
