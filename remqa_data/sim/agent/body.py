"""The agent as a body: where it stands and looks, what it sees, and how it walks."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from remqa_data.errors import ActionError
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Flags, Vec2, Vec3
from remqa_data.sim.agent.results import SUCCEEDED, ActionResult
from remqa_data.sim.navigation.embodiment import Embodiment
from remqa_data.sim.navigation.grid import ReachableGrid, reach_distance
from remqa_data.sim.navigation.ground import Ground
from remqa_data.sim.navigation.viewpoints import FRAME_PX, MIN_PIXELS
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.camera import AnyCamera, Camera
from remqa_data.sim.render.view import WorldView


class Body:
    """What `remqa_data.sim.agent.agent.Agent` is without its hands; see there for the parameters.

    Notes
    -----
    A subclass may say what else happens when the body moves, and what else is in its way: `_prepare_to_move` is called before
    it moves, `_face` to turn it, and `_arrive` after a teleport; `_blocker`, `_blocker_of_turn` and `_blocker_at` name what
    keeps it from a step, a turn, and from standing somewhere. None of them is called while it is made.
    """

    def __init__(
        self,
        world: World,
        view: WorldView,
        position: Sequence[float],
        yaw_deg: float,
        horizon_deg: float = 0.0,
        is_standing: bool = True,
        *,
        embodiment: Embodiment | None = None,
    ) -> None:
        self.world, self.view = world, view
        self.embodiment = embodiment or Embodiment()
        self.ground = Ground(world, self.embodiment)
        _check_finite(*position, yaw_deg, horizon_deg)
        self.x, self.y = float(position[0]), float(position[1])
        self.yaw_deg, self.horizon_deg, self.is_standing = _turn(float(yaw_deg)), float(horizon_deg), is_standing

    # ---- where it is

    def place(
        self, position: Sequence[float], yaw_deg: float, horizon_deg: float = 0.0, is_standing: bool = True
    ) -> None:
        """Put the agent somewhere, unchecked."""
        _check_finite(*position, yaw_deg, horizon_deg)
        self._prepare_to_move()
        self.x, self.y = float(position[0]), float(position[1])
        self._face(float(yaw_deg))
        self.horizon_deg = float(horizon_deg)
        self.is_standing = is_standing

    @property
    def position(self) -> Vec3:
        """The middle of its base on the floor, metres."""
        return self.x, self.y, self.world.scene.floor_z

    @property
    def grid(self) -> ReachableGrid:
        """Where it could stand, in the room as it is now: cells 0.25 m apart, whatever its own step is."""
        return self.ground.grid()

    def camera(self, width: int = FRAME_PX, height: int = FRAME_PX) -> Camera:
        """Its eye."""
        body = self.embodiment
        eye = (self.x, self.y, self.world.scene.floor_z + body.eye_height_m(self.is_standing))
        return Camera(eye, self.yaw_deg, self.horizon_deg, body.fov_deg, width, height)

    # ---- what it sees

    def object_at(self, x: float, y: float, camera: AnyCamera | None = None) -> str | None:
        """Id of the object at a point of its view, shares (0 to 1) of the width and height from the top left corner.

        With a camera, at a point of that one's.

        Raises
        ------
        ActionError
            If the point is not in the image.
        """
        if not (0.0 <= x <= 1.0 and 0.0 <= y <= 1.0):
            raise ActionError(f"the image point ({x}, {y}) is not between (0, 0) and (1, 1)")
        image = self.view.instances(camera or self.camera())
        height, width = image.shape
        index = image[min(int(y * height), height - 1), min(int(x * width), width - 1)]
        return self.world.ids[index] if index >= 0 else None

    def visible_objects(self, distance_m: float | None = None) -> list[str]:
        """Ids of the objects that it sees, in the scene's order; with a distance, those nearer in plan, metres."""
        seen = self.view.pixels(self.camera()) >= MIN_PIXELS
        ids = [self.world.ids[index] for index in np.flatnonzero(seen)]
        return ids if distance_m is None else [name for name in ids if self.plan_distance(name) <= distance_m]

    def are_seen(self, points: F64) -> Flags:
        """(n,) which of (n, 3) points in the room, metres, are in its view with nothing in front of them."""
        camera = self.camera()
        projected = camera.project(points)
        is_seen = camera.are_framed(projected)
        if is_seen.any():
            x, y, away = projected[is_seen].T
            depth = self.view.depth(camera)[y.astype(int), x.astype(int)]
            is_seen[is_seen] = (depth == 0.0) | (depth > away)
        return is_seen

    # ---- walking and looking

    def move(self, ahead_m: float, right_m: float = 0.0, force: bool = False) -> ActionResult:
        """Walk straight; with `force` through anything."""
        _check_finite(ahead_m, right_m)
        cos, sin = direction(self.yaw_deg)
        x = self.x + ahead_m * cos + right_m * sin
        y = self.y + ahead_m * sin - right_m * cos
        return self._go(x, y, None if force else self._blocker((self.x, self.y), (x, y)))

    def rotate(self, degrees: float) -> ActionResult:
        """Turn, counter-clockwise."""
        _check_finite(degrees)
        blocker = self._blocker_of_turn(degrees)
        if blocker is not None:
            return ActionResult(False, f"{blocker} is blocking Agent from turning", blocked_by=blocker)
        self._prepare_to_move()
        self._face(self.yaw_deg + degrees)
        return SUCCEEDED

    def look(self, degrees: float) -> ActionResult:
        """Tilt the camera; positive is down."""
        refusal = self.tilt_refusal(self.horizon_deg + degrees)
        if refusal is None:
            self.horizon_deg += degrees
        return refusal or SUCCEEDED

    def teleport(
        self,
        x: float | None = None,
        y: float | None = None,
        yaw_deg: float | None = None,
        horizon_deg: float | None = None,
        is_standing: bool | None = None,
        force: bool = False,
    ) -> ActionResult:
        """Be somewhere else, if the agent can stand there and look so; what is not given stays as it is."""
        x, y = self.x if x is None else float(x), self.y if y is None else float(y)
        horizon = self.horizon_deg if horizon_deg is None else float(horizon_deg)
        yaw = self.yaw_deg if yaw_deg is None else float(yaw_deg)
        _check_finite(x, y, yaw, horizon)
        stays = (x, y) == (self.x, self.y)  # where it is, it is, whatever has come there since
        refusal = None if force else self.tilt_refusal(horizon)
        result = refusal or self._go(x, y, None if force or stays else self._blocker_at(x, y))
        if result.success:
            turns = _turn(yaw) != self.yaw_deg
            self.place((x, y), yaw, horizon, self.is_standing if is_standing is None else is_standing)
            if turns or not stays:
                self._arrive()
        return result

    def crouch(self) -> ActionResult:
        """Lower the camera."""
        return self._take_posture(False)

    def stand(self) -> ActionResult:
        """Stand up."""
        return self._take_posture(True)

    # ---- distances

    def reach_distance(self, object_id: str) -> float:
        """Metres from the shoulder, at its best height and facing an object, to the object."""
        return reach_distance((self.x, self.y), self.world.scene.floor_z, self._nearest_point(object_id))

    def plan_distance(self, object_id: str) -> float:
        """Metres in plan from the middle of the agent to an object."""
        return math.dist((self.x, self.y), self._nearest_point(object_id)[:2])

    # ---- helpers

    def _prepare_to_move(self) -> None:
        """Called before the body moves."""

    def _arrive(self) -> None:
        """Called when the body has been put somewhere else, or faces another way there."""

    def _face(self, yaw_deg: float) -> None:
        """Have a heading."""
        self.yaw_deg = _turn(yaw_deg)

    def _blocker(self, start: Vec2, end: Vec2) -> str | None:
        """What keeps the body from a straight step, by the name that it has in errors."""
        return self.ground.blocker(start, end)

    def _blocker_of_turn(self, degrees: float) -> str | None:
        """What keeps the body, which is round, from turning."""
        return None

    def _blocker_at(self, x: float, y: float) -> str | None:
        """What keeps the body from standing at a point."""
        return self.ground.blocker_at(x, y)

    def _go(self, x: float, y: float, blocker: str | None) -> ActionResult:
        if blocker is not None:
            return ActionResult(False, f"{blocker} is blocking Agent from moving", blocked_by=blocker)
        self._prepare_to_move()
        self.x, self.y = x, y
        return SUCCEEDED

    def _nearest_point(self, object_id: str) -> F64:
        """The point of an object's closed box that is nearest to the agent and to the heights of its shoulder."""
        state = self.world.state(object_id)
        half = np.array(self.world.assets[object_id].spec.size) / 2
        frame = state.matrix()
        low, high = self.embodiment.shoulder_low_m, self.embodiment.shoulder_high_m
        height = min(max(state.position[2] - self.world.scene.floor_z, low), high)
        shoulder = np.array([self.x, self.y, self.world.scene.floor_z + height])
        local = np.clip(arithmetic.moved_back(shoulder, frame), -half, half)
        return arithmetic.moved(local, frame)

    def tilt_refusal(self, horizon_deg: float) -> ActionResult | None:
        """Why the camera cannot look so far up or down, or None."""
        least, most = self.embodiment.least_horizon_deg, self.embodiment.most_horizon_deg
        if least - 1e-6 <= horizon_deg <= most + 1e-6:
            return None
        return ActionResult(False, f"the camera tilts from {least:g} to {most:g} degrees, not to {horizon_deg:g}")

    def _take_posture(self, is_standing: bool) -> ActionResult:
        if self.is_standing == is_standing:
            return ActionResult(False, f"the agent is {'standing' if is_standing else 'crouching'} already")
        self.is_standing = is_standing
        return SUCCEEDED


def direction(yaw_deg: float) -> tuple[float, float]:
    """Cosine and sine; exact along the grid, so that whole steps stay on it."""
    sine, cosine = arithmetic.sin_cos_deg(yaw_deg)
    return float(cosine), float(sine)


def _check_finite(*numbers: float) -> None:
    if not all(map(math.isfinite, numbers)):
        raise ActionError(f"{numbers} are not all finite")


def _turn(degrees: float) -> float:
    """Degrees from 0 to below 360; a tiny negative number would round to 360 itself."""
    return degrees % 360.0 % 360.0
