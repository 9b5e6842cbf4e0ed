from pathlib import Path

import pytest

from remqa_data.agents.config import AnswererConfig, load_system
from remqa_data.agents.systems import make_agent
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
