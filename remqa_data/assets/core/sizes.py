"""Typical sizes of the object types, for pictures and for placing things that no floor plan names."""

from __future__ import annotations

from functools import lru_cache

from pydantic import PositiveFloat, RootModel

from remqa_data.catalog import SOURCE, TypeName, catalog
from remqa_data.errors import AssetError, UnknownNameError
from remqa_data.geometry.types import Vec3
from remqa_data.yaml_files import template_rules


class _Measured(RootModel[dict[TypeName, tuple[PositiveFloat, PositiveFloat, PositiveFloat]]]):
    """All of `templates/sizes.yaml`."""


def typical_size(type_: str) -> Vec3:
    """Width, depth and height of a closed object in metres: what its row says, else the median over the iTHOR floor plans.

    >>> typical_size("Fridge")[2] > 1.5
    True
    """
    sizes = _sizes()
    if type_ in catalog() and type_ not in sizes:
        raise AssetError(f"{SOURCE}: no iTHOR floor plan has a {type_}; give its row size_m")
    if type_ not in sizes:
        raise UnknownNameError("object type", type_, sizes)
    return sizes[type_]


@lru_cache(maxsize=1)
def _sizes() -> dict[str, Vec3]:
    measured: dict[str, Vec3] = template_rules(_Measured, "sizes.yaml").root
    return measured | {name: kind.size_m for name, kind in catalog().items() if kind.size_m is not None}
