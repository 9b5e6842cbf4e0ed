"""What `remqa-gen` is told: a YAML file of `configs/`, read, checked and scaled to the number of rooms."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    field_validator,
    model_validator,
)

from remqa_data.errors import ConfigError, UnknownNameError
from remqa_data.floorplans.ithor.table import scene_names
from remqa_data.floorplans.sampled.naming import sampled_index, sampled_name
from remqa_data.floorplans.splits import QUESTION_SPLITS, QuestionSplit, split_of
from remqa_data.generators.questions.allotment import LOT_SIZE
from remqa_data.generators.questions.chosen_scenes import choose_scenes
from remqa_data.generators.walks.walk import WalkSettings
from remqa_data.limits import MOST_IMAGE_PX, MOST_SEED
from remqa_data.scene import Light
from remqa_data.storage.manifest import config_hash
from remqa_data.tables.images import RgbFormat
from remqa_data.tables.rows import KINDS, QuestionKind
from remqa_data.yaml_files import checked, preset_names, read_config

Layouts = Literal["ithor", "sampled"]
LAYOUTS: tuple[Layouts, ...] = ("ithor", "sampled")

PRESETS = "remqa_data.configs"

MOST_SAMPLED = 1_000_000
"""Names of sampled rooms have six digits."""
_NAMES = {"ithor": "from FloorPlan1 to FloorPlan430", "sampled": "such as Sampled-kitchen-000000"}


MOST_QUESTIONS = 10_000_000
"""Of one kind in one split; the published benchmark has 1,653."""
MOST_FRAMES, MOST_POSES = 100_000, 36
"""Frames of one walk, and headings or horizons at one place."""


class _Section(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


Count = Annotated[int, Field(ge=0, le=MOST_QUESTIONS)]


class KindCounts(_Section):
    """A number for each kind of question."""

    EXISTENCE: Count
    COUNTING: Count
    SPATIAL: Count

    def by_kind(self) -> dict[QuestionKind, int]:
        """As a dictionary."""
        return {kind: getattr(self, kind) for kind in KINDS}


class Totals(_Section):
    """How many questions there are, by split and kind."""

    train: KindCounts
    test: KindCounts


class WalkConfig(_Section):
    """How frames are taken; see `walk.WalkSettings`."""

    frames_per_configuration: Annotated[int, Field(ge=1, le=MOST_FRAMES)]
    headings_deg: tuple[Annotated[int, Field(ge=-360, le=360)], ...] = Field(
        min_length=1, max_length=MOST_POSES, strict=False
    )
    horizons_deg: tuple[Annotated[int, Field(ge=-90, le=90)], ...] = Field(
        min_length=1, max_length=MOST_POSES, strict=False
    )
    cells_per_frame: Annotated[float, Field(gt=0, le=MOST_FRAMES)]

    @field_validator("headings_deg", "horizons_deg")
    @classmethod
    def _each_once(cls, angles: tuple[int, ...]) -> tuple[int, ...]:
        turns = [angle % 360 for angle in angles]
        for place, turn in enumerate(turns):
            if turn in turns[:place]:
                raise ValueError(f"{angles[place]} is there twice")
        return angles

    @field_validator("headings_deg")
    @classmethod
    def _as_stored(cls, headings: tuple[int, ...]) -> tuple[int, ...]:
        return tuple(heading % 360 for heading in headings)

    def settings(self, size_px: int) -> WalkSettings:
        """What `walk.walk` takes."""
        return WalkSettings(
            frames=self.frames_per_configuration,
            headings_deg=self.headings_deg,
            horizons_deg=self.horizons_deg,
            cells_per_frame=self.cells_per_frame,
            size_px=size_px,
        )


class ImageConfig(_Section):
    """How frames are stored."""

    size_px: Annotated[int, Field(ge=32, le=MOST_IMAGE_PX)]
    rgb_format: RgbFormat
    light: Light = "baked"


class Config(_Section):
    """All that decides what is generated, together with the files of `templates/`.

    Attributes
    ----------
    seed : int
        Of the whole dataset.
    layouts : {"ithor", "sampled"}
        Where rooms come from: the 120 recorded floor plans, or as many new ones as are asked for.
    scenes : int or tuple of str
        How many rooms, or which.
    configurations : int
        Arrangements of each room; at least four, one for each answer to a COUNTING question.
    questions : Totals
        For all scenes.
    spare_groups : KindCounts
        Groups of questions that each room makes beyond what it owes, in case the audit refuses some.
    walk : WalkConfig
        How frames are taken.
    image : ImageConfig
        How they are stored.
    """

    seed: Annotated[int, Field(ge=0, le=MOST_SEED)]
    layouts: Layouts
    scenes: Annotated[int, Field(ge=1)] | Annotated[tuple[str, ...], Field(min_length=1, strict=False)]
    configurations: Annotated[int, Field(ge=LOT_SIZE, le=32)]
    questions: Totals
    spare_groups: KindCounts
    walk: WalkConfig
    image: ImageConfig

    @field_validator("scenes", mode="before")
    @classmethod
    def _number_or_names(cls, scenes: Any) -> Any:
        is_number = isinstance(scenes, int) and not isinstance(scenes, bool)
        are_names = isinstance(scenes, list | tuple) and scenes and all(isinstance(name, str) for name in scenes)
        if not (is_number or are_names):
            raise ValueError(
                f"expected a number of rooms, or a list of their names such as [FloorPlan1], found {scenes!r:.80}"
            )
        return scenes

    @model_validator(mode="after")
    def _scenes_are_there(self) -> Config:
        if isinstance(self.scenes, int):
            if self.scenes > _most_rooms(self.layouts):
                most = _most_rooms(self.layouts)
                msg = f"scenes: {self.scenes} is more than the {most} rooms of the layouts {self.layouts}"
                raise ValueError(msg + _for_more(self.layouts))
            return self
        unknown = [name for name in self.scenes if not _is_room(self.layouts, name)]
        twice = [name for name, count in Counter(self.scenes).items() if count > 1]
        if unknown or twice:
            wrong = _no_room(self.layouts, unknown[0]) if unknown else f"{twice[0]!r} is named twice"
            msg = f"scenes: {wrong}; name rooms {_NAMES[self.layouts]}, each once"
            raise ValueError(msg)
        return self

    @property
    def scene_names(self) -> tuple[str, ...]:
        """The rooms."""
        return _first_rooms(self.layouts, self.scenes) if isinstance(self.scenes, int) else self.scenes

    @property
    def totals(self) -> dict[QuestionSplit, dict[QuestionKind, int]]:
        """Questions by split and kind."""
        return {split: getattr(self.questions, split).by_kind() for split in QUESTION_SPLITS}

    @property
    def sha256(self) -> str:
        """Hash of what the configuration says, whatever its file looks like."""
        return config_hash(self.model_dump(mode="json"))

    def with_scenes(self, count: int) -> Config:
        """The same with another number of rooms; questions shrink in proportion to the rooms of each split.

        Raises
        ------
        ConfigError
            If there are not so many rooms.
        """
        before = self.scene_names
        most = _most_rooms(self.layouts) if isinstance(self.scenes, int) else len(before)
        if not 1 <= count <= most:
            if not isinstance(self.scenes, int):
                raise ConfigError(
                    f"scenes: {count} is not between 1 and {most}, the rooms that the configuration names"
                )
            raise ConfigError(
                f"scenes: {count} is not between 1 and {most}, the number of rooms of the layouts {self.layouts}"
                f"{_for_more(self.layouts)}"
            )
        after = _first_rooms(self.layouts, count) if isinstance(self.scenes, int) else before[:count]
        totals = {}
        for split in QUESTION_SPLITS:
            had, has = (sum(split_of(name) == split for name in names) for names in (before, after))
            counts = {kind: _in_proportion(n, has, had) for kind, n in self.totals[split].items()}
            where = f"scenes: {count:,} rooms would be asked {max(counts.values()):,} questions of a kind"
            totals[split] = checked(KindCounts, {str(kind): n for kind, n in counts.items()}, where)
        scenes = count if isinstance(self.scenes, int) else after
        return self.model_copy(update={"scenes": scenes, "questions": Totals(**totals)})

    def with_layouts(self, layouts: str) -> Config:
        """The same with rooms from elsewhere.

        Raises
        ------
        ConfigError
            If there are no such layouts, they have not so many rooms, or the configuration names rooms of other layouts.
        """
        if layouts not in LAYOUTS:
            raise ConfigError(f"layouts: there are no layouts {layouts!r}; use {' or '.join(LAYOUTS)}")
        if layouts != self.layouts and not isinstance(self.scenes, int):
            raise ConfigError(
                f"layouts: the configuration names rooms of the layouts {self.layouts}; let its file say how many instead, "
                f"such as scenes: {len(self.scenes)}"
            )
        return checked(Config, self.model_dump() | {"layouts": layouts}, f"layouts {layouts}")

    def with_seed(self, seed: int) -> Config:
        """The same with another seed.

        Raises
        ------
        ConfigError
            If no such seed can be stored.
        """
        if not 0 <= seed <= MOST_SEED:
            raise ConfigError(f"seed: {seed} is not between 0 and {MOST_SEED}")
        return self.model_copy(update={"seed": seed})


def presets() -> tuple[str, ...]:
    """Names of the configurations that come with the package, such as "tiny"."""
    return preset_names(PRESETS)


def load_config(path: str | os.PathLike[str]) -> Config:
    """Read a configuration.

    Parameters
    ----------
    path : path or str
        A YAML file, or the name of a preset, see `presets`; a file of that name comes first.

    Raises
    ------
    ConfigError
        If the file cannot be read, or a key is missing, unknown or has a wrong value: one line that names the file, the
        key and the reason.
    """
    return read_config(Config, path, PRESETS)


def stored_config(stored: Mapping[str, Any]) -> Config:
    """The configuration that a manifest holds.

    Raises
    ------
    ConfigError
        If it is none: names the key and the reason.
    """
    return checked(Config, stored, "stored configuration")


def _most_rooms(layouts: Layouts) -> int:
    return len(scene_names()) if layouts == "ithor" else MOST_SAMPLED


def _for_more(layouts: Layouts) -> str:
    return "; use --layouts sampled for more rooms" if layouts == "ithor" else ""


def _first_rooms(layouts: Layouts, count: int) -> tuple[str, ...]:
    return choose_scenes(count) if layouts == "ithor" else tuple(map(sampled_name, range(count)))


def _is_room(layouts: Layouts, name: str) -> bool:
    if layouts == "ithor":
        return name in scene_names()
    try:
        return sampled_index(name) < MOST_SAMPLED
    except UnknownNameError:
        return False


def _no_room(layouts: Layouts, name: str) -> str:
    """That there is no such room, and which one has its number."""
    wrong, number = f"there is no room {name!r:.80}", name.rpartition("-")[2]
    if layouts == "sampled" and re.fullmatch("[0-9]{6}", number):
        return f"{wrong}, as number {int(number)} is {sampled_name(int(number))}"
    return wrong


def _in_proportion(total: int, has: int, had: int) -> int:
    """`total * has / had`, rounded; 2 instead of 1, as the answer to a single question cannot be balanced."""
    if not had:
        return 0
    scaled = (2 * total * has + had) // (2 * had)
    return 2 if scaled == 1 else scaled
