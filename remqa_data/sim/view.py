"""Kept for code that imports `remqa_data.sim.view`; it lives in `remqa_data.sim.render.view`."""

from remqa_data.sim.render.view import Observation, WorldView

__all__ = ["Observation", "WorldView"]
