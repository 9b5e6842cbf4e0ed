"""Assets as large as things of their type are as a rule."""

import numpy as np

from remqa_data.assets import Asset, AssetSpec, build
from remqa_data.assets.core.sizes import typical_size
from remqa_data.geometry.types import F64


def typical(type_: str, variant: int = 0, seed: int = 0) -> Asset:
    return build(AssetSpec(type_, typical_size(type_), variant, seed))


def vertices(asset: Asset) -> F64:
    """Of all its links where they are while it is closed."""
    return np.vstack([surface.vertices for link in asset.links for surface in link.surfaces]).astype(float)
