import pytest
import torch

from remqa_data.agents.networks.answerer import ManipulationAnswerer, View, _counts, _evidence, likeliest

ANSWERS = ("0", "1", "2", "no", "yes")
WORDS, TYPES = 20, 6


def answerer(*views: View) -> ManipulationAnswerer:
    torch.manual_seed(0)
    return ManipulationAnswerer(WORDS, len(ANSWERS), TYPES, views).eval()


def pictures(seed: int) -> torch.Tensor:
    return torch.randint(0, 256, (1, 2, 3, 48, 48), dtype=torch.uint8, generator=torch.Generator().manual_seed(seed))


@pytest.mark.parametrize("views", [("start", "end"), ("start",), ("end",), ()])
def test_it_looks_at_the_views_that_it_is_to_look_at_and_at_no_others(views: tuple[View, ...]) -> None:
    network, numbers, seen = answerer(*views), torch.tensor([[2, 3, 4]]), pictures(0)
    said = network(numbers, seen).answers
    for place, view in enumerate(("start", "end")):
        changed = seen.clone()
        changed[:, place] = pictures(1)[:, place]
        assert torch.equal(network(numbers, changed).answers, said) == (view not in views)


def test_it_says_of_every_cell_of_both_views_whether_it_fits_and_what_it_shows() -> None:
    said = answerer("start", "end")(torch.tensor([[2, 3]]), pictures(0))
    assert said.fits.shape == (1, 2, 12, 12)
    assert said.middles.shape == (1, 2, 12, 12)
    assert said.counts.shape == (1, 2)
    assert said.cells.shape == (1, 2, 1 + TYPES, 12, 12)
    assert said.answers.shape == (1, len(ANSWERS))


def test_it_counts_middles_of_what_fits_and_of_nothing_else() -> None:
    middles, fits = torch.full((1, 2, 12, 12), -20.0), torch.full((1, 2, 12, 12), -20.0)
    fits[0, 1, :, :6] = 20.0
    for row, column in ((2, 2), (2, 5), (9, 2), (9, 9)):  # the last one is not what is asked for
        middles[0, 1, row, column] = 20.0
        middles[0, 1, row + 1, column] = 5.0  # beside a middle
    assert torch.allclose(_counts(middles, fits), torch.tensor([[0.0, 3.0]]), atol=1e-3)


def test_how_near_a_count_is_to_each_number() -> None:
    near = _evidence(torch.zeros((1, 1, 4, 4)), torch.tensor([[2.25]]))[0, 0, -4:]
    assert near.tolist() == pytest.approx([0.0, 0.0, 0.75, 0.25])


def test_padding_and_other_questions_of_the_batch_do_not_matter() -> None:
    network, seen = answerer("end"), torch.cat([pictures(0), pictures(1)])
    both = network(torch.tensor([[2, 3, 0], [4, 5, 6]]), seen).answers
    alone = network(torch.tensor([[2, 3]]), seen[:1]).answers
    assert torch.allclose(both[:1], alone, atol=1e-5)


def test_a_number_is_the_answer_where_one_is_asked_for_and_nowhere_else() -> None:
    logits = torch.tensor([[0.0, 1.0, 5.0, 9.0, 2.0], [0.0, 9.0, 5.0, 1.0, 2.0]])
    assert likeliest(logits, ["COUNTING", "EXISTENCE"], ANSWERS) == ["2", "yes"]
