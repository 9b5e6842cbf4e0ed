"""The order of the systems beside the paper's."""

import pytest

from remqa_data.agents.config import load_system, systems
from remqa_data.agents.paper import paper_results
from remqa_data.agents.ranking import NAMESAKES, order, orders_grid
from remqa_data.agents.training.config import load_network_config, networks


def test_all_who_stand_for_a_row_of_the_paper_come_with_the_package() -> None:
    titles = {load_system(name).title for name in systems()}
    trained = {load_network_config(name).title for name in networks()}
    titles |= trained | {f"{title}, detected boxes" for title in trained}  # one stage knows no boxes beforehand
    for table, names in NAMESAKES.items():
        assert set(names) <= titles
        assert set(names.values()) <= set(paper_results()[table])
        assert len(set(names.values())) == len(names)


def test_the_same_order_is_one_and_the_opposite_minus_one() -> None:
    theirs = {name: figures["SPL@50"] for name, figures in paper_results()["VSN"].items()}
    assert order("VSN", "SPL@50", theirs, {name: 2 * value for name, value in theirs.items()}).tau == pytest.approx(1)
    opposite = order("VSN", "SPL@50", theirs, {name: -value for name, value in theirs.items()})
    assert opposite.tau == pytest.approx(-1)
    assert len(opposite.inverted) == 5 * 4 / 2


def test_who_changed_places_is_named_the_better_one_of_the_paper_first() -> None:
    theirs, ours = {"a": 3.0, "b": 2.0, "c": 1.0}, {"a": 1.0, "b": 2.0, "c": 0.5}
    found = order("VSN", "SPL@25", theirs, ours)
    assert found.inverted == (("a", "b"),)
    assert found.tau == pytest.approx((2 - 1) / 3)  # two pairs stand right, one does not
    assert orders_grid([found]).rows == (("VSN", "SPL@25", "3", "+0.33", "b above a"),)
