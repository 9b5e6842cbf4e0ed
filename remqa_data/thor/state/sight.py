"""How far the objects of a room are from an agent, and which of them it sees: found once for each pose.

A step without pictures needs no more of a picture than how many pixels show what is near.
"""

from __future__ import annotations

import numpy as np

from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec2
from remqa_data.sim.metadata import scaled_pixels
from remqa_data.sim.navigation.embodiment import Embodiment
from remqa_data.sim.physics.state import ObjectState
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.camera import Camera
from remqa_data.sim.render.view import WorldView

ENOUGH_PX = 10
"""An object is visible when so many pixels of a 300 x 300 frame show it. AI2-THOR asks for one point of its surface, and
lets clients take a fork from a metre and a half away, which has fewer pixels than make evidence of a question."""
MOST_KEPT = 10_000
"""So many poses are remembered while nothing in the room changes."""


class Sight:
    """Distances and sight in a room; later changes of it are followed.

    Parameters
    ----------
    world, view : World, WorldView
        The room and its renderer.
    body : Embodiment
        Of the agent: the heights of its shoulder.
    """

    def __init__(self, world: World, view: WorldView, body: Embodiment) -> None:
        self._world, self._view, self._body = world, view, body
        self._ids = np.array(world.ids, dtype=object)
        self._halves = np.array([world.assets[name].spec.size for name in world.ids]).reshape(-1, 3) / 2
        self._frames = np.tile(np.eye(4), (len(self._ids), 1, 1))
        self._shown: dict[str, ObjectState] = {}
        self._version: tuple[int, int] | None = None
        self._distances: dict[Vec2, F64] = {}
        self._visible: dict[tuple[Camera, float], frozenset[str]] = {}

    def distances(self, position: Vec2) -> F64:
        """(objects,) metres in plan from a position to the objects' closed boxes, as of `Body.plan_distance`."""
        self._follow()
        if position not in self._distances:
            floor, body = self._world.scene.floor_z, self._body
            shoulders = np.empty((len(self._ids), 3))
            shoulders[:, :2] = position
            heights = self._frames[:, 2, 3] - floor
            shoulders[:, 2] = floor + np.clip(heights, body.shoulder_low_m, body.shoulder_high_m)
            local = np.clip(arithmetic.moved_back(shoulders, self._frames), -self._halves, self._halves)
            nearest = arithmetic.moved(local, self._frames)
            self._distances[position] = arithmetic.length(nearest[:, :2] - position)
        return self._distances[position]

    def visible(self, camera: Camera, distance_m: float) -> frozenset[str]:
        """Ids of the objects within a distance in plan of which a camera's picture shows enough."""
        near = self.distances(camera.position[:2]) <= distance_m
        key = (camera, distance_m)
        if key not in self._visible:
            pixels = self._view.pixels_of(camera, self._ids[near].tolist())
            seen = near & (pixels >= enough_pixels((camera.height, camera.width)))
            self._visible[key] = frozenset(self._ids[seen].tolist())
        return self._visible[key]

    def _follow(self) -> None:
        """Forget what was found when the room was another; states are replaced, never changed, so identity tells."""
        version = self._view.version
        if version != self._version or len(self._visible) + len(self._distances) > MOST_KEPT:
            self._distances, self._visible = {}, {}
        if version == self._version:
            return
        self._version = version
        for index, object_id in enumerate(self._world.ids):
            state = self._world.state(object_id)
            if state is not self._shown.get(object_id):
                self._shown[object_id] = state
                self._frames[index] = state.matrix()


def enough_pixels(shape: tuple[int, ...]) -> int:
    """How many pixels of a (height, width) frame make an object visible."""
    return scaled_pixels(ENOUGH_PX, shape)
