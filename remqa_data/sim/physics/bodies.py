"""The side of a world that PyBullet knows: collision boxes, joints and poses."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from remqa_data.assets.core.model import Asset, Joint, Link
from remqa_data.catalog import object_type
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import snapped_quaternion
from remqa_data.geometry.types import F64, Box, Vec3
from remqa_data.scene import Quaternion
from remqa_data.sim.physics.bullet import BulletClient, pybullet
from remqa_data.sim.physics.state import ObjectState

TIME_STEP_S = 1 / 240
CHECK_STEPS = 20
"""After so many steps it is looked whether all is at rest."""
GRAVITY_M_S2 = -9.81
FRICTION = 0.7
ROLLING_FRICTION = 0.002
LINEAR_DAMPING, ANGULAR_DAMPING = 0.2, 0.6
MIN_MASS_KG = 0.05
"""Lighter things (a credit card weighs 6 g) make the solver restless; they are simulated with this mass."""
MAX_COMPOUND = 16
"""PyBullet silently drops the shapes of a compound beyond this number."""
STILL_M_S, STILL_RAD_S = 0.003, 0.15
"""What moves and turns no faster than this is at rest."""
DISTANCE_STEP_M = 2.0**-30
"""Distances that PyBullet measures are snapped to this: the joints of what it measures between stand by its own sines."""

STRUCTURE_NAME = "structure"
"""What the building is called where things touch it."""

REST_M = 0.004
"""A thing rests on what is no farther below it than this: it may have been put down a hair above."""
REST_SLOPE = 0.3
"""What a thing rests on pushes it up: the vertical part of the direction is at least so much of it."""


class Part(NamedTuple):
    """A link of an object, or the building."""

    object_id: str
    link: int


class Bodies:
    """The bodies of one PyBullet client, which is disconnected by `close`, or with the last reference to this.

    Attributes
    ----------
    client : BulletClient
        For questions to PyBullet that this class does not answer.
    """

    def __init__(self) -> None:
        self.client = BulletClient()
        self._assets: Mapping[str, Asset] = {}
        self._of: dict[str, int] = {}
        self._names: dict[int, str] = {}
        self._structure: list[int] = []
        self._passable: set[int] = set()

    def load(self, structure: Sequence[Box], assets: Mapping[str, Asset], states: Mapping[str, ObjectState]) -> None:
        """Begin afresh with a building and objects; the same arguments always give the same simulation."""
        self.client.resetSimulation()
        self.client.setGravity(0, 0, GRAVITY_M_S2)
        self.client.setPhysicsEngineParameter(
            fixedTimeStep=TIME_STEP_S, numSolverIterations=30, deterministicOverlappingPairs=1
        )
        self._assets = assets
        self._structure = self._static_boxes(structure)
        self._of, self._passable = {}, set()
        for object_id, state in states.items():
            self._of[object_id] = self._create(assets[object_id], state)
            self.place(object_id, state)
        self._names = {b: name for name, b in self._of.items()} | dict.fromkeys(self._structure, STRUCTURE_NAME)

    def settle(self, object_ids: Sequence[str], steps: int, awake: Iterable[str]) -> list[str]:
        """Let time pass until some free objects are at rest, at most a number of steps of 1/240 s; which have moved.

        Those that are not awake at first sleep until something hits them.
        """
        moved = set(awake)
        for object_id in object_ids:
            if object_id not in moved:
                self._put_to_sleep(object_id)
        moving, was_still = [name for name in object_ids if name in moved], False
        for done in range(0, steps, CHECK_STEPS):
            for _ in range(min(CHECK_STEPS, steps - done)):
                self.client.stepSimulation()
            moving = [name for name in object_ids if name in moved or self._is_in_motion(name)]
            moved.update(moving)
            self._snap(moving)
            is_still = self._are_still(moving)
            if is_still and was_still:  # once might be the top of a leap
                break
            was_still = is_still
        return moving

    def _snap(self, object_ids: Iterable[str]) -> None:
        """Snap poses and velocities of some objects and their joints.

        PyBullet asks the C library for sines and cosines, whose last digit depends on the processor, and things in
        contact make more of a last digit with every step. Snapped every few steps, it never gets that far.
        """
        for object_id in object_ids:
            body = self._of[object_id]
            position, quaternion = self.client.getBasePositionAndOrientation(body)
            velocity, turning = self.client.getBaseVelocity(body)
            self.client.resetBasePositionAndOrientation(
                body, arithmetic.snapped(position).tolist(), snapped_quaternion(quaternion)
            )
            self.client.resetBaseVelocity(
                body, arithmetic.snapped(velocity).tolist(), arithmetic.snapped(turning).tolist()
            )
            for joint in _joints(self._assets[object_id]):
                angle, speed = self.client.getJointState(body, joint)[:2]
                angle, speed = arithmetic.snapped([angle, speed]).tolist()
                self.client.resetJointState(body, joint, angle, speed)

    def set_velocity(self, object_id: str, velocity: Vec3) -> None:
        """Set a free object in motion, m/s."""
        self.client.resetBaseVelocity(self._of[object_id], velocity, (0.0, 0.0, 0.0))

    def _put_to_sleep(self, object_id: str) -> None:
        """Let a free object stay as it is until something hits it."""
        asleep = pybullet.ACTIVATION_STATE_ENABLE_SLEEPING | pybullet.ACTIVATION_STATE_SLEEP
        self.client.changeDynamics(self._of[object_id], -1, activationState=asleep)

    def _is_in_motion(self, object_id: str) -> bool:
        """Whether an object moves or turns at all."""
        velocity, turning = self.client.getBaseVelocity(self._of[object_id])
        return any(velocity) or any(turning)

    def _are_still(self, object_ids: Iterable[str]) -> bool:
        """Whether none of some objects moves or turns to speak of."""
        for object_id in object_ids:
            velocity, turning = self.client.getBaseVelocity(self._of[object_id])
            if arithmetic.length(velocity) > STILL_M_S or arithmetic.length(turning) > STILL_RAD_S:
                return False
        return True

    def pose(self, object_id: str) -> tuple[Vec3, Quaternion]:
        """Where physics has moved an object, snapped."""
        position, quaternion = self.client.getBasePositionAndOrientation(self._of[object_id])
        x, y, z = arithmetic.snapped(position).tolist()
        return (x, y, z), snapped_quaternion(quaternion)

    def place(self, object_id: str, state: ObjectState) -> None:
        """Put an object and its joints where they are said to be, at rest."""
        body = self._of[object_id]
        self.client.resetBasePositionAndOrientation(body, state.position, state.quaternion)
        if not state.is_fixed:
            self.client.resetBaseVelocity(body, (0, 0, 0), (0, 0, 0))
        asset = self._assets[object_id]
        for number, link in zip(_joints(asset), asset.links[1:], strict=True):
            assert link.joint is not None
            self.client.resetJointState(body, number, link.joint.upper * state.openness)

    def set_collisions(self, object_id: str, enabled: bool) -> None:
        """Let other bodies and rays meet an object, or pass through it; then it is near to nothing either."""
        body = self._of[object_id]
        (self._passable.discard if enabled else self._passable.add)(body)
        for link in range(-1, self.client.getNumJoints(body)):
            self.client.setCollisionFilterGroupMask(body, link, int(enabled), -1 if enabled else 0)

    def nearby(self, object_id: str, box: F64, margin_m: float) -> dict[str, float]:
        """Distance to everything that comes closer to an object, whose (2, 3) box is given, than a margin; metres.

        Asked without a margin, PyBullet now and then leaves out what an object is in by centimetres: who has to know asks
        with 2 cm.
        """
        body = self._of[object_id]
        found: dict[str, float] = {}
        for other in self._around(box, margin_m, body):
            points = self.client.getClosestPoints(body, other, margin_m)
            if points:
                distance = float(arithmetic.snapped(min(float(point[8]) for point in points), DISTANCE_STEP_M))
                name = self._names[other]
                found[name] = min(distance, found.get(name, distance))
        return found

    def around(self, box: F64, margin_m: float) -> set[str]:
        """Objects whose own boxes come near to a (2, 3) box; cheap, and some of them may be farther away."""
        return {self._names[body] for body in self._around(box, margin_m)} - {STRUCTURE_NAME}

    def carriers(self, object_id: str, box: F64) -> set[Part]:
        """The parts of other objects, and of the building, that an object, whose (2, 3) box is given, rests on."""
        body = self._of[object_id]
        found = set()
        for other in self._around(box, REST_M, body):
            points = self.client.getClosestPoints(body, other, REST_M)
            slopes = arithmetic.snapped([point[7][2] for point in points])
            for point, slope in zip(points, slopes.tolist(), strict=True):
                if slope >= REST_SLOPE:
                    name = self._names[other]
                    found.add(Part(name, 0 if name == STRUCTURE_NAME else self._link_of(name, int(point[4]))))
        return found

    def first_hit(self, start: Vec3, end: Vec3) -> tuple[str, Vec3] | None:
        """What a ray from one point to another meets first, and where, snapped; None if nothing."""
        ((body, _, _, point, _),) = self.client.rayTestBatch([start], [end])
        if body < 0:
            return None
        x, y, z = arithmetic.snapped(point).tolist()
        return self._names[body], (x, y, z)

    def depths_when_open(self, object_id: str, state: ObjectState) -> dict[str, float]:
        """How deep the moving parts of an object would be in other things if it were in a state, metres, by name."""
        joints = _joints(self._assets[object_id])
        now = [float(self.client.getJointState(self._of[object_id], number)[0]) for number in joints]
        self.place(object_id, state)
        body, found = self._of[object_id], dict[str, float]()
        for number in range(self.client.getNumJoints(body)):
            if self._link_of(object_id, number) == 0:
                continue
            box = np.array(self.client.getAABB(body, number))
            for other in self._around(box, 0.0, body):
                points = self.client.getClosestPoints(body, other, 0.0, linkIndexA=number)
                depth = max((-float(point[8]) for point in points), default=0.0)
                name = self._names[other]
                found[name] = max(float(arithmetic.snapped(depth, DISTANCE_STEP_M)), found.get(name, 0.0))
        for joint, amount in zip(joints, now, strict=True):
            self.client.resetJointState(body, joint, amount)
        return found

    def close(self) -> None:
        """Give PyBullet's memory back."""
        self.client.close()

    def _around(self, box: F64, margin_m: float, without: int = -1) -> list[int]:
        low, high = box[0] - margin_m - 0.02, box[1] + margin_m + 0.02
        pairs = self.client.getOverlappingObjects(low.tolist(), high.tolist())
        return sorted({body for body, _ in pairs or ()} - {without} - self._passable)

    def _link_of(self, object_id: str, number: int) -> int:
        """The asset's link to which a link of PyBullet's body belongs; its base is number -1."""
        return _compounds(self._assets[object_id])[number + 1].link

    def _static_boxes(self, boxes: Sequence[Box]) -> list[int]:
        bodies = []
        for start in range(0, len(boxes), MAX_COMPOUND):
            chunk = np.array(boxes[start : start + MAX_COMPOUND])
            shape = self._compound((chunk[:, 3:] - chunk[:, :3]) / 2, (chunk[:, 3:] + chunk[:, :3]) / 2, None)
            bodies.append(int(self.client.createMultiBody(0, shape)))
        return bodies

    def _compound(self, halves: F64, centres: F64, quaternions: F64 | None) -> int:
        count = len(halves)
        if quaternions is None:
            quaternions = np.tile([0.0, 0.0, 0.0, 1.0], (count, 1))
        return int(
            self.client.createCollisionShapeArray(
                shapeTypes=[pybullet.GEOM_BOX] * count,
                halfExtents=halves.tolist(),
                collisionFramePositions=centres.tolist(),
                collisionFrameOrientations=quaternions.tolist(),
            )
        )

    def _create(self, asset: Asset, state: ObjectState) -> int:
        mass = 0.0 if state.is_fixed else max(object_type(asset.spec.type).mass_kg or 0.0, MIN_MASS_KG)
        origins = [_origin(link) for link in asset.links]
        compounds, links = _compounds(asset), []
        for (i, start), boxes in zip(compounds, _boxes(asset), strict=True):
            link, shape = asset.links[i], -1 if boxes is None else self._compound(*boxes)
            if start == 0:
                parent = compounds.index(_Compound(link.parent, 0))
                links.append(_BodyLink(shape, parent, origins[i] - origins[link.parent], link.joint))
            else:
                links.append(_BodyLink(shape, compounds.index(_Compound(i, 0)), np.zeros(3), None))
        base, *links = links
        link_mass = mass / (4 * len(links)) if mass and links else 0.1
        zeros, identities = [[0.0] * 3 for _ in links], [[0.0, 0.0, 0.0, 1.0] for _ in links]
        body = self.client.createMultiBody(
            baseMass=mass,
            baseCollisionShapeIndex=base.shape,
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
        )
        for link_index in range(-1, len(links)):
            self.client.changeDynamics(
                body,
                link_index,
                lateralFriction=FRICTION,
                rollingFriction=ROLLING_FRICTION,
                spinningFriction=ROLLING_FRICTION,
                linearDamping=LINEAR_DAMPING,
                angularDamping=ANGULAR_DAMPING,
                restitution=0.0,
            )
        for joint in _joints(asset):  # hold every joint where it is told to be
            self.client.setJointMotorControl2(body, joint, pybullet.VELOCITY_CONTROL, targetVelocity=0.0, force=1000.0)
        return int(body)


