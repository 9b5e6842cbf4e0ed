"""Vases, centrepieces, floor pieces and watering cans."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import primitives
from remqa_data.assets.parts import forms
from remqa_data.assets.parts.forms import Part
from remqa_data.assets.types.small.plants import TERRACOTTA, branches, pampas
from remqa_data.assets.types.small.statues import twist
from remqa_data.geometry.types import Vec3

GLAZES = (
    *materials.CERAMICS,
    TERRACOTTA,
    materials.ceramic("gray", (0.60, 0.62, 0.64)),
    materials.ceramic("pink", (0.85, 0.63, 0.62)),
    materials.CLEAR_GLASS,
    materials.BRASS,
)


def vase(b: Builder) -> None:
    """A vase: bottle neck, round belly, trumpet, or an urn with two handles; flat ones are low bowls."""
    glaze = b.pick(GLAZES)
    slender = (
        [(0.55, 0), (0.62, 0.03), (0.98, 0.3), (1, 0.4), (0.8, 0.58), (0.34, 0.72), (0.28, 0.88), (0.4, 1)],
        [(0.5, 0), (0.55, 0.02), (0.9, 0.3), (1, 0.55), (0.9, 0.78), (0.52, 0.92), (0.6, 1)],
        [(0.62, 0), (0.66, 0.04), (0.42, 0.12), (0.46, 0.45), (0.66, 0.78), (1, 1)],
        [
            (0.46, 0),
            (0.48, 0.05),
            (0.28, 0.1),
            (0.62, 0.3),
            (0.86, 0.52),
            (0.84, 0.66),
            (0.46, 0.8),
            (0.42, 0.9),
            (0.56, 1),
        ],
    )
    squat = (
        [(0.5, 0), (0.6, 0.03), (1, 0.42), (0.96, 0.62), (0.5, 0.9), (0.52, 1)],
        [(0.6, 0), (0.9, 0.16), (1, 0.45), (0.9, 0.8), (0.74, 1)],
        [(0.45, 0), (0.5, 0.1), (0.62, 0.3), (0.85, 0.75), (1, 1)],
        [(0.55, 0), (0.7, 0.1), (0.86, 0.4), (0.8, 0.66), (0.52, 0.84), (0.62, 1)],
    )
    shape = _smooth(b.by_variant(squat if b.h < 0.8 * b.w else slender))
    half = np.array([b.w / 2, b.d / 2, b.h])
    mouth = shape[-1][0]
    wall = min(0.07, 0.3 * mouth)
    inside = [(mouth - wall, 0.985), (max(0.6 * (mouth - wall), 0.1), 0.7), (0, 0.6)]
    b.add(primitives.revolve([(0, 0), *shape, *inside], 20).scaled(half), glaze)
    b.add(
        primitives.revolve([(0.96 * (mouth - wall), 0.965), (0, 0.965)], 20).scaled(half), materials.tinted(glaze, 0.25)
    )
    heights, radii = np.array([z for _, z in shape]), np.array([r for r, _ in shape])
    trim = b.pick([other for other in GLAZES[:9] if other.color != glaze.color])
    for low, high in b.pick((((0.4, 0.5),), ((0.3, 0.33), (0.55, 0.58)), ((0.1, 0.36),))):
        z = np.linspace(low, high, 4)
        band = np.column_stack([np.interp(z, heights, radii) + 0.006, z])
        b.add(primitives.revolve(band, 20).scaled(half), trim)
    if b.variant == 3:
        for s in (-1, 1):
            loop = [(s * 0.42, 0, 0.9), (s * 0.75, 0, 0.94), (s, 0, 0.84), (s, 0, 0.7), (s * 0.8, 0, 0.58)]
            path = np.array(loop) * [b.w / 2 - 0.007, 1, b.h]
            b.add(primitives.tube(path, 0.007, 6), trim)
    b.solid((0.7 * b.w, 0.7 * b.d, 0.98 * b.h), (0, 0, 0.49 * b.h))
    b.looks_like(glaze)


def table_top_decor(b: Builder) -> None:
    """A centrepiece: glass bowl of balls, dish of wicker balls, tray of pebbles and tea lights, or a knot of rings."""
    balls: list[Material] = [b.pick((*materials.CERAMICS, materials.BRASS, materials.COPPER)) for _ in range(4)]
    bowl = b.by_variant(
        (
            materials.CLEAR_GLASS,
            b.pick(materials.WOODS),
            b.pick((materials.BLACK_METAL, materials.WALNUT)),
            materials.STEEL,
        )
    )
    half = (b.w / 2, b.d / 2, b.h)
    if b.variant == 3:
        rings: list[Part] = []
        wood = b.pick(materials.WOODS)
        for x, tilt, roll in ((-0.6, 30, 20), (0.0, -40, -10), (0.6, 35, -25)):
            link = forms.ring(0.5, 0.2, 20, 8).turned(primitives.turn("x", tilt) @ primitives.turn("y", roll))
            rings.append((link.moved((x, 0, 0)), wood))
        balls[0] = wood
        forms.draw_fitted(b, rings, (-b.w / 2, -b.d / 2, 0), half)
    else:
        rim = b.by_variant((0.62, 0.55, 0.16))
        dish = [
            (0, 0),
            (0.45, 0),
            (0.5, 0.03),
            (0.85, 0.5 * rim),
            (1, rim),
            (0.96, rim),
            (0.8, 0.5 * rim + 0.03),
            (0.45, 0.09),
            (0, 0.09),
        ]
        if b.variant == 2:
            dish = [(0, 0), (0.9, 0), (1, rim), (0.96, rim), (0.88, 0.06), (0, 0.06)]
        b.add(primitives.revolve(dish, 20).scaled(half), bowl)
        r = 0.27 * min(b.w, b.d)
        spots = [(0.42 * np.cos(a), 0.42 * np.sin(a), 0.34) for a in np.arange(6) * np.pi / 3] + [(0.0, 0.0, 0.72)]
        for i, (x, y, z) in enumerate(spots):
            ball = primitives.ellipsoid((r, r, 0.56 * b.h), 10, 6)
            at = (x * b.w / 2, y * b.d / 2, z * b.h)
            if b.variant == 2:
                _tea_light(b, at, balls[i % 4], top=i == 6)
            else:
                b.add(ball, materials.WICKER if b.variant == 1 and i % 2 else balls[i % 4], at)
    b.solid((0.8 * b.w, 0.8 * b.d, 0.6 * b.h), (0, 0, 0.3 * b.h))
    b.looks_like(bowl if b.variant < 3 else balls[0])


def room_decor(b: Builder) -> None:
    """A tall piece for the floor: vase of branches, vase of pampas grass, twisted sculpture, or stacked stones."""
    glaze = b.pick(GLAZES)
    low, high = (-b.w / 2, -b.d / 2, 0.0), (b.w / 2, b.d / 2, b.h)
    if b.variant > 1:
        plinth = 0.08 * b.h
        b.box(
            (b.w, b.d, plinth),
            (0, 0, plinth / 2),
            b.pick((materials.EBONY, materials.STONES[0], materials.OAK)),
            radius=0.004,
        )
        body = (twist(1.0), glaze) if b.variant == 2 else None
        stones: list[Part] = []
        z = 0.0
        for i, size in enumerate((1.0, 0.9, 0.76, 0.62, 0.5, 0.36)):
            ball = primitives.ellipsoid((size, size, size), 14, 8).moved((0.04 * (-1) ** i, 0, z + size / 2))
            stones.append((ball, materials.STONES[(0, 3, 1, 2, 0, 1)[i]]))
            z += 0.94 * size
        inner = 0.9 if body else 0.96
        forms.draw_fitted(
            b,
            [body] if body else stones,
            (inner * low[0], inner * low[1], plinth),
            (inner * high[0], inner * high[1], b.h),
        )
        b.solid((0.6 * b.w, 0.6 * b.d, b.h), (0, 0, b.h / 2))
        b.looks_like(glaze if body else materials.STONES[1])
        return
    tall = 0.46 * b.h
    shape = _smooth(
        b.pick(
            (
                [(0.6, 0), (0.7, 0.03), (1, 0.55), (0.9, 0.8), (0.5, 0.93), (0.6, 1)],
                [(0.8, 0), (0.85, 0.02), (0.6, 0.5), (0.6, 0.8), (0.85, 1)],
            )
        )
    )
    radii = (0.36 * b.w, 0.36 * b.d, tall)
    b.add(primitives.revolve([(0, 0), *shape, (0.4, 0.99), (0, 0.9)], 20).scaled(radii), glaze)
    stems = branches(b) if b.variant == 0 else pampas(b)
    forms.draw_fitted(b, stems, (low[0], low[1], 0.9 * tall), high, rooted=True)
    b.solid((0.66 * b.w, 0.66 * b.d, tall), (0, 0, tall / 2))
    b.looks_like(glaze)


def watering_can(b: Builder) -> None:
    """A watering can, spout to the front or the right: tin with a rose, plastic, round copper, slim and long-necked."""
    long, wide = max(b.w, b.d), min(b.w, b.d)
    body = b.by_variant(
        (
            b.pick((materials.STEEL, materials.paint("green", "metal"))),
            b.pick(materials.PLASTICS),
            materials.COPPER,
            b.pick((materials.paint("blue", "metal"), materials.WHITE_METAL, materials.paint("yellow", "metal"))),
        )
    )
    h = b.h
    r = wide / 2
    centre = long / 2 - max(r, 0.36 * long)
    shape = b.by_variant(
        (
            [(0.9, 0), (1, 0.02), (1, 0.62), (0.8, 0.66)],
            [(0.86, 0), (1, 0.06), (0.9, 0.5), (0.6, 0.7)],
            [(0.6, 0), (0.95, 0.15), (1, 0.32), (0.85, 0.52), (0.5, 0.64)],
            [(1, 0), (1, 0.03), (0.62, 0.66), (0.5, 0.68)],
        )
    )
    half = (r, min(0.36 * long, r * 1.25), h)
    mouth = shape[-1]
    parts: list[Part] = [
        (primitives.revolve([(0, 0), *shape, (0.9 * mouth[0], mouth[1]), (0, 0.8 * mouth[1])], 20).scaled(half), body)
    ]
    tip = centre - long + 0.02
    flare = b.by_variant((0.032, 0.012, 0.026, 0.012))
    start = (0.0, -0.8 * half[1], 0.2 * h)
    neck = [
        start,
        (0, -1.25 * half[1], 0.34 * h),
        (0, tip - centre + 0.02, 0.84 * h),
        (0, tip - centre - 0.012, 0.92 * h),
    ]
    parts.append((primitives.tube(neck, [0.02, 0.016, 0.01, 0.01], 8), body))
    rose = primitives.cylinder(0.011, 0.03, flare, 12).turned(forms.towards((0, -1, 0.55)))
    parts.append(
        (rose.moved((0, tip - centre - 0.016, 0.93 * h)), b.by_variant((materials.BRASS, body, materials.BRASS, body)))
    )
    loop = [
        (0, 0.7 * half[1], 0.14 * h),
        (0, 1.3 * half[1], 0.36 * h),
        (0, 1.25 * half[1], 0.66 * h),
        (0, 0.7 * half[1], 0.86 * h),
        (0, 0.1 * half[1], 0.98 * h),
        (0, -0.5 * half[1], 0.86 * h),
        (0, -0.66 * half[1], 0.6 * h),
    ]
    handle = loop if b.variant in (0, 3) else [*loop[:5], (0, -0.1 * half[1], 0.9 * h), (0, -0.3 * half[1], 0.62 * h)]
    bend = np.array(
        [
            np.interp(np.linspace(0, len(handle) - 1, 15), np.arange(len(handle)), np.array(handle)[:, i])
            for i in range(3)
        ]
    ).T
    for _ in range(2):  # round the corners
        bend[1:-1] = (bend[:-2] + 2 * bend[1:-1] + bend[2:]) / 4
    parts.append((primitives.tube(bend, 0.008, 6), body if b.variant == 1 else b.pick((materials.BLACK_METAL, body))))
    if b.variant in (0, 3):
        parts.append((primitives.tube([(0, -0.6 * half[1], 0.6 * h), (0, -1.6 * half[1], 0.52 * h)], 0.004, 5), body))
        parts.append(
            (
                forms.ring(1.01, 0.04, 20, 5)
                .scaled((half[0], half[1], 0.1))
                .moved((0, 0, 0.6 * h * (1 if b.variant == 0 else 0.06))),
                body,
            )
        )
    if b.w > b.d:
        parts = [(mesh.turned(primitives.turn("z", 90)), material) for mesh, material in parts]
    forms.draw_fitted(b, parts, (-b.w / 2, -b.d / 2, 0), (b.w / 2, b.d / 2, b.h))
    b.solid((0.8 * b.w, 0.8 * b.d, 0.3 * h), (0, 0, 0.15 * h))
    middle: Vec3 = (0, 0.18 * b.d, h / 2) if b.d >= b.w else (-0.18 * b.w, 0, h / 2)
    b.solid((0.5 * b.w, 0.5 * b.d, 0.96 * h), middle)
    b.looks_like(body)


def _tea_light(b: Builder, at: Vec3, wax: Material, *, top: bool) -> None:
    r = 0.16 * min(b.w, b.d) * (1.0 if top else 0.8)
    tall = (0.86 if top else 0.42) * b.h
    b.cylinder(r, tall, (at[0], at[1], 0.06 * b.h + tall / 2), wax, sections=14, solid=False)
    b.cylinder(0.003, 0.08 * b.h, (at[0], at[1], 0.1 * b.h + tall), materials.SHADOW_GAP, sections=5, solid=False)


def _smooth(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Points on a smooth curve through a profile's corners (monotone in between: cubic Hermite with limited slopes)."""
    p = np.asarray(points)
    tangents = np.gradient(p, axis=0)
    curve = [points[0]]
    for i in range(len(p) - 1):
        for t in (0.5, 1.0):
            h = (2 * t**3 - 3 * t**2 + 1, t**3 - 2 * t**2 + t, -2 * t**3 + 3 * t**2, t**3 - t**2)
            r, z = h[0] * p[i] + h[1] * 0.7 * tangents[i] + h[2] * p[i + 1] + h[3] * 0.7 * tangents[i + 1]
            curve.append((float(min(max(r, 0.02), 1.0)), float(min(max(z, curve[-1][1]), 1.0))))
    return curve


KINDS = {
    "RoomDecor": Kind(room_decor),
    "TableTopDecor": Kind(table_top_decor),
    "Vase": Kind(vase),
    "WateringCan": Kind(watering_can),
}
