"""The numbers that decide where things can be hidden and how rooms are arranged; they are in `templates/hiding.yaml`."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

from pydantic import BaseModel, ConfigDict, Field

from remqa_data.assets.core.sizes import typical_size
from remqa_data.catalog import TypeName
from remqa_data.geometry.types import Vec3
from remqa_data.yaml_files import template_rules

SOURCE = "hiding.yaml"


class HidingRules(BaseModel):
    """All of `hiding.yaml`, which says what each field means; metres and pixels."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    folded_m: Mapping[TypeName, Vec3]
    min_pickup_side_m: float = Field(gt=0)
    min_move_side_m: float = Field(gt=0)
    max_move_side_m: float = Field(gt=0)
    max_under_height_m: float = Field(gt=0)
    round_share: float = Field(gt=0, le=1)
    square_share: float = Field(gt=0, le=1)
    shift_gaps_m: tuple[float, ...] = Field(min_length=1)
    pitch_m: float = Field(gt=0)
    wall_gap_m: float = Field(ge=0)
    sight_heights_m: tuple[float, ...] = Field(min_length=1)
    min_area_side_m: float = Field(gt=0)
    min_share_seen: float = Field(gt=0, le=1)
    min_target_px: int = Field(gt=0)
    max_poses: int = Field(gt=0)
    other_goals: int = Field(ge=0)
    scout_px: int = Field(gt=0)
    spot_side_m: float = Field(gt=0)
    spot_side_under_m: float = Field(gt=0)
    long_thing_m: tuple[float, float]
    max_spots: int = Field(gt=0)
    max_spots_under: int = Field(gt=0)
    higher_m: float = Field(gt=0)
    size_spread: float = Field(ge=0, lt=1)
    gap_m: float = Field(ge=0)
    min_evidence_px: int = Field(gt=0)
    aim_evidence_px: int = Field(gt=0)
    pixel_margin: float = Field(gt=0)
    moved_share: float = Field(ge=0, le=1)


@lru_cache(maxsize=1)
def hiding_rules() -> HidingRules:
    """The rules that ship with the package."""
    return template_rules(HidingRules, SOURCE)


def hidden_size(type_: str) -> Vec3:
    """Width, depth and height in metres of a thing as it is put away: towels lie folded, all else is of its usual size.

    >>> hidden_size("Towel")[2] < 0.1
    True
    """
    return hiding_rules().folded_m.get(type_) or typical_size(type_)


def largest_size(type_: str) -> Vec3:
    """The same of the largest thing of a type that is made."""
    grown = 1.0 + hiding_rules().size_spread
    width, depth, height = (grown * side for side in hidden_size(type_))
    return width, depth, height


def plan_ratio(one: str, other: str) -> float:
    """How nearly things of two types are as large, looked at from above: the smaller plan by the larger, 0 to 1.

    >>> plan_ratio("Fork", "Fork")
    1.0
    """
    (w, d, _), (v, e, _) = hidden_size(one), hidden_size(other)
    return min(w * d, v * e) / max(w * d, v * e)
