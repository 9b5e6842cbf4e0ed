"""Balls, bats, rackets and dumbbells."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.core.posed import Posed
from remqa_data.assets.looks import materials
from remqa_data.assets.looks.materials import BLACK_METAL, BLACK_PLASTIC, CHROME, RUBBER, paint
from remqa_data.assets.mesh import primitives
from remqa_data.assets.mesh.primitives import Mesh
from remqa_data.assets.parts.spindle import spindle
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64

BRIGHT = ("red", "blue", "green", "yellow", "orange", "purple")
DARK_WOOD = Material("wooden", "brown", (0.36, 0.22, 0.14), "wood", 0.8, 0.3)
PALE_WOOD = Material("wooden", "beige", (0.88, 0.72, 0.50), "wood", 0.8, 0.3)
STRING = paint("white", gloss=0.1, rgb=(0.90, 0.90, 0.84))


def baseball_bat(b: Builder) -> None:
    """A baseball bat, barrel down when it stands: plain wood, black metal, two-tone wood, or coloured with stripes."""
    body = b.by_variant((PALE_WOOD, BLACK_METAL, DARK_WOOD, paint(b.pick(BRIGHT), "metal", 0.5)))
    tape = b.by_variant((RUBBER, paint(b.pick(BRIGHT), "rubber", 0.1), PALE_WOOD, materials.WHITE_PLASTIC))
    board = Posed(b)
    r, length = min(board.w, board.h) / 2, board.d
    shape = [
        (0, 0),
        (0.7, 0.0),
        (0.93, 0.008),
        (1, 0.03),
        (1, 0.30),
        (0.86, 0.42),
        (0.6, 0.56),
        (0.44, 0.68),
        (0.37, 0.80),
    ]
    spindle(board, [*shape, (0.35, 0.96), (0, 0.96)], body)
    spindle(board, [(0.36, 0.72), (0.41, 0.725), (0.39, 0.955), (0, 0.955)], tape)
    spindle(board, [(0, 0.95), (0.5, 0.955), (0.66, 0.975), (0.62, 0.995), (0, 1.0)], tape if b.variant == 3 else body)
    bands = {
        0: ((0.40, 0.405, DARK_WOOD), (0.415, 0.42, DARK_WOOD)),
        1: ((0.10, 0.16, tape), (0.18, 0.20, CHROME), (0.34, 0.36, tape)),
        2: ((0.30, 0.37, PALE_WOOD), (0.0, 0.03, PALE_WOOD)),
        3: ((0.08, 0.11, materials.WHITE_PLASTIC), (0.26, 0.29, materials.WHITE_PLASTIC), (0.60, 0.62, BLACK_PLASTIC)),
    }[b.variant]
    for start, end, material in bands:
        ends = [np.interp(t, [y for _, y in shape], [x for x, _ in shape]) + 0.02 for t in (start, end)]
        spindle(board, [(ends[0], start), (ends[1], end)], material)
    if b.variant == 0:
        mark = primitives.prism(primitives.ellipse(0.55 * r, 0.11 * length, 12), 0.12 * r)
        board.add(mark, DARK_WOOD, (0, -0.30 * length, board.h * 0.99))
    board.solid((board.w, 0.45 * length, board.h), (0, -0.275 * length, board.h / 2))
    board.solid((0.8 * r, 0.55 * length, 0.8 * r), (0, 0.225 * length, board.h / 2))
    b.looks_like(body)


def basket_ball(b: Builder) -> None:
    """A basketball: orange or dark brown with black seams, in two colours, or in three."""
    skin = b.by_variant(
        (
            (paint("orange", "rubber", 0.15, (0.85, 0.44, 0.16)),),
            (Material("leather", "brown", (0.55, 0.27, 0.13), "leather", 0.3, 0.15),),
            (paint(b.pick(("blue", "purple", "black", "green")), "rubber", 0.2), paint("yellow", "rubber", 0.2)),
            tuple(paint(color, "rubber", 0.2) for color in ("red", "white", "blue", "white")),
        )
    )
    seam = BLACK_PLASTIC if b.variant != 2 else materials.WHITE_PLASTIC
    tilt = primitives.turn("x", b.by_variant((20, -35, 15, 30))) @ primitives.turn("y", b.by_variant((25, 50, -30, 20)))
    size = np.array([b.w, b.d, b.h])
    for i, material in enumerate(skin):
        wedge = _sphere_wedges(len(skin), i).turned(tilt)
        b.add(wedge.scaled(size / 2), material, (0, 0, b.h / 2))
    t = np.linspace(0, 2 * np.pi, 25)
    zero = np.zeros_like(t)
    side = 0.62 + 0.16 * np.cos(2 * t)
    ring = np.sqrt(1 - side**2)
    curves = [
        np.column_stack([np.cos(t), zero, np.sin(t)]),
        np.column_stack([zero, np.cos(t), np.sin(t)]),
        np.column_stack([side, ring * np.cos(t), ring * np.sin(t)]),
        np.column_stack([-side, ring * np.cos(t), ring * np.sin(t)]),
    ]
    for curve in curves:
        b.add(_seam(curve).turned(tilt).scaled(size / 2 * 1.006), seam, (0, 0, b.h / 2))
    b.solid((0.7 * b.w, 0.7 * b.d, b.h), (0, 0, b.h / 2))
    b.looks_like(skin[0])


def dumbbell(b: Builder) -> None:
    """A dumbbell: hexagonal rubber heads, chrome discs, one coloured piece, or plates held by spinning collars."""
    board = Posed(b)
    r, length = min(board.w, board.h) / 2, board.d
    shade = b.by_variant((RUBBER, CHROME, paint(b.pick((*BRIGHT, "pink")), gloss=0.3), BLACK_METAL))
    bar = b.by_variant((CHROME, CHROME, shade, CHROME))
    grip = 0.24 * r
    head = 0.30
    if b.variant == 0:
        hexagon = primitives.ellipse(2 * r, 2 * r, 6) * [1.0, 1.15]
        for y in (-1, 1):
            board.add(
                primitives.prism(hexagon, 0.8 * head * length).pointed("y"),
                shade,
                (0, y * (0.5 - 0.42 * head) * length, r),
            )
            small = primitives.prism(hexagon * 0.8, head * length).pointed("y")
            board.add(small, materials.tinted(shade, 1.5), (0, y * (0.5 - head / 2) * length, r))
    else:
        steps = {
            1: ((0.0, 0.64, shade), (0.04, 0.8, shade), (0.09, 1.0, shade), (0.17, 0.84, shade), (0.23, 0.5, shade)),
            2: ((0.0, 0.80, shade), (0.05, 1.0, shade), (0.22, 0.72, shade)),
            3: (
                (0.0, 0.22, CHROME),
                (0.05, 0.5, CHROME),
                (0.09, 0.82, shade),
                (0.15, 1.0, shade),
                (0.24, 0.45, CHROME),
            ),
        }[b.variant]
        for material in dict.fromkeys(step[2] for step in steps):
            profile: list[tuple[float, float]] = []
            for (start, wide, own), end in zip(steps, [*(step[0] for step in steps[1:]), 0.27], strict=True):
                if own is material:
                    profile += [(wide - 0.03, start), (wide, start + 0.008), (wide, end)]
                elif profile:
                    profile.append((0, start))
            profile = [(0, profile[0][1]), *profile, (0, profile[-1][1])]
            spindle(board, profile, material, 12)
            spindle(board, [(radius, 1 - y) for radius, y in reversed(profile)], material, 12)
    knurl = materials.STEEL if b.variant in (0, 1, 3) else shade
    spindle(board, [(grip / r, 0.2), (grip / r, 0.8)], bar, 12)
    spindle(board, [(1.1 * grip / r, 0.34), (1.35 * grip / r, 0.5), (1.1 * grip / r, 0.66)], knurl, 12)
    for y in (-1, 1):
        board.solid((1.7 * r, 0.24 * length, 2 * r), (0, y * 0.38 * length, r))
    board.solid((2 * grip, 0.6 * length, 2 * grip), (0, 0, r))
    b.looks_like(shade)


def tennis_racket(b: Builder) -> None:
    """A tennis racket, head down when it stands: open throat, wooden with a solid throat, or with double struts."""
    shade = b.by_variant((paint(b.pick(BRIGHT), gloss=0.4), DARK_WOOD, materials.WHITE_PLASTIC, BLACK_PLASTIC))
    accent = b.by_variant(
        (BLACK_PLASTIC, PALE_WOOD, paint(b.pick(BRIGHT), gloss=0.4), paint(b.pick(BRIGHT), gloss=0.4))
    )
    wrap = b.by_variant((RUBBER, materials.LEATHERS[0], BLACK_PLASTIC, accent))
    board = Posed(b, flat=True)
    w, length, h = board.w, board.d, board.h
    head = length * b.by_variant((0.52, 0.46, 0.54, 0.5))
    thick = min(0.011, 0.045 * w)
    z = h / 2
    guard = 1.12 * thick  # a strip around the tip
    middle = -length / 2 + head / 2 + guard - thick
    t = np.linspace(0, 2 * np.pi, 21) + np.pi / 2
    narrow = 1 - b.by_variant((0.06, 0.0, 0.14, 0.04)) * np.sin(t)
    rim = np.column_stack(
        [(w / 2 - thick) * np.cos(t) * narrow, middle + (head / 2 - thick) * np.sin(t), np.full(21, z)]
    )
    board.add(primitives.tube(rim, thick, 5), shade)
    board.add(primitives.tube(rim[7:14], guard, 5), accent)
    _strings(board, w / 2 - thick, head / 2 - thick, (0.0, middle, z))
    neck, handle = middle + head / 2, length * 0.3
    top = length / 2 - handle
    if b.variant == 1:
        wedge = [(-0.22 * w, neck - 0.03 * length), (0.22 * w, neck - 0.03 * length), (0.05 * w, top), (-0.05 * w, top)]
        board.add(primitives.prism(wedge, 1.6 * thick), shade, (0, 0, z))
        board.add(primitives.prism(np.array(wedge) * [0.5, 1], 1.8 * thick), accent, (0, 0, z))
    else:
        spread = b.by_variant((0.30, 0.0, 0.36, 0.26)) * w
        for side in (-1, 1):
            low = middle + (head / 2 - thick) * np.sqrt(max(0.0, 1 - (spread / (w / 2 - thick)) ** 2))
            path = [
                (side * spread, low, z),
                (side * 0.07 * w, (neck + top) / 2 + 0.01, z),
                (side * 0.03 * w, top + 0.01, z),
            ]
            board.add(primitives.tube(path, thick * 0.95, 5), accent if b.variant == 3 else shade)
    broad, flat = 0.13 * w, min(0.8 * h, 0.13 * w)
    octagon = primitives.ellipse(1.08, 1.08, 8) @ primitives.turn("z", 22.5)[:2, :2]
    for y, long, grow, material in (
        (top + handle / 2, handle, 1.0, wrap),
        (length / 2 - 0.012, 0.024, h / flat, wrap),
        (top, 0.016, 1.08, accent),
    ):
        mesh = primitives.prism(octagon * [broad * min(grow, 1.2), flat * grow], long).pointed("y")
        board.add(mesh, material, (0, y, z))
    board.solid((0.8 * w, head, h), (0, middle, z))
    board.solid((broad, length - head, flat), (0, head / 2, z))
    b.looks_like(shade)


def _sphere_wedges(count: int, index: int) -> Mesh:
    """Every count-th of the eight slices of a unit sphere about z."""
    sections, rings = 24, 10
    latitude = np.linspace(-np.pi / 2, np.pi / 2, rings + 1)
    longitude = np.linspace(0, 2 * np.pi, sections + 1)
    lon, lat = np.meshgrid(longitude, latitude, indexing="ij")
    points = np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=2).reshape(-1, 3)
    faces = primitives.grid_faces(*lon.shape)
    slices = faces.min(axis=1) // (rings + 1) * 8 // sections
    flat = np.linalg.norm(
        arithmetic.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]]), axis=1
    )
    return Mesh(points, points, faces[(slices % count == index) & (flat > 1e-9)])


def _seam(curve: F64) -> Mesh:
    """A ribbon along a closed curve on the unit sphere, a twentieth of its radius wide."""
    along = np.gradient(curve, axis=0)
    along[[0, -1]] = curve[1] - curve[-2]
    across = arithmetic.cross(curve, along)
    across *= 0.025 / np.linalg.norm(across, axis=1, keepdims=True)
    left, right = curve + across, curve - across
    points = np.vstack([left, right])
    i, n = np.arange(len(curve) - 1), len(curve)
    faces = np.vstack([np.column_stack([i, n + i, n + i + 1]), np.column_stack([i, n + i + 1, i + 1])])
    return Mesh(points, np.vstack([curve, curve]), faces)


def _strings(board: Posed, half_width: float, half_height: float, at: tuple[float, float, float]) -> None:
    x0, y0, z = at
    gauge = 0.0022
    for k in np.linspace(-0.8, 0.8, 7):
        reach = np.sqrt(1 - k * k)
        board.add(primitives.box((gauge, 2 * half_height * reach, gauge)), STRING, (x0 + k * half_width, y0, z))
    for k in np.linspace(-0.84, 0.84, 9):
        reach = np.sqrt(1 - k * k)
        board.add(
            primitives.box((2 * half_width * reach, gauge, gauge)), STRING, (x0, y0 + k * half_height, z + 0.5 * gauge)
        )


KINDS = {
    "BaseballBat": Kind(baseball_bat),
    "BasketBall": Kind(basket_ball),
    "Dumbbell": Kind(dumbbell),
    "TennisRacket": Kind(tennis_racket),
}
