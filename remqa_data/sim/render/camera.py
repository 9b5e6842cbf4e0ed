"""Where pictures are taken from: a pinhole camera in the room, and a map camera above it.

World frame: right-handed, z up, metres. Yaw in degrees counter-clockwise from +x; horizon in degrees, positive looks
down. Pixel centres lie at +0.5, x to the right and y down from the top left corner of the image. Depth is the
distance along the camera's forward axis in metres.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple, Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, I64, Flags, Vec3

NEAR_M = 0.02
"""Nothing closer than this is drawn: short, because cameras can be close to doors."""


_Number = TypeVar("_Number", float, F64)


class Scissor(NamedTuple):
    """The part of a picture that is drawn: its first and last column and row; none where the last one is before the first."""

    left: int
    right: int
    top: int
    bottom: int

    @classmethod
    def whole(cls, width: int, height: int) -> Scissor:
        """All of a picture."""
        return cls(0, width - 1, 0, height - 1)


class View(NamedTuple):
    """A camera as the rasteriser reads it.

    With d = point - eye, a point has homogeneous image coordinates (axes[0] . d, axes[1] . d, w), in pixels from the
    image centre, y down; its depth is axes[2] . d; and w is that depth for a pinhole, 1 for a parallel projection.
    """

    eye: F64
    """(3,) metres."""
    axes: F64
    """(3, 3): right and down, scaled to pixels, and forward."""
    inverse: F64
    """(3, 3) inverse of `axes`: its columns are one pixel right, one pixel down and one metre forward, in metres."""
    pinhole: bool
    width: int
    height: int
    scissor: Scissor
    """Pixels beyond it are not drawn; those in it are as in the whole picture, to the bit, but that along its border no edge is
    smoothed."""

    @classmethod
    def of(cls, eye: npt.ArrayLike, axes: F64, *, pinhole: bool, width: int, height: int) -> View:
        """A view with its inverse.

        Raises
        ------
        ValueError
            If a number is not finite, the picture has no pixels, or nothing fits into its field of view.
        """
        where = np.array(eye, dtype=np.float64)
        if (
            min(width, height) < 1
            or not np.isfinite(where).all()
            or not (np.isfinite(axes).all() and axes.any(axis=1).all())
        ):
            msg = f"no camera: at {where.tolist()}, {width} x {height} pixels, axes {axes.tolist()}"
            raise ValueError(msg)
        return cls(where, axes, _inverse(axes), pinhole, width, height, Scissor.whole(width, height))

    @property
    def is_whole(self) -> bool:
        """Whether all of the picture is drawn."""
        return self.scissor == Scissor.whole(self.width, self.height)


def scissor_around(view: View, points: F64, margin_px: int = 1) -> Scissor:
    """What a picture shows of the convex hull of (n, 3) points, and a margin; all of it if one is not before a camera.

    What is out of the picture has no columns, or no rows: the last one is that before the first.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        x, y, depth = _project(view, points).T
    if view.pinhole and depth.min() < NEAR_M:
        return Scissor.whole(view.width, view.height)
    edges = []
    for at, size in ((x, view.width), (y, view.height)):
        first, stop = math.floor(at.min()) - margin_px, math.floor(at.max()) + margin_px + 1
        edges += [min(max(first, 0), size), min(max(stop, 0), size) - 1]
    return Scissor(*edges)


SLACK_PX = 1e-3
"""So much beyond its border a point still counts as in the picture, for what rounding may do."""


def are_outside(view: View, points: F64) -> Flags:
    """(...,) whether no point between (..., n, 3) points of the room can be in a picture, as all are beyond one border."""
    x, y, depth = np.moveaxis(arithmetic.turned(points - view.eye, view.axes), -1, 0)
    scale = depth if view.pinhole else np.ones_like(depth)
    outside = (depth < 0.0).all(axis=-1)
    for across, pixels in ((x, view.width), (y, view.height)):
        edge = 0.5 * pixels * scale + SLACK_PX
        outside |= (across > edge).all(axis=-1) | (-across > edge).all(axis=-1)
    return np.asarray(outside)


class Windows(NamedTuple):
    """Many square pinhole views, each of which looks straight at a point; as `View`."""

    eye: F64
    """(n, 3) metres."""
    axes: F64
    """(n, 3, 3)."""
    inverse: F64
    """(n, 3, 3)."""
    side: I64
    """(n,) pixels along each side."""

    @classmethod
    def looking_at(cls, eyes: F64, targets: F64, side: I64, focal_px: float) -> Windows:
        """Views from (n, 3) eyes to (n, 3) targets, of some sides in pixels, and of one focal length.

        Each is the middle of what a level camera there shows, to the last bit: `Camera.look_at(...).view()`.
        """
        half_deg = np.degrees(arithmetic.arctan2(side / 2, np.full(len(side), focal_px)))
        sine, cosine = arithmetic.sin_cos_deg(half_deg)
        focal = (0.5 * side * cosine / sine)[:, None]
        dx, dy, dz = (targets - eyes).T
        yaw = arithmetic.sin_cos_deg(np.degrees(arithmetic.arctan2(dy, dx)))
        pitch = arithmetic.sin_cos_deg(np.degrees(arithmetic.arctan2(-dz, np.sqrt(dx * dx + dy * dy))))
        right, up, forward = np.moveaxis(_level(*yaw, *pitch), -1, 1)
        # Row after row in memory, as those of other views are: kernels are compiled for each way.
        axes = np.ascontiguousarray(np.stack([right * focal, -up * focal, forward], axis=1))
        return cls(eyes, axes, _inverse(axes), side)


