"""Kept for code that imports `remqa_data.generators.floorplans.ithor`; it lives in `remqa_data.floorplans.ithor.scenes`."""

from remqa_data.floorplans.ithor.scenes import load_scene, scene_names

__all__ = ["load_scene", "scene_names"]
