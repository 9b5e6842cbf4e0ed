"""A floor plan that clients act in: the room, the agents in it, and how both are shown."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from remqa_data.catalog import types_with
from remqa_data.errors import MisuseError
from remqa_data.floorplans.ithor.uncovered import uncovered
from remqa_data.floorplans.load import load_scene
from remqa_data.geometry.boxes import corners
from remqa_data.geometry.types import F64, Flags, Vec2, Vec3
from remqa_data.scene import SceneObject
from remqa_data.sim.agent import handling
from remqa_data.sim.agent.pictures import Pictures
from remqa_data.sim.agent.results import ActionResult
from remqa_data.sim.agent.third_person import ARM, body_of
from remqa_data.sim.arm.body import robot_surfaces
from remqa_data.sim.arm.postures import COLUMN_TOP_M
from remqa_data.sim.navigation.grid import ReachableGrid, reachable_grid
from remqa_data.sim.navigation.viewpoints import HEADINGS_DEG, MIN_PIXELS, AgentPose
from remqa_data.sim.physics.world import AWAY_Z_M, World
from remqa_data.sim.render.camera import AnyCamera, Camera, OrthographicCamera, are_outside
from remqa_data.sim.render.view import Figure, Observation, WorldView
from remqa_data.thor.object_states.appearance import shapes_of
from remqa_data.thor.object_states.conditions import Conditions
from remqa_data.thor.state.agent import ThorAgent
from remqa_data.thor.state.arm_agent import ArmAgent
from remqa_data.thor.state.cameras import ThirdPartyCamera
from remqa_data.thor.state.frames import to_thor
from remqa_data.thor.state.images import Palette
from remqa_data.thor.state.looks import Look, Looks
from remqa_data.thor.state.objects import ObjectRecords
from remqa_data.thor.state.settings import FrameSize, Quality, Settings

AGENT_MIDDLE_M = 0.900999
"""AI2-THOR describes its agent by its middle, which is so high above the floor."""
APART_M = 0.5
"""Agents begin at least so far from each other."""
BELOW_CEILING_M = 0.05
"""Where the map camera is."""
HOVERS_M = {"FloorPlan12": 0.079}
"""In this room it was recorded above the floor on which everything else stands."""
OFF_GRID_M = 1e-4
"""Who stands no farther beside the grid stands on it."""
SNAPS_AWAY = 4
"""Else it is put onto the grid, at most so many steps away."""
PICTURE_BYTES = 128 << 20
"""Pictures that are remembered take no more: some 75 of 300 x 300."""


class LoadedFloorPlan:
    """A loaded floor plan, at rest, with an agent at its start.

    Parameters
    ----------
    scene : str
        Such as "FloorPlan1".
    settings : Settings
        Of the agent.
    frame : FrameSize
        Of the agent's pictures.

    Attributes
    ----------
    world, view, pictures, records, palette, looks
        The simulated room, its renderer and what that has drawn, the objects' metadata, their colours in masks, and how the
        room is shown.
    agents : list of ThorAgent
        The agents in it, by their numbers.
    active : int
        Number of the one that acts.
    at_rest : Snapshot
        The world as it was loaded.
    depths : mapping
        How deep things were then in what they did not only touch: recorded chairs are in tables. See `handling.depths`.
    shows_map : bool
        Whether the agent's pictures are those of the map camera.
    """

    def __init__(self, scene: str, settings: Settings, frame: FrameSize) -> None:
        self.scene = scene
        self._as_built = uncovered(load_scene(scene))
        world = World(self._as_built)
        world.settle()
        self.at_rest = world.save()
        depths = handling.depths(world, world.ids)
        self.depths = {where: depths[where] for where in handling.deeper(depths, {})}
        self._live_in(world)
        self._start = _start_pose(self.view, reachable_grid(self.world))
        self.restart(settings, frame)

    def _live_in(self, world: World) -> None:
        """Let this be the room from now on, and be seen."""
        self.world = world
        self.view = WorldView(world)
        self._hides_room = _parts_that_hide_it(self.view)
        self.looks = Looks(self.view)
        self._conditions_shown: tuple[object, int | None] | None = None
        self.palette = Palette(world.ids, [world.type_of(object_id) for object_id in world.ids], world.scene)
        self.records = ObjectRecords(world)
        self.pictures, self._pictured = Pictures(self.view, PICTURE_BYTES), self.view.version

    def restart(self, settings: Settings, frame: FrameSize) -> None:
        """Put everything back to where it was when the room was loaded."""
        if len(self.world.ids) > len(self._as_built.objects):
            self.world.close()
            self._live_in(World(self._as_built))
        self.world.restart(self.at_rest)
        self.records = ObjectRecords(self.world)
        self.shows_map = False
        self.looks.change(Look())
        self.agents: list[ThorAgent] = []
        self.active = 0
        self._add_agents(settings, frame)

    def _add_agents(self, settings: Settings, frame: FrameSize) -> None:
        """Let there be as many agents as are asked for: the first at the start, each other one as near as there is room."""
        del self.agents[settings.agent_count :]
        position, yaw_deg = self._start
        for number in range(len(self.agents), settings.agent_count):
            place = position if not self.agents else self._free_place(settings)
            self.agents.append(self._agent(settings, frame, number, place, yaw_deg))

    def _agent(
        self, settings: Settings, frame: FrameSize, number: int, position: Vec2, yaw_deg: float, **pose: Any
    ) -> ThorAgent:
        kind = ArmAgent if settings.has_arm else ThorAgent
        return kind(
            self.world,
            self.view,
            position,
            yaw_deg,
            settings=settings,
            frame=frame,
            number=number,
            others=self.agents,
            **pose,
        )

    def _free_place(self, settings: Settings) -> Vec2:
        """Of the reachable cells that no agent is near, the one nearest to the first agent."""
        grid = reachable_grid(self.world)
        places = [grid.position(cell) for cell in grid.cells]
        free = [p for p in places if min(math.dist(p, (a.x, a.y)) for a in self.agents) >= APART_M]
        if not free:
            raise MisuseError("InvalidArgument", f"there is no room for {settings.agent_count} agents here")
        return min(free, key=lambda place: (math.dist(place, (self.agents[0].x, self.agents[0].y)), place))

    @property
    def agent(self) -> ThorAgent:
        """The agent that acts."""
        return self.agents[self.active]

    def let_go(self, agents: Iterable[ThorAgent]) -> ActionResult | None:
        """Let some agents drop what they hold; why one cannot, or None."""
        holders = [agent for agent in agents if agent.held is not None]
        return next((dropped for agent in holders if not (dropped := agent.drop()).success), None)

    @property
    def conditions(self) -> Conditions:
        """What the objects are in besides where they are."""
        return self.records.conditions

    def take_away(self, object_id: str) -> None:
        """Take an object out of the scene, with what it is made of and what is held with it."""
        for name in (object_id, *self.world.built_into(object_id), *self.world.load_of(object_id)):
            self.world.put_away(name)

    def add(self, objects: Sequence[SceneObject], settings: Settings) -> None:
        """Let there be more objects; the room is loaded anew with them, and all else is as it was."""
        before, records, look = self.world, self.records, self.looks.look
        saved = before.save()
        self._live_in(World(before.scene.with_objects((*before.scene.objects, *objects))))
        self.world.restore(replace(saved, states={**self.world.save().states, **saved.states}))
        before.close()
        self.records.take_over(records)
        self.looks.change(look)
        self.embody(settings)

    def copy(self, copies: Mapping[str, str], suffix: str, settings: Settings) -> None:
        """Let there be copies of objects, out of the scene; one that was made before, and is out of it, is taken again.

        Parameters
        ----------
        copies : mapping of str to str
            Whose copy each one is, by its id: that of the original, "_copy_" and a number.
        suffix : str
            What the original's `name` is followed by, before that number.
        settings : Settings
            Of the agents.
        """
        world, records = self.world, self.records
        new = {name: original for name, original in copies.items() if name not in world.ids}
        states = {name: world.state_when_there(original) for name, original in new.items()}
        for name, original in new.items():
            records.copy_of(original, name, records.name_of(original) + suffix + name.rpartition("_")[2])
        if new:
            at = (0.0, 0.0, AWAY_Z_M)
            self.add(
                [SceneObject(n, world.assets[o].spec, at, openness=states[n].openness) for n, o in new.items()],
                settings,
            )
        for name, state in states.items():
            self.world.put_away(name, state)

    def show_conditions(self) -> None:
        """Let pictures show what objects are in: stains, liquids, what glows, ..."""
        self.records.update()
        seen = self.conditions.shown()
        is_wet = any(
            seen[name].get("isToggled") for name in seen if self.world.type_of(name) in types_with("runs_water")
        )
        key = (seen, self.world.revision if is_wet else None)  # water falls onto what is below
        if key != self._conditions_shown:
            self._conditions_shown = key
            self.looks.reshape(shapes_of(self.world, self.conditions))

    def embody(self, settings: Settings) -> None:
        """Give the agents other settings, where they are; and let there be more or fewer of them."""
        frame = self.agent.frame
        for number, old in enumerate(self.agents):
            pose = {"horizon_deg": old.horizon_deg, "is_standing": old.is_standing}
            new = self._agent(settings, frame, number, (old.x, old.y), old.yaw_deg, **pose)
            if type(new) is type(old):
                new.take_over(old)
            self.agents[number] = new
        self._add_agents(settings, frame)
        self.active = min(self.active, len(self.agents) - 1)

    def snap_to_grid(self) -> None:
        """Let each agent stand at a multiple of its steps, the nearest one to which it could walk straight."""
        for agent in self.agents:
            here, step = (agent.x, agent.y), agent.embodiment.step_m
            nearest = [round(value / step) for value in here]
            if math.dist(here, (nearest[0] * step, nearest[1] * step)) <= OFF_GRID_M:
                continue
            around = range(-SNAPS_AWAY, SNAPS_AWAY + 1)
            places = [((nearest[0] + i) * step, (nearest[1] + j) * step) for i in around for j in around]
            for x, y in sorted(places, key=lambda place: (math.dist(place, here), place)):
                if agent.can_walk(here, (x, y)) and agent.teleport(x, y).success:
                    break

    def agent_position(self) -> Vec3:
        """Where AI2-THOR says the agent is, metres in the room."""
        return self.agent.x, self.agent.y, self.agent_y

    @property
    def agent_y(self) -> float:
        """How high AI2-THOR says the agent is, metres."""
        scene = self.world.scene
        return scene.floor_z + AGENT_MIDDLE_M + HOVERS_M.get(scene.name, 0.0)

    def map_camera(self) -> ThirdPartyCamera:
        """A camera under the ceiling that sees the whole floor plan."""
        low, high = self.box()
        eye = to_thor((*(low + high)[:2] / 2, high[2] - BELOW_CEILING_M))
        return ThirdPartyCamera(eye, {"x": 90.0, "y": 0.0, "z": 0.0}, 90.0, float((high - low)[:2].max()) / 2)

    def frame_camera(self) -> Camera | OrthographicCamera:
        """The camera that takes the agent's pictures: its eye, or that of the map."""
        return self.map_camera().camera(self.agent.frame) if self.shows_map else self.agent.camera()

    def shown_to(self, camera: AnyCamera) -> Flags | None:
        """(parts,) what a camera is shown; None for all.

        From above one sees into the room: there is no ceiling then, and nothing around the house.
        """
        shown = self.looks.only
        if camera.view().eye[2] < self.world.scene.floor_z + self.world.scene.height:
            return shown
        return ~self._hides_room if shown is None else shown & ~self._hides_room

    def picture(
        self, camera: AnyCamera, only: Flags | None, quality: Quality, whose: ThorAgent | None = None
    ) -> Observation:
        """What `WorldView.render` gives; not to be written to, as it is remembered while nothing in the room changes.

        With the bodies of agents and what they hold, where the camera is not in the body; of the one whose eye it is, with
        its arm and what it holds.
        """
        if self.view.version != self._pictured:
            self._pictured = self.view.version
            self.pictures.forget()
        return self.pictures.of(
            camera,
            only,
            shadows=quality.shadows,
            antialias=quality.smooth_edges,
            figures=self._figures(camera, whose),
        )

    @property
    def shows_own_hand(self) -> bool:
        """Whether the pictures of the agent that acts show its arm, or what it holds."""
        has_arm = self.agent.hands == "arm" and len(self.view.bodies) > 0
        return not self.shows_map and (has_arm or self.agent.held is not None)

    def have_bodies(self, count: int) -> None:
        """Let the first of the agents be in pictures that others take of them from now on, and no more of them."""
        if len(self.view.bodies) != count:
            self.looks.reshape(bodies=[robot_surfaces()] * count)
            self._hides_room = _parts_that_hide_it(self.view)

    def _figures(self, camera: AnyCamera, whose: ThorAgent | None) -> dict[int, Figure]:
        """Who is in a picture, by their numbers."""
        figures = {}
        for agent in self.agents:
            is_own, has_bodies = agent is whose, len(self.view.bodies) > 0
            is_in = self.shows_own_hand if is_own else has_bodies and _can_see(camera, agent)
            if is_in:
                has_body = has_bodies and (agent.hands == "arm" or not is_own)
                figures[agent.number] = Figure(
                    poses=body_of(agent) if has_body else None,
                    parts=ARM if is_own else slice(None),
                    held={o: state.link_poses(self.world.assets[o]) for o, state in agent.states_of_held().items()},
                )
        return figures

    def box(self) -> F64:
        """(2, 3) corners of the room inside its walls, metres."""
        scene = self.world.scene
        x0, y0, x1, y1 = scene.bounds
        return np.array([(x0, y0, scene.floor_z), (x1, y1, scene.floor_z + scene.height)])


