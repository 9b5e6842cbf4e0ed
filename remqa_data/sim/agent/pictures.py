"""Pictures that are remembered: agents turn back, and come by the same places again."""

from __future__ import annotations

from collections.abc import Mapping

from remqa_data.geometry.types import Flags
from remqa_data.sim.render.camera import AnyCamera
from remqa_data.sim.render.view import Figure, Observation, WorldView

BYTES_PER_PIXEL = 19
"""Of an observation: colour, depth, instances, objects, links."""


class Pictures:
    """What cameras see of a room, drawn once from each place until it is forgotten.

    Parameters
    ----------
    view : WorldView
        Draws the room.
    most_bytes : int
        All take no more together; the oldest goes first, and a larger one is not kept.
    """

    def __init__(self, view: WorldView, most_bytes: int) -> None:
        self.most_bytes = most_bytes
        self._view = view
        self._drawn: dict[tuple[AnyCamera, bytes | None, bool, bool, tuple[bytes, ...]], Observation] = {}
        self._bytes = 0

    def __len__(self) -> int:
        return len(self._drawn)

    def of(
        self,
        camera: AnyCamera,
        only: Flags | None = None,
        *,
        shadows: bool = True,
        antialias: bool = True,
        figures: Mapping[int, Figure] | None = None,
    ) -> Observation:
        """What `WorldView.render` gives, with figures in it; not to be written to, as it may be given again."""
        shown = figures or {}
        figure_keys = tuple(figure.key() for figure in shown.values())
        key = (camera, None if only is None else only.tobytes(), shadows, antialias, figure_keys)
        if key not in self._drawn:
            with self._view.showing(shown):
                drawn = self._view.render(camera, shadows=shadows, antialias=antialias, only=only)
            size = BYTES_PER_PIXEL * drawn.depth.size
            if size > self.most_bytes:
                return drawn
            while self._bytes + size > self.most_bytes:
                self._bytes -= BYTES_PER_PIXEL * self._drawn.pop(next(iter(self._drawn))).depth.size
            self._drawn[key] = drawn
            self._bytes += size
        return self._drawn[key]

    def forget(self) -> None:
        """Draw everything anew, as the room is another one."""
        self._drawn, self._bytes = {}, 0
