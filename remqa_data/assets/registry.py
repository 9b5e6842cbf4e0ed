"""Every object type and the function that draws it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache
from types import ModuleType

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.hollow import with_hollow
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Asset, AssetSpec
from remqa_data.assets.looks.seen_colors import color_word
from remqa_data.assets.types.bathroom import basins, faucets, shower, tissue, toiletries, toilets, towels
from remqa_data.assets.types.fixtures import candles, lamps, wall_and_floor
from remqa_data.assets.types.furniture import beds, desks, seating, sofas, storage, tables
from remqa_data.assets.types.kitchen import (
    appliances,
    bottles,
    coffee_machines,
    cookware,
    food,
    fridges,
    kitchen_supplies,
    slices,
    stoves,
    tableware,
    utensils,
)
from remqa_data.assets.types.small import (
    bins,
    books,
    boots,
    carried,
    clocks,
    containers,
    decor,
    electronics,
    plants,
    plush,
    sports,
    stationery,
    statues,
    vacuums,
)
from remqa_data.catalog import catalog, object_type
from remqa_data.errors import AssetError, UnknownNameError

MODULES: tuple[ModuleType, ...] = (
    *(basins, faucets, shower, tissue, toiletries, toilets, towels),
    *(candles, lamps, wall_and_floor),
    *(beds, desks, seating, sofas, storage, tables),
    *(appliances, bottles, coffee_machines, cookware, food, fridges, kitchen_supplies, stoves, tableware, utensils),
    *(bins, books, boots, carried, clocks, containers, decor, electronics, plants, plush),
    *(sports, stationery, statues, vacuums),
)
"""Those that announce object types in a mapping `KINDS`."""


def merged_kinds(modules: Iterable[ModuleType]) -> dict[str, Kind]:
    """The object types of some modules.

    Raises
    ------
    AssetError
        If two of them announce the same type.
    """
    homes: dict[str, str] = {}
    kinds: dict[str, Kind] = {}
    for module in modules:
        for type_, kind in module.KINDS.items():
            if type_ in kinds:
                raise AssetError(f"{type_} is drawn by {homes[type_]} and by {module.__name__}; remove one of them")
            homes[type_], kinds[type_] = module.__name__, kind
    return kinds


KINDS = merged_kinds(MODULES)
TYPES = tuple(sorted(KINDS))


@lru_cache(maxsize=1024)  # many times what one room needs
def build(spec: AssetSpec) -> Asset:
    """The asset that a specification describes; equal specifications share one asset.

    Raises
    ------
    UnknownNameError
        If the type is not known.
    AssetError
        If the variant does not exist, or nothing can be built of this size.
    """
    kind = _kind(spec.type)
    if not 0 <= spec.variant < kind.variants:
        raise AssetError(f"{spec.type} has variants 0 to {kind.variants - 1}, not {spec.variant}")
    if min(spec.size) <= 0:
        raise AssetError(f"{spec.type}: size {spec.size} m must be positive on each axis")
    builder = Builder(spec)
    try:
        kind.draw(builder)
        asset = builder.finish()
        is_whole = bool(np.isfinite(asset.bounds()).all())
    except AssetError:
        raise
    except ValueError:  # pieces too thin to be there
        is_whole = False
    if not is_whole:
        raise AssetError(f"{spec.type}: cannot be built in the size {spec.size} m")
    asset = with_hollow(asset, object_type(spec.type).hollow_m)
    return replace(asset, color=color_word(asset.links, asset.color))


def variant_count(type_: str) -> int:
    """How many variants a type has."""
    return _kind(type_).variants


def _kind(type_: str) -> Kind:
    kind = KINDS.get(type_) or slices.SLICES.get(type_)
    if kind is None and type_ in catalog():
        raise AssetError(
            f"nothing draws a {type_}, though objects.yaml has it; write a function for it in remqa_data/assets/types"
        )
    if kind is None:
        raise UnknownNameError("object type", type_, KINDS)
    return kind