def _parts_that_hide_it(view: WorldView) -> Flags:
    """(parts,) what is between a room and a camera above it."""
    return view.parts_of_building("ceiling") | view.parts_of_building("outside")


def _can_see(camera: AnyCamera, agent: ThorAgent) -> bool:
    """Whether an agent may be in a camera's picture: it is not out of its sight, and the camera is not in its body."""
    view, radius, floor_z = camera.view(), agent.embodiment.radius_m, agent.world.scene.floor_z
    if math.dist(view.eye[:2], (agent.x, agent.y)) < radius and view.eye[2] < floor_z + COLUMN_TOP_M:
        return False
    box = np.array(
        [(agent.x - radius, agent.y - radius, floor_z), (agent.x + radius, agent.y + radius, floor_z + COLUMN_TOP_M)]
    )
    reaches_out = agent.held is not None or agent.hands == "arm"
    return reaches_out or not bool(are_outside(view, corners(box)))


def _start_pose(view: WorldView, grid: ReachableGrid) -> tuple[Vec2, float]:
    """The middle of the floor that can be reached, and the heading from which most objects are seen there."""
    positions = grid.positions()
    nearest = int(np.linalg.norm(positions - positions.mean(axis=0), axis=1).argmin())
    cell = grid.cells[nearest]

    def seen(heading: int) -> int:
        return int((view.pixels(AgentPose(cell, heading).camera(grid)) >= MIN_PIXELS).sum())

    return grid.position(cell), float(max(HEADINGS_DEG, key=seen))
