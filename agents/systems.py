"""From the configuration of a system to its agent."""

from __future__ import annotations

from pathlib import Path

from remqa_data.agents.agent import Agent
from remqa_data.agents.config import SystemConfig
from remqa_data.agents.parts.interfaces import Answerer, Navigator
from remqa_data.agents.parts.majority_answerer import MajorityAnswerer, majority
from remqa_data.agents.parts.map_localizer import MapLocalizer
from remqa_data.agents.parts.random_navigator import RandomNavigator
from remqa_data.agents.parts.rule_manipulator import RuleManipulator
from remqa_data.agents.parts.semantic_navigator import SemanticMapNavigator
from remqa_data.storage.shards import read_table


def make_agent(system: SystemConfig, root: Path) -> Agent:
    """The agent of a system; what it learns, it learns from the train split of a dataset.

    Raises
    ------
    DatasetError
        If it has to learn and this is not a finished dataset with a train split.
    """
    navigator: Navigator = SemanticMapNavigator()
    if system.navigator.kind == "random":
        navigator = RandomNavigator(system.most_steps)
    return Agent(
        navigator,
        MapLocalizer() if system.localizer else None,
        RuleManipulator() if system.manipulator else None,
        _majority_answerer(root) if system.answerer else None,
        system.most_steps,
    )


def _majority_answerer(root: Path) -> Answerer:
    train = read_table(root, "questions", "train", ["question", "answer"]).to_pylist()
    return MajorityAnswerer(majority((row["question"], row["answer"]) for row in train))