class AnyCamera(Protocol):
    """What the renderer asks of a camera."""

    def view(self) -> View:
        """The camera as the rasteriser reads it."""
        ...


class _Projecting(ABC):
    """From the room to the image and back."""

    width: int
    height: int

    @abstractmethod
    def view(self) -> View:
        """The camera as the rasteriser reads it."""

    def project(self, points: npt.ArrayLike) -> F64:
        """Image position of world points.

        Parameters
        ----------
        points : (n, 3) array
            Metres, world frame.

        Returns
        -------
        (n, 3) float64: pixel x, pixel y, depth. Behind the camera the depth is negative and the pixel means nothing.
        """
        return _project(self.view(), points)

    def are_framed(self, projected: F64) -> Flags:
        """(n,) which of (n, 3) points, as `project` gives them, are before the camera and in the picture."""
        x, y, depth = projected.T
        return np.asarray((depth > 0) & (x >= 0) & (y >= 0) & (x < self.width) & (y < self.height))

    def unproject(self, depth: npt.ArrayLike) -> F64:
        """World point that each pixel of a (h, w) depth image shows, (h, w, 3) float64; inverse of `project`."""
        return _unproject(self.view(), depth)


@dataclass(frozen=True)
class Camera(_Projecting):
    """A pinhole camera with square pixels.

    Attributes
    ----------
    position : tuple of float
        Metres, world frame.
    yaw_deg, horizon_deg : float
        Where it looks.
    fov_deg : float
        Vertical field of view.
    width, height : int
        Pixels.
    roll_deg : float
        How far it is turned about where it looks, counter-clockwise as seen from behind it.
    """

    position: Vec3
    yaw_deg: float
    horizon_deg: float = 0.0
    fov_deg: float = 90.0
    width: int = 300
    height: int = 300
    roll_deg: float = 0.0

    def __post_init__(self) -> None:
        if not isinstance(self.position, tuple):  # an array, say
            x, y, z = map(float, self.position)
            object.__setattr__(self, "position", (x, y, z))

    @classmethod
    def look_at(cls, eye: Vec3, target: Vec3, *, fov_deg: float = 90.0, width: int = 300, height: int = 300) -> Camera:
        """A level camera at `eye` with `target` in the middle of its image."""
        dx, dy, dz = (float(t) - float(e) for e, t in zip(eye, target, strict=True))
        return cls(
            position=eye,
            yaw_deg=math.degrees(arithmetic.arctan2(dy, dx)),
            horizon_deg=math.degrees(arithmetic.arctan2(-dz, math.sqrt(dx * dx + dy * dy))),
            fov_deg=fov_deg,
            width=width,
            height=height,
        )

    @property
    def focal_px(self) -> float:
        """Focal length in pixels.

        Raises
        ------
        ValueError
            If the field of view is not between 0 and 180 degrees.
        """
        if not 0.0 < self.fov_deg < 180.0:
            raise ValueError(f"fov_deg is {self.fov_deg}: a pinhole camera sees more than 0 and less than 180 degrees")
        sine, cosine = arithmetic.sin_cos_deg(self.fov_deg / 2)
        return float(0.5 * self.height * cosine / sine)

    def rotation(self) -> F64:
        """(3, 3) unit rows: right, up, forward, in the world frame."""
        return _looking(self.yaw_deg, self.horizon_deg, self.roll_deg)

    def view(self) -> View:
        """The camera as the rasteriser reads it."""
        return _pinhole_view(self)


@dataclass(frozen=True)
class OrthographicCamera(_Projecting):
    """A camera with a parallel projection. What is behind it is cut off.

    Attributes
    ----------
    position : tuple of float
        Metres, world frame.
    half_height_m : float
        Metres from the middle of the image to its upper side.
    yaw_deg, horizon_deg, roll_deg : float
        As of `Camera`.
    width, height : int
        Pixels.
    """

    position: Vec3
    half_height_m: float
    yaw_deg: float = 90.0
    horizon_deg: float = 90.0
    roll_deg: float = 0.0
    width: int = 300
    height: int = 300

    def rotation(self) -> F64:
        """(3, 3) unit rows: right, up, forward, in the world frame."""
        return _looking(self.yaw_deg, self.horizon_deg, self.roll_deg)

    def view(self) -> View:
        """The camera as the rasteriser reads it."""
        return _parallel_view(self.position, self.rotation(), _scale(self.height, 2.0 * self.half_height_m), self)


