"""Learning to walk by reward, in a corridor where everything is known."""

from collections.abc import Iterator

import numpy as np
import pytest
import torch

from remqa_data.agents.networks.actor_critic import DONE, MOVES, ActorCritic, PlainWalk, Seen, Thought, drawn, told
from remqa_data.agents.networks.adaptation import AT_ONCE, AdaptiveWalk, adapted, adaptive_weights
from remqa_data.agents.networks.threads import one_thread
from remqa_data.agents.training.adapting import AdaptingTask
from remqa_data.agents.training.cached_walks import NOT_THERE, Walks
from remqa_data.agents.training.reinforcing import (
    DISCOUNT,
    MISTAKEN,
    NEARER,
    REACHED,
    SMOOTHED,
    STEP,
    ReinforcingTask,
    Rollout,
    actor_critic_losses,
    advantages_of,
    rollout,
)
from tests.helpers.corridor import corridor_errand


@pytest.fixture(autouse=True)
def on_one_core() -> Iterator[None]:
    """Networks as small as these are slower on several."""
    with one_thread():
        yield


AHEAD, LEFT, RIGHT = (MOVES.index(name) for name in ("MoveAhead", "RotateLeft", "RotateRight"))


def task_in_the_corridor(kind: type[ReinforcingTask], form: str, seed: int = 0) -> ReinforcingTask:
    task = kind.__new__(kind)
    torch.manual_seed(seed)
    task.errands = [corridor_errand((cell, yaw)) for cell in range(5) for yaw in (0, 90, 180, 270)]
    task.model = ActorCritic(3, form)  # type: ignore[arg-type]
    task.device = "cpu"
    return task


def test_distances_are_actions_to_the_target() -> None:
    errand = corridor_errand((0, 0))
    number = errand.room.states.number
    assert errand.distances[errand.start] == 5  # a turn and four steps
    assert errand.distances[number(0.0, 0.0, 90, 0)] == 4
    assert errand.distances[number(1.0, 0.0, 270, 0)] == 2
    assert errand.distances[number(1.0, 0.0, 90, 30)] == NOT_THERE  # looking up and down does nothing here
    assert errand.distances[number(1.0, 0.0, 90, 0, False)] == NOT_THERE  # nobody stands up


def test_starts_are_not_farther_than_asked_and_not_at_the_target() -> None:
    errand = corridor_errand()
    rng = np.random.default_rng(0)
    drawn_far = [errand.distances[errand.some_start(rng, 6)] for _ in range(200)]
    assert set(drawn_far) == {1, 2, 3, 4, 5, 6}
    assert {int(errand.distances[errand.some_start(rng, 1)]) for _ in range(20)} == {1}


def test_walks_do_what_is_told_and_end_with_done() -> None:
    walks = Walks(
        [corridor_errand((3, 90)), corridor_errand((3, 0))],
        [errand.start for errand in (corridor_errand((3, 90)), corridor_errand((3, 0)))],
    )
    assert walks.step(np.array([AHEAD, AHEAD])).tolist() == [True, False]  # the second one looks at a wall
    assert walks.moved_m.tolist() == [0.25, 0.0]
    walks.step(np.array([DONE, DONE]))
    assert walks.is_over.tolist() == [True, True]
    assert walks.succeeded.tolist() == [True, False]
    before = walks.states.copy()
    walks.step(np.array([LEFT, LEFT]))
    assert (walks.states == before).all()


class Told:
    """Does the same in each walk."""

    def __init__(self, *moves: int) -> None:
        self.moves = iter(moves)

    def think(
        self,
        features: torch.Tensor,
        asked: torch.Tensor,
        before: torch.Tensor,
        is_going: torch.Tensor | None = None,
    ) -> torch.Tensor:
        return torch.eye(len(MOVES))[[next(self.moves)] * len(asked)] * 1e4


def test_rewards_are_for_what_comes_nearer_and_for_stopping_at_the_target() -> None:
    rngs = [np.random.default_rng(0)]
    errand = corridor_errand((3, 0))
    made = rollout(Told(RIGHT, AHEAD, DONE), Walks([errand], [errand.start]), rngs)
    wanted = [STEP + NEARER, STEP + NEARER, STEP + REACHED]
    assert np.allclose(made.rewards[:, 0], wanted)
    assert bool(made.is_done[0])
    made = rollout(Told(LEFT, DONE), Walks([errand], [errand.start]), rngs)
    assert np.allclose(made.rewards[:, 0], [STEP - NEARER, STEP + MISTAKEN])
    assert made.before[1, 0].tolist() == [0, 1, 0, 0, 0, 0, 0]


def test_advantages_by_hand() -> None:
    rewards, values = torch.tensor([[1.0, 1.0], [2.0, 0.0]]), torch.tensor([[0.5, 0.5], [0.25, 9.0]])
    is_going = torch.tensor([[True, True], [True, False]])  # the second walk ends with its first step
    found = advantages_of(rewards, values, is_going, torch.tensor([True, True]))
    last = 2.0 - 0.25
    assert np.allclose(found[:, 0], [1.0 + DISCOUNT * 0.25 - 0.5 + DISCOUNT * SMOOTHED * last, last])
    assert np.allclose(found[:, 1], [0.5, 0.0])
    found = advantages_of(rewards[:, :1], values[:, :1], is_going[:, :1], torch.tensor([False]))
    assert np.isclose(found[1, 0], last + DISCOUNT * 0.25)  # it would have gone on


