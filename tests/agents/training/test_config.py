from pathlib import Path

import pytest

from remqa_data.agents.training.config import load_network_config, networks
from remqa_data.errors import ConfigError


def test_the_networks_that_come_with_the_package_are_read() -> None:
    kinds = {name: load_network_config(name).network.kind for name in networks()}
    assert kinds["detector"] == "detector"
    assert kinds["language_attention"] == kinds["plain_matcher"] == "matcher"
    assert {kind for name, kind in kinds.items() if name.startswith("answerer")} == {"answerer"}
    titles = [load_network_config(name).title for name in networks()]
    assert len(set(titles)) == len(titles)


def test_what_answerers_differ_in_is_what_they_see() -> None:
    configs = [load_network_config(name) for name in networks() if name.startswith("answerer")]
    assert len({config.network for config in configs}) == len(configs)
    assert len({config.schedule for config in configs}) == 1


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ("side_px: 192", "side_px: 8", "network.detector.side_px"),
        ("kind: detector", "kind: oracle", "network"),
        ("epochs: ", "epoch: ", "schedule.epoch: there is no such key; did you mean 'epochs'"),
        ("title: detector", "title: detector\nextra: 1", "extra"),
    ],
)
def test_a_key_that_is_wrong_is_named(before: str, after: str, said: str, tmp_path: Path) -> None:
    text = Path("configs/agents/training/detector.yaml").read_text()
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    assert load_network_config(path) == load_network_config("detector")
    assert before in text
    path.write_text(text.replace(before, after))
    with pytest.raises(ConfigError, match=rf"mine\.yaml: .*{said}"):
        load_network_config(path)


def test_what_a_network_works_with_is_not_what_it_began_with() -> None:
    networks = {name: load_network_config(name).network for name in ("anchored_matcher", "answerer", "savn")}
    assert {name: network.needs for name, network in networks.items()} == {
        "anchored_matcher": ("detector", "refiner"),
        "answerer": (),
        "savn": ("view_encoder",),
    }
    assert {name: network.began_with for name, network in networks.items()} == {
        "anchored_matcher": (),
        "answerer": ("detector", "refiner"),
        "savn": ("a3c",),
    }
