"""What `templates/questions.yaml` says: the words of questions, and how often each of them is asked."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, PositiveFloat

from remqa_data.catalog import Manipulation
from remqa_data.language.inner import InnerRelation
from remqa_data.scene_graph.relations import Relation
from remqa_data.tables.rows import QuestionKind
from remqa_data.yaml_files import template_rules

SOURCE = "questions.yaml"
YES, NO = "yes", "no"

ExpressionKind = Literal["bare", "relation", "attribute", "superlative"]
"""What an expression tells its target by: "the fridge", "... next to the sink", "the red ...", "... closest to the door"."""


class QuestionRules(BaseModel):
    """All of `templates/questions.yaml`, which says what each field means."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    templates: Mapping[QuestionKind, str]
    inner_template: str
    inner_share: float = Field(ge=0, le=1)
    inner_longest_words: int
    inner_relations: Mapping[InnerRelation, float]
    aim_words: Mapping[QuestionKind, PositiveFloat]
    bare_share: Mapping[QuestionKind, float]
    bare_share_per_word: float = Field(ge=0)
    tolerance_words: Mapping[QuestionKind, PositiveFloat]
    longest_words: Mapping[QuestionKind, int]
    expression_weights: Mapping[ExpressionKind, float]
    rank_factor: float = Field(gt=0, le=1)
    spatial_words: Mapping[Relation, str]
    manipulations: Mapping[QuestionKind, Mapping[Manipulation, float]]
    type_weights: Mapping[str, PositiveFloat]
    max_groups_per_place: Mapping[QuestionKind, int]
    max_groups_per_type: int
    again_factor: float = Field(ge=1)
    counts: tuple[int, ...]

    def answers(self, kind: QuestionKind) -> tuple[str, ...]:
        """The answers to a kind of question."""
        return tuple(map(str, self.counts)) if kind == "COUNTING" else (YES, NO)


@lru_cache(maxsize=1)
def question_rules() -> QuestionRules:
    """The rules that come with the package, read once."""
    return template_rules(QuestionRules, SOURCE)
