"""Parametric objects: one small function for each object type draws it from a size, a variant and a seed."""

from __future__ import annotations

from remqa_data.assets.core.model import Asset, AssetSpec
from remqa_data.assets.registry import TYPES, build, variant_count

__all__ = ["TYPES", "Asset", "AssetSpec", "build", "variant_count"]
