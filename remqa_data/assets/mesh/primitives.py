"""Meshes of simple solids with their exact normals. All sizes in metres, all centred on the origin.

Every function returns a `Mesh` whose triangles are counter-clockwise as seen from outside and whose normals are those
of the ideal surface, so a 16-sided cylinder is shaded round and a box is shaded flat. What asset functions draw with
comes from here: also the outlines, cloth and turns of the modules beside this one.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from remqa_data.assets.mesh.grids import cushion, grid_faces, sheet
from remqa_data.assets.mesh.outlines import Points2, arc, ellipse, rounded_rect
from remqa_data.assets.mesh.triangles import AXES, Axis, Mesh, joined, turn
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec3

__all__ = [
    "AXES",
    "Axis",
    "Mesh",
    "Points2",
    "arc",
    "box",
    "cushion",
    "cylinder",
    "disc",
    "ellipse",
    "ellipsoid",
    "grid_faces",
    "joined",
    "loft",
    "prism",
    "revolve",
    "rounded_box",
    "rounded_rect",
    "sheet",
    "tube",
    "turn",
]


def box(size: Vec3) -> Mesh:
    """A box with sharp edges: 24 vertices, 12 triangles."""
    unit_vertices, normals, faces, uv = _unit_box()
    return Mesh(unit_vertices * np.asarray(size, dtype=np.float64), normals, faces, uv)


@lru_cache
def _unit_box() -> tuple[F64, F64, npt.NDArray[np.int64], F64]:
    vertices: list[F64] = []
    normals: list[F64] = []
    faces: list[tuple[int, int, int]] = []
    uv: list[tuple[float, float]] = []
    for normal, right in (("x", "y"), ("-x", "-y"), ("y", "-x"), ("-y", "x"), ("z", "x"), ("-z", "-x")):
        n, r = AXES[normal], AXES[right]
        u = arithmetic.cross(n, r)
        start = len(vertices)
        for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
            vertices.append((n + a * r + b * u) / 2)
            normals.append(n)
            uv.append(((a + 1) / 2, (1 - b) / 2))
        faces += [(start, start + 1, start + 2), (start, start + 2, start + 3)]
    return np.array(vertices), np.array(normals), np.array(faces), np.array(uv, dtype=np.float64)


def rounded_box(size: Vec3, radius: float, segments: int = 2) -> Mesh:
    """A box whose edges and corners are rounded with a radius, in `segments` steps a quarter turn."""
    half = np.asarray(size, dtype=np.float64) / 2
    radius = min(radius, 0.999 * float(half.min()))
    if radius <= 0:
        return box(size)
    signs, directions, faces = _octants(segments)
    return Mesh(signs * (half - radius) + radius * directions, directions, faces)


@lru_cache
def _octants(segments: int) -> tuple[F64, F64, npt.NDArray[np.int64]]:
    """Corner signs, unit directions and faces of a sphere cut into octants that a rounded box pulls apart."""
    ring = 4 * (segments + 1)
    signs, directions = [], []
    steps = np.linspace(0.0, np.pi / 2, segments + 1)
    polar = [(1.0, a) for a in steps[::-1]] + [(-1.0, a) for a in steps]
    for z_sign, from_equator in polar:
        for quadrant, (sx, sy) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
            for a in steps:
                around = quadrant * np.pi / 2 + a
                c = np.cos(from_equator)
                directions.append((c * np.cos(around), c * np.sin(around), z_sign * np.sin(from_equator)))
                signs.append((sx, sy, z_sign))
    rows = len(polar)
    faces = []
    for i in range(rows - 1):
        for j in range(ring):
            a, b = i * ring + j, i * ring + (j + 1) % ring
            c, d = a + ring, b + ring
            faces += [(a, c, d), (a, d, b)]
    top, bottom = 0, (rows - 1) * ring
    q = segments + 1
    for start, flip in ((top, False), (bottom, True)):
        corners = [start + k * q for k in range(4)]
        quads = [(corners[0], corners[1], corners[2]), (corners[0], corners[2], corners[3])]
        faces += [(a, c, b) if flip else (a, b, c) for a, b, c in quads]
    signs_, directions_ = np.array(signs, dtype=np.float64), np.array(directions)
    kept = np.array(faces)
    points = signs_ * 2 + directions_
    area = np.linalg.norm(
        arithmetic.cross(points[kept[:, 1]] - points[kept[:, 0]], points[kept[:, 2]] - points[kept[:, 0]]), axis=1
    )
    return signs_, directions_, kept[area > 1e-9]


def revolve(profile: Points2, sections: int = 20, crease_deg: float = 40.0) -> Mesh:
    """A solid of revolution about z.

    Parameters
    ----------
    profile : sequence of (radius, z)
        From the bottom of the axis, outside and upwards; to the axis again for a closed solid, and back down inside for
        a vessel. Corners sharper than `crease_deg` are shaded as edges.
    sections : int
        Steps of the full turn.
    """
    points = np.asarray(profile, dtype=np.float64)
    steps = np.diff(points, axis=0)
    keep = np.linalg.norm(steps, axis=1) > 1e-9
    starts, ends = points[:-1][keep], points[1:][keep]
    steps = steps[keep]
    # A profile that runs upwards on the outside has its outward normal to the right of its direction.
    flat = np.stack([steps[:, 1], -steps[:, 0]], axis=1)
    flat /= np.linalg.norm(flat, axis=1, keepdims=True)
    from_normals, to_normals = flat.copy(), flat.copy()
    smooth = np.cos(np.radians(crease_deg))
    for i in range(len(flat) - 1):
        if flat[i] @ flat[i + 1] > smooth:
            mean = flat[i] + flat[i + 1]
            to_normals[i] = from_normals[i + 1] = mean / np.linalg.norm(mean)
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(steps, axis=1))])
    along = 1 - np.stack([length[:-1], length[1:]], axis=1) / max(length[-1], 1e-9)
    turns, around, upper, lower = _revolution(sections)
    faces = []
    for i, (start, end) in enumerate(zip(starts[:, 0].tolist(), ends[:, 0].tolist(), strict=True)):
        base = 2 * i * (sections + 1)
        if start > 1e-9:
            faces.append(upper + base)
        if end > 1e-9:
            faces.append(lower + base)
    rings = np.stack([starts, ends], axis=1), np.stack([from_normals, to_normals], axis=1)
    uv = np.empty((len(flat), 2, sections + 1, 2))
    uv[..., 0], uv[..., 1] = turns, along[..., None]
    vertices, normals = (_turned_round(ring, around) for ring in rings)
    return Mesh(vertices, normals, np.vstack(faces), uv.reshape(-1, 2))


def _turned_round(rings: F64, around: F64) -> F64:
    """(n, 3) what (..., 2) radii and heights become by being turned about z."""
    turned = np.empty((*rings.shape[:-1], len(around), 3))
    turned[..., :2] = rings[..., :1, None] * around
    turned[..., 2] = rings[..., 1:]
    return turned.reshape(-1, 3)


@lru_cache
def _revolution(sections: int) -> tuple[F64, F64, npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Shares and directions of the steps of a full turn; the triangles between two rings that have a side on each."""
    angles = np.arange(sections + 1) * 2 * np.pi / sections
    around = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    count, a = sections + 1, np.arange(sections)
    b = a + 1
    upper, lower = np.column_stack([a, b, a + count]), np.column_stack([b, b + count, a + count])
    return angles / (2 * np.pi), around, upper, lower


