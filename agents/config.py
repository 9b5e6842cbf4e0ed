"""What `remqa-agent` is told of a system: a YAML file of `configs/agents/`, read and checked."""

from __future__ import annotations

import os
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from remqa_data.agents.training.config import is_committee, load_committee_config, seeded_name
from remqa_data.limits import MAX_ACTIONS, MOST_SEED
from remqa_data.storage.manifest import config_hash
from remqa_data.yaml_files import preset_names, read_config

PRESETS = "remqa_data.configs.agents"
OF_SEED = ", seed "
"""In titles, before the seed if it is not 0."""


class _Section(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class SemanticMapConfig(_Section):
    """The agent walks by the semantic map of its walk: as the simulator has labelled it, or the detector."""

    kind: Literal["semantic_map"]
    map: Literal["true", "predicted"] = "true"


class RandomConfig(_Section):
    """It walks anywhere."""

    kind: Literal["random"]


class PolicyConfig(_Section):
    """It walks as a network of this name has learnt by reward."""

    kind: Literal["policy"]
    network: str


class ImitatorConfig(_Section):
    """It walks as a network of this name has learnt from shortest ways."""

    kind: Literal["imitator"]
    network: str


class FrontierConfig(_Section):
    """It has not walked there before: it explores, and makes its map on the way."""

    kind: Literal["frontier"]


Navigator = SemanticMapConfig | RandomConfig | PolicyConfig | ImitatorConfig | FrontierConfig


class LocalizerConfig(_Section):
    """How it finds the target in its view: by the box that the walk has left, or by a network or a committee of a name."""

    kind: Literal["map", "network"]
    matcher: str = "language_attention"


class ManipulatorConfig(_Section):
    """How it decides what to do: by the question's words and the target's type, or as the navigator's network says."""

    kind: Literal["rule", "navigator"]


class AnswererConfig(_Section):
    """How it answers: with the most frequent answer, by a network of this name, or as the navigator's network says."""

    kind: Literal["majority", "network", "navigator"]
    network: str = "answerer"


class SystemConfig(_Section):
    """A system: an agent of four parts.

    Attributes
    ----------
    title : str
        What it is called in tables; says what each part is, so that nobody takes it for another system.
    seed : int
        Of what it draws.
    most_steps : int
        After so many navigation actions it stops where it is.
    looks : int
        What it has opened it looks into from so many other places; its answerer must look at the view after alone.
    navigator, localizer, manipulator, answerer
        Its parts; all but the first may be missing.
    """

    title: Annotated[str, Field(min_length=1, max_length=200)]
    seed: Annotated[int, Field(ge=0, le=MOST_SEED)]
    most_steps: Annotated[int, Field(ge=0, le=MAX_ACTIONS)]
    navigator: Annotated[Navigator, Field(discriminator="kind")]
    localizer: LocalizerConfig | None
    manipulator: ManipulatorConfig | None
    answerer: AnswererConfig | None
    looks: Annotated[int, Field(ge=0, le=10)] = 0

    @model_validator(mode="after")
    def _explores(self) -> SystemConfig:
        if isinstance(self.navigator, FrontierConfig) and self.most_steps == 0:
            msg = "most_steps: who explores does a step at least"
            raise ValueError(msg)
        return self

    def seeded(self, seed: int) -> SystemConfig:
        """The same system with other draws, and with networks that have learnt to walk with others."""
        navigator = self.navigator
        if isinstance(navigator, PolicyConfig | ImitatorConfig):
            navigator = navigator.model_copy(update={"network": seeded_name(navigator.network, seed)})
        title = f"{self.title}{OF_SEED}{seed}" if seed else self.title
        return self.model_copy(update={"title": title, "seed": seed, "navigator": navigator})

    @property
    def networks(self) -> tuple[str, ...]:
        """Names of the weights that its parts are made of; those may need others."""
        names: list[str] = []
        walks = self.navigator
        if isinstance(walks, PolicyConfig | ImitatorConfig):
            names += [walks.network, "view_encoder"]
        if isinstance(walks, FrontierConfig) or (isinstance(walks, SemanticMapConfig) and walks.map == "predicted"):
            names.append("detector")
        if self.localizer is not None and self.localizer.kind == "network":
            matcher = self.localizer.matcher
            names += load_committee_config(matcher).members if is_committee(matcher) else [matcher]
        if self.answerer is not None and self.answerer.kind == "network":
            names.append(self.answerer.network)
        return tuple(names)

    @property
    def sha256(self) -> str:
        """Hash of what the configuration says, whatever its file looks like."""
        return config_hash(self.model_dump(mode="json"))


def systems() -> tuple[str, ...]:
    """Names of the systems that come with the package, such as "semantic_map"."""
    return preset_names(PRESETS)


def load_system(path: str | os.PathLike[str]) -> SystemConfig:
    """Read a system: a YAML file, or the name of one that comes with the package.

    Raises
    ------
    ConfigError
        If the file cannot be read, or a key is missing, unknown or has a wrong value: names file, key and reason.
    """
    return read_config(SystemConfig, path, PRESETS)
