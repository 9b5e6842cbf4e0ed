from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from remqa_data.agents.config import AnswererConfig, load_system, systems
from remqa_data.agents.parts.interfaces import Sighting
from remqa_data.agents.parts.network_answerer import NetworkAnswerer
from remqa_data.agents.systems import fingerprint, make_agent
from remqa_data.agents.training.weights import load_network, load_trained, save_network, weights_path
from remqa_data.errors import ConfigError


def test_who_looks_from_elsewhere_answers_from_the_view_after_alone(tmp_path: Path) -> None:
    system = load_system("framework_memory")
    assert system.looks > 0
    agent = make_agent(system, tmp_path, force=True)
    assert agent.looks == system.looks
    both = system.model_copy(update={"answerer": AnswererConfig(kind="network", network="answerer")})
    with pytest.raises(ConfigError, match="looks: 'answerer' compares two views from one place"):
        make_agent(both, tmp_path, force=True)
    assert make_agent(both.model_copy(update={"looks": 0}), tmp_path, force=True).looks == 0


def test_a_network_is_not_used_with_another_one_than_it_has_learnt_with(tmp_path: Path) -> None:
    detector, about = load_network(weights_path("detector"))
    next(iter(detector.parameters())).data.add_(1.0)
    save_network(tmp_path / "detector.safetensors", detector, about)
    for name in ("language_attention", "refiner", "cgan"):
        with pytest.raises(ConfigError, match=rf"{name}.* has learnt with another detector than .*: train it anew"):
            load_trained(name, tmp_path)
        load_trained(name, tmp_path, force=True)
    load_trained("a3c", tmp_path)  # it sees through another one


@pytest.mark.slow
def test_what_rows_depend_on_are_the_configuration_and_the_weights_behind_it(tmp_path: Path) -> None:
    for name in systems():
        agent = load_system(name)
        assert fingerprint(agent) == fingerprint(agent, tmp_path)
        assert (fingerprint(agent) == agent.sha256) is (not agent.networks)
    known = {name: fingerprint(load_system(name)) for name in systems()}
    assert len(set(known.values())) == len(known)
    network, about = load_network(weights_path("refiner"))
    next(iter(network.parameters())).data.add_(1.0)
    save_network(tmp_path / "refiner.safetensors", network, about)
    changed = {name for name in systems() if fingerprint(load_system(name), tmp_path) != known[name]}
    assert changed == {"framework_two_stage", "framework_anchored", "framework_committee"}


@pytest.mark.parametrize("with_box", [True, False])
def test_an_answerer_sees_what_it_has_learnt_on(tmp_path: Path, with_box: bool) -> None:
    network, about = load_network(weights_path("answerer"))
    config = {**about.config, "network": {**about.config["network"], "with_box": with_box}}
    save_network(tmp_path / "answerer.safetensors", network, replace(about, config=config))
    answerer = make_agent(load_system("framework"), tmp_path, tmp_path, force=True).answerer
    assert isinstance(answerer, NetworkAnswerer)
    rng = np.random.default_rng(0)
    before, after = (
        SimpleNamespace(rgb=rng.integers(0, 256, (300, 300, 3), np.uint8), depth=np.ones((300, 300))) for _ in range(2)
    )
    asked = SimpleNamespace(text="Is there a mug in the cabinet?", kind="EXISTENCE")
    sightings = [Sighting(box, box[:2]) for box in ((0.1, 0.1, 0.3, 0.3), (0.6, 0.5, 0.9, 0.8))]
    said = [answerer.chances(asked, before, after, sighting) for sighting in sightings]
    assert (said[0] == said[1]) is not with_box
