"""What `remqa-agent train` is told of a network: a YAML file of `configs/agents/training/`, read and checked."""

from __future__ import annotations

import os
from importlib import resources
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from remqa_data.agents.networks.windows import SIDE_PX
from remqa_data.errors import ConfigError, one_line
from remqa_data.limits import MOST_SEED
from remqa_data.storage.manifest import config_hash
from remqa_data.yaml_files import preset_names, read_config

PRESETS = "remqa_data.configs.agents.training"
COMMITTEES = "remqa_data.configs.agents.committees"
SHIPPED = "remqa_data.agents.weights"
SUFFIX = ".safetensors"
"""Of files of weights."""
CURVES = "curves.csv"
"""Where training writes what it measures after each epoch, in a folder of the network's name."""
DURATION = "duration.json"
"""Beside it: how many minutes that took. Not in the weights, so that the same seed gives the same file."""


class _Section(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class _Network(_Section):
    """A network."""

    @property
    def needs(self) -> tuple[str, ...]:
        """Names of the trained networks that it works with."""
        return ("detector",)

    @property
    def began_with(self) -> tuple[str, ...]:
        """Names of the trained networks whose weights it begins with, and does not need when it has learnt."""
        return ()


class DetectorConfig(_Network):
    """Finds objects; learns from squares of so many pixels."""

    kind: Literal["detector"]
    side_px: Annotated[int, Field(ge=32, le=1024)]

    @property
    def needs(self) -> tuple[str, ...]:
        """None: all others are built upon it."""
        return ()


class RefinerConfig(_Network):
    """Looks at the boxes of the detector again, and at those that it proposes; learns from squares of so many pixels."""

    kind: Literal["refiner"]
    side_px: Annotated[int, Field(ge=32, le=1024)]


class MatcherConfig(_Network):
    """Finds what an expression means, by language attention, with an anchor or not, or with one vector for all words.

    It chooses among what the detector finds, with a second stage of the name `refiner` if that is given. Boxes that overlap
    what is meant by `spared_iou` are no wrong choice.
    With `questions` it learns from what questions say of the views before their manipulations, too; with `box_head` also where
    objects end, and how well boxes fit them. With `colors` it sees these as they are, too.
    """

    kind: Literal["matcher"]
    form: Literal["language_attention", "anchored", "plain"]
    refiner: str | None = None
    spared_iou: Annotated[float, Field(gt=0, le=1)] | None = None
    questions: bool = False
    box_head: bool = False
    colors: bool = False

    @property
    def needs(self) -> tuple[str, ...]:
        """The stages of what it sees through."""
        return tuple(name for name in ("detector", self.refiner) if name)


class GrounderConfig(_Network):
    """Says box and mask of what an expression means at once: two branches that agree (MCN), or groups of features (CGAN)."""

    kind: Literal["grounder"]
    form: Literal["collaborative", "grouped"]


class AnswererNetworkConfig(_Network):
    """Answers by what it looks at; `with_box` is whether it is told where the target is.

    It sees squares of `side_px` pixels, through a backbone that begins as the detector's, or as that of its second stage of
    the name `refiner`; and learns from all questions of train rooms, or from so many, of all these rooms alike.
    """

    kind: Literal["answerer"]
    views: Annotated[tuple[Literal["start", "end"], ...], Field(strict=False)]  # YAML has no tuples
    with_box: bool
    side_px: Annotated[int, Field(ge=32)] = SIDE_PX
    questions: Annotated[int, Field(ge=1)] | None = None
    refiner: str | None = None

    @property
    def needs(self) -> tuple[str, ...]:
        """None: it sees by itself."""
        return ()

    @property
    def began_with(self) -> tuple[str, ...]:
        """What it has learnt to see with."""
        return ("detector", self.refiner) if self.refiner else ("detector",)


class ViewEncoderConfig(_Network):
    """Says what the parts of small views show."""

    kind: Literal["view_encoder"]

    @property
    def needs(self) -> tuple[str, ...]:
        """None: it sees by itself."""
        return ()

    @property
    def began_with(self) -> tuple[str, ...]:
        """What has learnt to see before."""
        return ("detector",)


class WalkerConfig(_Network):
    """Walks to a type of object; learns by reward, an epoch being so many walks on cached views."""

    kind: Literal["walker"]
    form: Literal["a3c", "scene_priors"]
    walks: Annotated[int, Field(ge=1)] = 6400

    @property
    def needs(self) -> tuple[str, ...]:
        """What it sees through."""
        return ("view_encoder",)


class AdaptiveWalkerConfig(_Network):
    """The same, and it goes on learning while it walks; begins with what a walker has learnt."""

    kind: Literal["adaptive_walker"]
    begins_with: str
    walks: Annotated[int, Field(ge=1)] = 640

    @property
    def needs(self) -> tuple[str, ...]:
        """What it sees through."""
        return ("view_encoder",)

    @property
    def began_with(self) -> tuple[str, ...]:
        """What has learnt to walk before."""
        return (self.begins_with,)


class ImitatorNetworkConfig(_Network):
    """Walks as shortest ways do, and answers or says what to do in the end; an epoch is so many walks on cached views."""

    kind: Literal["imitator"]
    form: Literal["planner_controller", "transformer", "spatial_memory"]
    walks: Annotated[int, Field(ge=1)] = 6400

    @property
    def needs(self) -> tuple[str, ...]:
        """What it sees through."""
        return ("view_encoder",)


class ScheduleConfig(_Section):
    """How long and how fast is learnt; see `remqa_data.agents.training.trainer.Schedule`."""

    epochs: Annotated[int, Field(ge=1, le=10_000)]
    batch_size: Annotated[int, Field(ge=1, le=4096)]
    learning_rate: Annotated[float, Field(gt=0, le=1)]
    weight_decay: Annotated[float, Field(ge=0, le=1)]
    seed: Annotated[int, Field(ge=0, le=MOST_SEED)]
    score_every: Annotated[int, Field(ge=1)]
    precision: Literal["float32", "bfloat16"] = "float32"


Network = (
    DetectorConfig
    | RefinerConfig
    | MatcherConfig
    | GrounderConfig
    | AnswererNetworkConfig
    | ViewEncoderConfig
    | WalkerConfig
    | AdaptiveWalkerConfig
    | ImitatorNetworkConfig
)


class NetworkConfig(_Section):
    """A network and its training.

    Attributes
    ----------
    title : str
        What it is called in tables.
    network : Network
        What is learnt.
    schedule : ScheduleConfig
        How.
    """

    title: Annotated[str, Field(min_length=1, max_length=200)]
    network: Annotated[Network, Field(discriminator="kind")]
    schedule: ScheduleConfig

    def seeded(self, seed: int) -> NetworkConfig:
        """The same training with other draws; what begins with another network begins with that of the same seed."""
        network = self.network
        if isinstance(network, AdaptiveWalkerConfig):
            network = network.model_copy(update={"begins_with": seeded_name(network.begins_with, seed)})
        return self.model_copy(update={"network": network, "schedule": self.schedule.model_copy(update={"seed": seed})})

    @property
    def sha256(self) -> str:
        """Hash of what the configuration says, whatever its file looks like."""
        return config_hash(self.model_dump(mode="json"))


class CommitteeConfig(_Section):
    """Trained matchers that are heard together: a YAML file of `configs/agents/committees/`.

    Attributes
    ----------
    title : str
        What it is called in tables.
    members : dict
        How much the scores of each count, by its name; the first one says where objects end.
    """

    title: Annotated[str, Field(min_length=1, max_length=200)]
    members: Annotated[dict[str, Annotated[float, Field(gt=0, le=100)]], Field(min_length=2)]


def seeded_name(name: str, seed: int) -> str:
    """The name of weights or of a submission that a seed gives.

    >>> seeded_name("a3c", 2), seeded_name("a3c", 0)
    ('a3c-2', 'a3c')
    """
    return f"{name}-{seed}" if seed else name


def networks() -> tuple[str, ...]:
    """Names of the networks that come with the package, such as "detector"."""
    return preset_names(PRESETS)


def weights_file(name: str, folder: Path | None = None) -> Path | None:
    """The weights of a network in a folder, or else those that come with the package; None if there are neither."""
    file = f"{name}{SUFFIX}"
    places = [*([folder / file] if folder else []), Path(str(resources.files(SHIPPED) / file))]
    return next((place for place in places if place.is_file()), None)


def no_network(path: Path, error: Exception) -> ConfigError:
    """What is said of a file of weights that cannot be used, and what to do; `error` is what came of reading it."""
    if isinstance(error, OSError):
        reason = f"the file cannot be read ({one_line(error)})"
    elif isinstance(error, KeyError | TypeError | ValueError | RuntimeError):
        reason = "what it says of itself is missing, or fits neither this version nor what it holds"
    else:  # of safetensors
        reason = "the file is damaged, cut off or of another kind"
    return ConfigError(
        f"{path} is no network that remqa-agent has trained: {reason}; train it again, with --overwrite, or copy it anew"
    )


def committees() -> tuple[str, ...]:
    """Names of the committees that come with the package."""
    return preset_names(COMMITTEES)


def is_committee(name: str) -> bool:
    """Whether a name is that of a committee, or of a file that says of whom it consists, and not of weights."""
    return name in committees() or Path(name).suffix == ".yaml"


def load_committee_config(path: str | os.PathLike[str]) -> CommitteeConfig:
    """Read a committee: a YAML file, or the name of one that comes with the package.

    Raises
    ------
    ConfigError
        If the file cannot be read, or a key is missing, unknown or has a wrong value: names file, key and reason.
    """
    return read_config(CommitteeConfig, path, COMMITTEES)


def load_network_config(path: str | os.PathLike[str]) -> NetworkConfig:
    """Read a network: a YAML file, or the name of one that comes with the package.

    Raises
    ------
    ConfigError
        If the file cannot be read, or a key is missing, unknown or has a wrong value: names file, key and reason.
    """
    return read_config(NetworkConfig, path, PRESETS)
