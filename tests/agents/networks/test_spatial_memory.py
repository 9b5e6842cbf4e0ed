"""A memory in space: where the agent is, what it writes where, what it reads there again, and that this can be learnt from."""

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from remqa_data.agents.networks.actor_critic import MOVES, told
from remqa_data.agents.networks.imitation import DRAWS, SEEN
from remqa_data.agents.networks.spatial_memory import (
    AHEAD,
    SIDE,
    WAYS,
    MemoryPlanner,
    RememberedWalk,
    cells_at,
    moved,
)

WORDS, TYPES = 9, 3
MIDDLE = SIDE // 2
GO, LEFT, RIGHT = (MOVES.index(name) for name in ("MoveAhead", "RotateLeft", "RotateRight"))


def walked(moves: list[int], refused: tuple[int, ...] = ()) -> tuple[list[int], int]:
    places, headings = torch.full((1, 2), MIDDLE), torch.zeros(1, dtype=torch.int64)
    for number, move in enumerate(moves):
        last = told(torch.tensor([move]), torch.tensor([number not in refused]))
        places, headings = moved(places, headings, last)
    return (places[0] - MIDDLE).tolist(), int(headings)


def test_the_agent_knows_where_it_is_by_its_moves() -> None:
    assert walked([GO, GO, RIGHT, GO]) == ([1, 2], 1)
    assert walked([LEFT, GO, LEFT, GO, GO]) == ([-1, -2], 2)
    assert walked([GO, RIGHT, GO], refused=(0, 1)) == ([0, 1], 0)
    assert walked([MOVES.index("LookUp"), MOVES.index("LookDown")]) == ([0, 0], 0)
    assert walked([GO] * 100) == ([0, SIDE - 1 - MIDDLE], 0)  # it does not leave the map


@given(st.integers(0, 3), st.integers(8, SIDE - 9), st.integers(8, SIDE - 9))
def test_rows_lie_ahead_and_columns_from_left_to_right(heading: int, east: int, north: int) -> None:
    found = cells_at(torch.tensor([[east, north]]), torch.tensor([heading]), AHEAD, first_row=0)[0]
    at = torch.stack([found % SIDE - east, found // SIDE - north], 1).view(AHEAD, AHEAD, 2)
    ahead, right = torch.tensor(WAYS[heading]), torch.tensor(WAYS[(heading + 1) % 4])
    assert at[0, AHEAD // 2].tolist() == [0, 0]
    assert (at[3, AHEAD // 2] == 3 * ahead).all()
    assert (at[2, 0] == 2 * ahead - AHEAD // 2 * right).all()
    assert len(set(found.tolist())) == AHEAD**2


def model() -> MemoryPlanner:
    torch.manual_seed(0)
    return MemoryPlanner(WORDS, TYPES).eval()


@torch.no_grad()
def test_what_was_seen_stays_where_it_was_seen() -> None:
    network = model()
    asking = network.read(torch.tensor([[2, 3, 4]]))
    generator = torch.Generator().manual_seed(0)
    views = torch.randn(3, 1, SEEN, generator=generator)
    turn = told(torch.tensor([RIGHT]), torch.tensor([True]))
    first = network.remember(network.nothing(1), views[0], torch.zeros(1, len(MOVES) + 1), asking)
    assert int(first.is_written.sum()) == AHEAD**2
    assert not first.cells[~first.is_written].any()
    once = network.remember(first, views[1], turn, asking)
    north = cells_at(first.places, first.headings, AHEAD, 0)[0]
    east = cells_at(once.places, once.headings, AHEAD, 0)[0]
    untouched = sorted(set(north.tolist()) - set(east.tolist()))
    assert untouched
    assert torch.equal(once.cells[0, untouched], first.cells[0, untouched])
    assert not torch.equal(once.cells[0, east], first.cells[0, east])
    assert not torch.equal(once.hidden, first.hidden)


def test_what_is_thought_in_bfloat16_is_remembered_too() -> None:
    network = model()
    asking = network.read(torch.tensor([[2, 3, 4]]))
    view, before = torch.randn(1, SEEN, generator=torch.Generator().manual_seed(0)), torch.zeros(1, len(MOVES) + 1)
    with torch.autocast("cpu", torch.bfloat16):
        short = network.remember(network.nothing(1), view, before, asking)
    full = network.remember(network.nothing(1), view, before, asking)
    assert short.cells.dtype == torch.float32
    assert not torch.equal(short.cells, full.cells)
    assert torch.allclose(short.cells, full.cells, atol=0.05)
    assert torch.allclose(short.hidden.float(), full.hidden, atol=0.05)


@torch.no_grad()
def test_a_walk_thinks_what_is_thought_along_the_whole_walk() -> None:
    network, generator = model(), torch.Generator().manual_seed(1)
    numbers = torch.tensor([[2, 3, 4, 0], [5, 6, 7, 8]])
    walk, asking = RememberedWalk(network, numbers), network.read(numbers)
    before, shown, lasts, deeds = torch.zeros(2, len(MOVES) + 1), [], [], []
    for _ in range(6):
        features, draws = torch.randn(2, 49, 64, generator=generator), torch.rand(2, DRAWS, generator=generator)
        chosen = walk.move(features, before, draws)
        shown.append(network.eye(features, asking.names))
        lasts.append(before)
        deeds.append(walk.deeds)
        before = told(chosen.moves, torch.tensor([True, False]))
    said = network(torch.stack(shown), torch.stack(lasts), asking)
    assert torch.allclose(said.deeds, torch.stack(deeds), atol=1e-5)


@pytest.mark.slow
def test_it_learns_to_turn_back_to_what_it_has_seen_before() -> None:
    """In the first view the thing is at the left or at the right; after a blank view one turns to it."""
    torch.manual_seed(0)
    network, generator = MemoryPlanner(WORDS, TYPES), torch.Generator().manual_seed(0)
    optimizer = torch.optim.AdamW(network.parameters(), lr=3e-3)
    numbers, signs = torch.tensor([[2, 3]]), torch.randn(SEEN, generator=generator)

    def said(is_left: torch.Tensor) -> torch.Tensor:
        first = torch.where(is_left[:, None], signs, -signs)
        shown = torch.stack([first, torch.zeros_like(first)])
        last = torch.zeros(2, len(is_left), len(MOVES) + 1)
        moves: torch.Tensor = network(shown, last, network.read(numbers.expand(len(is_left), -1))).moves[1]
        return moves

    for _ in range(40):
        is_left = torch.rand(16, generator=generator) < 0.5
        loss = torch.nn.functional.cross_entropy(said(is_left), torch.where(is_left, LEFT, RIGHT))
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
    is_left = torch.tensor([True, False, True, True])
    assert said(is_left).argmax(1).tolist() == [LEFT, RIGHT, LEFT, LEFT]
    assert network.write.weight.grad is not None
    assert network.write.weight.grad.abs().sum() > 0