def test_moves_are_drawn_as_often_as_they_are_likely() -> None:
    logits = torch.log(torch.tensor([[0.1, 0.2, 0.3, 0.2, 0.1, 0.1]])).expand(10_000, -1)
    draws = torch.from_numpy(np.random.default_rng(0).random(10_000))
    shares = np.bincount(drawn(logits, draws), minlength=6) / 10_000
    assert np.allclose(shares, [0.1, 0.2, 0.3, 0.2, 0.1, 0.1], atol=0.02)
    assert drawn(logits[:1], torch.tensor([1.0])).tolist() == [5]
    assert told(torch.tensor([2]), torch.tensor([False])).tolist() == [[0, 0, 1, 0, 0, 0, 1]]


def learnt(task: ReinforcingTask, batches: int, walks: int) -> float:
    """Share of the last walks that succeed."""
    optimizer = torch.optim.AdamW(task.model.parameters(), lr=0.002)
    for number in range(batches):
        batch = task.batch(np.arange(walks), [np.random.default_rng([number, walk]) for walk in range(walks)])
        optimizer.zero_grad()
        task.losses(batch)["loss"].backward()  # type: ignore[no-untyped-call]
        optimizer.step()
    return float((batch.rewards > REACHED - 1).any(0).float().mean())


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1])
def test_an_actor_critic_learns_to_walk_the_corridor(seed: int) -> None:
    task = task_in_the_corridor(ReinforcingTask, "a3c", seed)
    assert learnt(task, 1, 64) < 0.5
    assert learnt(task, 70, 64) > 0.9


@pytest.mark.slow
def test_the_same_generators_make_the_same_walks() -> None:
    task = task_in_the_corridor(ReinforcingTask, "scene_priors")
    first, again, other = (
        task.batch(np.arange(8), [np.random.default_rng([seed, walk]) for walk in range(8)]) for seed in (0, 0, 1)
    )
    assert torch.equal(first.moves, again.moves)
    assert first.moves.shape != other.moves.shape or not torch.equal(first.moves, other.moves)


def test_a_step_down_the_learnt_loss_lowers_it_and_gradients_go_through_it() -> None:
    task = task_in_the_corridor(AdaptingTask, "savn")
    model = task.model
    errand = corridor_errand()
    made = rollout(Told(*[LEFT] * 50), Walks([errand], [errand.start]), [np.random.default_rng(0)])
    seen = Seen(made.features[:AT_ONCE], made.asked, made.before[:AT_ONCE])
    weights = adaptive_weights(model)
    thought = model(seen, model.rest(1))
    before = float(model.loss(thought.hidden[:, 0], thought.moves[:, 0].softmax(1)).detach())
    moved = adapted(model, weights, thought, is_learning=True)
    again = torch.func.functional_call(model, moved, (seen, model.rest(1)))
    after = model.loss(again.hidden[:, 0], again.moves[:, 0].softmax(1))
    assert float(after.detach()) < before
    again.moves.square().sum().backward()
    assert model.loss.first.weight.grad is not None
    assert float(model.loss.first.weight.grad.abs().sum()) > 0


@pytest.mark.parametrize("form", ["a3c", "scene_priors"])
def test_what_walks_see_that_are_over_is_not_looked_at(form) -> None:
    model = task_in_the_corridor(ReinforcingTask, form).model
    features, asked, before = torch.rand(4, 3, 49, 64), torch.tensor([[1, 2], [2, 0], [3, 1]]), torch.rand(4, 3, 7)
    is_going = torch.tensor([[True, True, True], [True, False, True], [True, False, True], [False, False, True]])
    features_left = torch.where(is_going[..., None, None], features, torch.nan)
    with torch.no_grad():
        thought = model(Seen(features, asked, before), model.rest(3))
        again = model(Seen(features_left, asked, before, is_going), model.rest(3))
    assert torch.allclose(thought.moves[is_going], again.moves[is_going], atol=1e-6)
    assert torch.allclose(thought.values[is_going], again.values[is_going], atol=1e-6)
    assert again.moves.isfinite().all()


@pytest.mark.slow
def test_savn_walks_and_learns_with_the_same_corrections() -> None:
    """What it thought on its way is what training works out again."""
    task = task_in_the_corridor(AdaptingTask, "savn")
    assert isinstance(task, AdaptingTask)
    errands = [corridor_errand(), corridor_errand((2, 270))]
    walks = Walks(errands, [errand.start for errand in errands])
    thinker, thoughts = AdaptiveWalk(task.model, 2), []

    class Listening:
        def think(self, *seen: torch.Tensor) -> torch.Tensor:
            thoughts.append(thinker.think(*seen).detach())
            return Told(LEFT).think(*seen)

    made = rollout(Listening(), walks, [np.random.default_rng(0)] * 2)
    again = task._thought_again(made, 1).moves[:, 0]
    assert torch.allclose(again, torch.stack(thoughts)[:, 1], atol=1e-5)
    plain = PlainWalk(task.model, 2)
    unmoved = torch.stack([plain.think(made.features[step], made.asked, made.before[step]) for step in range(20)])
    assert torch.allclose(unmoved[:AT_ONCE, 1], again[:AT_ONCE], atol=1e-5)
    assert not torch.allclose(unmoved[-1, 1], again[19], atol=1e-5)


def test_of_a_single_step_something_is_learnt_too() -> None:
    moves = torch.zeros(1, 1, len(MOVES), requires_grad=True)
    thought = Thought(moves, torch.zeros(1, 1), torch.zeros(1, 1, 1), (torch.zeros(1, 1), torch.zeros(1, 1)))
    done, going = torch.full((1, 1), DONE), torch.ones(1, 1, dtype=torch.bool)
    none = torch.zeros(1, 1)
    losses = actor_critic_losses(thought, Rollout(none, none, none, done, torch.full((1, 1), REACHED), going, going[0]))
    assert all(torch.isfinite(loss) for loss in losses.values())
    losses["loss"].backward()
    assert moves.grad is not None
    assert torch.isfinite(moves.grad).all()
