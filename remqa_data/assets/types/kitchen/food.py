"""Fruit, vegetables, bread, eggs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.core.posed import Posed
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import primitives
from remqa_data.assets.mesh.primitives import Mesh
from remqa_data.assets.parts.turnery import rod, rounded
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Vec3


def _food(color: str, rgb: Vec3, gloss: float = 0.1, texture: str | None = None, repeat_m: float = 0.1) -> Material:
    return Material("organic", color, rgb, texture, repeat_m, gloss)


STEM = _food("brown", (0.36, 0.25, 0.14))
LEAF = _food("green", (0.29, 0.50, 0.20), 0.2)
APPLES = (
    (_food("red", (0.74, 0.13, 0.12), 0.5), _food("yellow", (0.86, 0.62, 0.28), 0.4)),
    (_food("green", (0.52, 0.70, 0.22), 0.5), _food("green", (0.66, 0.76, 0.32), 0.4)),
    (_food("yellow", (0.90, 0.76, 0.26), 0.5), _food("green", (0.66, 0.72, 0.28), 0.4)),
    (_food("red", (0.56, 0.08, 0.12), 0.5), _food("red", (0.70, 0.25, 0.16), 0.4)),
)
CRUSTS = (
    _food("brown", (0.72, 0.45, 0.20), 0.1, "plaster", 0.12),
    _food("brown", (0.62, 0.36, 0.16), 0.1, "plaster", 0.12),
    _food("brown", (0.80, 0.56, 0.28), 0.1, "plaster", 0.12),
    _food("brown", (0.50, 0.29, 0.14), 0.1, "plaster", 0.12),
)
CRUMB = _food("beige", (0.93, 0.84, 0.66), 0.0, "plaster", 0.06)
EGGS = (
    _food("white", (0.95, 0.94, 0.91), 0.2),
    _food("brown", (0.78, 0.55, 0.38), 0.2),
    _food("beige", (0.91, 0.81, 0.68), 0.2),
)
SKINS = (
    _food("brown", (0.66, 0.49, 0.31), 0.05, "plaster", 0.08),
    _food("yellow", (0.84, 0.71, 0.42), 0.05, "plaster", 0.08),
    _food("red", (0.62, 0.31, 0.29), 0.05, "plaster", 0.08),
    _food("brown", (0.52, 0.38, 0.25), 0.05, "plaster", 0.08),
)
TOMATOES = (
    _food("red", (0.80, 0.13, 0.09), 0.6),
    _food("red", (0.70, 0.09, 0.10), 0.6),
    _food("orange", (0.90, 0.42, 0.10), 0.6),
    _food("red", (0.86, 0.22, 0.12), 0.6),
)


def apple(b: Builder) -> None:
    """An apple with its stem: round; tall and lobed; with a leaf; flat and broad."""
    p = Posed(b, upright=True, slack=1.12)
    skin, cavity = b.pick((APPLES[b.variant], APPLES[(b.variant + 1) % 4]))
    stem = min(0.012, 0.10 * p.h)
    top = p.h - stem
    shape = b.by_variant(
        (
            [(0.0, 0.06), (0.20, 0.03), (0.46, 0.0), (0.84, 0.16), (1.0, 0.52), (0.84, 0.90), (0.46, 1.0)],
            [
                (0.0, 0.07),
                (0.16, 0.02),
                (0.36, 0.0),
                (0.66, 0.16),
                (0.94, 0.58),
                (1.0, 0.80),
                (0.80, 0.98),
                (0.46, 1.0),
            ],
            [(0.0, 0.06), (0.20, 0.03), (0.46, 0.0), (0.88, 0.18), (1.0, 0.56), (0.86, 0.92), (0.44, 1.0)],
            [(0.0, 0.08), (0.24, 0.03), (0.55, 0.0), (0.95, 0.20), (1.0, 0.45), (0.88, 0.86), (0.52, 1.0)],
        )
    )
    lobes = b.by_variant((0.012, 0.045, 0.02, 0.02))
    size = (p.w / 2, p.d / 2, top)
    p.add(_lobed([*rounded(shape)[1:], (0.30, 0.985)], size, lobes, 5), skin)
    p.add(_lobed([(0.30, 0.985), (0.18, 0.95), (0.08, 0.89), (0.0, 0.84)], size, lobes, 5), cavity)
    lean = 0.05 * p.w
    p.add(primitives.tube([(0, 0, 0.84 * top), (0, 0, top), (lean, 0, p.h)], [0.0016, 0.0016, 0.0026], 5), STEM)
    if b.variant == 2:
        leaf = _leaf_blade(0.36 * p.w, 0.16 * p.w, 0.04 * p.w)
        p.add(leaf.turned(primitives.turn("z", -35)), LEAF, (0.0, 0.0, top - 0.002))
    p.rest()
    b.looks_like(skin)


def tomato(b: Builder) -> None:
    """A tomato with its green star: smooth; ribbed; flat; with a long stem."""
    p = Posed(b, upright=True, slack=10.0)
    skin = b.pick(TOMATOES)
    stem = min(b.by_variant((0.006, 0.005, 0.006, 0.012)), 0.15 * p.h)
    top = p.h - stem
    shape = [(0.0, 0.02), (0.30, 0.0), (0.80, 0.10), (1.0, 0.45), (0.92, 0.82), (0.50, 1.0), (0.20, 0.97), (0.0, 0.90)]
    if b.variant == 2:
        shape = [
            (0.0, 0.04),
            (0.45, 0.0),
            (0.95, 0.20),
            (1.0, 0.50),
            (0.94, 0.80),
            (0.55, 1.0),
            (0.22, 0.96),
            (0.0, 0.88),
        ]
    ribs, count = b.by_variant(((0.01, 5), (0.09, 7), (0.03, 6), (0.012, 5)))
    p.add(_lobed(rounded(shape), (p.w / 2, p.d / 2, top), ribs, count), skin)
    sepals = b.by_variant((6, 7, 5, 5))
    for i in range(sepals):
        leaf = _leaf_blade(0.26 * p.w, 0.075 * p.w, -0.02 * p.w).turned(primitives.turn("y", 8))
        p.add(leaf.turned(primitives.turn("z", 360 / sepals * i + 10)), LEAF, (0.0, 0.0, 0.955 * top + 0.002))
    p.add(primitives.tube([(0, 0, 0.88 * top), (0, 0, top), (0.03 * p.w, 0, p.h)], [0.003, 0.002, 0.0028], 5), LEAF)
    if b.variant == 3:  # a piece of the vine
        p.add(
            primitives.tube([(-0.10 * p.w, 0.05 * p.d, p.h - 0.003), (0.20 * p.w, -0.05 * p.d, p.h - 0.002)], 0.003, 6),
            LEAF,
        )
    p.rest()
    b.looks_like(skin)


def egg(b: Builder) -> None:
    """An egg, lying: common; pointed; roundish; speckled."""
    p = Posed(b)
    shell = egg_shell(b)
    blunt = b.by_variant((0.12, 0.22, 0.05, 0.14))
    t = np.linspace(-np.pi / 2, np.pi / 2, 11)
    profile = np.column_stack([np.cos(t) * (1 - blunt * np.sin(t)), np.sin(t)])
    profile[0, 0] = profile[-1, 0] = 0.0
    profile /= profile.max(axis=0)
    mesh = primitives.revolve(profile, 16, crease_deg=60).pointed("y").scaled((p.w / 2, p.d / 2, p.h / 2))
    p.add(mesh, shell, (0, 0, p.h / 2))
    if b.variant == 3:
        _dots(b, p, mesh, _food("brown", (0.38, 0.25, 0.16)), (0.0034, 0.0026, 0.0010), 30)
    p.rest()


def egg_shell(b: Builder) -> Material:
    """What the shell of an egg is like."""
    white, brown, beige = EGGS
    return b.pick(b.by_variant(((white,), (brown,), (beige,), (white, beige))))


def potato(b: Builder) -> None:
    """A potato with eyes: long; kidney-shaped; bulky; knobbly."""
    p = Posed(b)
    skin = b.pick(SKINS)
    lump = b.by_variant((0.05, 0.06, 0.09, 0.15))
    ball = primitives.ellipsoid((2, 2, 2), 16, 9).pointed("y")
    x, y, z = ball.vertices.T
    a, c, e = (b.between(0, 6.28) for _ in range(3))
    swell = 1 + lump * (np.sin(2.6 * y + a) * np.cos(1.8 * x + c) + 0.7 * np.sin(3.1 * z + e) * np.sin(2.2 * y + c))
    points = ball.vertices * swell[:, None]
    points[:, 0] += b.by_variant((0.0, 0.30, 0.05, 0.1)) * y**2  # bent like a kidney
    low, high = points.min(axis=0), points.max(axis=0)
    points = ((points - low) / (high - low) - 0.5) * [p.w, p.d, p.h]
    mesh = _smooth(Mesh(points, ball.normals, ball.faces))
    p.add(mesh, skin, (0, 0, p.h / 2))
    _dots(b, p, mesh, materials.tinted(skin, 0.62), (0.009, 0.004, 0.0016), b.by_variant((7, 9, 11, 14)))
    p.rest()
    b.looks_like(skin)


def bread(b: Builder) -> None:
    """A loaf: tin loaf; country loaf with scores; sandwich loaf partly sliced; plaited."""
    b.by_variant((_tin_loaf, _country_loaf, _sliced_loaf, _plaited_loaf))(b, Posed(b), b.pick(CRUSTS))


def lettuce(b: Builder) -> None:
    """A head of lettuce: romaine; butterhead; frilly; iceberg with few outer leaves."""
    p = Posed(b)
    outer, middle, heart = lettuce_greens(b)
    pale = _green((0.72, 0.80, 0.52), 1.0)
    core, ruffle, rows = b.by_variant(
        (
            (0.50, 0.07, ((4, 1.0, 0.92, outer), (4, 0.80, 1.0, middle), (3, 0.45, 0.94, heart))),
            (0.66, 0.05, ((5, 1.0, 0.74, outer), (4, 0.88, 0.92, middle), (3, 0.55, 1.0, heart))),
            (0.45, 0.17, ((5, 1.0, 0.84, outer), (4, 0.80, 0.95, middle), (3, 0.45, 1.0, heart))),
            (0.93, 0.03, ((4, 1.0, 0.72, outer), (3, 0.97, 0.86, middle))),
        )
    )
    aim = primitives.turn("z", 0.0 if p.stands else 180.0)  # lying, its leaves point to the front
    rise = (0.0, 0.0, p.h / 2)
    ball = primitives.ellipsoid((core * p.w, 0.92 * p.d, core * p.h), 10, 5)
    p.add(ball.turned(aim), heart, rise)
    for row, (count, spread, length, green) in enumerate(rows):
        for i in range(count):
            angle = 2 * np.pi * (i + 0.5 * (row % 2)) / count + b.between(-0.12, 0.12)
            leaf = _head_leaf(p, angle, 2.9 * np.pi / count, spread, length, ruffle, b.between(0, 6.28))
            p.add(leaf.turned(aim), green, rise)
            if row == 0:
                p.add(_rib(p, angle, spread, length * b.by_variant((0.85, 0.6, 0.7, 0.7))).turned(aim), pale, rise)
    root = primitives.cylinder(0.10 * p.w, 0.05 * p.d, 0.13 * p.w, sections=8).pointed("y").moved((0, -0.475 * p.d, 0))
    p.add(root.turned(aim), pale, rise)
    p.rest(along=0.8)
    b.looks_like(middle)


def lettuce_greens(b: Builder) -> tuple[Material, Material, Material]:
    """What the outer leaves, the middle ones and the heart of a head of lettuce are like."""
    tone = b.pick(((0.42, 0.64, 0.22), (0.34, 0.58, 0.20), (0.50, 0.68, 0.26), (0.38, 0.60, 0.28)))
    light = b.by_variant((1.0, 1.1, 1.0, 1.35))
    return _green(tone, light * 0.92), _green(tone, light * 1.12), _green(tone, light * 1.35)


def _tin_loaf(b: Builder, p: Posed, crust: Material) -> None:
    p.add(_loaf(p, -p.d / 2, p.d / 2, soft=0.10), crust)
    split = [
        (t * p.d, width * p.w, 0.010, p.h - 0.0035)
        for t, width in ((-0.40, 0.02), (-0.3, 0.12), (0.3, 0.12), (0.40, 0.02))
    ]
    p.add(rod(split), materials.tinted(CRUMB, 0.88))
    p.rest(0.85, 0.95)
    b.looks_like(crust)


def _sliced_loaf(b: Builder, p: Posed, crust: Material) -> None:
    cut = -p.d / 2 + 0.40 * p.d
    p.add(_loaf(p, cut, p.d / 2, soft=0.08), crust)
    faces, thick = [cut], 0.014
    for i in range(3):
        y = cut - (i + 1) * (cut + p.d / 2) / 3
        p.add(_loaf(p, y, y + thick, soft=0.0), crust)
        faces.append(y)
    for y in faces:
        face = loaf_section(p.w, p.h)
        inner = face * [0.90, 0.90] + [0, 0.05 * p.h]
        disc = primitives.prism(inner, 0.0012).pointed("-y")
        p.add(disc, CRUMB, (0, y - 0.0002, 0))
    p.rest(0.85, 1.0)
    b.looks_like(crust)


def _country_loaf(b: Builder, p: Posed, crust: Material) -> None:
    ball = primitives.ellipsoid((2, 2, 2), 20, 10)
    x, y, z = ball.vertices.T
    up = np.where(z < 0, 0.35 * z, z)
    body = np.column_stack([x, np.sign(y) * np.abs(y) ** 0.85, (up + 0.35) / 1.35])
    p.add(Mesh(body, ball.normals, ball.faces).scaled((p.w / 2, p.d / 2, p.h)), crust)
    flour = materials.tinted(CRUMB, 0.95)
    s = np.linspace(-0.52, 0.52, 6)
    for t in (-0.54, -0.18, 0.18, 0.54):
        along = t + 0.22 * s
        up = np.sqrt(np.maximum(0.05, 1 - s**2 - np.abs(along) ** (2 / 0.85)))
        path = np.column_stack([s * p.w / 2, along * p.d / 2, (up + 0.35) / 1.35 * p.h - 0.002])
        p.add(primitives.tube(path, [0.001, 0.005, 0.006, 0.006, 0.005, 0.001], 6), flour)
    p.rest()
    b.looks_like(crust)


def _plaited_loaf(b: Builder, p: Posed, crust: Material) -> None:
    count = 5
    step = p.d / (count + 0.6)
    for i in range(count):
        t = (i - (count - 1) / 2) / (count / 2)
        full = 1 - 0.45 * t**2
        for side in (-1, 1):
            knot = primitives.ellipsoid((0.66 * p.w * full, 1.5 * step, p.h * full), 9, 5).turned(
                primitives.turn("z", side * 38)
            )
            y = (i - (count - 1) / 2) * step + side * 0.25 * step
            p.add(
                knot, crust if side > 0 else materials.tinted(crust, 1.1), (side * 0.20 * p.w * full, y, p.h * full / 2)
            )
    p.rest(0.75, 0.85)
    b.looks_like(crust)


def loaf_section(width: float, height: float) -> F64:
    """Outline of a tin loaf seen from the end, (n, 2) as x and z, counter-clockwise."""
    right = [
        (0.40, 0.0),
        (0.42, 0.03),
        (0.43, 0.52),
        (0.49, 0.60),
        (0.50, 0.72),
        (0.44, 0.88),
        (0.28, 0.97),
        (0.0, 1.0),
    ]
    left = [(-x, z) for x, z in right[-2::-1]]
    return np.array([*right, *left]) * [width, height]


def _loaf(p: Posed, start: float, end: float, soft: float) -> Mesh:
    """A tin loaf from y = start to end; its far end, and its near end if at the box's, is rounded by `soft`."""
    outline = loaf_section(p.w, p.h)[::-1]  # seen along +y
    stops = [(0.0, 1.0), (1.0, 1.0)]
    if soft > 0:
        near = [(0.0, 0.80), (0.03, 0.92), (soft, 1.0)] if start <= -p.d / 2 + 1e-6 else [(0.0, 1.0)]
        stops = [*near, (1 - soft, 1.0), (0.97, 0.92), (1.0, 0.80)]
    rings = []
    for t, scale in stops:
        x, z = outline[:, 0] * scale, outline[:, 1] * (0.5 + 0.5 * scale)
        rings.append(np.column_stack([x, np.full(len(x), start + t * (end - start)), z]))
    return primitives.loft(rings)


