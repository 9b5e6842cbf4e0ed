"""The simulated world: physics, camera and frames, navigation, the arm and the agent.

Its front door is `World`, `WorldView` and `Camera`, which load when they are used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from remqa_data.lazy import lazy_names

if TYPE_CHECKING:
    from remqa_data.sim.physics.world import World
    from remqa_data.sim.render.camera import Camera
    from remqa_data.sim.render.view import WorldView

__all__ = ["Camera", "World", "WorldView"]

__getattr__ = lazy_names(
    __name__,
    {
        "Camera": "remqa_data.sim.render.camera",
        "World": "remqa_data.sim.physics.world",
        "WorldView": "remqa_data.sim.render.view",
    },
)