class _Compound(NamedTuple):
    """Some of the boxes of an asset's link: those from one on, as many as PyBullet takes."""

    link: int
    start: int


@lru_cache(maxsize=1024)
def _compounds(asset: Asset) -> tuple[_Compound, ...]:
    """The compounds of which PyBullet's body consists, the base first; what it calls link n is number n + 1 here.

    They are in PyBullet's own order, which is depth first, whatever order they are given in: each link, then the links that
    hang on it, then those of its boxes that did not fit into its own compound, fixed to it.
    """

    def of(link: int) -> list[_Compound]:
        found = [_Compound(link, 0)]
        for child, other in enumerate(asset.links):
            if other.joint is not None and other.parent == link:
                found += of(child)
        return found + [
            _Compound(link, start) for start in range(MAX_COMPOUND, len(asset.links[link].boxes), MAX_COMPOUND)
        ]

    return tuple(of(0))


@lru_cache(maxsize=1024)
def _boxes(asset: Asset) -> list[tuple[F64, F64, F64] | None]:
    """Half sizes, centres from the link's origin, and quaternions, of the boxes of each compound; None if it has none."""
    found: list[tuple[F64, F64, F64] | None] = []
    for number, start in _compounds(asset):
        link = asset.links[number]
        boxes = link.boxes[start : start + MAX_COMPOUND]
        if not boxes:
            found.append(None)
            continue
        halves = np.array([box.size for box in boxes]) / 2
        centres = np.array([box.centre for box in boxes]) - _origin(link)
        found.append((halves, centres, np.array([box.quaternion for box in boxes])))
    return found


def _origin(link: Link) -> F64:
    """(3,) where its joint is in the closed asset."""
    return np.zeros(3) if link.joint is None else np.asarray(link.joint.origin)


@lru_cache(maxsize=1024)
def _joints(asset: Asset) -> tuple[int, ...]:
    """PyBullet's number of the joint of each link but the base."""
    compounds = _compounds(asset)
    return tuple(compounds.index(_Compound(link, 0)) - 1 for link in range(1, len(asset.links)))


_JOINT_TYPES = {"revolute": pybullet.JOINT_REVOLUTE, "prismatic": pybullet.JOINT_PRISMATIC}


@dataclass(frozen=True)
class _BodyLink:
    """A link as PyBullet wants it: parent 0 is the base, and the offset is from the parent's origin."""

    shape: int
    parent: int
    offset: F64
    joint: Joint | None
