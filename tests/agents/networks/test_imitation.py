"""A planner and a controller, and a transformer: how moves are decided on, repeated and led, and what a view sees."""

import numpy as np
import torch

from remqa_data.agents.networks.actor_critic import DONE, MOVES, told
from remqa_data.agents.networks.imitation import DOUBT, DRAWS, SEEN, SHARPNESS, Eye, Lead, led
from remqa_data.agents.networks.planner_controller import MOST_REPEATS, PlannedWalk, PlannerController
from remqa_data.agents.networks.view_transformer import LAYERS, VIEWS, AttentiveWalk, ViewTransformer

TYPES, WORDS = 3, 9
NUMBERS = torch.tensor([[2, 3, 4, 0], [5, 6, 7, 8]])
HALF = torch.full((2, DRAWS), 0.5)


def flags(*moves: int) -> torch.Tensor:
    best = torch.zeros(len(moves), len(MOVES), dtype=torch.bool)
    for place, move in enumerate(moves):
        best[place, move] = True
    return best


def planner(goes_on: float) -> PlannerController:
    """One whose controller always says the same."""
    torch.manual_seed(0)
    model = PlannerController(WORDS, 2, TYPES).eval()
    last = model.controller[-1]
    assert isinstance(last, torch.nn.Linear)
    with torch.no_grad():
        last.weight.zero_()
        last.bias.fill_(goes_on)
    return model


def steps(
    walk: PlannedWalk | AttentiveWalk, count: int, lead: Lead | None = None
) -> list[tuple[list[int], list[bool]]]:
    """Moves, and whether they were planned, in views that never look alike."""
    generator = torch.Generator().manual_seed(1)
    before, found = torch.zeros(2, len(MOVES) + 1), []
    for _ in range(count):
        features, draws = torch.randn(2, 49, 64, generator=generator), torch.rand(2, DRAWS, generator=generator)
        chosen = walk.move(features, before, draws, lead)
        found.append((chosen.moves.tolist(), chosen.is_planned.tolist()))
        before = told(chosen.moves, torch.tensor([True, True]))
    return found


# ---- the eye


def test_the_eye_sees_each_walk_by_what_it_looks_for_and_nothing_where_a_walk_is_over() -> None:
    torch.manual_seed(0)
    eye = Eye(4, TYPES)
    features, names = torch.randn(3, 49, 64), torch.randn(2, 2, 1 + TYPES)
    shown = eye.along(features, names, torch.tensor([[True, True], [False, True]]))
    assert torch.allclose(shown[0, 0], eye(features[:1], names[:1])[0], atol=1e-6)
    assert torch.allclose(shown[0, 1], eye(features[1:2], names[1:])[0], atol=1e-6)
    assert torch.allclose(shown[1, 1], eye(features[2:], names[1:])[0], atol=1e-6)
    assert not shown[1, 0].any()
    assert not torch.allclose(shown[0, 0], eye(features[:1], names[1:])[0])


# ---- the planner and its controller


def test_the_controller_repeats_a_move_but_not_for_ever() -> None:
    found = steps(PlannedWalk(planner(50.0), NUMBERS), 2 * MOST_REPEATS)
    planned = [is_planned for _, is_planned in found]
    assert planned == ([[True, True]] + [[False, False]] * (MOST_REPEATS - 1)) * 2
    moves = [move for move, _ in found]
    assert moves[:MOST_REPEATS] == [moves[0]] * MOST_REPEATS


def test_where_the_controller_gives_control_back_the_planner_decides() -> None:
    found = steps(PlannedWalk(planner(-50.0), NUMBERS), 8)
    assert all(is_planned == [True, True] for _, is_planned in found)
    assert len({tuple(moves) for moves, _ in found}) > 2


def test_the_planner_remembers_its_decisions_and_not_the_steps_between() -> None:
    walk = PlannedWalk(planner(50.0), NUMBERS)
    steps(walk, 1)
    decided = walk._hidden
    before = told(torch.tensor([0, 0]), torch.tensor([True, True]))
    walk.move(torch.randn(2, 49, 64), before, HALF)
    assert torch.equal(walk._hidden, decided)
    assert not torch.equal(decided, walk.model.rest(2))


def test_who_is_led_repeats_while_that_is_right_and_then_does_what_is() -> None:
    walk = PlannedWalk(planner(-50.0), NUMBERS)
    lead = Lead(flags(1, 2), torch.tensor([True, True]))
    assert steps(walk, 3, lead) == [([1, 2], [True, True]), ([1, 2], [False, False]), ([1, 2], [False, False])]
    before = told(torch.tensor([1, 2]), torch.tensor([True, True]))
    chosen = walk.move(torch.zeros(2, 49, 64), before, HALF, Lead(flags(1, DONE), torch.tensor([True, True])))
    assert chosen.moves.tolist() == [1, DONE]
    assert chosen.is_planned.tolist() == [False, True]


