"""Parts that small things share: turned pieces of several materials, loops, rods of varying section."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.model import Material
from remqa_data.assets.core.posed import Posed
from remqa_data.assets.mesh import primitives
from remqa_data.assets.mesh.primitives import Axis, Mesh, Points2
from remqa_data.geometry.types import F64, Vec3

Profile = Sequence[tuple[float, float]] | F64
"""(radius, z) points in metres."""
Piece = tuple[Material, Profile]
"""A material and its stretch of a profile."""
Station = tuple[float, float, float, float]
"""Position along y, width, thickness and height of the middle, in metres."""


def turned(
    b: Builder | Posed,
    pieces: Sequence[Piece],
    at: Vec3 = (0, 0, 0),
    *,
    sections: int = 20,
    power: float = 2.0,
    stretch: tuple[float, float] = (1.0, 1.0),
    axis: Axis = "z",
) -> None:
    """Draw a solid of revolution whose profile is made of pieces of different materials.

    Parameters
    ----------
    pieces : sequence of (material, points)
        One after the other along the profile; every piece after the first starts where the one before it ended.
    power : float
        2 for a round plan, 4 and more for a square plan with rounded corners.
    stretch : tuple of float
        Factors along x and y, for an oval plan.
    axis : Axis
        Where the profile's z points.
    """
    start: list[tuple[float, float]] = []
    for material, pieces_of_it in groupby(pieces, key=lambda piece: piece[0]):  # no crease within a material
        profile = [*start, *((float(r), float(z)) for _, points in pieces_of_it for r, z in points)]
        start = profile[-1:]
        if len(profile) < 2:
            continue
        mesh = squared(primitives.revolve(profile, sections), power).scaled((*stretch, 1.0))
        b.add(mesh.pointed(axis), material, at)


def turned_vessel(
    b: Builder,
    pieces: Sequence[Piece],
    lining: Material,
    at: Vec3 = (0, 0, 0),
    *,
    wall: float,
    floor: float,
    sections: int = 20,
    steps: int = 2,
) -> None:
    """Draw an open vessel from the pieces of its outside, which end at the rim, and declare the space inside it.

    Parameters
    ----------
    lining : Material
        Of the inside, which runs parallel to the outside.
    wall : float
        Thickness in metres.
    floor : float
        Height of the inner floor in metres, unless the spec has a level.
    steps : int
        Points of the inside's curve between floor and rim.
    """
    outside = [(float(r), float(z)) for _, points in pieces for r, z in points]
    rim, top = outside[-1]
    floor = b.level(floor, 0.003, 0.6 * top)
    foot = max(radius_at(outside, floor) - wall, 0.002)
    heights = np.linspace(top - 0.04 * (top - floor), floor + 0.06 * (top - floor), steps)
    side = [(radius_at(outside, z) - wall, float(z)) for z in heights]
    inside = [(rim - wall, top), *side, (foot, floor), (0.0, floor)]
    turned(b, [*pieces, (lining, inside)], at, sections=sections)
    b.hollow([*outside, *inside], at, floor=floor, wall=wall)
    width = 1.4 * (foot + rim - wall) / 2
    b.space("inside", (width, width, top - floor), (at[0], at[1], at[2] + (top + floor) / 2))


def sticker(
    b: Builder,
    material: Material,
    profile: Profile,
    at: Vec3 = (0, 0, 0),
    *,
    share: float = 0.4,
    sections: int = 20,
    power: float = 2.0,
    stretch: tuple[float, float] = (1.0, 1.0),
) -> None:
    """Draw a label on the front of a turned body, half a millimetre off: its texture once over a share of the turn."""
    raised = [(r + 0.0005, z) for r, z in profile]
    mesh = primitives.revolve(raised, sections)
    assert mesh.uv is not None
    half = max(1, round(share * sections / 2)) / sections
    u, v = mesh.uv[:, 0] - 0.75, mesh.uv[:, 1]
    faces = mesh.faces[np.abs(u[mesh.faces].mean(axis=1)) < half]
    uv = np.column_stack([u / (2 * half) + 0.5, (v - v.min()) / max(float(np.ptp(v)), 1e-9)])
    patch = squared(Mesh(mesh.vertices, mesh.normals, faces, uv), power).scaled((*stretch, 1.0))
    used, index = np.unique(patch.faces, return_inverse=True)
    b.add(Mesh(patch.vertices[used], patch.normals[used], index.reshape(-1, 3), uv[used]), material, at)


def radius_at(profile: Profile, z: float) -> float:
    """Radius of a profile that never runs down, at a height."""
    points = np.asarray(profile, dtype=np.float64)
    return float(np.interp(z, points[:, 1], points[:, 0]))


def squared(mesh: Mesh, power: float) -> Mesh:
    """A mesh turned about z whose circles become rounded squares of the same width."""
    if power == 2.0:
        return mesh
    xy = mesh.vertices[:, :2]
    radius = np.maximum(np.linalg.norm(xy, axis=1, keepdims=True), 1e-12)
    unit = np.abs(xy / radius)
    wider = xy / np.maximum(np.sum(unit**power, axis=1, keepdims=True), 1e-12) ** (1 / power)
    outward = np.sign(xy) * unit ** (power - 1)
    outward /= np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1e-12)
    level = np.sum(mesh.normals[:, :2] * xy / radius, axis=1, keepdims=True)
    vertices = np.column_stack([wider, mesh.vertices[:, 2]])
    return Mesh(vertices, np.column_stack([level * outward, mesh.normals[:, 2]]), mesh.faces, mesh.uv)


def rounded(points: Points2, rounds: int = 1) -> F64:
    """A profile with its inner corners cut off smoothly (Chaikin's algorithm); the ends stay."""
    line = np.asarray(points, dtype=np.float64)
    for _ in range(rounds):
        near = 0.75 * line[:-1] + 0.25 * line[1:]
        far = 0.25 * line[:-1] + 0.75 * line[1:]
        line = np.vstack([line[:1], np.stack([near, far], axis=1).reshape(-1, 2)[1:-1], line[-1:]])
    return line


def loop(start: Vec3, end: Vec3, out: Vec3, *, power: float = 2.0, count: int = 9) -> F64:
    """Points of a handle from one point to another that bulges by a vector: round (power 2) or square (4 and more)."""
    t = np.linspace(-np.pi / 2, np.pi / 2, count)
    along = np.sign(np.sin(t)) * np.abs(np.sin(t)) ** (2 / power)
    bulge = np.abs(np.cos(t)) ** (2 / power)
    a, b, o = (np.asarray(v, dtype=np.float64) for v in (start, end, out))
    return np.asarray((a + b) / 2 + along[:, None] * (b - a) / 2 + bulge[:, None] * o)


def rod(stations: Sequence[Station], sides: int = 8, power: float = 2.0) -> Mesh:
    """A bar along +y whose oval (power 2) or boxy (4) section changes from station to station."""
    section = (
        primitives.ellipse(1.0, 1.0, sides, power) if sides != 4 else np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) / 2
    )
    rings = [
        np.column_stack([section[:, 1] * width, np.full(sides, y), z + section[:, 0] * thickness])
        for y, width, thickness, z in stations
    ]
    return primitives.loft(rings)