def cylinder(radius: float, height: float, top_radius: float | None = None, sections: int = 16) -> Mesh:
    """A cylinder or cone frustum along z, centred."""
    top = radius if top_radius is None else top_radius
    h = height / 2
    return revolve([(0, -h), (radius, -h), (top, h), (0, h)], sections)


def disc(radius: float, inner: float = 0.0, sections: int = 24) -> Mesh:
    """A flat disc or ring that faces +z, with a picture stretched once over its square."""
    t = np.arange(sections) * 2 * np.pi / sections
    rim = np.column_stack([np.cos(t), np.sin(t), np.zeros(sections)])
    points = np.vstack([rim * inner, rim * radius])
    j = np.arange(sections)
    k = (j + 1) % sections
    faces = np.column_stack([j, j + sections, k + sections])
    if inner > 0:
        faces = np.vstack([faces, np.column_stack([j, k + sections, k])])
    uv = np.column_stack([0.5 + points[:, 0] / (2 * radius), 0.5 - points[:, 1] / (2 * radius)])
    return Mesh(points, np.tile([0.0, 0.0, 1.0], (2 * sections, 1)), faces, uv)


def ellipsoid(size: Vec3, sections: int = 16, rings: int = 8) -> Mesh:
    """An ellipsoid that fills a box of a size."""
    t = np.linspace(-np.pi / 2, np.pi / 2, rings + 1)
    profile = np.column_stack([np.cos(t), np.sin(t)])
    profile[0, 0] = profile[-1, 0] = 0.0
    return revolve(profile, sections, crease_deg=89).scaled(np.asarray(size, dtype=np.float64) / 2)


