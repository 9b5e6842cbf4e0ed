from pathlib import Path

import pytest

from remqa_data.agents.costs import cost_of, costs_grid, known_costs
from remqa_data.agents.training.config import load_network_config, networks
from remqa_data.agents.training.weights import load_network, weights_path
from remqa_data.errors import ConfigError


def test_costs_are_those_of_the_networks_that_come_with_the_package() -> None:
    titles = [load_network_config(name).title for name in networks()]
    costs = known_costs()
    assert costs
    assert [cost.title for cost in costs] == [title for title in titles if title in {cost.title for cost in costs}]
    assert all(cost.minutes and cost.score for cost in costs)
    assert len(costs_grid(costs).rows) == len(costs)


def test_parameters_are_counted_as_torch_counts_them() -> None:
    names = [name for name in networks() if name != "answerer_no_box"]  # of which no weights come with the package
    assert names
    for name in names:
        network, _ = load_network(weights_path(name))
        assert cost_of(weights_path(name)).parameters == sum(tensor.numel() for tensor in network.parameters()), name
    path = weights_path("plain_matcher")
    cost, about = cost_of(path), load_network(path)[1]
    assert cost.megabytes == pytest.approx(path.stat().st_size / 1e6)
    assert cost.score == {name: value for name, value in about.score.items() if name != "minutes"}


def test_those_in_a_folder_come_first_and_junk_is_refused(tmp_path: Path) -> None:
    (tmp_path / "plain_matcher.safetensors").write_bytes(b"junk" * 100)
    with pytest.raises(ConfigError, match=r"plain_matcher\.safetensors is no network that remqa-agent has trained"):
        known_costs(tmp_path)
