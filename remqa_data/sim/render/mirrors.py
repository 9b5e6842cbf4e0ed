"""What does a mirror show? A kernel that looks reflected rays up in pictures of the room, taken once from each mirror.

Each mirror has a map: pictures with depth over the half space in front of it, seen from a point before its middle. A ray
that leaves another point of the mirror is followed until it is as far away as what the map shows in its direction, as in
Szirmay-Kalos et al., Approximate Ray-Tracing on the GPU with Distance Impostors, 2005.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from remqa_data.compiled import exact
from remqa_data.geometry.types import F32, F64, I32
from remqa_data.sim.render import pixels as px
from remqa_data.sim.render.camera import View
from remqa_data.sim.render.raster import Buffers, Geometry

_F = np.float32
SIDES = 5
"""Pictures of a map, each 90 degrees wide: ahead, then towards its right, left, up and down."""
_FIRST_M, _GROWTH, _STEPS = 0.1, 1.55, 11
"""Where a ray is looked at: this far from the mirror, then farther by this factor; it ends after 12 m."""
_REFINEMENTS = 3
_GUESSES, _WIDE, _NEAR = 3, 0.3, 0.03
"""A guess is mended so often; it is worth it, and as good as right, if what the map shows there is as far as the ray to
these shares of its distance."""
_MISS = 0.12
"""What a ray meets counts if it is where the ray is, to this share of its distance; else the ray goes on behind it."""


class Mirrors(NamedTuple):
    """The maps of all mirrors, and who shows them."""

    of_surface: I32
    """(s,) map of each surface if it is a mirror, -1 where there is none."""
    frames: F32
    """(k, 4, 3) unit vectors to the right, up and ahead, as seen from the mirror; and the point, metres, world frame."""
    texels: F32
    """(k, 5, n, n, 4) linear red, green and blue as pictures show them, and 1 / depth, 0 where nothing is."""


def no_mirrors(surfaces: int) -> Mirrors:
    """Maps of a room without mirrors."""
    nothing = np.full(surfaces, -1, dtype=np.int32)
    return Mirrors(nothing, np.zeros((0, 4, 3), dtype=np.float32), np.zeros((0, SIDES, 1, 1, 4), dtype=np.float32))


def side_views(frame: F64, size: int) -> list[View]:
    """The pinhole views of a map's pictures, in the order that `reflect` looks them up; a frame as in `Mirrors`."""
    right, up, ahead, eye = frame
    directions = (
        (right, -up, ahead),
        (-ahead, -up, right),
        (ahead, -up, -right),
        (right, ahead, up),
        (right, -ahead, -up),
    )
    scale = np.array([[0.5 * size], [0.5 * size], [1.0]])
    return [View.of(eye, np.array(axes) * scale, pinhole=True, width=size, height=size) for axes in directions]


@exact
def reflect(
    geometry: Geometry,
    view: View,
    buffers: Buffers,
    share: F32,
    mirrors: Mirrors,
    y: int,
    start: int,
    sheet: F32,
    count: int,
) -> None:
    """Mix what mirrors show into the light of those pixels of a row that show one; a share of each surface's light."""
    size = mirrors.texels.shape[2]
    texels = mirrors.texels.reshape(-1)
    stop = 0
    while stop < count:
        first = stop
        slot = buffers.slot[y, start + first]
        stop = first + 1
        while stop < count and buffers.slot[y, start + stop] == slot:
            stop += 1
        if slot < 0:
            continue
        surface = geometry.face_surface[buffers.record_face[slot]]
        number = mirrors.of_surface[surface]
        if number >= 0:
            base = number * SIDES * size * size * 4
            _reflect_run(view, share[surface], mirrors.frames[number], texels, base, size, sheet[first:], stop - first)


@exact
def _reflect_run(view: View, share: _F, frame: F32, texels: F32, base: int, size: int, run: F32, count: int) -> None:
    """Mix what one mirror shows into the light of neighbouring pixels."""
    one, zero = np.float32(1.0), np.float32(0.0)
    ex, ey, ez = np.float32(view.eye[0]), np.float32(view.eye[1]), np.float32(view.eye[2])
    fx, fy, fz = np.float32(view.axes[2, 0]), np.float32(view.axes[2, 1]), np.float32(view.axes[2, 2])
    rx, ry, rz, ux, uy, uz = frame[0, 0], frame[0, 1], frame[0, 2], frame[1, 0], frame[1, 1], frame[1, 2]
    ax, ay, az, cx, cy, cz = frame[2, 0], frame[2, 1], frame[2, 2], frame[3, 0], frame[3, 1], frame[3, 2]
    far = zero
    for i in range(count):
        x, y, z = run[px.X + i], run[px.Y + i], run[px.Z + i]
        dx, dy, dz = (x - ex, y - ey, z - ez) if view.pinhole else (fx, fy, fz)
        scale = one / math.sqrt(dx * dx + dy * dy + dz * dz + np.float32(1e-20))
        ahead = -(dx * ax + dy * ay + dz * az) * scale
        if ahead <= zero:
            continue
        aside, above = (dx * rx + dy * ry + dz * rz) * scale, (dx * ux + dy * uy + dz * uz) * scale
        ox, oy, oz = x - cx, y - cy, z - cz
        ox, oy, oz = ox * rx + oy * ry + oz * rz, ox * ux + oy * uy + oz * uz, ox * ax + oy * ay + oz * az
        far = _follow(texels, base, size, far, ox, oy, oz, aside, above, ahead)
        red, green, blue = _colour(texels, base, size, ox + far * aside, oy + far * above, oz + far * ahead)
        run[px.LIGHT_RED + i] += share * (red - run[px.LIGHT_RED + i])
        run[px.LIGHT_GREEN + i] += share * (green - run[px.LIGHT_GREEN + i])
        run[px.LIGHT_BLUE + i] += share * (blue - run[px.LIGHT_BLUE + i])


