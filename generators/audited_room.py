"""A configuration of a room at rest, and what is found out about it once for all its samples."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from remqa_data.generators.arrangement.hiding_place import HidingPlace, PlaceKey
from remqa_data.generators.arrangement.interior_view import depth_looks, looks_about
from remqa_data.generators.provable import seen_share
from remqa_data.generators.questions.expressions import Expressions
from remqa_data.generators.revealed import Looks, Views
from remqa_data.generators.seen_anywhere import most_pixels_anywhere
from remqa_data.generators.walks.scene_walk import ConfigurationInfo
from remqa_data.geometry.types import F64
from remqa_data.scene import Scene
from remqa_data.scene_graph.graph import SceneGraph
from remqa_data.sim.agent.actions import Action
from remqa_data.sim.agent.replay import Replay
from remqa_data.sim.metadata import object_metadata
from remqa_data.sim.navigation.grid import ReachableGrid
from remqa_data.sim.navigation.viewpoints import AgentPose
from remqa_data.sim.physics.world import Snapshot
from remqa_data.tables.images import RgbFormat
from remqa_data.tables.rows import QuestionRow

MOST_SHOWN_PX = 2
"""Of evidence in the middle of a view from anywhere; one more is seen by whoever looks a little aside of there."""


@dataclass(eq=False)
class AuditedRoom:
    """A configuration at rest, with all that its samples share.

    Attributes
    ----------
    info : ConfigurationInfo
        Names and split of its rows.
    scene : Scene
        The configuration, settled.
    replay : Replay
        A freshly loaded world of it; brought back to its first state after each sample.
    """

    info: ConfigurationInfo
    scene: Scene
    rgb_format: RgbFormat = "jpeg"

    def __post_init__(self) -> None:
        self.replay = Replay(self.scene, AgentPose((0, 0), 0))
        self._first: Snapshot = self.replay.world.save()
        self.graph = SceneGraph.from_objects(object_metadata(self.replay.world).values())
        self.loose_graph = SceneGraph.from_objects(self.graph.objects.values(), self.graph.rules.loosened())
        self.expressions = Expressions(self.graph)
        self._views: dict[tuple[AgentPose, Action], Views] = {}
        self._types_in_view: dict[AgentPose, frozenset[str]] = {}
        self._looks: dict[tuple[PlaceKey, AgentPose, Action], Looks] = {}
        self._repeated: dict[tuple[AgentPose, Action], bool] = {}
        self._hides: dict[tuple[str, ...], bool] = {}

    @property
    def grid(self) -> ReachableGrid:
        """Where the agent can stand in it."""
        return self.replay.grid

    def start_over(self, pose: AgentPose) -> None:
        """Undo all actions and put the agent somewhere."""
        self.replay.world.restore(self._first)
        self.replay.pose = pose

    def views(self, goal: AgentPose, manipulation: Action) -> Views:
        """What a manipulation shows; drawn once, however many questions are about it."""
        key = (goal, manipulation)
        if key not in self._views:
            object_id, world = str(manipulation.target), self.replay.world
            self.start_over(goal)
            before, closed = self.replay.observe(), world.link_poses(object_id)
            self.replay.step(manipulation)
            after, motion = self.replay.observe(), world.motion_since(object_id, closed)
            new = [world.ids[i] for i in np.setdiff1d(after.objects, before.objects).tolist() if i >= 0]
            boxes = tuple(world.box(name) for name in new)
            self._views[key] = Views(before, after, motion, boxes, world.save(), object_metadata(world))
            self.start_over(goal)
        return self._views[key]

    def types_in_view(self, goal: AgentPose) -> frozenset[str]:
        """The types of which something shows from a pose while nothing is manipulated."""
        if goal not in self._types_in_view:
            self.start_over(goal)
            world = self.replay.world
            pixels = self.replay.view.pixels(goal.camera(self.grid))
            shown = frozenset(world.type_of(name) for name, n in zip(world.ids, pixels, strict=False) if n)
            self._types_in_view[goal] = shown
        return self._types_in_view[goal]

    def looks(self, hiding: HidingPlace, goal: AgentPose, manipulation: Action, motion: F64 | None) -> Looks:
        """What who looks about after a manipulation sees of what a place hides, drawn once; `motion` is that of its links."""
        key = (hiding.key, goal, manipulation)
        if key not in self._looks:
            about = [pose.camera(self.grid) for pose in looks_about(goal)]
            with self._after(goal, manipulation) as replay:
                self._looks[key] = tuple(depth_looks(replay.view, about, hiding.interior, motion))
        return self._looks[key]

    def share_by_chance(self, goal: AgentPose, manipulation: Action, sample: QuestionRow) -> float:
        """Share of the ways in which a thing could lie there that one would see, counted as `verify` does."""
        with self._after(goal, manipulation) as replay:
            return seen_share(replay, sample)

    @contextmanager
    def _after(self, goal: AgentPose, manipulation: Action) -> Iterator[Replay]:
        """The room as a manipulation leaves it, for the length of a block."""
        state = self.views(goal, manipulation).state
        self.start_over(goal)
        self.replay.world.restore(state)
        try:
            yield self.replay
        finally:
            self.start_over(goal)

    def repeats(self, goal: AgentPose, manipulation: Action) -> bool:
        """Whether a manipulation, done once more, ends in the state of the room that its views show."""
        key, known = (goal, manipulation), self.views(goal, manipulation)
        if key not in self._repeated:
            self.start_over(goal)
            is_done = self.replay.attempt(manipulation).success
            self._repeated[key] = is_done and (self.replay.pose, self.replay.world.save()) == (goal, known.state)
            self.start_over(goal)
        return self._repeated[key]

    def hides(self, hiding: HidingPlace, object_ids: Sequence[str]) -> bool:
        """Whether some objects in or under a place, and all else that lies in it, are seen from nowhere before it is opened."""
        together = set(object_ids)
        if hiding.relation == "in":
            records = self.graph.objects.items()
            together |= {name for name, r in records if (r.support, r.support_kind) == (hiding.object_id, "in")}
        key = tuple(sorted(together))
        if key not in self._hides:
            self.start_over(self.replay.pose)
            shown = most_pixels_anywhere(self.replay.view, self.grid, key, [hiding.object_id], MOST_SHOWN_PX)
            self._hides[key] = shown <= MOST_SHOWN_PX
        return self._hides[key]

    def forget_views(self) -> None:
        """Give the memory of all pictures back; what is asked for again is drawn again."""
        self._views.clear()
        self._looks.clear()

    def close(self) -> None:
        """Give the simulator's memory back."""
        self.replay.close()
