"""Every object type and the function that draws it."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Asset, AssetSpec
from remqa_data.assets.types.bathroom import basins as plumbing
from remqa_data.assets.types.bathroom import shower
from remqa_data.assets.types.bathroom import toiletries as bathroom
from remqa_data.assets.types.bathroom import towels as textiles
from remqa_data.assets.types.fixtures import candles as lighting
from remqa_data.assets.types.fixtures import lamps
from remqa_data.assets.types.fixtures import wall_and_floor as wall
from remqa_data.assets.types.furniture import beds as bedding
from remqa_data.assets.types.furniture import desks, seating, sofas, storage, tables
from remqa_data.assets.types.kitchen import appliances, bottles, cookware, food, kitchen_supplies, tableware, utensils
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
from remqa_data.errors import AssetError, UnknownNameError

KINDS: dict[str, Kind] = {
    **storage.KINDS,
    **containers.KINDS,
    **bins.KINDS,
    **desks.KINDS,
    **tables.KINDS,
    **tableware.KINDS,
    **kitchen_supplies.KINDS,
    **food.KINDS,
    **utensils.KINDS,
    **bottles.KINDS,
    **cookware.KINDS,
    **bathroom.KINDS,
    **textiles.KINDS,
    **wall.KINDS,
    **bedding.KINDS,
    **decor.KINDS,
    **lamps.KINDS,
    **lighting.KINDS,
    **plants.KINDS,
    **plush.KINDS,
    **seating.KINDS,
    **sofas.KINDS,
    **statues.KINDS,
    **books.KINDS,
    **boots.KINDS,
    **carried.KINDS,
    **clocks.KINDS,
    **electronics.KINDS,
    **sports.KINDS,
    **stationery.KINDS,
    **vacuums.KINDS,
    **appliances.KINDS,
    **plumbing.KINDS,
    **shower.KINDS,
}
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
    return asset


def variant_count(type_: str) -> int:
    """How many variants a type has."""
    return _kind(type_).variants


def _kind(type_: str) -> Kind:
    if type_ not in KINDS:
        raise UnknownNameError("object type", type_, KINDS)
    return KINDS[type_]
