"""What furniture is made of: the drawers, shelves and cabinets of a dresser, a desk or a bookcase are objects of their own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from remqa_data.assets.core.model import Asset
from remqa_data.catalog import object_type, types_with
from remqa_data.geometry import boxes
from remqa_data.geometry.types import F64
from remqa_data.scene import SceneObject
from remqa_data.sim.physics.state import ObjectState

PART_SHARE = 0.8
"""So much of a drawer or shelf, by volume, is in the furniture that it is a part of."""


def parts_of_furniture(objects: Sequence[SceneObject], assets: Mapping[str, Asset]) -> dict[str, tuple[str, ...]]:
    """Ids of the parts of each moveable object that has any: of what is, closed and as it was built, nearly all in its box."""
    parts = [o for o in objects if o.type in types_with("cupboard_part")]
    furniture = [o for o in objects if object_type(o.type).moveable]
    if not parts or not furniture:
        return {}
    around, within = (np.stack([_closed_box(o, assets[o.id]) for o in some]) for some in (furniture, parts))
    shares = boxes.intersection_volume(around, within) / boxes.volume(within)
    made_of = {
        whole.id: tuple(part.id for part, share in zip(parts, row, strict=True) if share >= PART_SHARE)
        for whole, row in zip(furniture, shares.tolist(), strict=True)
    }
    return {whole: ids for whole, ids in made_of.items() if ids}


def _closed_box(thing: SceneObject, asset: Asset) -> F64:
    """(6,) corners."""
    state = ObjectState(thing.position, thing.quaternion, 0.0, thing.is_fixed)
    return asset.box_at(state.link_poses(asset)).ravel()