def _lobed(profile: Sequence[tuple[float, float]] | F64, size: Vec3, lobes: float, count: int) -> Mesh:
    """A turned shape, in units of (half width, half depth, height), with lobes around it."""
    mesh = primitives.revolve(profile, 20, crease_deg=80)
    angle = np.arctan2(mesh.vertices[:, 1], mesh.vertices[:, 0])
    factor = 1 - lobes * (0.5 - 0.5 * np.cos(count * angle))
    return _smooth(Mesh(mesh.vertices * factor[:, None] ** [1, 1, 0] * size, mesh.normals, mesh.faces))


def _smooth(mesh: Mesh) -> Mesh:
    """The same mesh, shaded round everywhere: normals are means over the faces that meet in a point."""
    corners = mesh.vertices[mesh.faces]
    flat = arithmetic.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    _, point = np.unique(np.round(mesh.vertices, 6), axis=0, return_inverse=True)
    point = point.reshape(-1)
    total = np.zeros((int(point.max()) + 1, 3))
    for corner in range(3):
        np.add.at(total, point[mesh.faces[:, corner]], flat)
    total /= np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-12)
    return Mesh(mesh.vertices, total[point], mesh.faces)


def _leaf_blade(length: float, width: float, lift: float) -> Mesh:
    """A pointed leaf along +x that rises (or droops) towards its tip."""
    t = np.linspace(0, 1, 5)
    u, v = np.meshgrid(t, np.array([-1.0, 0.0, 1.0]), indexing="ij")
    half = np.maximum(np.sin(np.pi * u**0.8), 0.08) * width / 2
    return _open_sheet(u * length, v * half, lift * u**1.5 + 0.15 * np.abs(v) * half)