def tube(path: Sequence[Vec3] | F64, radius: float | Sequence[float], sides: int = 8) -> Mesh:
    """A round rod along a path of points; `radius` may be one number for each point. Ends are capped flat."""
    points = np.asarray(path, dtype=np.float64)
    radii = np.broadcast_to(np.asarray(radius, dtype=np.float64), (len(points),))
    tangents = np.gradient(points, axis=0)
    tangents /= np.maximum(np.linalg.norm(tangents, axis=1, keepdims=True), 1e-12)
    across = int(arithmetic.snapped(np.abs(tangents[0])).argmin())  # snapped, because two may be equal but for rounding
    normal = arithmetic.cross(tangents[0], np.eye(3)[across])
    angle = np.arange(sides) * 2 * np.pi / sides
    cosines, sines = np.cos(angle)[:, None], np.sin(angle)[:, None]
    rings_v, rings_n = [], []
    for point, tangent, r in zip(points, tangents, radii, strict=True):
        normal = normal - tangent * arithmetic.dot(normal, tangent)  # parallel transport keeps the tube from twisting
        normal /= arithmetic.length(normal)
        spokes = cosines * normal + sines * arithmetic.cross(tangent, normal)
        rings_v.append(point + r * spokes)
        rings_n.append(spokes)
    j = np.arange(sides)
    k = (j + 1) % sides
    faces = []
    for i in range(len(points) - 1):
        a, b = i * sides + j, i * sides + k
        faces += [np.column_stack([a, b, a + sides]), np.column_stack([b, b + sides, a + sides])]
    n = len(points) * sides
    fan = j[1:-1]
    faces += [
        np.column_stack([np.full_like(fan, n), n + fan + 1, n + fan]),
        np.column_stack([np.full_like(fan, n + sides), n + sides + fan, n + sides + fan + 1]),
    ]
    ends_v = [rings_v[0], rings_v[-1]]
    ends_n = [np.tile(-tangents[0], (sides, 1)), np.tile(tangents[-1], (sides, 1))]
    return Mesh(np.vstack(rings_v + ends_v), np.vstack(rings_n + ends_n), np.vstack(faces))


def prism(outline: Points2, height: float, holes: Sequence[Points2] = (), crease_deg: float = 40.0) -> Mesh:
    """A polygon in the xy plane extruded along z, centred on z = 0.

    Parameters
    ----------
    outline : sequence of (x, y)
        Corners in either direction, without repeating the first.
    height : float
        Length along z.
    holes : sequence of outlines
        Holes through the prism.
    crease_deg : float
        Corners of the outline flatter than this are shaded round.
    """
    import mapbox_earcut

    points, *inner = (_snapped_ring(ring) for ring in (outline, *holes))
    rings = [_oriented(points, ccw=True), *(_oriented(hole, ccw=False) for hole in inner)]
    flat = np.vstack(rings)
    ends = np.cumsum([len(ring) for ring in rings]).astype(np.uint32)
    triangles = np.asarray(mapbox_earcut.triangulate_float64(flat, ends), dtype=np.int64).reshape(-1, 3)
    a, b, c = flat[triangles[:, 0]], flat[triangles[:, 1]], flat[triangles[:, 2]]
    winding = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    triangles[winding < 0] = triangles[winding < 0][:, ::-1]
    n, h = len(flat), height / 2
    up = np.tile([0.0, 0.0, 1.0], (n, 1))
    meshes = [
        Mesh(np.column_stack([flat, np.full(n, h)]), up, triangles),
        Mesh(np.column_stack([flat, np.full(n, -h)]), -up, triangles[:, ::-1]),
    ]
    meshes += [_side_walls(ring, h, crease_deg) for ring in rings]
    return joined(meshes)


