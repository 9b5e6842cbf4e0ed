"""AI2-THOR's server without a second process: an action is executed where it is sent."""

from __future__ import annotations

import json
from typing import Any

from ai2thor.server import Event, NumpyAwareEncoder
from ai2thor.server import Server as ThorServer

from remqa_data.errors import MisuseError
from remqa_data.thor.event_metadata import EventMetadata
from remqa_data.thor.session import Session


class Server(ThorServer):  # type: ignore[misc]  # AI2-THOR has no types
    """Passes actions to a session, and what the session answers to AI2-THOR's own code that makes events.

    Parameters
    ----------
    session : Session
        Executes the actions.
    **settings
        Of AI2-THOR's server: width, height, timeout, depth_format, add_depth_noise.
    """

    server_type = "REMQA"
    sequence_id: int

    def __init__(self, session: Session, **settings: Any) -> None:
        super().__init__(**settings)
        self.session = session
        self._reply = session.first_reply()
        self._is_stopped = False

    def start(self) -> None:
        """Nothing needs starting."""
        self.started = True

    def stop(self) -> None:
        """Give the simulator's memory back."""
        self.started, self._is_stopped = False, True
        self.session.close()

    def send(self, action: dict[str, Any]) -> None:
        """Execute an action. It goes through JSON as in AI2-THOR, so arrays and tuples mean the same here.

        Raises
        ------
        MisuseError
            After `stop`.
        """
        if self._is_stopped:
            raise MisuseError("InvalidAction", "this controller has been stopped: make another")
        self.sequence_id = action.setdefault("sequenceId", self.sequence_id + 1)
        self._reply = self.session.execute(json.loads(json.dumps(action, cls=NumpyAwareEncoder)))

    def receive(self, timeout: float | None = None) -> Event:
        """The event of the action that was sent last."""
        reply = self._reply
        metadata = {"sequenceId": self.sequence_id, "activeAgentId": reply.active, "agents": reply.metadata}
        event = self.create_event(metadata, reply.files)
        for one, rest, listing in zip(event.events, reply.metadata, reply.objects, strict=True):
            one.metadata = EventMetadata(rest, listing)
        event.metadata = event.events[reply.active].metadata
        return event
