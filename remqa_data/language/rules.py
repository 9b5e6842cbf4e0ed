"""Which words referring expressions use and what may be mistaken for what; read from `templates/expressions.yaml`."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Annotated, Literal

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    NonNegativeFloat,
    PositiveFloat,
    PositiveInt,
    field_validator,
    model_validator,
)

from remqa_data.catalog import TypeName, catalog, types_with
from remqa_data.scene_graph.relations import Relation, relation_rules
from remqa_data.yaml_files import Word, check_told_apart, template_rules

SOURCE = "expressions.yaml"
SEEN_AS_ONE = types_with("seen_as_one")
"""Types of which several are one landmark."""
StackPlace = Literal["highest", "lowest", "middle"]
RowPlace = Literal[
    "left",
    "right",
    "leftmost",
    "rightmost",
    "second from the left",
    "second from the right",
    "third from the left",
    "third from the right",
]
RowOrdinal = Literal["second", "third"]
STEPS: Mapping[RowOrdinal, int] = {"second": 1, "third": 2}
"""How far each is from the end of its row."""
RowSide = Literal["from the left", "from the right"]

BARE, RELATED, DESCRIBED = "the {noun}", "the {noun} {relation} the {noun2}", "the {attribute} {noun}"
"""What phrases look like; `referring.program_of` reads them back."""
Share = Annotated[float, Field(gt=0, le=1)]


class ExpressionRules(BaseModel):
    """All of `templates/expressions.yaml`, which says what each field means."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    landmarks: tuple[tuple[TypeName, ...], ...]
    only_for: dict[TypeName, tuple[Relation, ...]]
    stack_words: dict[Word, StackPlace]
    same_height_m: NonNegativeFloat
    column_min_share: Share
    row_words: dict[Word, RowPlace]
    row_ordinals: dict[Word, RowOrdinal]
    row_sides: dict[Word, RowSide]
    row_min_step_m: NonNegativeFloat
    row_max_turn_deg: float = Field(ge=0, le=180)
    row_min_height_share: Share
    closest_word: Word
    closest_tie_m: NonNegativeFloat
    closest_max_m: PositiveFloat
    closest_margin_m: NonNegativeFloat
    closest_margin_factor: float = Field(ge=1)
    closest_landmark_groups: PositiveInt
    near_m: NonNegativeFloat
    near_height_m: NonNegativeFloat
    substances: frozenset[str]
    similar_words: tuple[frozenset[str], ...]
    may_mean: dict[TypeName, frozenset[TypeName]]

    @field_validator("closest_word")
    @classmethod
    def _is_no_relation(cls, word: str) -> str:
        if word in relation_rules().words.values():
            raise ValueError(f"{word!r} is what relations.yaml says for a relation, and phrases are to be told apart")
        return word

    @model_validator(mode="after")
    def _words_mean_one_thing(self) -> ExpressionRules:
        check_told_apart([*self.stack_words, *self.row_words, *self.row_ordinals, *self.substances], "things")
        return self


@lru_cache(maxsize=1)
def expression_rules() -> ExpressionRules:
    """The rules that come with the package, read once."""
    return template_rules(ExpressionRules, SOURCE)


def may_be_called(type_name: str) -> frozenset[str]:
    """The types that a person may mean by the word for one type, itself among them.

    >>> sorted(may_be_called("Knife")), sorted(may_be_called("Box"))
    (['ButterKnife', 'Knife'], ['Box', 'TissueBox'])
    """
    return _confusable()[type_name]


def similar_words(word: str) -> frozenset[str]:
    """The words that look like a colour or a substance in a picture, itself among them."""
    return frozenset({word}.union(*(group for group in expression_rules().similar_words if word in group)))


@lru_cache(maxsize=1)
def _confusable() -> Mapping[str, frozenset[str]]:
    table: dict[str, frozenset[str]] = {}
    for name, kind in catalog().items():
        word = kind.singular
        others = {
            other
            for other, candidate in catalog().items()
            for called in (candidate.singular, *candidate.synonyms)
            if called == word or called.endswith(f" {word}") or called.startswith(f"{word} of ")
        }
        table[name] = frozenset(others | {name} | expression_rules().may_mean.get(name, frozenset()))
    return table
