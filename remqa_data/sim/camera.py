"""Kept for code that imports `remqa_data.sim.camera`; it lives in `remqa_data.sim.render.camera`."""

from remqa_data.sim.render.camera import Camera, TopDownCamera

__all__ = ["Camera", "TopDownCamera"]
