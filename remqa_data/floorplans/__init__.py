"""Where rooms come from: recorded floor plans and sampled ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

from remqa_data.lazy import lazy_names

if TYPE_CHECKING:
    from remqa_data.floorplans.load import load_scene, recorded_poses, scene_names

__all__ = ["load_scene", "recorded_poses", "scene_names"]

__getattr__ = lazy_names(__name__, dict.fromkeys(__all__, "remqa_data.floorplans.load"))
