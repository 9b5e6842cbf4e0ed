"""Kept for code that imports `remqa_data.sim.world`; it lives in `remqa_data.sim.physics.world`."""

from remqa_data.sim.physics.world import World

__all__ = ["World"]