@dataclass(frozen=True)
class TopDownCamera(_Projecting):
    """A map: parallel projection, looking straight down, image right is +x and image up is +y.

    Attributes
    ----------
    centre_xy : tuple of float
        World point in the middle of the image.
    height_m : float
        z of the camera. What is above it is cut off, such as the ceiling and the tops of the walls, and what is more than
        128 m below.
    extent_m : float
        Metres that the shorter side of the image covers.
    width, height : int
        Pixels.
    """

    centre_xy: tuple[float, float]
    height_m: float
    extent_m: float
    width: int = 300
    height: int = 300

    @property
    def pixels_per_m(self) -> float:
        """Scale of the map."""
        return _scale(min(self.width, self.height), self.extent_m)

    def rotation(self) -> F64:
        """(3, 3) unit rows: right, up, forward, in the world frame."""
        return np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]])

    def view(self) -> View:
        """The camera as the rasteriser reads it."""
        return _parallel_view((*self.centre_xy, self.height_m), self.rotation(), self.pixels_per_m, self)


def _looking(yaw_deg: float, horizon_deg: float, roll_deg: float) -> F64:
    """(3, 3) unit rows, right, up and forward, of a camera that looks somewhere."""
    sin_yaw, cos_yaw = (float(v) for v in arithmetic.sin_cos_deg(yaw_deg))
    sin_pitch, cos_pitch = (float(v) for v in arithmetic.sin_cos_deg(horizon_deg))
    level = _level(sin_yaw, cos_yaw, sin_pitch, cos_pitch)
    if roll_deg == 0.0:
        return level
    sin_roll, cos_roll = (float(v) for v in arithmetic.sin_cos_deg(roll_deg))
    right, up, forward = level
    return np.stack([cos_roll * right + sin_roll * up, cos_roll * up - sin_roll * right, forward])


def _level(sin_yaw: _Number, cos_yaw: _Number, sin_pitch: _Number, cos_pitch: _Number) -> F64:
    """(3, 3) or, of (n,) angles each, (3, 3, n) rows: right, up and forward, of cameras that are not rolled."""
    return np.array(
        [
            [sin_yaw, -cos_yaw, sin_yaw - sin_yaw],
            [sin_pitch * cos_yaw, sin_pitch * sin_yaw, cos_pitch],
            [cos_pitch * cos_yaw, cos_pitch * sin_yaw, -sin_pitch],
        ]
    )


def _inverse(axes: F64) -> F64:
    """Inverses of (..., 3, 3) axes, which are at right angles."""
    return np.ascontiguousarray(np.swapaxes(axes, -1, -2) / arithmetic.dot(axes, axes)[..., None, :])


@lru_cache(maxsize=1024)  # one camera looks, and then points are looked up in its image
def _pinhole_view(camera: Camera) -> View:
    right, up, forward = camera.rotation()
    focal = camera.focal_px
    axes = np.stack([right * focal, -up * focal, forward])
    return View.of(camera.position, axes, pinhole=True, width=camera.width, height=camera.height)


def _scale(size_px: int, size_m: float) -> float:
    """Pixels per metre of a parallel projection; ValueError if it shows nothing, or everything."""
    if not 0.0 < size_m < math.inf:
        raise ValueError(f"no camera: what it shows is {size_m} m high; give a size that is positive and finite")
    return size_px / size_m


def _parallel_view(eye: Vec3, rotation: F64, pixels_per_m: float, image: OrthographicCamera | TopDownCamera) -> View:
    right, up, forward = rotation
    axes = np.stack([right * pixels_per_m, -up * pixels_per_m, forward])
    return View.of(eye, axes, pinhole=False, width=image.width, height=image.height)


def _project(view: View, points: npt.ArrayLike) -> F64:
    image = arithmetic.turned(np.asarray(points, dtype=np.float64).reshape(-1, 3) - view.eye, view.axes)
    if view.pinhole:
        image[:, :2] /= image[:, 2:]
    image[:, 0] += 0.5 * view.width
    image[:, 1] += 0.5 * view.height
    return image


def _unproject(view: View, depth: npt.ArrayLike) -> F64:
    distance = np.asarray(depth, dtype=np.float64)
    image = np.empty((view.height, view.width, 3))
    image[..., 0] = np.arange(view.width) + 0.5 - 0.5 * view.width
    image[..., 1] = (np.arange(view.height) + 0.5 - 0.5 * view.height)[:, None]
    if view.pinhole:
        image[..., :2] *= distance[..., None]
    image[..., 2] = distance
    points: F64 = view.eye + arithmetic.turned(image, view.inverse)
    return points