def _head_leaf(p: Posed, angle: float, arc: float, spread: float, length: float, ruffle: float, phase: float) -> Mesh:
    """One leaf of a lettuce: grows from the root at -y, hugs the head, and frills at its edge."""
    t, s = np.meshgrid(np.linspace(0, 1, 5), np.linspace(-1, 1, 7), indexing="ij")
    around = angle + s * arc / 2 * np.sin(np.pi * (0.12 + 0.72 * t)) ** 0.7
    edge = np.maximum(np.abs(s) ** 3, t**3)
    radius = _head_radius(spread, t) * (1 - 0.06 * np.abs(s)) + ruffle * edge * np.sin(8.5 * s + 7 * t + phase)
    y = (-0.5 + t * length * (1 - 0.14 * s**2 * t)) * p.d
    return _open_sheet(radius * np.cos(around) * p.w / 2, y, radius * np.sin(around) * p.h / 2)


def _rib(p: Posed, angle: float, spread: float, length: float) -> Mesh:
    """The pale rib of a leaf up to a fraction of the head."""
    t = np.linspace(0, length, 3)
    radius = _head_radius(spread, t) + 0.012
    x, y, z = radius * np.cos(angle) * p.w / 2, (t - 0.5) * p.d, radius * np.sin(angle) * p.h / 2
    return primitives.tube(np.column_stack([x, y, z]), [0.036 * p.w, 0.022 * p.w, 0.004 * p.w], 4)


