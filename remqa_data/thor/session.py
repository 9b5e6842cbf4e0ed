"""Executes AI2-THOR's actions, one after the other, and answers each with a state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any
from weakref import WeakSet

from remqa_data.errors import MisuseError, RemqaError
from remqa_data.sim.agent.results import ActionResult
from remqa_data.thor.actions import arm as actions_arm
from remqa_data.thor.actions import conditions as actions_conditions
from remqa_data.thor.actions import expert as actions_expert
from remqa_data.thor.actions import hand as actions_hand
from remqa_data.thor.actions import legacy as actions_legacy
from remqa_data.thor.actions import looks as actions_looks
from remqa_data.thor.actions import navigation as actions_navigation
from remqa_data.thor.actions import objects as actions_objects
from remqa_data.thor.actions import placing as actions_placing
from remqa_data.thor.actions import rays as actions_rays
from remqa_data.thor.actions import scene as actions_scene
from remqa_data.thor.actions import search as actions_search
from remqa_data.thor.actions import spawning as actions_spawning
from remqa_data.thor.actions import states as actions_states
from remqa_data.thor.state.dispatch import call, checked
from remqa_data.thor.state.events import Listing, Outcome, Reply, reply
from remqa_data.thor.state.settings import QUALITIES, FrameSize, Images
from remqa_data.thor.state.simulator import SimulatorState
from remqa_data.thor.state.wording import error_code, in_thors_words

ACTIONS = checked(
    actions_scene.ACTIONS
    | actions_navigation.ACTIONS
    | actions_search.ACTIONS
    | actions_rays.ACTIONS
    | actions_objects.ACTIONS
    | actions_hand.ACTIONS
    | actions_placing.ACTIONS
    | actions_spawning.ACTIONS
    | actions_states.ACTIONS
    | actions_conditions.ACTIONS
    | actions_looks.ACTIONS
    | actions_expert.ACTIONS
    | actions_legacy.ACTIONS
)
"""What the agent without an arm can do."""
ARM_ACTIONS = ACTIONS | checked(actions_arm.ACTIONS | actions_legacy.ARM_ACTIONS)
"""What the agent with an arm can do; it picks up and lets go in its own way."""
LEAVES_ROOM_AS_IT_IS = frozenset(actions_navigation.ACTIONS) | {"Done", "Pass"}
"""Who does one of these moves only the agent, so the objects of earlier events can still be worked out after it."""


class Session:
    """One simulation.

    Parameters
    ----------
    width, height : int
        Of every picture, pixels.
    quality : str
        What pictures are drawn with, a key of QUALITIES.
    """

    def __init__(self, width: int, height: int, quality: str) -> None:
        self._simulator = SimulatorState(FrameSize(width, height), QUALITIES[quality])
        self._outcomes: dict[int, Outcome] = {}
        self._unread: WeakSet[Listing] = WeakSet()

    def execute(self, request: Mapping[str, Any]) -> Reply:
        """Execute an action: "action" and its arguments. What cannot be done is said in the reply's metadata."""
        with self._simulator.lock:
            return self._execute(request)

    def _execute(self, request: Mapping[str, Any]) -> Reply:
        if request.get("action") in ("Reset", "Initialize"):
            self._outcomes.clear()
        if request.get("action") not in LEAVES_ROOM_AS_IT_IS:
            self._read_all()
        actions = ARM_ACTIONS if self._simulator.settings.has_arm else ACTIONS
        code = None
        try:
            self._let_act(request.get("agentId"))
            _refuse_pictures(request)
            result = call(actions, self._simulator, request)
        except MisuseError as error:
            result, code = ActionResult(False, str(error)), error.code
        except RemqaError as error:
            result = ActionResult(False, str(error))
        result = replace(result, error=in_thors_words(result.error))
        code = code or error_code(result.error)
        number = self._simulator.room.active if self._simulator.has_room else 0
        self._outcomes[number] = Outcome(str(request.get("action")), result, code)
        replied = reply(self._simulator, self._outcomes, self._images(request))
        self._unread.update(replied.objects)
        return replied

    def resize(self, width: int, height: int) -> None:
        """Change the size of all pictures."""
        self._simulator.resize(FrameSize(width, height))

    def first_reply(self) -> Reply:
        """What AI2-THOR sends when it has started."""
        return reply(self._simulator, {0: Outcome("", ActionResult(True))}, Images())

    def close(self) -> None:
        """Give the simulator's memory back."""
        self._read_all()
        self._simulator.close()

    def _read_all(self) -> None:
        """Work out, as the room is about to change, the objects of those events that somebody has kept."""
        for listing in list(self._unread):
            listing.read()
        self._unread.clear()

    def _let_act(self, agent: object) -> None:
        """Choose who acts: the agent of a number, which Unity reads from text too; the first if there is none."""
        count = len(self._simulator.room.agents) if self._simulator.has_room else 1
        number = str(int(agent) if isinstance(agent, float) and agent.is_integer() else agent or 0)
        if number not in map(str, range(count)):
            there = "is one, number 0" if count == 1 else f"are {count}, from number 0"
            raise MisuseError("InvalidArgument", f"agentId {agent!r} is not an agent here: there {there}")
        if self._simulator.has_room:
            self._simulator.room.active = int(number)

    def _images(self, request: Mapping[str, Any]) -> Images:
        """The pictures that Initialize has asked for, and those that this action asks for; none without `renderImage`."""
        always = self._simulator.settings.images
        if not request.get("renderImage", True):
            return Images(color=False)
        return Images(
            depth=always.depth or bool(request.get("renderDepthImage")),
            instances=always.instances or bool(request.get("renderInstanceSegmentation")),
            types=always.types or bool(request.get("renderSemanticSegmentation")),
        )


def _refuse_pictures(request: Mapping[str, Any]) -> None:
    """Pictures that AI2-THOR has and we have not, asked for by Initialize or by any other action, are an error."""
    for name in ("renderNormalsImage", "renderFlowImage"):
        if request.get(name):
            raise MisuseError("InvalidArgument", f"{name} is not supported here")
