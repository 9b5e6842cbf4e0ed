"""The room in motion: PyBullet holds collision shapes, joints and poses; nothing is drawn here.

The poses and openness that this class keeps are the truth. PyBullet is asked to move free objects (`settle`), and its
answer is read back; every other change is made here and told to PyBullet. An object's pose is that of the centre of its
closed box, and PyBullet's centre of mass is put there too, so that no conversion ever loses a bit.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from types import TracebackType

import numpy as np

from remqa_data.assets import Asset, build
from remqa_data.assets.model import F64, Box, Joint, Vec3
from remqa_data.catalog import object_type
from remqa_data.errors import ActionError, UnknownNameError
from remqa_data.rotations import quaternion_of, rotation_of
from remqa_data.scene import Quaternion, Scene, SceneObject
from remqa_data.sim.bullet import pybullet

TIME_STEP_S = 1 / 240
SETTLE_STEPS = 240
GRAVITY_M_S2 = -9.81
FRICTION = 0.7
ROLLING_FRICTION = 0.002
LINEAR_DAMPING, ANGULAR_DAMPING = 0.2, 0.6
MIN_MASS_KG = 0.05
"""Lighter things (a credit card weighs 6 g) make the solver restless; they are simulated with this mass."""
MAX_COMPOUND = 16
"""PyBullet silently drops the shapes of a compound beyond this number."""
CARRY_MARGIN_M = 0.03
"""Things whose centre is within this distance of a space belong to it."""


@dataclass(frozen=True)
class ObjectState:
    """Where one object is: pose of the centre of its closed box, openness, and whether physics moves it."""

    position: Vec3
    quaternion: Quaternion
    openness: float
    is_fixed: bool

    def matrix(self) -> F64:
        """(4, 4) pose, asset frame to world frame."""
        pose = np.eye(4)
        pose[:3, :3] = rotation_of(self.quaternion)
        pose[:3, 3] = self.position
        return pose


@dataclass(frozen=True)
class Snapshot:
    """The state of a whole world; see `World.save`."""

    states: dict[str, ObjectState]
    held: str | None


class World:
    """A simulated scene.

    Parameters
    ----------
    scene : Scene
        What to load.

    Notes
    -----
    `client` is the PyBullet client, for questions to PyBullet that this class does not answer; changing the simulation
    through it breaks the promise that this class makes.

    Two worlds loaded from equal scenes behave alike to the last bit, in any process. Use it as a context manager, or
    call `close`, to give PyBullet's memory back.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.assets: dict[str, Asset] = {o.id: build(o.asset) for o in scene.objects}
        self._objects: dict[str, SceneObject] = {o.id: o for o in scene.objects}
        self._states = {o.id: ObjectState(o.position, o.quaternion, o.openness, o.is_fixed) for o in scene.objects}
        self.held: str | None = None
        self.client = pybullet.connect(pybullet.DIRECT)
        self._bodies: dict[str, int] = {}
        self._structure_bodies: list[int] = []
        self._load()

    # ---- reading

    @property
    def ids(self) -> tuple[str, ...]:
        """Ids of all objects, in the scene's order."""
        return tuple(self._objects)

    def state(self, object_id: str) -> ObjectState:
        """Where an object is."""
        self._check_known(object_id)
        return self._states[object_id]

    def type_of(self, object_id: str) -> str:
        """Type of an object."""
        self._check_known(object_id)
        return self._objects[object_id].type

    def link_poses(self, object_id: str) -> F64:
        """(links, 4, 4) poses of an object's links, each mapping closed asset geometry to the world."""
        state = self.state(object_id)
        return np.asarray(state.matrix() @ self.assets[object_id].link_poses(state.openness))

    def box(self, object_id: str) -> F64:
        """(2, 3) corners of the axis-aligned box of an object's visible mesh as it is now, metres."""
        points = []
        for link, pose in zip(self.assets[object_id].links, self.link_poses(object_id), strict=True):
            points += [s.vertices @ pose[:3, :3].T + pose[:3, 3] for s in link.surfaces]
        stacked = np.vstack(points)
        return np.stack([stacked.min(axis=0), stacked.max(axis=0)])

    def contents(self, object_id: str, link: int | None = None) -> list[str]:
        """Ids of the free objects whose centre is in a space of an object (of one link of it, if given)."""
        asset, poses = self.assets[object_id], self.link_poses(object_id)
        spaces = [s for s in asset.spaces if link is None or s.link == link]
        inside = []
        for other, state in self._states.items():
            if other == object_id or state.is_fixed or other == self.held:
                continue
            for space in spaces:
                pose = poses[space.link]
                local = pose[:3, :3].T @ (np.asarray(state.position) - pose[:3, 3])
                low, high = np.asarray(space.box[:3]), np.asarray(space.box[3:])
                if np.all(local > low - CARRY_MARGIN_M) and np.all(local < high + CARRY_MARGIN_M):
                    inside.append(other)
                    break
        return inside

    def to_scene(self) -> Scene:
        """The world as it is now, as data; loading it gives this world again."""
        objects = tuple(
            replace(
                o,
                position=self._states[o.id].position,
                quaternion=self._states[o.id].quaternion,
                openness=self._states[o.id].openness,
                is_fixed=self._states[o.id].is_fixed,
            )
            for o in self._objects.values()
        )
        return self.scene.with_objects(objects)

    # ---- acting

    def settle(self, steps: int = SETTLE_STEPS) -> None:
        """Let physics move the free objects for a number of steps of 1/240 s, then bring them to rest.

        The outcome depends on the poses only, not on what happened before: PyBullet starts afresh, because its contact
        cache and the order of its pairs would remember.
        """
        self._reload()
        for _ in range(steps):
            pybullet.stepSimulation(physicsClientId=self.client)
        for object_id, state in self._states.items():
            if state.is_fixed or object_id == self.held:
                continue
            position, quaternion = pybullet.getBasePositionAndOrientation(
                self._bodies[object_id], physicsClientId=self.client
            )
            self._states[object_id] = replace(state, position=position, quaternion=quaternion)
            self._tell_pose(object_id)

    def open(self, object_id: str, openness: float = 1.0) -> list[str]:
        """Open or close an object; what lies in its moving parts is carried along, exactly.

        Parameters
        ----------
        object_id : str
            An openable object.
        openness : float
            0 (closed) to 1 (open).

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
        carried: dict[str, int] = {}
        for link in range(1, len(asset.links)):
            carried |= {other: link for other in self.contents(object_id, link) if other not in carried}
        before = self.link_poses(object_id)
        self._states[object_id] = replace(state, openness=openness)
        after = self.link_poses(object_id)
        for other, link in carried.items():
            self._move_by(other, after[link] @ np.linalg.inv(before[link]))
        self._tell_pose(object_id)
        return list(carried)

    def close_object(self, object_id: str) -> list[str]:
        """Close an object; see `open`."""
        return self.open(object_id, 0.0)

    def move(self, object_id: str, position: Vec3, quaternion: Quaternion | None = None) -> list[str]:
        """Put an object somewhere else, with what is in or on it; no check for obstacles (see `overlapping`).

        Returns
        -------
        Ids of the objects that were carried along.
        """
        state = self.state(object_id)
        carried = self.contents(object_id)
        before = state.matrix()
        moved = replace(state, position=_vec3(position), quaternion=quaternion or state.quaternion)
        motion = moved.matrix() @ np.linalg.inv(before)
        self._states[object_id] = moved
        self._tell_pose(object_id)
        for other in carried:
            self._move_by(other, motion)
        return carried

    def pick_up(self, object_id: str) -> None:
        """Take an object out of the room; it stays out of physics until it is put back.

        Raises
        ------
        ActionError
            If it is not pickupable, or something is held already.
        """
        self._check_known(object_id)
        if not object_type(self.type_of(object_id)).pickupable:
            raise ActionError(f"{object_id} is not pickupable")
        if self.held is not None:
            raise ActionError(f"cannot pick up {object_id}: already holding {self.held}")
        self._set_fixed(object_id, False)
        self.held = object_id
        self._set_collisions(object_id, False)

    def put(self, position: Vec3, quaternion: Quaternion | None = None) -> str:
        """Put the held object back into the room at a pose, free to fall; returns its id.

        Raises
        ------
        ActionError
            If nothing is held.
        """
        if self.held is None:
            raise ActionError("nothing is held")
        object_id, self.held = self.held, None
        self._set_collisions(object_id, True)
        state = self._states[object_id]
        self._states[object_id] = replace(state, position=_vec3(position), quaternion=quaternion or state.quaternion)
        self._tell_pose(object_id)
        return object_id

    def overlapping(self, object_id: str, margin_m: float = 0.0) -> list[tuple[str, float]]:
        """Other objects (and "structure") that an object's collision boxes come closer to than a margin.

        Returns
        -------
        Pairs of id and distance in metres, negative where they interpenetrate; nearest first.
        """
        body = self._bodies[object_id]
        low, high = self.box(object_id)
        pairs = pybullet.getOverlappingObjects(
            (low - margin_m - 0.02).tolist(), (high + margin_m + 0.02).tolist(), physicsClientId=self.client
        )
        names = {b: name for name, b in self._bodies.items()} | dict.fromkeys(self._structure_bodies, "structure")
        found: dict[str, float] = {}
        for other in sorted({b for b, _ in pairs or ()} - {body}):
            points = pybullet.getClosestPoints(body, other, margin_m, physicsClientId=self.client)
            if points:
                distance = min(float(point[8]) for point in points)
                found[names[other]] = min(distance, found.get(names[other], distance))
        return sorted(found.items(), key=lambda pair: pair[1])

    def move_alone(self, object_id: str, position: Vec3) -> None:
        """Put an object somewhere else and leave what is in or on it where it is."""
        self._states[object_id] = replace(self.state(object_id), position=_vec3(position))
        self._tell_pose(object_id)

    @contextmanager
    def without_collisions(self, object_id: str) -> Iterator[None]:
        """For the length of a block, physics and rays pass through an object."""
        self._set_collisions(object_id, False)
        try:
            yield
        finally:
            self._set_collisions(object_id, object_id != self.held)

    # ---- saving

    def save(self) -> Snapshot:
        """The state of everything, to come back to with `restore`."""
        return Snapshot(dict(self._states), self.held)

    def restore(self, snapshot: Snapshot) -> None:
        """Bring back a saved state exactly: later actions give what they would have given then."""
        if self.held is not None and self.held != snapshot.held:
            self._set_collisions(self.held, True)
        for object_id, state in snapshot.states.items():
            self._set_fixed(object_id, state.is_fixed)
        for object_id, state in snapshot.states.items():
            self._states[object_id] = state
            self._tell_pose(object_id)
        self.held = snapshot.held
        if self.held is not None:
            self._set_collisions(self.held, False)

    def close(self) -> None:
        """Give PyBullet's memory back; the world cannot be used afterwards."""
        if self.client >= 0:
            pybullet.disconnect(self.client)
            self.client = -1

    def __enter__(self) -> World:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    # ---- PyBullet

    def _load(self) -> None:
        pybullet.setGravity(0, 0, GRAVITY_M_S2, physicsClientId=self.client)
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=TIME_STEP_S,
            numSolverIterations=30,
            deterministicOverlappingPairs=1,
            physicsClientId=self.client,
        )
        solid = [part.box for part in self.scene.structure if part.kind != "outside"]
        self._structure_bodies = self._static_boxes(solid)
        for object_id in self._objects:
            self._bodies[object_id] = self._create(object_id)

    def _reload(self) -> None:
        pybullet.resetSimulation(physicsClientId=self.client)
        self._load()
        if self.held is not None:
            self._set_collisions(self.held, False)

    def _static_boxes(self, boxes: list[Box]) -> list[int]:
        bodies = []
        for start in range(0, len(boxes), MAX_COMPOUND):
            chunk = np.array(boxes[start : start + MAX_COMPOUND])
            shape = self._compound((chunk[:, 3:] - chunk[:, :3]) / 2, (chunk[:, 3:] + chunk[:, :3]) / 2, None)
            bodies.append(int(pybullet.createMultiBody(0, shape, physicsClientId=self.client)))
        return bodies

    def _compound(self, halves: F64, centres: F64, quaternions: F64 | None) -> int:
        count = len(halves)
        if quaternions is None:
            quaternions = np.tile([0.0, 0.0, 0.0, 1.0], (count, 1))
        return int(
            pybullet.createCollisionShapeArray(
                shapeTypes=[pybullet.GEOM_BOX] * count,
                halfExtents=halves.tolist(),
                collisionFramePositions=centres.tolist(),
                collisionFrameOrientations=quaternions.tolist(),
                physicsClientId=self.client,
            )
        )

    def _create(self, object_id: str) -> int:
        asset, state = self.assets[object_id], self._states[object_id]
        mass = 0.0 if state.is_fixed else max(object_type(asset.spec.type).mass_kg or 0.0, MIN_MASS_KG)
        origins = [np.zeros(3) if link.joint is None else np.asarray(link.joint.origin) for link in asset.links]
        first, rest = [-1] * len(asset.links), []
        for i, link in enumerate(asset.links):
            for start in range(0, len(link.boxes), MAX_COMPOUND):
                chunk = link.boxes[start : start + MAX_COMPOUND]
                halves = np.array([box.size for box in chunk]) / 2
                centres = np.array([box.centre for box in chunk]) - origins[i]
                shape = self._compound(halves, centres, np.array([box.quaternion for box in chunk]))
                if start == 0:
                    first[i] = shape
                else:
                    rest.append((i, shape))
        # Joints come first, in the asset's order; then what did not fit into one compound, fixed to its link.
        links = [
            _BodyLink(first[i], link.parent, origins[i] - origins[link.parent], link.joint)
            for i, link in enumerate(asset.links)
            if link.joint is not None
        ]
        moving = range(len(links))
        links += [_BodyLink(shape, parent, np.zeros(3), None) for parent, shape in rest]
        link_mass = mass / (4 * len(links)) if mass and links else 0.1
        zeros, identities = [[0.0] * 3 for _ in links], [[0.0, 0.0, 0.0, 1.0] for _ in links]
        body = pybullet.createMultiBody(
            baseMass=mass,
            baseCollisionShapeIndex=first[0],
            basePosition=state.position,
            baseOrientation=state.quaternion,
            linkMasses=[link_mass for _ in links],
            linkCollisionShapeIndices=[link.shape for link in links],
            linkVisualShapeIndices=[-1 for _ in links],
            linkPositions=[link.offset.tolist() for link in links],
            linkOrientations=identities,
            linkInertialFramePositions=zeros,
            linkInertialFrameOrientations=identities,
            linkParentIndices=[link.parent for link in links],
            linkJointTypes=[
                pybullet.JOINT_FIXED if link.joint is None else _JOINT_TYPES[link.joint.kind] for link in links
            ],
            linkJointAxis=[[0.0, 0.0, 1.0] if link.joint is None else list(link.joint.axis) for link in links],
            physicsClientId=self.client,
        )
        for link_index in range(-1, len(links)):
            pybullet.changeDynamics(
                body,
                link_index,
                lateralFriction=FRICTION,
                rollingFriction=ROLLING_FRICTION,
                spinningFriction=ROLLING_FRICTION,
                linearDamping=LINEAR_DAMPING,
                angularDamping=ANGULAR_DAMPING,
                restitution=0.0,
                physicsClientId=self.client,
            )
        for joint in moving:  # hold every joint where it is told to be
            pybullet.setJointMotorControl2(
                body,
                joint,
                pybullet.VELOCITY_CONTROL,
                targetVelocity=0.0,
                force=1000.0,
                physicsClientId=self.client,
            )
        self._bodies[object_id] = int(body)
        self._tell_pose(object_id)
        return int(body)

    def _tell_pose(self, object_id: str) -> None:
        body, state = self._bodies[object_id], self._states[object_id]
        pybullet.resetBasePositionAndOrientation(body, state.position, state.quaternion, physicsClientId=self.client)
        if not state.is_fixed:
            pybullet.resetBaseVelocity(body, (0, 0, 0), (0, 0, 0), physicsClientId=self.client)
        for i, link in enumerate(self.assets[object_id].links[1:]):
            assert link.joint is not None
            pybullet.resetJointState(body, i, link.joint.upper * state.openness, physicsClientId=self.client)

    def _set_fixed(self, object_id: str, is_fixed: bool) -> None:
        """PyBullet cannot free a fixed body, so the world is loaded anew: bodies keep their order, and so their effect."""
        state = self._states[object_id]
        if state.is_fixed == is_fixed:
            return
        self._states[object_id] = replace(state, is_fixed=is_fixed)
        self._reload()

    def _set_collisions(self, object_id: str, enabled: bool) -> None:
        body = self._bodies[object_id]
        for link in range(-1, pybullet.getNumJoints(body, physicsClientId=self.client)):
            pybullet.setCollisionFilterGroupMask(
                body, link, int(enabled), -1 if enabled else 0, physicsClientId=self.client
            )

    def _move_by(self, object_id: str, motion: F64) -> None:
        state = self._states[object_id]
        position = motion[:3, :3] @ np.asarray(state.position) + motion[:3, 3]
        quaternion = state.quaternion
        if not np.allclose(motion[:3, :3], np.eye(3), rtol=0, atol=1e-12):
            quaternion = quaternion_of(motion[:3, :3] @ rotation_of(state.quaternion))
        self._states[object_id] = replace(state, position=_vec3(position), quaternion=quaternion)
        self._tell_pose(object_id)

    def _check_known(self, object_id: str) -> None:
        if object_id not in self._objects:
            raise UnknownNameError("object", object_id, self._objects)


_JOINT_TYPES = {"revolute": pybullet.JOINT_REVOLUTE, "prismatic": pybullet.JOINT_PRISMATIC}


@dataclass(frozen=True)
class _BodyLink:
    """A link as PyBullet wants it: parent 0 is the base, and the offset is from the parent's origin."""

    shape: int
    parent: int
    offset: F64
    joint: Joint | None


def _vec3(values: Iterable[float]) -> Vec3:
    x, y, z = values
    return float(x), float(y), float(z)
