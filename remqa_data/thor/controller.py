"""AI2-THOR's Controller over our rooms: the same Python class, with the Unity process replaced."""

from __future__ import annotations

from typing import Any

from ai2thor.build import COMMIT_ID
from ai2thor.controller import Controller as ThorController
from ai2thor.server import Event

from remqa_data.errors import ActionError, MisuseError
from remqa_data.thor.server import Server
from remqa_data.thor.session import Session
from remqa_data.thor.state.settings import MOST_PIXELS


class Controller(ThorController):  # type: ignore[misc]  # AI2-THOR has no types
    """Drop-in replacement of `ai2thor.controller.Controller`.

    Parameters
    ----------
    *args, **parameters
        As of AI2-THOR's Controller: scene, width, height, quality, gridSize, renderDepthImage, agentMode and so on. What
        chooses a Unity build, a display or a graphics card is accepted and has no effect.

    Examples
    --------
    >>> controller = Controller(scene="FloorPlan401", width=64, height=64)
    >>> event = controller.step("RotateRight")
    >>> event.frame.shape, event.metadata["lastActionSuccess"]
    ((64, 64, 3), True)
    >>> controller.stop()

    Notes
    -----
    docs/AI2THOR.md says, action by action, what is supported, approximated or missing.
    """

    server: Server | None
    width: int
    height: int
    quality: str

    def __init__(self, *args: Any, **parameters: Any) -> None:
        super().__init__(*args, **{**parameters, "start_unity": False})
        # Clients look here for the version that they have asked for.
        self._build.commit_id = parameters.get("commit_id") or COMMIT_ID
        self._build.url = f"no build of Unity, in the place of {self._build.commit_id}"

    def start(
        self,
        port: int = 0,
        start_unity: bool = True,
        width: int = 300,
        height: int = 300,
        *args: Any,
        player_screen_width: float | None = None,
        player_screen_height: float | None = None,
        **where: Any,
    ) -> None:
        """Start; once that is done, as it is after construction, only set the size of the pictures, as old clients do.

        `player_screen_width` and `player_screen_height` are old names of `width` and `height`.
        """
        width, height = int(player_screen_width or width), int(player_screen_height or height)
        if self.server is None:
            super().start(port, False, width, height, *args, **where)
        elif (width, height) != (self.width, self.height):
            self.width, self.height = width, height
            self.step(action="ChangeResolution", x=width, y=height)

    def reset(self, scene: str | None = None, **init_params: Any) -> Event:
        """Load a room, or the same room again, and place the agent at its start.

        Parameters
        ----------
        scene : str, optional
            Such as "FloorPlan1"; by default the last one.
        **init_params
            New initialization parameters, also width and height; the others stay as they are.

        Raises
        ------
        ValueError
            If there is no such scene, or a parameter is not supported.
        """
        assert self.server is not None
        if scene is not None and not isinstance(scene, str):
            message = (
                "a scene is the name of a floor plan here, such as FloorPlan1: houses of ProcTHOR are not supported"
            )
            raise MisuseError("InvalidArgument", message)
        before = self.width, self.height
        wanted = init_params.get("width", self.width), init_params.get("height", self.height)
        try:
            width, height = (int(size) for size in wanted)
            self.server.session.resize(width, height)
        except (ActionError, TypeError, ValueError):
            message = (
                f"a picture of {wanted[0]!r:.40} x {wanted[1]!r:.40} pixels: give whole numbers from 1 to {MOST_PIXELS}"
            )
            raise MisuseError("InvalidArgument", message) from None
        self.width, self.height = width, height
        try:
            return super().reset(scene, **{**init_params, "width": width, "height": height})
        except ValueError:
            self.width, self.height = before
            self.server.session.resize(*before)
            raise

    def _build_server(self, host: str, port: int, width: int, height: int) -> None:
        if self.server is None:
            self.server = Server(
                Session(width, height, self.quality),
                width=width,
                height=height,
                timeout=self.server_timeout,
                depth_format=self.depth_format,
                add_depth_noise=self.add_depth_noise,
            )
