"""The room in motion: PyBullet holds collision shapes, joints and poses; nothing is drawn here.

The poses and openness that this class keeps are the truth. PyBullet is asked to move free objects (`settle`), and its
answer is read back; every other change is made here and told to PyBullet. An object's pose is that of the centre of its
closed box, and PyBullet's centre of mass is put there too, so that no conversion ever loses a bit.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import TracebackType
from typing import NoReturn

from remqa_data.assets import Asset, build
from remqa_data.catalog import object_type
from remqa_data.errors import ActionError, UnknownNameError
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec3
from remqa_data.scene import Quaternion, Scene, SceneObject
from remqa_data.sim.physics.bodies import Bodies
from remqa_data.sim.physics.bullet import BulletClient
from remqa_data.sim.physics.carrying import met_nothing, riders
from remqa_data.sim.physics.furniture import parts_of_furniture
from remqa_data.sim.physics.state import ObjectState, finite_vector

SETTLE_STEPS = 240
AWAY_Z_M, AWAY_APART_M = -1000.0, 10.0
"""Where things are that were taken out of the room: how high, and how far from each other."""

_Kept = dict[str, tuple[ObjectState, F64]]
"""What was found of objects, with the state that they were in."""


@dataclass(frozen=True)
class Snapshot:
    """The state of a whole world; see `World.save`, and `World` for what is held and away."""

    states: dict[str, ObjectState]
    held: dict[str, int]
    away: dict[str, ObjectState] = field(default_factory=dict)


class World:
    """A simulated scene.

    Parameters
    ----------
    scene : Scene
        What to load.

    Attributes
    ----------
    held : dict of str to int
        Ids of the objects that are in hands, and so out of physics and pictures, each with the number of the agent.
    away : dict of str to ObjectState
        Ids of the objects that were taken out of the room, each with the state in which it would come back.
    revision : int
        Grows with every change, so that who follows the world can tell that nothing has changed.

    Notes
    -----
    Two worlds loaded from equal scenes behave alike to the last bit, in any process. Use it as a context manager, or
    call `close`, to give PyBullet's memory back.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.assets: dict[str, Asset] = {o.id: build(o.asset) for o in scene.objects}
        self._objects: dict[str, SceneObject] = {o.id: o for o in scene.objects}
        self._link_poses: _Kept = {}
        self._boxes: _Kept = {}
        self._states = {o.id: ObjectState(o.position, o.quaternion, o.openness, o.is_fixed) for o in scene.objects}
        self.held: dict[str, int] = {}
        self.away: dict[str, ObjectState] = {}
        self.revision = self._afresh = 0
        self._bodies = Bodies()
        self._reload()

    # ---- reading

    @property
    def client(self) -> BulletClient:
        """The PyBullet client, for questions to PyBullet that this class does not answer; leave the simulation as it is."""
        return self._bodies.client

    @property
    def ids(self) -> tuple[str, ...]:
        """Ids of all objects, in the scene's order."""
        return tuple(self._objects)

    def state(self, object_id: str) -> ObjectState:
        """Where an object is."""
        self._check_known(object_id)
        return self._states[object_id]

    @property
    def there(self) -> list[str]:
        """Ids of the objects that are not away, in the scene's order."""
        return [name for name in self._objects if name not in self.away]

    def state_when_there(self, object_id: str) -> ObjectState:
        """Where an object is or, while it is away, would be if it came back."""
        return self.away.get(object_id) or self.state(object_id)

    def type_of(self, object_id: str) -> str:
        """Type of an object."""
        self._check_known(object_id)
        return self._objects[object_id].type

    def link_poses(self, object_id: str) -> F64:
        """(links, 4, 4) poses of an object's links, each mapping closed asset geometry to the world."""
        return self._known(self._link_poses, object_id, self._find_link_poses)

    def motion_since(self, object_id: str, poses: F64) -> F64:
        """(links, 4, 4) how the links of an object have moved since they had some `link_poses`."""
        return arithmetic.product(self.link_poses(object_id), arithmetic.inverse(poses))

    def box(self, object_id: str) -> F64:
        """(2, 3) corners of the axis-aligned box of an object's visible mesh as it is now, metres."""
        return self._known(self._boxes, object_id, self._find_box)

    def contents(self, object_id: str, link: int | None = None, *, along: Collection[str] = ()) -> list[str]:
        """Ids of the things that go along with an object (with one link of it, if given), in the scene's order.

        What rests on it or in it, or `along` on or in what is moved as one with it, and what rests on that; see
        `remqa_data.sim.physics.carrying`.
        """
        carried = riders(self, self._bodies, object_id, link, along=along)
        return [other for other in self._objects if other in carried]

    def built_into(self, object_id: str) -> tuple[str, ...]:
        """Ids of the drawers, shelves and cabinets that an object is made of; see `remqa_data.sim.physics.furniture`."""
        return self._furniture.get(object_id, ())

    @cached_property
    def _furniture(self) -> dict[str, tuple[str, ...]]:
        return parts_of_furniture(self.scene.objects, self.assets)

    def most_open(self, object_id: str) -> float:
        """How far an object opens where it stands, from 0 (not at all) to 1."""
        self._check_known(object_id)
        return self._objects[object_id].most_open

    def depths_when_open(self, object_id: str, openness: float) -> dict[str, float]:
        """How deep the moving parts of an object would be in other things, and in "structure", at an openness; metres."""
        return self._bodies.depths_when_open(object_id, replace(self.state(object_id), openness=openness))

    def first_hit(self, start: Vec3, end: Vec3) -> tuple[str, Vec3] | None:
        """The object, or "structure", whose collision boxes a ray meets first, and where, metres; None if none."""
        return self._bodies.first_hit(start, end)

    def borne(self, object_id: str, *, along: Collection[str] = ()) -> list[str]:
        """Ids of what rests on or in an object, or on what is moved along with it, if only partly, in the scene's order."""
        found = riders(self, self._bodies, object_id, along=along, or_lean=True)
        return [other for other in self._objects if other in found]

    def to_scene(self) -> Scene:
        """The world as it is now, as data; loading it gives this world again, without what is away, and with empty hands."""
        objects = tuple(
            replace(
                o,
                position=self._states[o.id].position,
                quaternion=self._states[o.id].quaternion,
                openness=self._states[o.id].openness,
                is_fixed=self._states[o.id].is_fixed,
            )
            for o in self._objects.values()
            if o.id not in self.away
        )
        return self.scene.with_objects(objects)

    # ---- acting

    def settle(
        self,
        steps: int = SETTLE_STEPS,
        velocities: Mapping[str, Vec3] | None = None,
        awake: Iterable[str] | None = None,
    ) -> None:
        """Let physics move the free objects until all are at rest, at most for a number of steps of 1/240 s.

        Then they are held where they are. The outcome depends on the poses only, not on what happened before: PyBullet
        starts afresh, because its contact cache and the order of its pairs would remember.

        Parameters
        ----------
        steps : int
            How many at most.
        velocities : mapping of str to tuple of float, optional
            Of what is in motion at first, m/s by object id.
        awake : iterable of str, optional
            All else sleeps until something hits it: a third of the time. PyBullet wakes what lies in a drawer, or has moving
            parts, all the same; where nothing that was awake has come near, it stays as it was.
        """
        awake = None if awake is None else tuple(awake)
        in_motion = {name: finite_vector(speed, f"velocity of {name}") for name, speed in (velocities or {}).items()}
        for object_id in (*in_motion, *(awake or ())):
            self._check_known(object_id)
        self._reload()
        for object_id, velocity in in_motion.items():
            self._bodies.set_velocity(object_id, velocity)
        free = [i for i, state in self._states.items() if not state.is_fixed and i not in self.held]
        moved = self._bodies.settle(free, steps, free if awake is None else awake)
        before = {} if awake is None else {name: (self._states[name], self.box(name)) for name in moved}
        for object_id in moved:
            position, quaternion = self._bodies.pose(object_id)
            self._put_at(object_id, replace(self._states[object_id], position=position, quaternion=quaternion))
        if awake is not None:
            # What fell asleep again between two looks has not moved to speak of, and in PyBullet lies elsewhere by micrometres.
            for object_id in set(free).difference(moved):
                self._bodies.place(object_id, self._states[object_id])
            for object_id in met_nothing({name: (box, self.box(name)) for name, (_, box) in before.items()}, awake):
                self._put_at(object_id, before[object_id][0])
        for object_id in self.held:  # nothing bore their bodies meanwhile
            self._bodies.place(object_id, self._states[object_id])

    def open(self, object_id: str, openness: float = 1.0, *, force: bool = False) -> list[str]:
        """Open or close an object; what lies in its moving parts is carried along, exactly.

        Parameters
        ----------
        object_id : str
            An openable object.
        openness : float
            0 (closed) to 1 (open); where it opens less far, see `most_open`, it opens as far as it can.
        force : bool
            Whether it opens all the same, through what is in its way.

        Returns
        -------
        Ids of the objects that were carried along.

        Raises
        ------
        ActionError
            If it cannot be opened, or the openness is not in 0..1.
        """
        state, asset = self.state(object_id), self.assets[object_id]
        if not asset.is_openable:
            raise ActionError(f"{object_id} is not openable")
        if not 0.0 <= openness <= 1.0:
            raise ActionError(f"openness {openness} is not between 0 and 1")
        if not force:
            openness = min(openness, self.most_open(object_id))
        carried: dict[str, int] = {}
        for link in range(1, len(asset.links)):
            carried |= {other: link for other in self.contents(object_id, link) if other not in carried}
        before = self.link_poses(object_id)
        self._put_at(object_id, replace(state, openness=openness))
        after = self.link_poses(object_id)
        for other, link in carried.items():
            self._move_by(other, arithmetic.product(after[link], arithmetic.inverse(before[link])))
        return list(carried)

    def close_object(self, object_id: str) -> list[str]:
        """Close an object; see `open`."""
        return self.open(object_id, 0.0)

    def move(
        self, object_id: str, position: Vec3, quaternion: Quaternion | None = None, *, along: Collection[str] = ()
    ) -> list[str]:
        """Put an object somewhere else, with what is in or on it; no check for obstacles (see `overlapping`).

        Others may go `along` as if they were one with it; what of them is away comes back as if it had gone along.

        Returns
        -------
        Ids of the objects that were carried along.

        Raises
        ------
        ActionError
            If a number is not finite, or the quaternion not a unit one; or the object is away.
        """
        self._check_there(object_id)
        state = self.state(object_id)
        along = [other for other in along if other != object_id]
        carried = [*along, *self.contents(object_id, along=along)]
        before = state.matrix()
        moved = state.elsewhere(position, quaternion)
        motion = arithmetic.product(moved.matrix(), arithmetic.inverse(before))
        self._put_at(object_id, moved)
        for other in carried:
            self._move_by(other, motion)
        return carried

    def held_by(self, agent: int) -> str | None:
        """Id of what is in the hand of an agent, by its number."""
        return next((object_id for object_id, number in self.held.items() if number == agent), None)

    def load_of(self, object_id: str) -> list[str]:
        """Ids of what is held with an object because it lies in it or on it; none if that is in no hand."""
        agent = self.held.get(object_id)
        if agent is None or self.held_by(agent) != object_id:
            return []
        return [other for other, number in self.held.items() if number == agent and other != object_id]

    def pick_up(self, object_id: str, agent: int = 0, load: Iterable[str] = ()) -> None:
        """Take an object out of the room into the hand of an agent; it stays out of physics until it is put back.

        With it comes its load, which goes along with it until it is put down.

        Raises
        ------
        ActionError
            If it is not pickupable, is away or in a hand, or the agent holds something already; or its load is in a hand.
        """
        self._check_there(object_id)
        load = tuple(load)
        if not object_type(self.type_of(object_id)).pickupable:
            raise ActionError(f"{object_id} is not pickupable")
        if object_id in self.held:
            raise ActionError(f"cannot pick up {object_id}: agent {self.held[object_id]} holds it")
        if (held := self.held_by(agent)) is not None:
            raise ActionError(f"cannot pick up {object_id}: already holding {held}")
        for name in load:
            self._check_there(name)
            if name == object_id or name in self.held:
                raise ActionError(f"cannot pick up {object_id} with {name}: that is taken already")
        for name in (object_id, *load):
            self.set_fixed(name, False)
            self.held[name] = agent
            self.revision += 1
            self._bodies.set_collisions(name, False)

    def put(self, object_id: str, position: Vec3, quaternion: Quaternion | None = None) -> None:
        """Put a held object, with its load, back into the room at a pose, free to fall.

        Raises
        ------
        ActionError
            If nobody holds it.
        """
        self._check_known(object_id)
        if object_id not in self.held or self.held_by(self.held[object_id]) != object_id:
            raise ActionError(f"{object_id} is not held")
        load = self.load_of(object_id)
        self.move_alone(object_id, position, quaternion)
        for name in (object_id, *load):
            self._let_go(name)

    def overlapping(self, object_id: str, margin_m: float = 0.0) -> list[tuple[str, float]]:
        """Other objects (and "structure") that an object's collision boxes come closer to than a margin.

        Returns
        -------
        Pairs of id and distance in metres, negative where they interpenetrate; nearest first.
        """
        found = self._bodies.nearby(object_id, self.box(object_id), margin_m)
        return sorted(found.items(), key=lambda pair: pair[1])

    def move_alone(self, object_id: str, position: Vec3, quaternion: Quaternion | None = None) -> None:
        """Put an object somewhere else and leave what is in or on it where it is; what is held takes its load along."""
        state = self.state(object_id)
        moved = state.elsewhere(position, quaternion)
        self._put_at(object_id, moved)
        if load := self.load_of(object_id):
            motion = arithmetic.product(moved.matrix(), arithmetic.inverse(state.matrix()))
            for other in load:
                self._move_by(other, motion)

    def set_fixed(self, object_id: str, is_fixed: bool) -> None:
        """Say whether physics leaves an object where it is; ActionError if it is to be fixed and is in a hand."""
        # PyBullet cannot free a fixed body, so the world is loaded anew: bodies keep their order, and so their effect.
        state = self.state(object_id)
        if state.is_fixed == is_fixed:
            return
        if is_fixed and object_id in self.held:
            raise ActionError(f"{object_id} is in a hand: put it down before it is fixed")
        self._states[object_id] = replace(state, is_fixed=is_fixed)
        self._reload()
        self.revision += 1

    def put_away(self, object_id: str, state: ObjectState | None = None) -> None:
        """Take an object, and not what is in or on it, out of the room: it lies far below, where nothing meets it.

        It would come back in the state in which it is, or in the one that is given.
        """
        state = state or self.state_when_there(object_id)
        self._take_out_of_hand(object_id)
        self.set_fixed(object_id, True)
        self.move_alone(object_id, self.place_away(object_id))
        self.away[object_id] = state

    def place_away(self, object_id: str) -> Vec3:
        """Where an object is while it is out of the room, metres."""
        return AWAY_APART_M * self.ids.index(object_id), 0.0, AWAY_Z_M

    def put_back(self, object_id: str, state: ObjectState) -> None:
        """Give an object a state that it had before, or may have; no check for obstacles."""
        self._take_out_of_hand(object_id)
        self.away.pop(object_id, None)
        self.set_fixed(object_id, state.is_fixed)
        self._put_at(object_id, state)

    @contextmanager
    def without_collisions(self, object_id: str) -> Iterator[None]:
        """For the length of a block, physics and rays pass through an object."""
        self._check_known(object_id)
        self._bodies.set_collisions(object_id, False)
        try:
            yield
        finally:
            self._bodies.set_collisions(object_id, object_id not in self.held)

    # ---- saving

    def save(self) -> Snapshot:
        """The state of everything, to come back to with `restore`."""
        return Snapshot(dict(self._states), dict(self.held), dict(self.away))

    def is_as(self, snapshot: Snapshot) -> bool:
        """Whether everything is where it was when a state was saved, or has been brought back; states are never changed."""
        same = (state is snapshot.states.get(object_id) for object_id, state in self._states.items())
        return (self.held, self.away) == (snapshot.held, snapshot.away) and all(same)

    def restore(self, snapshot: Snapshot) -> None:
        """Bring back a saved state exactly: later actions give what they would have given then."""
        for object_id in self.held.keys() - snapshot.held.keys():
            self._bodies.set_collisions(object_id, True)
        self.held, self.away = dict(snapshot.held), dict(snapshot.away)
        for object_id, state in snapshot.states.items():
            self.set_fixed(object_id, state.is_fixed)  # may load all anew, but for what is held
        for object_id, state in snapshot.states.items():
            if state is not self._states[object_id]:
                self._put_at(object_id, state)
        self.revision += 1
        for object_id in self.held:
            self._bodies.set_collisions(object_id, False)

    def restart(self, snapshot: Snapshot) -> None:
        """As `restore`, and all that follows is as in a world that was just loaded.

        For PyBullet, joints that have swung and come to rest are elsewhere by micrometres, until it starts afresh.
        """
        if self.revision != self._afresh or not self.is_as(snapshot):
            self.restore(snapshot)
            self._reload()
            self._afresh = self.revision

    def __reduce__(self) -> NoReturn:
        msg = "a World lives in a simulator of this process: it cannot be copied or pickled; use save() and restore()"
        raise TypeError(msg)

    def close(self) -> None:
        """Give PyBullet's memory back; the world cannot be used afterwards."""
        self._bodies.close()

    def __enter__(self) -> World:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    # ---- what follows from an object's state

    def _known(self, kept: _Kept, object_id: str, find: Callable[[str], F64]) -> F64:
        """A copy of what was found when the object came to be where it is."""
        state = self.state(object_id)
        if object_id not in kept or kept[object_id][0] is not state:
            kept[object_id] = (state, find(object_id))
        return kept[object_id][1].copy()

    def _find_link_poses(self, object_id: str) -> F64:
        return self._states[object_id].link_poses(self.assets[object_id])

    def _find_box(self, object_id: str) -> F64:
        return self.assets[object_id].box_at(self.link_poses(object_id))

    # ---- PyBullet

    def _reload(self) -> None:
        solid = [part.box for part in self.scene.structure if part.kind != "outside"]
        self._bodies.load(solid, self.assets, self._states)
        for object_id in self.held:
            self._bodies.set_collisions(object_id, False)

    def _put_at(self, object_id: str, state: ObjectState) -> None:
        self._states[object_id] = state
        self._bodies.place(object_id, state)
        if object_id not in self.held:  # what is in a hand is nowhere in the room
            self.revision += 1

    def _let_go(self, object_id: str) -> None:
        del self.held[object_id]
        self._bodies.set_collisions(object_id, True)
        self.revision += 1

    def _take_out_of_hand(self, object_id: str) -> None:
        """Let an object be in no hand; nor is its load, which is where it was in the room."""
        for name in (*self.load_of(object_id), object_id):
            if name in self.held:
                self._let_go(name)

    def _move_by(self, object_id: str, motion: F64) -> None:
        if object_id in self.away:
            self.away[object_id] = self.away[object_id].moved(motion)
        else:
            self._put_at(object_id, self._states[object_id].moved(motion))

    def _check_there(self, object_id: str) -> None:
        self._check_known(object_id)
        if object_id in self.away:
            raise ActionError(f"{object_id} is away: put it back first")

    def _check_known(self, object_id: str) -> None:
        if object_id not in self._objects:
            raise UnknownNameError("object", object_id, self._objects)
