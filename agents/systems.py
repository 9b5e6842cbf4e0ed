"""From the configuration of a system to its agent."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

from remqa_data.agents.agent import Agent
from remqa_data.agents.config import (
    FrontierConfig,
    ImitatorConfig,
    LocalizerConfig,
    PolicyConfig,
    RandomConfig,
    SemanticMapConfig,
    SystemConfig,
)
from remqa_data.agents.parts.interfaces import Answerer, Localizer, Manipulator, Navigator
from remqa_data.agents.parts.majority_answerer import MajorityAnswerer, majority
from remqa_data.agents.parts.map_localizer import MapLocalizer
from remqa_data.agents.parts.random_navigator import RandomNavigator
from remqa_data.agents.parts.rule_manipulator import RuleManipulator
from remqa_data.agents.parts.semantic_navigator import SemanticMapNavigator
from remqa_data.errors import ConfigError
from remqa_data.extras import require
from remqa_data.storage.shards import read_table


def make_agent(system: SystemConfig, root: Path, weights: Path | None = None, *, force: bool = False) -> Agent:
    """The agent of a system; what it learns, it learns from the train split of a dataset.

    Parameters
    ----------
    system : SystemConfig
        Its parts.
    root : path
        The dataset.
    weights : path, optional
        A folder with weights of networks, which come before those that come with the package.
    force : bool
        Use weights on another dataset than that from which they have learnt.

    Raises
    ------
    DatasetError
        If it has to learn and this is not a finished dataset with a train split.
    ConfigError
        If weights are missing, or have learnt from another dataset.
    MissingExtraError
        If it has networks and the extra `agents` is not installed.
    """
    navigator = _navigator(system, root, weights, force)
    return Agent(
        navigator,
        _localizer(system.localizer, root, weights, force) if system.localizer else None,
        _manipulator(system, navigator),
        _answerer(system, navigator, root, weights, force),
        system.most_steps,
        system.looks,
    )


def fingerprint(system: SystemConfig, weights: Path | None = None) -> str:
    """What the rows of a system depend on beside the dataset: its configuration, and the weights of its networks.

    Raises
    ------
    ConfigError
        If weights are missing.
    MissingExtraError
        If it has networks and the extra `agents` is not installed.
    """
    if not system.networks:
        return system.sha256
    require("torch", "agents")
    from remqa_data.agents.training.weights import weights_behind

    told = json.dumps([system.sha256, weights_behind(system.networks, weights)])
    return hashlib.sha256(told.encode()).hexdigest()


def _navigator(system: SystemConfig, root: Path, weights: Path | None, force: bool) -> Navigator:
    config = system.navigator
    if isinstance(config, RandomConfig):
        return RandomNavigator(system.most_steps)
    if isinstance(config, PolicyConfig):
        return _policy(config, root, weights, force)
    if isinstance(config, ImitatorConfig):
        return _imitator(config, root, weights, force)
    if isinstance(config, FrontierConfig) or config.map == "predicted":
        return _mapper(config, root, weights, force)
    return SemanticMapNavigator()


def _mapper(config: FrontierConfig | SemanticMapConfig, root: Path, weights: Path | None, force: bool) -> Navigator:
    require("torch", "agents")
    from remqa_data.agents.networks.detection.detector import Detector
    from remqa_data.agents.parts.frontier_navigator import FrontierNavigator
    from remqa_data.agents.parts.predicted_navigator import PredictedMapNavigator
    from remqa_data.agents.training.weights import DETECTOR, load_trained

    detector, about = load_trained(DETECTOR, weights, root, force=force)
    if not isinstance(detector, Detector):
        raise ConfigError(f"navigator: {DETECTOR!r} is no detector")
    kind = FrontierNavigator if isinstance(config, FrontierConfig) else PredictedMapNavigator
    return kind(detector, about.types)


def _policy(config: PolicyConfig, root: Path, weights: Path | None, force: bool) -> Navigator:
    require("torch", "agents")
    from remqa_data.agents.networks.actor_critic import ActorCritic
    from remqa_data.agents.networks.view_encoder import ViewEncoder
    from remqa_data.agents.parts.policy_navigator import PolicyNavigator
    from remqa_data.agents.training.weights import load_trained

    policy, about = load_trained(config.network, weights, root, force=force)
    encoder, _ = load_trained("view_encoder", weights, root, force=force)
    if not isinstance(policy, ActorCritic) or not isinstance(encoder, ViewEncoder):
        raise ConfigError(f"navigator: {config.network!r} is no policy, or 'view_encoder' no view encoder")
    return PolicyNavigator(policy, encoder, about.types)


def _imitator(config: ImitatorConfig, root: Path, weights: Path | None, force: bool) -> Navigator:
    require("torch", "agents")
    from remqa_data.agents.networks.planner_controller import PlannerController
    from remqa_data.agents.networks.spatial_memory import MemoryPlanner
    from remqa_data.agents.networks.view_encoder import ViewEncoder
    from remqa_data.agents.networks.view_transformer import ViewTransformer
    from remqa_data.agents.parts.imitators import DoingAgent, EqaAgent
    from remqa_data.agents.training.weights import load_trained

    network, about = load_trained(config.network, weights, root, force=force)
    encoder, _ = load_trained("view_encoder", weights, root, force=force)
    if isinstance(encoder, ViewEncoder) and isinstance(network, PlannerController):
        return EqaAgent(network, encoder, about.vocabulary)
    if isinstance(encoder, ViewEncoder) and isinstance(network, ViewTransformer | MemoryPlanner):
        return DoingAgent(network, encoder, about.vocabulary)
    raise ConfigError(f"navigator: {config.network!r} is no imitator, or 'view_encoder' no view encoder")


def _manipulator(system: SystemConfig, navigator: Navigator) -> Manipulator | None:
    if system.manipulator is None or system.manipulator.kind == "rule":
        return RuleManipulator() if system.manipulator else None
    if not isinstance(navigator, Manipulator):
        raise ConfigError(f"manipulator: a navigator of kind {system.navigator.kind!r} does not manipulate")
    return navigator


def _localizer(config: LocalizerConfig, root: Path, weights: Path | None, force: bool) -> Localizer:
    if config.kind == "map":
        return MapLocalizer()
    require("torch", "agents")
    from remqa_data.agents.networks.committee import alone
    from remqa_data.agents.networks.detection.detector import Detector
    from remqa_data.agents.networks.grounding import Grounder
    from remqa_data.agents.networks.matcher import Matcher
    from remqa_data.agents.parts.network_localizer import GroundingLocalizer, NetworkLocalizer
    from remqa_data.agents.training.config import is_committee
    from remqa_data.agents.training.weights import load_committee, load_trained, trained_detector

    if is_committee(config.matcher):
        committee, about = load_committee(config.matcher, weights, root, force=force)
        return NetworkLocalizer(trained_detector(about.network.network, weights, root, force=force), committee)
    matcher, about = load_trained(config.matcher, weights, root, force=force)
    detector = trained_detector(about.network.network, weights, root, force=force)
    if isinstance(matcher, Matcher):
        return NetworkLocalizer(detector, alone(matcher, about.vocabulary))
    if isinstance(matcher, Grounder) and isinstance(detector, Detector):
        return GroundingLocalizer(detector, matcher, about.vocabulary)
    raise ConfigError(f"localizer: {config.matcher!r} does not tell what expressions mean")


def _answerer(
    system: SystemConfig, navigator: Navigator, root: Path, weights: Path | None, force: bool
) -> Answerer | None:
    config = system.answerer
    if config is None:
        return None
    if config.kind == "navigator":
        if not isinstance(navigator, Answerer):
            raise ConfigError(f"answerer: a navigator of kind {system.navigator.kind!r} does not answer")
        return navigator
    if config.kind == "majority":
        return _majority_answerer(root)
    require("torch", "agents")
    from remqa_data.agents.networks.answerer import ManipulationAnswerer
    from remqa_data.agents.parts.network_answerer import NetworkAnswerer
    from remqa_data.agents.training.config import AnswererNetworkConfig
    from remqa_data.agents.training.weights import load_trained

    network, about = load_trained(config.network, weights, root, force=force)
    if not isinstance(network, ManipulationAnswerer):
        raise ConfigError(f"answerer: {config.network!r} is no answerer")
    if system.looks and network.views != ("end",):
        raise ConfigError(
            f"looks: {config.network!r} compares two views from one place; take one that has the end alone"
        )
    settings = about.network.network
    assert isinstance(settings, AnswererNetworkConfig)
    return NetworkAnswerer(network, about.vocabulary, settings.with_box)


def _majority_answerer(root: Path) -> Answerer:
    train = read_table(root, "questions", "train", ["question", "answer"]).to_pylist()
    return MajorityAnswerer(majority((row["question"], row["answer"]) for row in train))