def _head_radius(spread: float, t: F64) -> F64:
    """How far a leaf is from the axis of its head, from the root (t = 0) to the tip (t = 1)."""
    return np.asarray(spread * np.sin(np.pi * (0.06 + 0.66 * t)) ** 0.8)


def _green(rgb: Vec3, factor: float) -> Material:
    r, g, b = rgb
    return _food("green", (min(1.0, r * factor), min(1.0, g * factor), min(1.0, b * factor)), 0.1)


def _open_sheet(x: F64, y: F64, z: F64) -> Mesh:
    """A thin skin over a grid of points, seen from both sides."""
    grid = np.stack([x, y, z], axis=2)
    normals = arithmetic.cross(np.gradient(grid, axis=0), np.gradient(grid, axis=1))
    normals /= np.maximum(np.linalg.norm(normals, axis=2, keepdims=True), 1e-12)
    return Mesh(grid.reshape(-1, 3), normals.reshape(-1, 3), primitives.grid_faces(*x.shape))


def _facing(mesh: Mesh, normal: F64) -> Mesh:
    """A mesh turned so that its z axis points along a normal."""
    side = arithmetic.cross(normal, [0.31, 0.87, 0.38])
    side /= np.linalg.norm(side)
    return mesh.turned(np.column_stack([side, arithmetic.cross(normal, side), normal]))


def _dots(b: Builder, p: Posed, mesh: Mesh, material: Material, size: Vec3, count: int) -> None:
    """Flat spots on a round mesh that is centred on the origin."""
    dot = primitives.ellipsoid(size, 6, 2)
    for i in b.rng.choice(len(mesh.vertices), count, replace=False):
        at = mesh.vertices[i] * 0.998
        p.add(_facing(dot, mesh.normals[i]), material, (at[0], at[1], at[2] + p.h / 2))


KINDS = {
    "Apple": Kind(apple),
    "Bread": Kind(bread),
    "Egg": Kind(egg),
    "Lettuce": Kind(lettuce),
    "Potato": Kind(potato),
    "Tomato": Kind(tomato),
}
