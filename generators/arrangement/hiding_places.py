"""Where evidence can be hidden in a room: what can be opened, and what things can lie under that is taken away.

Places are found once for each room, on the room as recorded without the loose things that lie about: those are moved
for each configuration. A place comes with the poses at which the agent acts, chosen so that what is hidden there is
out of sight before the manipulation and in sight after it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import islice
from typing import Literal

import numpy as np

from remqa_data.catalog import Manipulation, object_type, question_types, types_with
from remqa_data.generators.arrangement.areas import Area
from remqa_data.generators.arrangement.hiding_goals import (
    Front,
    GoalPose,
    at_height,
    best_goals,
    out_of_sight,
    poses_that_reach,
)
from remqa_data.generators.arrangement.hiding_place import HidingPlace
from remqa_data.generators.arrangement.hiding_rules import HidingRules, hiding_rules
from remqa_data.generators.arrangement.interior_view import LEAST_SHARE, depth_looks, looks_about, share_in_view
from remqa_data.generators.arrangement.plausible import plausible_types
from remqa_data.generators.arrangement.push_targets import push_targets
from remqa_data.generators.arrangement.sightlines import Sightlines
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F32, Vec3
from remqa_data.scene import Scene
from remqa_data.sim.navigation.grid import Outline, object_outlines, reachable_grid
from remqa_data.sim.navigation.viewpoints import FRAME_PX, MIN_PIXELS, AgentPose, front_points, surface_points
from remqa_data.sim.physics.support import Support, directly_held, supports
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.view import WorldView

SOLID_M = 0.02
"""The bottom of a space is this near to what physics lets things rest on."""
THIN_M = 0.005
"""The thinnest things that lie under others, such as a credit card."""
HOLLOW_GAP_M = 0.006
"""Things leave so much free of the width, the depth and the height of the hollow below what covers them."""
LEANS_DEG = 8.0
"""What is tilted by more than this stands on nothing that could be an area."""
EMPTY_SHARE = 0.05
"""So much more of an empty place is seen than is asked for, as other things will lie in it."""
SWEPT = tuple(k / 10 for k in range(1, 11))
"""At these opennesses what opens stays clear of the agent."""


def hiding_places(scene: Scene) -> list[HidingPlace]:
    """The hiding places of a room, in the order of its objects; the same for equal scenes.

    An object can be two places: a box can be opened, and it can be picked up.
    """
    rules = hiding_rules()
    with World(scene) as world:
        world.settle()
        grid = reachable_grid(world)
        held_by = supports(world)
        for object_id in world.ids:
            if object_type(world.type_of(object_id)).is_container:
                world.open(object_id, 0.0)
        view = WorldView(world)
        _hide_loose_things(view)
        finder = _Finder(world, Sightlines(view, grid, rules.scout_px), rules, held_by)
        found = []
        for object_id in world.ids:
            for look in (finder.behind_door, finder.under_liftable, finder.under_moveable):
                place = look(object_id)
                if place is not None:
                    found.append(place)
    return found


def _hide_loose_things(view: WorldView) -> None:
    """Leave out of the pictures what can lie elsewhere in a configuration."""
    for object_id in view.world.ids:
        if not view.world.state(object_id).is_fixed:
            view.hide(object_id)


class _Finder:
    """Looks at one object after the other; the world is at rest between two of them."""

    def __init__(self, world: World, sight: Sightlines, rules: HidingRules, held_by: dict[str, Support]) -> None:
        self.world, self.sight, self.rules, self.held_by = world, sight, rules, held_by
        self.boxes = {object_id: world.box(object_id) for object_id in world.ids}
        self.questioned = frozenset(question_types())

    # ---- things that open

    def behind_door(self, object_id: str) -> HidingPlace | None:
        world, rules = self.world, self.rules
        type_ = world.type_of(object_id)
        if not object_type(type_).is_container or not world.assets[object_id].is_openable:
            return None
        areas = _inner_areas(world, object_id, rules)
        if not areas:
            return None
        with _shown(self.sight.view, object_id):
            closed, front = world.link_poses(object_id), front_points(self.sight.view, object_id)
            swept: list[Outline] = []
            for openness in SWEPT:
                world.open(object_id, openness)
                swept += object_outlines(world, object_id, first_link=1)
            motion = world.motion_since(object_id, closed)
            poses = poses_that_reach(self.sight, front, areas, rules.max_poses, swept, self._front(object_id))
            opened = np.concatenate([arithmetic.moved(area.corners, motion[area.link]) for area in areas])
            after = {pose: self.sight.depth(pose, opened) for pose in poses}
            world.open(object_id, 0.0)
            is_kept = world.state(object_id).is_fixed  # what is loose is not in the pictures that are kept
            before = {pose: self.sight.depth_at_rest(pose) if is_kept else self.sight.depth(pose) for pose in poses}
        goals = best_goals(self.sight, rules, areas, before, after, motion)
        return self._place(object_id, "Open", "in", areas, goals)

    # ---- things that are taken away

    def under_liftable(self, object_id: str) -> HidingPlace | None:
        type_ = self.world.type_of(object_id)
        if type_ not in types_with("pickup_cover") or not object_type(type_).pickupable or type_ not in self.questioned:
            return None
        area = self._area_beneath(object_id, self.rules.min_pickup_side_m, math.inf)
        if area is None or directly_held(self.held_by, object_id) or self._holds_what_is_beneath(object_id, area):
            return None
        return next(iter(self._taken_away(object_id, area, "Pickup", [None])), None)

    def under_moveable(self, object_id: str) -> HidingPlace | None:
        type_ = self.world.type_of(object_id)
        if type_ not in types_with("move_cover") or not object_type(type_).moveable or type_ not in self.questioned:
            return None
        area = self._area_beneath(object_id, self.rules.min_move_side_m, self.rules.max_move_side_m)
        if area is None or self._holds_what_is_beneath(object_id, area):
            return None
        shifts = push_targets(self.world, object_id, self.rules.shift_gaps_m)
        best: HidingPlace | None = None
        for place in self._taken_away(object_id, area, "Move", shifts):
            if best is None or _area_of(place) > 1.1 * _area_of(best):
                best = place
        return best

    def _area_beneath(self, object_id: str, min_side: float, max_side: float) -> Area | None:
        """Where things lie under an upright object that stands on something open with nothing on it.

        That is its hollow, if it has one, else its plan with a margin.
        """
        world, rules = self.world, self.rules
        state, asset = world.state(object_id), world.assets[object_id]
        matrix = state.matrix()
        if math.degrees(arithmetic.arccos(np.clip(matrix[2, 2], -1.0, 1.0))) > LEANS_DEG:
            return None
        support = self.held_by.get(object_id)
        if support is None or support.kind != "on" or self._carries_something(object_id):
            return None
        width, depth, _ = asset.spec.size
        if min(width, depth) < min_side or max(width, depth) > max_side:
            return None
        bottom = float(self.boxes[object_id][0][2])
        yaw = math.degrees(arithmetic.arctan2(matrix[1, 0], matrix[0, 0]))
        if asset.hollow is not None:
            low, high = np.array(asset.hollow[:3]), np.array(asset.hollow[3:])
            x, y, _ = (float(v) for v in arithmetic.moved((low + high) / 2, matrix))
            a, b, room = (float(side) for side in (high - low) - HOLLOW_GAP_M)
            return Area((x, y, bottom), yaw, (a / 2, b / 2), room)
        share = rules.round_share if asset.spec.type in types_with("round_outline") else rules.square_share
        x, y, _ = state.position
        return Area((x, y, bottom), yaw, (share * width / 2, share * depth / 2), rules.max_under_height_m)

    def _carries_something(self, object_id: str) -> bool:
        """Whether anything stands on top of an object."""
        low, high = self.boxes[object_id]
        for other, (other_low, other_high) in self.boxes.items():
            if other == object_id:
                continue
            middle = (other_low + other_high) / 2
            above = np.all(middle[:2] > low[:2]) and np.all(middle[:2] < high[:2])
            if above and -0.03 < other_low[2] - high[2] < 0.1:
                return True
        return False

    def _holds_what_is_beneath(self, object_id: str, area: Area) -> bool:
        """Whether the world's metadata would say that a thin thing beneath an object is in or on it.

        So it is with low vessels, whose inner floor is near the ground; tried with the box of some loose thing.
        """
        world = self.world
        loose = (o for o in world.ids if o != object_id and object_type(world.type_of(o)).pickupable)
        stand_in = next(loose, None)
        if stand_in is None:
            return False
        snapshot = world.save()
        x, y, z = world.state(object_id).position
        world.move_alone(object_id, (x, y, z + THIN_M))
        middle = np.array(area.centre)
        beneath = middle + np.array([[-0.02, -0.02, 0.0], [0.02, 0.02, THIN_M]])
        held_by = supports(world, {**self.boxes, object_id: world.box(object_id), stand_in: beneath})
        world.restore(snapshot)
        return stand_in in held_by and held_by[stand_in].id == object_id

    def _taken_away(
        self, object_id: str, area: Area, manipulation: Manipulation, targets: Sequence[Vec3 | None]
    ) -> list[HidingPlace]:
        """The places under an object, for where it can go; it lies a little higher if it has no hollow for what is under it."""
        world, rules, view = self.world, self.rules, self.sight.view
        snapshot = world.save()
        x, y, z = world.state(object_id).position
        before: dict[AgentPose, F32] = {}
        found: list[tuple[list[GoalPose], Vec3 | None]] = []
        with _shown(view, object_id):
            raised = (x, y, z + (rules.max_under_height_m if world.assets[object_id].hollow is None else 0.0))
            world.move_alone(object_id, raised)
            unseen = out_of_sight(self.sight, rules, area)
            if unseen is None:
                world.restore(snapshot)
                return []
            points = surface_points(world, object_id)
            for move_to in targets:
                outlines: list[Outline] = []
                if move_to is not None:
                    world.move_alone(object_id, move_to)
                    outlines = object_outlines(world, object_id)
                    world.move_alone(object_id, raised)
                front = self._front(object_id)
                poses = poses_that_reach(self.sight, points, [unseen], rules.max_poses, outlines, front)
                before |= {pose: self.sight.depth(pose, unseen.corners) for pose in poses if pose not in before}
                if move_to is None:
                    view.hide(object_id)
                else:
                    world.move_alone(object_id, move_to)
                after = {pose: self.sight.depth(pose, unseen.corners) for pose in poses}
                found.append((best_goals(self.sight, rules, [unseen], before, after, np.eye(4)[None]), move_to))
            world.restore(snapshot)
        places = (self._place(object_id, manipulation, "under", [unseen], goals, to) for goals, to in found)
        return [place for place in places if place is not None]

    # ---- goals

    def _front(self, object_id: str) -> Front | None:
        """Where an object's front looks; None if it has none."""
        if not object_type(self.world.type_of(object_id)).has_front:
            return None
        low, high = self.boxes[object_id]
        x, y = (float(v) for v in (low + high)[:2] / 2)
        matrix = self.world.state(object_id).matrix()
        return Front((x, y), math.degrees(arithmetic.arctan2(-matrix[1, 1], -matrix[0, 1])))

    def _shows(self, object_id: str, pose: AgentPose) -> bool:
        """Whether the object, at rest, is well seen from a pose: it is no sliver."""
        with _shown(self.sight.view, object_id):
            camera = pose.camera(self.sight.grid, FRAME_PX)
            view = self.sight.view
            image = view.instances(camera, scissor=view.scissor_around(camera, [object_id]))
        rows, columns = np.nonzero(image == self.world.ids.index(object_id))
        least = self.rules.min_target_px
        return len(rows) >= MIN_PIXELS and min(int(np.ptp(rows)), int(np.ptp(columns))) + 1 >= least

    def _provable(
        self,
        object_id: str,
        manipulation: Manipulation,
        relation: Literal["in", "under"],
        interior: Sequence[Area],
        goal: AgentPose,
        move_to: Vec3 | None,
    ) -> frozenset[str]:
        """The types kept there of which one would see, looking about from a pose after the manipulation, that there is none."""
        world, view = self.world, self.sight.view
        snapshot, closed = world.save(), world.link_poses(object_id)
        with _shown(view, object_id):
            if manipulation == "Open":
                world.open(object_id, 1.0)
            elif move_to is not None:
                world.move_alone(object_id, move_to)
            else:
                view.hide(object_id)
            moved = world.motion_since(object_id, closed) if manipulation == "Open" else None
            about = [pose.camera(self.sight.grid) for pose in looks_about(goal)]
            looks = depth_looks(view, about, interior, moved)
            world.restore(snapshot)
        kept = plausible_types(world.type_of(object_id), relation, world.scene.room_type)
        shares = {name: share_in_view(interior, moved, looks, (), name) for name in kept}
        return frozenset(name for name, share in shares.items() if share >= LEAST_SHARE + EMPTY_SHARE)

    def _place(
        self,
        object_id: str,
        manipulation: Manipulation,
        relation: Literal["in", "under"],
        interior: Sequence[Area],
        goals: Sequence[GoalPose],
        move_to: Vec3 | None = None,
    ) -> HidingPlace | None:
        """The place, if there is a pose for it."""
        shown = (goal for goal in goals if self._shows(object_id, goal.pose))
        best = next(shown, None)
        if best is None:
            return None
        provable = self._provable(object_id, manipulation, relation, interior, best.pose, move_to)
        if not provable:
            return None
        areas = best.parts
        side = self.rules.spot_side_m if relation == "in" else self.rules.spot_side_under_m
        spots = [spot for area in areas for spot in area.spots(side)]
        most = min(len(spots), self.rules.max_spots if relation == "in" else self.rules.max_spots_under)
        if relation == "in":  # two phones need more than the room of two mugs
            most = min(most, sum(area.capacity((*self.rules.long_thing_m, 0.0), self.rules.gap_m) for area in areas))
        count = max(1, most)
        return HidingPlace(
            object_id=object_id,
            type=self.world.type_of(object_id),
            manipulation=manipulation,
            relation=relation,
            goal=best.pose,
            other_goals=tuple(goal.pose for goal in islice(shown, self.rules.other_goals)),
            spots=tuple(spots[i * len(spots) // count] for i in range(count)),
            areas=areas,
            interior=tuple(interior),
            provable=provable,
            floor_z=self.world.scene.floor_z,
            move_to=move_to,
        )


def _area_of(place: HidingPlace) -> float:
    return sum(4 * area.half[0] * area.half[1] for area in place.areas)


@contextmanager
def _shown(view: WorldView, object_id: str) -> Iterator[None]:
    """For the length of a block a loose object is in the pictures."""
    is_loose = not view.world.state(object_id).is_fixed
    view.hide(object_id, False)
    try:
        yield
    finally:
        if is_loose:
            view.hide(object_id)


def _inner_areas(world: World, object_id: str, rules: HidingRules) -> list[Area]:
    """The floors of an object's enclosed spaces, off its walls, as they lie in the room when it is closed."""
    matrix = world.state(object_id).matrix()
    if matrix[2, 2] < 0.99:
        return []
    yaw = math.degrees(arithmetic.arctan2(matrix[1, 0], matrix[0, 0]))
    areas = []
    for space in world.assets[object_id].spaces:
        low, high = np.array(space.box[:3]), np.array(space.box[3:])
        half = (high - low)[:2] / 2 - rules.wall_gap_m
        if not space.enclosed or half.min() < rules.min_area_side_m / 2:
            continue
        bottom = np.append((low + high)[:2] / 2, low[2])
        x, y, z = arithmetic.moved(bottom, matrix)
        height = float(high[2] - low[2]) - 0.005
        area = Area((float(x), float(y), float(z)), yaw, (float(half[0]), float(half[1])), height, space.link)
        if _is_solid(world, area):
            areas.append(area)
    return areas


def _is_solid(world: World, area: Area) -> bool:
    """Whether things come to rest on most of an area: rays down hit its bottom."""
    flat = area.lattice(max(area.half)).reshape(-1, 2) * 0.8
    starts = area.to_room(at_height(flat, min(0.06, 0.8 * area.height_m)))
    ends = area.to_room(at_height(flat, -SOLID_M))
    hits = world.client.rayTestBatch(starts.tolist(), ends.tolist())
    return bool(np.mean([hit[0] >= 0 and abs(hit[3][2] - area.centre[2]) <= SOLID_M for hit in hits]) >= 0.8)
