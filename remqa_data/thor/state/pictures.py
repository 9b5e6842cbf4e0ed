"""Pictures of a room that nothing has changed in since: agents turn back, and come by the same places again."""

from __future__ import annotations

from remqa_data.geometry.types import Flags
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.camera import AnyCamera
from remqa_data.sim.render.view import Observation, WorldView

MOST_BYTES = 64 << 20
"""Pictures take no more together, but for the last one: some 50 of 300 x 300."""


class Pictures:
    """What cameras see of a room, drawn once from each place; any change of the room is followed.

    Parameters
    ----------
    world, view : World, WorldView
        The room and its renderer.
    """

    def __init__(self, world: World, view: WorldView) -> None:
        self._world, self._view = world, view
        self._drawn: dict[tuple[AnyCamera, bytes | None], Observation] = {}
        self._bytes = 0
        self._state: tuple[int, int] | None = None

    def of(self, camera: AnyCamera, only: Flags | None = None) -> Observation:
        """What `WorldView.render` gives; not to be written to, as it may be given again."""
        state = (self._world.revision, self._view.changes)
        if state != self._state:
            self._drawn, self._bytes, self._state = {}, 0, state
        key = (camera, None if only is None else only.tobytes())
        if key not in self._drawn:
            drawn = self._view.render(camera, only=only)
            self._bytes += _size(drawn)
            while self._drawn and self._bytes > MOST_BYTES:
                self._bytes -= _size(self._drawn.pop(next(iter(self._drawn))))
            self._drawn[key] = drawn
        return self._drawn[key]


def _size(drawn: Observation) -> int:
    return drawn.rgb.nbytes + drawn.depth.nbytes + drawn.objects.nbytes + drawn.links.nbytes