@exact
def _follow(texels: F32, base: int, size: int, guess: _F, ox: _F, oy: _F, oz: _F, dx: _F, dy: _F, dz: _F) -> _F:
    """How far a ray goes until it meets something: from a point, in a unit direction, both in the frame of a map.

    The guess is how far the ray beside it went; most rays meet the same plane, which takes four looks instead of ten.
    """
    one, zero, near, wide = np.float32(1.0), np.float32(0.0), np.float32(_NEAR), np.float32(_WIDE)
    s = guess
    for _ in range(_GUESSES):
        if s <= zero:
            break
        at_s = _nearness(texels, base, size, ox + s * dx, oy + s * dy, oz + s * dz)
        if abs(at_s - one) < near:
            first, second, third = np.float32(0.4) * s, np.float32(0.7) * s, np.float32(0.88) * s
            if (
                _nearness(texels, base, size, ox + third * dx, oy + third * dy, oz + third * dz) < one
                and _nearness(texels, base, size, ox + second * dx, oy + second * dy, oz + second * dz) < one
                and _nearness(texels, base, size, ox + first * dx, oy + first * dy, oz + first * dz) < one
            ):
                return s / at_s
            break
        s = s / at_s if abs(at_s - one) < wide else zero
    growth, miss = np.float32(_GROWTH), np.float32(_MISS)
    low, at_low, high = zero, zero, np.float32(_FIRST_M)
    for _ in range(_STEPS):
        at_high = _nearness(texels, base, size, ox + high * dx, oy + high * dy, oz + high * dz)
        if at_high >= one and at_low < one:
            # Along a ray, nearness to a plane grows evenly: where one plane is met, the first guess is right.
            a, at_a, b, at_b = low, at_low, high, at_high
            at_s = at_b
            for _ in range(_REFINEMENTS):
                s = a + (b - a) * (one - at_a) / (at_b - at_a)
                at_s = _nearness(texels, base, size, ox + s * dx, oy + s * dy, oz + s * dz)
                if at_s >= one:
                    b, at_b = s, at_s
                else:
                    a, at_a = s, at_s
            if abs(at_s - one) < miss:
                return s
        low, at_low = high, at_high
        high = high * growth
    return high


@exact
def _nearness(texels: F32, base: int, size: int, x: _F, y: _F, z: _F) -> _F:
    """How far a point is, as a share of how far one sees in its direction: 1 where it lies on what is seen."""
    side, across, down, depth = _place(size, x, y, z)
    nearness: _F = (
        depth * texels[base + ((side * size + min(int(down), size - 1)) * size + min(int(across), size - 1)) * 4 + 3]
    )
    return nearness


@exact
def _place(size: int, x: _F, y: _F, z: _F) -> tuple[int, _F, _F, _F]:
    """Picture of a map that shows a point, where in it (pixels from its corner), and the point's depth."""
    wide, tall, zero = abs(x), abs(y), np.float32(0.0)
    if z >= wide and z >= tall:
        side, u, v, depth = 0, x, -y, z
    elif wide >= tall:
        side, u, v, depth = (1, -z, -y, x) if x > zero else (2, z, -y, -x)
    else:
        side, u, v, depth = (3, x, z, y) if y > zero else (4, x, -z, -y)
    depth = max(depth, np.float32(1e-6))
    half = np.float32(0.5) * np.float32(size)
    scale = half / depth
    across = min(max(u * scale + half, zero), half + half)
    down = min(max(v * scale + half, zero), half + half)
    return side, across, down, depth


@exact
def _colour(texels: F32, base: int, size: int, x: _F, y: _F, z: _F) -> tuple[_F, _F, _F]:
    """Red, green and blue that a map shows in the direction of a point, mixed from the four pixels around it."""
    side, across, down, _ = _place(size, x, y, z)
    half, one, zero, last = np.float32(0.5), np.float32(1.0), np.float32(0.0), np.float32(size - 1)
    across, down = min(max(across - half, zero), last), min(max(down - half, zero), last)
    left, top = min(int(across), size - 2), min(int(down), size - 2)
    u, v = across - np.float32(left), down - np.float32(top)
    a = base + ((side * size + top) * size + left) * 4
    c = a + size * 4
    wa, wb, wc, wd = (one - u) * (one - v), u * (one - v), (one - u) * v, u * v
    red = wa * texels[a] + wb * texels[a + 4] + wc * texels[c] + wd * texels[c + 4]
    green = wa * texels[a + 1] + wb * texels[a + 5] + wc * texels[c + 1] + wd * texels[c + 5]
    blue = wa * texels[a + 2] + wb * texels[a + 6] + wc * texels[c + 2] + wd * texels[c + 6]
    return red, green, blue