def test_what_is_thought_along_a_whole_walk_is_what_was_thought_on_the_way() -> None:
    torch.manual_seed(3)
    model = PlannerController(WORDS, 2, TYPES).eval()
    walk = PlannedWalk(model, NUMBERS)
    features, draws = torch.randn(12, 2, 49, 64), torch.rand(12, 2, DRAWS)
    before, befores, planned, states = torch.zeros(2, len(MOVES) + 1), [], [], []
    for view, draw in zip(features, draws, strict=True):
        chosen = walk.move(view, before, draw)
        befores.append(before)
        planned.append(chosen.is_planned)
        states.append(walk._hidden)
        before = told(chosen.moves, torch.tensor([True, False]))
    with torch.no_grad():
        asking = model.read(NUMBERS)
        shown = model.eye.along(features.flatten(0, 1), asking.names, torch.ones(12, 2, dtype=torch.bool))
        said = model(shown, torch.stack(befores), asking, torch.stack(planned))
        wanted = model.plan(torch.stack(states))
    is_planned = torch.stack(planned)
    assert 0 < int(is_planned.sum()) < is_planned.numel()  # some moves were repeated, some not
    assert torch.allclose(said.moves[is_planned], wanted[is_planned], atol=1e-5)


def test_answers_do_not_come_from_views_that_there_are_not() -> None:
    model = planner(0.0)
    asking, shown = model.read(NUMBERS), torch.rand(5, 2, SEEN)
    is_view = torch.tensor([[False, True]] * 2 + [[True, True]] * 3)
    other = torch.where(is_view[..., None], shown, torch.rand(5, 2, 128))
    with torch.no_grad():
        assert torch.equal(model.answers(asking, shown, is_view), model.answers(asking, other, is_view))
        assert not torch.equal(
            model.answers(asking, shown, is_view), model.answers(asking, other, torch.ones_like(is_view))
        )


# ---- the transformer


def transformer() -> ViewTransformer:
    torch.manual_seed(0)
    model = ViewTransformer(WORDS, TYPES).eval()
    with torch.no_grad():
        model.ago.normal_()
    return model


def test_step_by_step_it_thinks_what_it_thinks_along_the_whole_walk() -> None:
    model = transformer()
    count = 2 * VIEWS
    shown, before = torch.randn(count, 2, SEEN), torch.rand(count, 2, len(MOVES) + 1)
    with torch.no_grad():
        reading = model.read(NUMBERS)
        whole, known = model(shown, before, reading), None
        for step in range(count):
            said = model(shown[step : step + 1], before[step : step + 1], reading, known)
            known = said.known
            assert torch.allclose(said.moves[0], whole.moves[step], atol=1e-4)
        assert [part.shape[1] for part in said.known] == [VIEWS - 1] * LAYERS


def test_a_view_sees_nothing_that_comes_later_and_not_what_is_long_ago() -> None:
    model = transformer()
    reach = LAYERS * (VIEWS - 1)
    shown, before = torch.randn(reach + 3, 1, SEEN), torch.zeros(reach + 3, 1, len(MOVES) + 1)
    with torch.no_grad():
        reading = model.read(NUMBERS[1:])
        first = model(shown, before, reading).moves
        shown[1] = torch.randn(1, SEEN)
        second = model(shown, before, reading).moves
    is_other = ((first - second).abs() > 1e-6).any(2)[:, 0].tolist()
    assert not is_other[0]
    assert is_other[1]
    assert is_other[VIEWS]
    assert not is_other[reach + 2]


def test_what_fills_a_shorter_question_up_is_not_read() -> None:
    model = transformer()
    shown, before = torch.randn(3, 1, SEEN), torch.zeros(3, 1, len(MOVES) + 1)
    with torch.no_grad():
        short, longer, other = (
            model(shown, before, model.read(numbers)).moves for numbers in (NUMBERS[:1, :3], NUMBERS[:1], NUMBERS[1:])
        )
    assert torch.allclose(short, longer, atol=1e-5)
    assert not torch.allclose(short, other, atol=1e-3)


# ---- who leads


def test_who_is_alone_prefers_likelier_moves_and_stops_late() -> None:
    shares = np.array([0.3, 0.1, 0.1, 0.1, 0.1, 0.3])
    own = torch.log(torch.from_numpy(shares)).expand(10_000, -1)
    draws = torch.from_numpy(np.random.default_rng(0).random(10_000))
    wanted = shares**SHARPNESS
    wanted[DONE] *= np.exp(-SHARPNESS * DOUBT)
    found = np.bincount(led(own, draws, None), minlength=6) / 10_000
    assert np.allclose(found, wanted / wanted.sum(), atol=0.02)
    nobody = Lead(torch.ones(10_000, 6, dtype=torch.bool), torch.zeros(10_000, dtype=torch.bool))
    assert np.allclose(np.bincount(led(own, draws, nobody), minlength=6) / 10_000, shares, atol=0.02)


def test_who_is_led_does_one_of_the_best_moves_and_any_of_them() -> None:
    own = torch.zeros(2, len(MOVES))
    own[:, DONE] = 50.0
    best = flags(1, 3)
    best[0, 4] = True
    lead = Lead(best, torch.tensor([True, False]))
    found = [led(own, torch.full((2,), draw), lead).tolist() for draw in (0.01, 0.3, 0.7, 0.999)]
    assert found == [[1, DONE], [1, DONE], [4, DONE], [4, DONE]]
    assert led(own, torch.tensor([0.5, 0.5]), None).tolist() == [DONE, DONE]
    nothing = Lead(torch.zeros_like(best), torch.tensor([True, True]))
    assert led(own, torch.tensor([0.5, 0.5]), nothing).tolist() == [DONE, DONE]
