"""Which receptacles take which things unless they must: AI2-THOR's default compatible receptacles."""

from __future__ import annotations

from functools import cache

from pydantic import BaseModel, ConfigDict

from remqa_data.yaml_files import template_rules

SOURCE = "thor_receptacles.yaml"


class _Rules(BaseModel):
    """What the file says."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    tables: frozenset[str]
    specific: frozenset[str]
    compatible: dict[str, frozenset[str]]


def is_compatible(type_name: str, receptacle_type: str) -> bool:
    """Whether AI2-THOR puts things of a type on or into a type of receptacle of itself.

    >>> is_compatible("Apple", "Fridge"), is_compatible("Apple", "Toilet"), is_compatible("Apple", "SideTable")
    (True, False, True)
    """
    rules = _rules()
    named = rules.compatible.get(type_name)
    return named is None or receptacle_type in named or ("tables" in named and receptacle_type in rules.tables)


def is_specific(receptacle_type: str) -> bool:
    """Whether a type of receptacle takes only what is compatible with it, even if one is forced to.

    >>> is_specific("StoveBurner"), is_specific("Fridge")
    (True, False)
    """
    return receptacle_type in _rules().specific


@cache
def _rules() -> _Rules:
    """The rules of `templates/thor_receptacles.yaml`, read once."""
    return template_rules(_Rules, SOURCE)
