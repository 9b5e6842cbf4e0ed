"""Executing a list of actions in a room: what the oracle does, and how it is checked.

An action is a word, or a word and an object id: `MoveAhead`, `OpenObject Fridge|...`, `PickupObject Pillow|...`, or
`MoveObject Stool|... 1.25 -0.5 0.38`, which puts the centre of an object there, in metres.
"""

from __future__ import annotations

from remqa_data.assets.model import Vec3
from remqa_data.errors import ActionError
from remqa_data.scene import Scene
from remqa_data.sim.navigation import ReachableGrid, reachable_grid
from remqa_data.sim.paths import pose_after
from remqa_data.sim.view import Observation, WorldView
from remqa_data.sim.viewpoints import FRAME_PX, AgentPose
from remqa_data.sim.world import World

OPEN, CLOSE, PICK_UP, MOVE, DONE = "OpenObject", "CloseObject", "PickupObject", "MoveObject", "Done"


class Replay:
    """An agent in a freshly loaded room.

    Parameters
    ----------
    scene : Scene
        The room; it is not settled again, because a stored one is at rest.
    start : AgentPose
        Where the agent stands.

    Attributes
    ----------
    pose : AgentPose
        Where it stands now.
    """

    def __init__(self, scene: Scene, start: AgentPose) -> None:
        self.world = World(scene)
        self.view = WorldView(self.world)
        self.grid: ReachableGrid = reachable_grid(self.world)
        self.pose = start

    def step(self, action: str) -> None:
        """Execute one action.

        Raises
        ------
        ActionError
            If the room or the agent's body refuses it, or it cannot be read.
        """
        word, *rest = action.split(" ")
        if word == DONE:
            return
        if word in (OPEN, CLOSE, PICK_UP, MOVE):
            self._manipulate(word, rest, action)
        else:
            self.pose = pose_after(self.grid, self.pose, action)

    def observe(self, size_px: int = FRAME_PX) -> Observation:
        """What the agent sees now."""
        return self.view.render(self.pose.camera(self.grid, size_px))

    def close(self) -> None:
        """Give the simulator's memory back."""
        self.world.close()

    def _manipulate(self, word: str, rest: list[str], action: str) -> None:
        if len(rest) != (4 if word == MOVE else 1):
            raise ActionError(f"{action!r}: {word} takes an object id{' and three numbers' if word == MOVE else ''}")
        object_id = rest[0]
        if word in (OPEN, CLOSE):
            self.world.open(object_id, float(word == OPEN))
        elif word == PICK_UP:
            self.world.pick_up(object_id)
            self.view.hide(object_id)
        else:
            try:
                x, y, z = (float(number) for number in rest[1:])
            except ValueError:
                raise ActionError(f"{action!r}: {word} takes an object id and three numbers") from None
            self.world.move_alone(object_id, (x, y, z))


def open_action(object_id: str) -> str:
    """The action that opens an object."""
    return f"{OPEN} {object_id}"


def pick_up_action(object_id: str) -> str:
    """The action that picks an object up."""
    return f"{PICK_UP} {object_id}"


def move_action(object_id: str, position: Vec3) -> str:
    """The action that puts the centre of an object somewhere, metres.

    >>> move_action("Stool|1", (1.25, -0.5, 0.38))
    'MoveObject Stool|1 1.25 -0.5 0.38'
    """
    return " ".join([MOVE, object_id, *map(repr, position)])
