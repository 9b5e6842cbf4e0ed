"""The thresholds that decide relations and the words for them; the numbers are in `templates/relations.yaml`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from typing import Literal

import yaml
from pydantic import BaseModel, ConfigDict, Field

Relation = Literal["in", "on", "under", "above", "below", "next to"]
"""What one object is to another, by their boxes and by what holds them: the edges of the scene graph."""
OrderRelation = Literal["behind", "between"]
"""How things lie in what holds them all: it takes more than two objects to tell, so these are no edges."""
InnerRelation = Literal["on", "next to", "behind", "between"]
"""What a question may ask of two things that lie in the same closed thing."""

SOURCE = "relations.yaml"


@dataclass(frozen=True)
class Partner:
    """What a thing is asked to lie on, next to, behind or between, in the same place.

    Attributes
    ----------
    relation : {"on", "next to", "behind", "between"}
        What the thing is to it.
    type : str
        Its type: there is one of it in the place, or two, for what lies between.
    """

    relation: InnerRelation
    type: str

    @property
    def count(self) -> int:
        """How many there are of it."""
        return 2 if self.relation == "between" else 1


class _Rules(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class SupportRules(_Rules):
    """When an object is held by a space of another; metres. The file says what each number means."""

    side_margin_m: float = Field(ge=0)
    sunk_m: float = Field(ge=0)
    overhang_m: float = Field(ge=0)
    contact_m: float = Field(ge=0)
    pile_m: float = Field(ge=0)


class PartRules(_Rules):
    """When a drawer is in a dresser."""

    min_share: float = Field(gt=0, le=1)
    parts: dict[str, frozenset[str]]


class FloorRules(_Rules):
    """When a thing is on the floor."""

    max_gap_m: float = Field(ge=0)


class UnderRules(_Rules):
    """When a thing is under another: beneath what can be lifted, or beneath furniture on legs."""

    min_plan_share: float = Field(gt=0, le=1)
    max_contact_gap_m: float = Field(ge=0)
    max_sunk_m: float = Field(ge=0)
    max_area_ratio: float = Field(gt=0)
    min_head_room_m: float = Field(ge=0)
    legs: frozenset[str]


class PileRules(_Rules):
    """When a thing lies on another that is in the same thing as it."""

    min_plan_share: float = Field(gt=0, le=1)
    max_gap_m: float = Field(ge=0)
    max_sunk_m: float = Field(ge=0)


class OrderRules(_Rules):
    """When a thing is behind another, or between two others, in what holds them all."""

    max_gap_m: float = Field(ge=0)
    max_sunk_m: float = Field(ge=0)
    min_side_share: float = Field(gt=0, le=1)
    min_height_share: float = Field(gt=0, le=1)
    min_part: float = Field(gt=0, lt=0.5)
    max_off_share: float = Field(gt=0)
    max_distance_m: float = Field(gt=0)


class StackedRules(_Rules):
    """When a thing is above or below another."""

    min_side_share: float = Field(gt=0, le=1)
    wall_depth_m: float = Field(ge=0)
    on_walls: frozenset[str]
    max_gap_m: float = Field(ge=0)
    max_sunk_m: float = Field(ge=0)
    max_sunk_share: float = Field(ge=0, le=1)
    sunk_in: frozenset[str]
    max_distance_m: float = Field(gt=0)
    max_iou: float = Field(ge=0, le=1)
    never: frozenset[str]


class NextToRules(_Rules):
    """When a thing is next to another."""

    max_gap_m: float = Field(ge=0)
    gap_per_size: float = Field(gt=0)
    min_height_share: float = Field(gt=0, le=1)
    max_distance_m: float = Field(gt=0)
    max_iou: float = Field(ge=0, le=1)
    max_shared_volume: float = Field(gt=0, le=1)
    never: frozenset[str]


class RelationRules(_Rules):
    """All of `relations.yaml`.

    Attributes
    ----------
    support : SupportRules
        When an object is held by another.
    vessels : mapping of str to tuple of str
        By type, the first words of the names of its spaces that have walls around them but are not closed.
    words, order_words : mapping of relation to str
        What stands between the two nouns of a phrase.
    inverses : mapping of relation to relation or None
        What the second object is to the first.
    floor, part, under, pile, stacked, next_to, order
        Thresholds of the relations.
    near_miss_factor : float
        How much `loosened` loosens, and `tightened` tightens.
    """

    support: SupportRules
    vessels: dict[str, tuple[str, ...]]
    words: dict[Relation, str]
    order_words: dict[OrderRelation, str]
    inverses: dict[Relation, Relation | None]
    floor: FloorRules
    part: PartRules
    under: UnderRules
    pile: PileRules
    stacked: StackedRules
    next_to: NextToRules
    order: OrderRules
    near_miss_factor: float = Field(ge=1)

    def loosened(self) -> RelationRules:
        """Rules under which more pairs are related: limits times the factor, shares to be reached divided by it."""
        return self._with_limits_times(self.near_miss_factor)

    def tightened(self) -> RelationRules:
        """Rules under which fewer pairs are related, by the same factor: what is related by these too, clearly is."""
        return self._with_limits_times(1.0 / self.near_miss_factor)

    def said(self, relation: InnerRelation) -> str:
        """The words for a relation of two things in a closed thing."""
        if relation == "behind" or relation == "between":
            return self.order_words[relation]
        return self.words[relation]

    def _with_limits_times(self, more: float) -> RelationRules:
        floor, part, under, stacked, beside = self.floor, self.part, self.under, self.stacked, self.next_to
        pile, order = self.pile, self.order
        return self.model_copy(
            update={
                "floor": floor.model_copy(update={"max_gap_m": floor.max_gap_m * more}),
                "part": part.model_copy(update={"min_share": min(part.min_share / more, 1.0)}),
                "under": under.model_copy(
                    update={
                        "min_plan_share": min(under.min_plan_share / more, 1.0),
                        "max_contact_gap_m": under.max_contact_gap_m * more,
                        "max_sunk_m": under.max_sunk_m * more,
                        "max_area_ratio": under.max_area_ratio * more,
                        "min_head_room_m": under.min_head_room_m / more,
                    }
                ),
                "pile": pile.model_copy(
                    update={
                        "min_plan_share": min(pile.min_plan_share / more, 1.0),
                        "max_gap_m": pile.max_gap_m * more,
                        "max_sunk_m": pile.max_sunk_m * more,
                    }
                ),
                "order": order.model_copy(
                    update={
                        "max_gap_m": order.max_gap_m * more,
                        "max_sunk_m": order.max_sunk_m * more,
                        "min_side_share": min(order.min_side_share / more, 1.0),
                        "min_height_share": min(order.min_height_share / more, 1.0),
                        "min_part": order.min_part / more,
                        "max_off_share": order.max_off_share * more,
                        "max_distance_m": order.max_distance_m * more,
                    }
                ),
                "stacked": stacked.model_copy(
                    update={
                        "min_side_share": min(stacked.min_side_share / more, 1.0),
                        "max_gap_m": stacked.max_gap_m * more,
                        "max_sunk_m": stacked.max_sunk_m * more,
                        "max_distance_m": stacked.max_distance_m * more,
                        "max_iou": min(stacked.max_iou * more, 1.0),
                    }
                ),
                "next_to": beside.model_copy(
                    update={
                        "max_gap_m": beside.max_gap_m * more,
                        "gap_per_size": beside.gap_per_size * more,
                        "min_height_share": min(beside.min_height_share / more, 1.0),
                        "max_distance_m": beside.max_distance_m * more,
                        "max_iou": min(beside.max_iou * more, 1.0),
                        "max_shared_volume": min(beside.max_shared_volume * more, 1.0),
                    }
                ),
            }
        )


@lru_cache(maxsize=1)
def relation_rules() -> RelationRules:
    """The rules that come with the package, read once."""
    text = (resources.files("remqa_data.templates") / SOURCE).read_text(encoding="utf-8")
    return RelationRules.model_validate(yaml.safe_load(text))
