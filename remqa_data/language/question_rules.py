"""What `templates/questions.yaml` says: the words of questions, and how often each of them is asked."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Annotated, Literal, TypeVar, get_args

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

from remqa_data.catalog import Manipulation, TypeName
from remqa_data.language.inner_relations import InnerRelation
from remqa_data.scene_graph.relations import Relation, relation_rules
from remqa_data.tables.rows import KINDS, QuestionKind
from remqa_data.yaml_files import Word, check_told_apart, checked_pattern, entry_for_each, template_rules

SOURCE = "questions.yaml"
YES, NO = "yes", "no"

ExpressionKind = Literal["bare", "relation", "attribute", "superlative"]
"""What an expression tells its target by: "the fridge", "... next to the sink", "the red ...", "... closest to the door"."""

RELATIONS_OF: Mapping[QuestionKind, tuple[Relation, ...]] = {
    "EXISTENCE": ("in",),
    "COUNTING": ("in", "under"),
    "SPATIAL": ("in", "under"),
}
"""Where a kind of question looks."""

T = TypeVar("T")
ForEachKind = Annotated[Mapping[QuestionKind, T], entry_for_each(KINDS)]
"""What each kind of question has; none is left out."""


class QuestionRules(BaseModel):
    """All of `templates/questions.yaml`, which says what each field means."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    templates: ForEachKind[str]
    inner_template: str
    inner_share: float = Field(ge=0, le=1)
    inner_longest_words: PositiveInt
    inner_relations: Annotated[Mapping[InnerRelation, NonNegativeFloat], entry_for_each(get_args(InnerRelation))]
    aim_words: ForEachKind[PositiveFloat]
    bare_share: ForEachKind[Annotated[float, Field(ge=0, le=1)]]
    bare_share_per_word: float = Field(ge=0)
    tolerance_words: ForEachKind[PositiveFloat]
    longest_words: ForEachKind[PositiveInt]
    expression_weights: Annotated[Mapping[ExpressionKind, NonNegativeFloat], entry_for_each(get_args(ExpressionKind))]
    rank_factor: float = Field(gt=0, le=1)
    spatial_words: Mapping[Relation, Word]
    manipulations: ForEachKind[Mapping[Manipulation, NonNegativeFloat]]
    type_weights: Mapping[TypeName, PositiveFloat]
    max_groups_per_place: ForEachKind[PositiveInt]
    max_groups_per_type: PositiveInt
    again_factor: float = Field(ge=1)
    counts: tuple[int, ...]

    @field_validator("templates")
    @classmethod
    def _say_what_is_asked(cls, templates: Mapping[QuestionKind, str]) -> Mapping[QuestionKind, str]:
        for kind, template in templates.items():
            if len(RELATIONS_OF[kind]) > 1:
                checked_pattern(template, ("re", "relation"), ("a_obj", "objs"))
            else:
                checked_pattern(template, ("re",), ("a_obj", "objs", "relation"))
            if kind == "COUNTING" and "{a_obj}" in template:
                raise ValueError(f"how many is asked of {{objs}}, not of {{a_obj}}, found {template!r:.200}")
            if "{a_obj}" not in template and "{objs}" not in template:
                raise ValueError(f"expected the placeholder {{a_obj}} or {{objs}}, found {template!r:.200}")
        return templates

    @field_validator("inner_template")
    @classmethod
    def _inner_can_be_filled(cls, template: str) -> str:
        return checked_pattern(template, ["obj", "relation", "obj2", "re"])

    @model_validator(mode="after")
    def _some_inner_relation_is_asked(self) -> QuestionRules:
        if not any(self.inner_relations.values()) and self.inner_share:
            raise ValueError("inner_relations: one of them must be likelier than 0, or inner_share be 0")
        return self

    @model_validator(mode="after")
    def _kinds_are_told_apart(self) -> QuestionRules:
        for relation in RELATIONS_OF["EXISTENCE"]:
            spatial, other = (
                self.templates[kind].replace("{relation}", self.said(kind, relation))
                for kind in ("SPATIAL", "EXISTENCE")
            )
            if spatial == other:
                raise ValueError(
                    f"spatial_words: SPATIAL and EXISTENCE both ask {spatial!r}; say another word for {relation!r}"
                )
        check_told_apart(
            [self.said("SPATIAL", relation) for relation in RELATIONS_OF["SPATIAL"]], "relations", "spatial_words"
        )
        return self

    @field_validator("counts")
    @classmethod
    def _fill_a_lot(cls, counts: tuple[int, ...]) -> tuple[int, ...]:
        if counts not in ((0, 1), (0, 1, 2, 3)):
            raise ValueError(
                f"expected [0, 1] or [0, 1, 2, 3], each as often among four questions, found {list(counts)}"
            )
        return counts

    def said(self, kind: QuestionKind, relation: Relation) -> str:
        """The words of a kind of question for a relation."""
        words = relation_rules().words[relation]
        return self.spatial_words.get(relation, words) if kind == "SPATIAL" else words

    def answers(self, kind: QuestionKind) -> tuple[str, ...]:
        """The answers to a kind of question."""
        return tuple(map(str, self.counts)) if kind == "COUNTING" else (YES, NO)


@lru_cache(maxsize=1)
def question_rules() -> QuestionRules:
    """The rules that come with the package, read once."""
    return template_rules(QuestionRules, SOURCE)
