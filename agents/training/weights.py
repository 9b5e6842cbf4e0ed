"""Trained networks as files: safetensors with half-precision weights, and what made them."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import torch
from pydantic import ConfigDict, TypeAdapter
from torch import nn

from remqa_data.agents.networks.actor_critic import ActorCritic
from remqa_data.agents.networks.answerer import ManipulationAnswerer
from remqa_data.agents.networks.committee import Committee, Member
from remqa_data.agents.networks.detection.detector import Detector
from remqa_data.agents.networks.detection.refiner import Refiner, TwoStageDetector
from remqa_data.agents.networks.detection.regions import AnyDetector
from remqa_data.agents.networks.matcher import Matcher
from remqa_data.agents.networks.planner_controller import PlannerController
from remqa_data.agents.networks.view_encoder import ViewEncoder
from remqa_data.agents.training.config import (
    SUFFIX,
    AdaptiveWalkerConfig,
    AnswererNetworkConfig,
    DetectorConfig,
    GrounderConfig,
    ImitatorNetworkConfig,
    MatcherConfig,
    Network,
    NetworkConfig,
    RefinerConfig,
    ViewEncoderConfig,
    WalkerConfig,
    load_committee_config,
    no_network,
    weights_file,
)
from remqa_data.agents.training.grounding import GROUNDERS
from remqa_data.agents.training.imitating import DOERS
from remqa_data.agents.training.matching import empty_matcher
from remqa_data.agents.training.rooms import held_out_elsewhere
from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.errors import ConfigError
from remqa_data.evaluation.scoring.ground_truth import dataset_sha256
from remqa_data.extras import require
from remqa_data.files import atomic_path, sha256_of
from remqa_data.storage.manifest import load_manifest

if TYPE_CHECKING:
    from safetensors import safe_open
    from safetensors.torch import save
else:
    safe_open = require("safetensors", "agents").safe_open
    save = require("safetensors.torch", "agents").save

KEY = "remqa"
FORMAT = 1
DETECTOR = "detector"
"""The network that most others are built upon."""

N = TypeVar("N", bound=nn.Module)


@dataclass(frozen=True)
class About:
    """What made a network.

    Attributes
    ----------
    config : dict
        `NetworkConfig`, as JSON has it.
    datasets : tuple of str
        sha256 of the datasets that it has learnt from, the first one's first: that is the one it is scored on.
    types : tuple of str
        What its detector knows.
    words, answers : tuple of str
        Of its vocabulary.
    score : dict
        Of the val rooms.
    needs, began_with : dict
        sha256 of the weights of the networks that it works with, and of those that it began with, by name.
    """

    __pydantic_config__ = ConfigDict(extra="forbid")

    config: dict[str, Any]
    datasets: tuple[str, ...]
    types: tuple[str, ...]
    words: tuple[str, ...] = ()
    answers: tuple[str, ...] = ()
    score: dict[str, float] = field(default_factory=dict)
    needs: dict[str, str] = field(default_factory=dict)
    began_with: dict[str, str] = field(default_factory=dict)
    format: int = FORMAT

    @property
    def network(self) -> NetworkConfig:
        """Its configuration."""
        return NetworkConfig.model_validate_json(json.dumps(self.config))

    @property
    def vocabulary(self) -> Vocabulary:
        """Its words and answers."""
        return Vocabulary(self.words, self.answers)


def halved(model: nn.Module) -> None:
    """Round all weights to what is stored, so that a stored network does what was measured."""
    for tensor in model.state_dict().values():
        if tensor.is_floating_point():
            tensor.copy_(tensor.to(torch.float16).to(tensor.dtype))


def save_network(path: Path, model: nn.Module, about: About) -> None:
    """Write a network, whole or not at all."""
    tensors = {
        name: (tensor.to(torch.float16) if tensor.is_floating_point() else tensor).contiguous().cpu()
        for name, tensor in model.state_dict().items()
    }
    with atomic_path(path) as temporary:
        temporary.write_bytes(save(tensors, metadata={KEY: json.dumps(asdict(about))}))


def weights_path(name: str, folder: Path | None = None) -> Path:
    """Where the weights of a network are: a file of that name, one in the folder, or one that comes with the package.

    Raises
    ------
    ConfigError
        If there are none.
    """
    named = Path(name)
    path = named if named.suffix == SUFFIX and named.is_file() else weights_file(name, folder)
    if path is None:
        raise ConfigError(f"no weights of {name!r}; remqa-agent train makes them")
    return path


def load_network(path: Path, root: Path | None = None, *, force: bool = False) -> tuple[nn.Module, About]:
    """Read a network; it is in evaluation mode.

    Parameters
    ----------
    path : path
        What `save_network` wrote.
    root : path, optional
        The dataset that it is to be used on.
    force : bool
        Use it also where it may have learnt from rooms on which it is tried.

    Raises
    ------
    ConfigError
        If the file is no such network, or has learnt from another dataset and this one holds out other rooms than usual.
    """
    with _opened(path) as file:
        about = _about(file)
        tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 - it is no mapping
        model = empty_network(about)
        model.load_state_dict(
            {name: tensor.float() if tensor.is_floating_point() else tensor for name, tensor in tensors.items()}
        )
    if broken := [name for name, tensor in tensors.items() if not tensor.isfinite().all()]:
        raise ConfigError(f"{path}: {broken[0]} holds what is no number; train it again, with --overwrite")
    if root is not None and not force and (rooms := _may_have_learnt_from(about, root)):
        raise ConfigError(
            f"{path} was trained on another dataset, and may have learnt from {rooms[0]}, which {root} holds out: "
            "use --force to try it all the same, or remqa-agent train on this one"
        )
    return model.eval(), about


def _may_have_learnt_from(about: About, root: Path) -> tuple[str, ...]:
    """The rooms that a dataset holds out and from which a network of other datasets may have learnt."""
    is_its_own = dataset_sha256(load_manifest(root)) == about.datasets[0]
    return () if is_its_own else held_out_elsewhere(root)


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """The file of a network; what is wrong with it, and with what is made of it, is a ConfigError."""
    try:
        with safe_open(path, framework="pt") as file:
            yield file
    except (OSError, KeyError, TypeError, ValueError, RuntimeError, _safetensors_error()) as error:
        raise no_network(path, error) from None


def _about(file: Any) -> About:
    """What an opened file says of itself; an error of some kind if it says nothing that is understood here."""
    stored: Mapping[str, Any] = json.loads(file.metadata()[KEY])
    about = TypeAdapter(About).validate_python(stored)
    if about.format != FORMAT or not about.datasets:
        msg = f"format {about.format} of {len(about.datasets)} datasets"
        raise ValueError(msg)
    return about


def weights_behind(names: Sequence[str], folder: Path | None = None) -> dict[str, str]:
    """sha256 of the weights of some names, see `weights_path`, and of all that these need, by name.

    Raises
    ------
    ConfigError
        If some are missing, or are none.
    """
    found: dict[str, str] = {}
    waiting = list(names)
    while waiting:
        name = waiting.pop()
        if name not in found:
            path = weights_path(name, folder)
            found[name] = sha256_of(path)
            with _opened(path) as file:
                waiting += _about(file).needs
    return dict(sorted(found.items()))


def load_trained(
    name: str, folder: Path | None = None, root: Path | None = None, *, force: bool = False
) -> tuple[nn.Module, About]:
    """Read the network of a name, which is to work with others of the same folder; see `weights_path` and `load_network`.

    Raises
    ------
    ConfigError
        If there are no such weights, they have learnt from another dataset, or with other networks than are there now.
    """
    path = weights_path(name, folder)
    network, about = load_network(path, root, force=force)
    for other, sha256 in about.needs.items():
        if not force and sha256_of(there := weights_path(other, folder)) != sha256:
            raise ConfigError(f"{path} has learnt with another {other} than {there}: train it anew, or use --force")
    return network, about


def trained(name: str, kind: type[N], folder: Path | None, root: Path | None, *, force: bool = False) -> N:
    """A trained network of a kind, which another one is built upon; see `load_trained`.

    Raises
    ------
    ConfigError
        If there are no such weights, or they are of another kind or another dataset.
    """
    network, _ = load_trained(name, folder, root, force=force)
    if not isinstance(network, kind):
        raise ConfigError(f"{weights_path(name, folder)} is no {kind.__name__}")
    return network


def trained_detector(
    network: Network | None, folder: Path | None, root: Path | None, *, force: bool = False
) -> AnyDetector:
    """What a network sees through: the detector, or both of its stages; see `trained`."""
    first = trained(DETECTOR, Detector, folder, root, force=force)
    if not isinstance(network, MatcherConfig) or not network.refiner:
        return first
    return TwoStageDetector(first, trained(network.refiner, Refiner, folder, root, force=force))


def load_committee(
    name: str, folder: Path | None = None, root: Path | None = None, *, force: bool = False
) -> tuple[Committee, About]:
    """Matchers that are heard together, and what the first one says of itself; see `load_network`.

    Raises
    ------
    ConfigError
        If there is no such committee, weights of a member are missing or have learnt from another dataset, or members are no
        matchers or do not see through the same networks.
    """
    members: list[Member] = []
    abouts: list[About] = []
    for member, weight in load_committee_config(name).members.items():
        matcher, about = load_trained(member, folder, root, force=force)
        if not isinstance(matcher, Matcher) or (abouts and about.needs != abouts[0].needs):
            raise ConfigError(f"{name}: {member!r} is no matcher, or sees through other networks than the first member")
        members.append(Member(matcher, about.vocabulary, weight))
        abouts.append(about)
    return Committee(tuple(members)), abouts[0]


def empty_network(about: About) -> nn.Module:
    """A network that knows nothing yet."""
    network, types, words = about.network.network, len(about.types), len(about.words)
    if isinstance(network, DetectorConfig):
        return Detector(types)
    if isinstance(network, RefinerConfig):
        return Refiner(types)
    if isinstance(network, WalkerConfig):
        return ActorCritic(types, network.form)
    if isinstance(network, AdaptiveWalkerConfig):
        return ActorCritic(types, "savn")
    if isinstance(network, ViewEncoderConfig):
        return ViewEncoder(types)
    if isinstance(network, ImitatorNetworkConfig):
        if network.form == "planner_controller":
            return PlannerController(words, len(about.answers), types)
        return DOERS[network.form](words, types)
    if isinstance(network, AnswererNetworkConfig):
        return ManipulationAnswerer(words, len(about.answers), types, network.views, network.side_px)
    if isinstance(network, GrounderConfig):
        return GROUNDERS[network.form](words)
    return empty_matcher(network, words, types)


def _safetensors_error() -> type[Exception]:
    return require("safetensors", "agents").SafetensorError  # type: ignore[no-any-return]