def _snapped_ring(outline: Points2) -> F64:
    """An outline's points, snapped, because many triangulations are as good and a last digit would choose.

    Points that become one stay one: a side without a length has no normal.
    """
    points = arithmetic.snapped(outline)
    return np.asarray(points[(points != np.roll(points, 1, axis=0)).any(axis=1)])


def _oriented(outline: Points2, *, ccw: bool) -> F64:
    points = np.asarray(outline, dtype=np.float64)
    x, y = points[:, 0], points[:, 1]
    area = float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    return points if (area > 0) == ccw else points[::-1]


def _side_walls(ring: F64, half: float, crease_deg: float) -> Mesh:
    following = np.roll(ring, -1, axis=0)
    steps = following - ring
    flat = np.column_stack([steps[:, 1], -steps[:, 0]])
    flat /= np.maximum(np.linalg.norm(flat, axis=1, keepdims=True), 1e-12)
    before = np.roll(flat, 1, axis=0)
    smooth = np.sum(flat * before, axis=1) > np.cos(np.radians(crease_deg))
    mean = flat + before
    mean /= np.maximum(np.linalg.norm(mean, axis=1, keepdims=True), 1e-12)
    start_n = np.where(smooth[:, None], mean, flat)
    end_n = np.roll(np.where(smooth[:, None], mean, before), -1, axis=0)
    n = len(ring)
    vertices = np.vstack([np.column_stack([p, np.full(n, z)]) for z in (-half, half) for p in (ring, following)])
    normals = np.vstack([np.column_stack([m, np.zeros(n)]) for _ in range(2) for m in (start_n, end_n)])
    i = np.arange(n)
    faces = np.vstack([np.column_stack([i, n + i, 3 * n + i]), np.column_stack([i, 3 * n + i, 2 * n + i])])
    return Mesh(vertices, normals, faces)


def loft(rings: Sequence[F64] | F64, *, capped: bool = True) -> Mesh:
    """A skin over rings of points, each (n, 3), counter-clockwise as seen from above, from the bottom to the top.

    Shaded round throughout; flat caps close both ends unless `capped` is False.
    """
    stack = np.asarray(rings, dtype=np.float64)
    m, n, _ = stack.shape
    around = np.roll(stack, -1, axis=1) - np.roll(stack, 1, axis=1)
    along = np.gradient(stack, axis=0)
    normals = arithmetic.cross(around, along)
    length = np.linalg.norm(normals, axis=2, keepdims=True)
    normals = np.where(length > 1e-12, normals / np.maximum(length, 1e-12), [0.0, 0.0, 1.0])
    j = np.arange(n)
    k = (j + 1) % n
    faces = []
    for i in range(m - 1):
        a, b = i * n + j, i * n + k
        faces += [np.column_stack([a, b, a + n]), np.column_stack([b, b + n, a + n])]
    meshes = [Mesh(stack.reshape(-1, 3), normals.reshape(-1, 3), np.vstack(faces))]
    if capped:
        for ring, flip in ((stack[0], True), (stack[-1], False)):
            normal = arithmetic.cross(ring - ring.mean(axis=0), np.roll(ring, -1, axis=0) - ring.mean(axis=0)).sum(
                axis=0
            )
            normal = normal / max(float(np.linalg.norm(normal)), 1e-12) * (-1 if flip else 1)
            centre = np.vstack([ring, ring.mean(axis=0, keepdims=True)])
            fan = np.column_stack([np.full(n, n), k if flip else j, j if flip else k])
            meshes.append(Mesh(centre, np.tile(normal, (n + 1, 1)), fan))
    return joined(meshes)
