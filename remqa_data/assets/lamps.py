"""Lamps that stand on a desk or on the floor."""

from __future__ import annotations

import numpy as np

from remqa_data.assets import forms, materials, primitives
from remqa_data.assets.builder import Builder
from remqa_data.assets.kind import Kind
from remqa_data.assets.model import F64, Material

SHADES = tuple(
    Material("fabric", color, rgb, "fabric", 0.2, glow=0.15)
    for color, rgb in (
        ("white", (0.96, 0.94, 0.88)),
        ("beige", (0.88, 0.79, 0.62)),
        ("red", (0.70, 0.26, 0.22)),
        ("blue", (0.36, 0.48, 0.64)),
        ("black", (0.17, 0.17, 0.18)),
        ("green", (0.44, 0.58, 0.46)),
    )
)
LAMP_METALS = (materials.BLACK_METAL, materials.WHITE_METAL, materials.BRASS, materials.CHROME, materials.COPPER)
ENAMELS = (*LAMP_METALS, *(materials.paint(color, "metal", 0.4) for color in ("red", "yellow", "green", "blue")))


def desk_lamp(b: Builder) -> None:
    """A desk lamp: shade on a turned foot, jointed arm with a cone, banker's lamp, or a glass globe."""
    draw = b.by_variant((_shade_lamp, _arm_lamp, _bankers_lamp, _globe_lamp))
    draw(b)


def floor_lamp(b: Builder) -> None:
    """A floor lamp: shade on a pole, shade on three legs, curved pole with a dome, uplight, or a paper column."""
    draw = b.by_variant((_pole_lamp, _tripod_lamp, _arc_lamp, _uplight, _paper_column))
    draw(b)


def _shade_lamp(b: Builder) -> None:
    foot = b.pick((*materials.CERAMICS, materials.WALNUT, materials.OAK, materials.BRASS))
    shade = b.pick(SHADES)
    low = 0.54 * b.h
    r = min(0.3 * min(b.w, b.d), 0.3 * low)
    neck = low + 0.08 * b.h
    shapes = (
        [(0.8, 0), (0.85, 0.03), (0.6, 0.08), (0.95, 0.3), (1.0, 0.45), (0.8, 0.65), (0.3, 0.85), (0.12, 1)],
        [(0.9, 0), (0.9, 0.05), (0.3, 0.12), (0.2, 0.3), (0.42, 0.45), (0.2, 0.6), (0.16, 1)],
        [(1.0, 0), (1.0, 0.62), (0.85, 0.7), (0.15, 0.74), (0.12, 1)],
    )
    profile = [(0, 0), *((r * u, v * neck) for u, v in b.pick(shapes)), (0, neck)]
    b.add(primitives.revolve(profile, 18), foot)
    b.solid((1.4 * r, 1.4 * r, neck), (0, 0, neck / 2))
    _shade(b, (b.w, b.d), low, b.h, shade, b.pick((0.6, 0.72, 0.9)))
    b.looks_like(shade)


def _arm_lamp(b: Builder) -> None:
    paint = b.pick(ENAMELS)
    foot, head = min(0.34 * min(b.w, b.d), 0.09), min(0.32 * min(b.w, b.d), 0.085)
    base, reach = (foot - b.w / 2, b.d / 2 - foot), (b.w / 2 - head, head - b.d / 2)
    plate = [(0, 0), (foot, 0), (foot, 0.012), (0.8 * foot, 0.02), (0.25 * foot, 0.026), (0, 0.03)]
    b.add(primitives.revolve(plate, 20), paint, (*base, 0))
    b.solid((1.6 * foot, 1.6 * foot, 0.02), (*base, 0.01))
    tall = 0.42 * head + 0.03
    hip = (base[0], base[1], 0.05)
    bend = (base[0] + 0.06 * b.w, base[1] - 0.04 * b.d, 0.62 * b.h)
    elbow = (base[0] * 0.96 + 0.02, base[1] * 0.96 - 0.02, b.h - 0.012)
    wrist = (0.72 * reach[0], 0.72 * reach[1], b.h - 0.14 * b.h)
    for start, end in ((hip, bend), (bend, elbow), (elbow, wrist)):
        b.add(primitives.tube([start, end], 0.006, 6), paint)
    for joint in (hip, bend, elbow, wrist):
        b.add(primitives.ellipsoid((0.024, 0.024, 0.024), 8, 6), materials.STEEL, joint)
    b.add(primitives.tube([(*base, 0.02), hip], 0.009, 8), paint)
    drop = min(0.26 * b.h, 2.0 * head)
    crown = b.h - 0.1 * b.h
    cone = [(head, -drop), (0.85 * head, -0.62 * drop), (0.34 * head, -0.16 * drop), (0.3 * head, 0.0), (0, 0.0)]
    inner = [(0, -0.3 * drop), (0.5 * head, -0.4 * drop), (0.97 * head, -drop), (head, -drop)]
    b.add(primitives.revolve(cone, 20), paint, (*reach, crown))
    b.add(primitives.revolve(inner, 20), materials.WHITE_METAL, (*reach, crown))
    b.add(
        primitives.ellipsoid((0.7 * head, 0.7 * head, 0.8 * head), 10, 6),
        materials.LAMP_LIGHT,
        (*reach, crown - 0.62 * drop),
    )
    b.add(primitives.tube([wrist, (*reach, crown - 0.02)], 0.008, 6), paint)
    b.solid((0.1 * b.w + 0.02, 0.1 * b.d + 0.02, b.h), (base[0] + 0.02, base[1] - 0.02, b.h / 2))
    b.solid((1.6 * head, 1.6 * head, drop), (*reach, crown - drop / 2))
    b.solid(
        (0.9 * b.w, 0.04, tall), (0, 0, b.h - 0.1 * b.h), primitives.turn("z", float(np.degrees(np.arctan2(-b.d, b.w))))
    )
    b.looks_like(paint)


def _bankers_lamp(b: Builder) -> None:
    brass = b.pick((materials.BRASS, materials.COPPER, materials.CHROME))
    glass = b.pick(
        (
            materials.ceramic("green", (0.10, 0.42, 0.24)),
            materials.ceramic("blue", (0.14, 0.26, 0.52)),
            materials.ceramic("orange", (0.80, 0.47, 0.16)),
        )
    )
    shade = min(0.36 * b.h, 0.55 * min(b.w, b.d) + 0.04)
    low = b.h - shade
    foot = [(0, 0), (1, 0), (1, 0.014), (0.86, 0.024), (0.2, 0.04), (0, 0.04)]
    b.add(primitives.revolve(foot, 20).scaled((0.3 * b.w, min(0.42 * b.d, 0.3 * b.w + 0.03), 1)), brass, solid=True)
    stem = [
        (0, 0.02),
        (0.028, 0.03),
        (0.012, 0.08),
        (0.01, 0.4 * low),
        (0.02, 0.45 * low),
        (0.01, 0.5 * low),
        (0.009, low + 0.5 * shade),
        (0, low + 0.5 * shade),
    ]
    b.add(primitives.revolve(stem, 12), brass)
    b.solid((0.04, 0.04, low), (0, 0, low / 2))
    steps = np.linspace(0, np.pi / 2, 6)
    rings = [
        _ring(b.w * (0.72 + 0.28 * np.cos(a)), b.d * (0.1 + 0.9 * np.cos(a)), low + 0.94 * shade * np.sin(a))
        for a in steps
    ]
    b.add(primitives.loft(rings, capped=False), glass)
    b.add(primitives.prism(rings[-1][:, :2], 0.004), glass, (0, 0, low + 0.94 * shade - 0.002))
    under = [_ring(0.98 * b.w, 0.96 * b.d, low + 0.004)]
    b.add(
        primitives.prism(under[0][:, :2], 0.006),
        Material("glass", "white", (0.98, 0.95, 0.82), glow=0.7),
        (0, 0, low + 0.006),
    )
    b.add(primitives.ellipsoid((0.03, 0.03, 0.12 * shade), 10, 6), brass, (0, 0, b.h - 0.06 * shade))
    chain = [(0.22 * b.w, -0.2 * b.d, low), (0.22 * b.w, -0.2 * b.d, low - 0.22 * b.h)]
    b.add(primitives.tube(chain, 0.0022, 5), brass)
    b.add(primitives.ellipsoid((0.014, 0.014, 0.014), 8, 4), brass, chain[1])
    b.solid((0.96 * b.w, 0.9 * b.d, 0.8 * shade), (0, 0, low + 0.4 * shade))
    b.looks_like(glass)


def _globe_lamp(b: Builder) -> None:
    metal = b.pick((*LAMP_METALS, materials.OAK, materials.WALNUT))
    light = Material("glass", "white", (0.98, 0.96, 0.90), glow=0.55)
    ball = min(0.5 * (b.w + b.d), 0.78 * b.h)
    low = b.h - ball
    foot = [(0, 0), (1, 0), (1, 0.03), (0.92, 0.036), (0, 0.036)]
    b.add(primitives.revolve(foot, 20).scaled((0.34 * b.w, 0.34 * b.d, min(1.0, low / 0.06))), metal)
    stem = low + 0.04 * ball
    b.cylinder(0.012, stem, (0, 0, stem / 2), metal, sections=10, solid=False)
    cup = [(0.06, low - 0.02), (0.22, low + 0.03 * ball), (0.3, low + 0.1 * ball), (0, low + 0.1 * ball)]
    b.add(primitives.revolve([(0, low - 0.02), *cup], 18).scaled((b.w, b.d, 1)), metal)
    b.add(primitives.ellipsoid((b.w, b.d, ball), 20, 12), light, (0, 0, low + ball / 2))
    b.solid((0.66 * b.w, 0.66 * b.d, b.h), (0, 0, b.h / 2))
    b.looks_like(light)


def _pole_lamp(b: Builder) -> None:
    metal, shade = b.pick(LAMP_METALS), b.pick(SHADES)
    low = b.h - min(0.36, 0.2 * b.h)
    _disc_foot(b, (0.34 * b.w, 0.34 * b.d), metal)
    b.cylinder(0.014, low + 0.08, (0, 0, (low + 0.08) / 2), metal, sections=10)
    for z in (0.33, 0.66):
        b.add(primitives.ellipsoid((0.044, 0.044, 0.03), 10, 6), metal, (0, 0, z * b.h))
    b.add(primitives.tube([(0.06, -0.04, low + 0.02), (0.06, -0.04, low - 0.14)], 0.002, 5), metal)
    _shade(b, (b.w, b.d), low, b.h, shade, b.pick((0.55, 0.75, 0.95)))
    b.looks_like(shade)


def _tripod_lamp(b: Builder) -> None:
    wood, shade = b.pick((*materials.WOODS, materials.BLACK_METAL)), b.pick(SHADES)
    low = b.h - min(0.38, 0.2 * b.h)
    for a in np.radians((-90, 30, 150)):
        foot = (0.92 * b.w / 2 * np.cos(a), 0.92 * b.d / 2 * np.sin(a), 0.0)
        b.add(primitives.tube([foot, (0.04 * np.cos(a), 0.04 * np.sin(a), low - 0.1)], [0.014, 0.018], 8), wood)
    b.solid((0.7 * b.w, 0.7 * b.d, 0.4 * b.h), (0, 0, 0.2 * b.h))
    b.solid((0.3 * b.w, 0.3 * b.d, low), (0, 0, low / 2))
    b.cylinder(0.065, 0.045, (0, 0, low - 0.1), b.pick((materials.BRASS, materials.BLACK_METAL)), sections=12)
    b.cylinder(0.014, 0.16, (0, 0, low - 0.02), materials.BLACK_METAL, sections=8)
    _shade(b, (b.w, b.d), low, b.h, shade, 0.9)
    b.looks_like(shade)


def _arc_lamp(b: Builder) -> None:
    metal, paint = b.pick((materials.CHROME, materials.BLACK_METAL, materials.BRASS)), b.pick(ENAMELS)
    foot, head = min(0.3 * min(b.w, b.d), 0.15), min(0.34 * min(b.w, b.d), 0.17)
    base, reach = (foot - b.w / 2, b.d / 2 - foot), (b.w / 2 - head, head - b.d / 2)
    b.cylinder(foot, 0.05, (*base, 0.025), b.pick((materials.STONES[0], materials.STONES[2], metal)), sections=20)
    drop = 1.15 * head
    bend = 0.22 * b.h
    t = np.linspace(0, np.pi, 12)
    along = (1 - np.cos(t)) / 2
    z = b.h - bend + (bend - 0.012) * np.sin(t)
    curve = [
        (base[0] + (reach[0] - base[0]) * u, base[1] + (reach[1] - base[1]) * u, v)
        for u, v in zip(along, z, strict=True)
    ]
    end = b.h - bend - 0.02
    b.add(primitives.tube([(*base, 0.04), (*base, 0.5 * b.h), *curve, (*reach, end)], 0.012, 8), metal)
    dome = [
        (head, -drop),
        (0.96 * head, -0.7 * drop),
        (0.72 * head, -0.28 * drop),
        (0.3 * head, -0.04 * drop),
        (0.2 * head, 0),
        (0, 0),
    ]
    inner = [(0, -0.2 * drop), (0.7 * head, -0.34 * drop), (0.98 * head, -drop), (head, -drop)]
    b.add(primitives.revolve(dome, 20), paint, (*reach, end))
    b.add(primitives.revolve(inner, 20), materials.WHITE_METAL, (*reach, end))
    b.add(primitives.ellipsoid((0.09, 0.09, 0.1), 10, 6), materials.LAMP_LIGHT, (*reach, end - 0.62 * drop))
    b.solid((0.05, 0.05, b.h - bend), (*base, (b.h - bend) / 2))
    b.solid((1.6 * head, 1.6 * head, drop), (*reach, end - drop / 2))
    b.looks_like(paint)


def _uplight(b: Builder) -> None:
    metal = b.pick(LAMP_METALS)
    tall = min(0.16, 0.1 * b.h)
    bowl = [
        (0.06, 0),
        (0.5, 0.3 * tall),
        (0.86, 0.65 * tall),
        (1, tall),
        (0.97, tall),
        (0.82, 0.68 * tall),
        (0, 0.4 * tall),
    ]
    _disc_foot(b, (0.36 * b.w, 0.36 * b.d), metal)
    low = b.h - tall
    b.cylinder(0.018, low + 0.02, (0, 0, (low + 0.02) / 2), metal, top_radius=0.013, sections=10)
    b.add(
        primitives.revolve([(0, 0), *bowl], 24).scaled((b.w / 2, b.d / 2, 1)),
        b.pick((metal, materials.FROSTED_GLASS)),
        (0, 0, low),
    )
    glow = primitives.cylinder(0.84, 0.01, sections=24).scaled((b.w / 2, b.d / 2, 1))
    b.add(glow, materials.LAMP_LIGHT, (0, 0, b.h - 0.26 * tall))
    b.solid((0.7 * b.w, 0.7 * b.d, tall), (0, 0, b.h - tall / 2))
    arm = [(0, 0, 0.62 * b.h), (0.12 * b.w, -0.1 * b.d, 0.66 * b.h), (0.24 * b.w, -0.2 * b.d, 0.62 * b.h)]
    b.add(primitives.tube(arm, 0.007, 6), metal)
    b.add(primitives.cylinder(0.05, 0.09, 0.025, 14), metal, (0.24 * b.w, -0.2 * b.d, 0.58 * b.h))
    b.looks_like(metal)


def _paper_column(b: Builder) -> None:
    paper = Material("paper", "white", (0.97, 0.94, 0.86), glow=0.35)
    wood = b.pick(materials.WOODS)
    low = 0.12 * b.h
    ribs = 14
    z = np.linspace(low, b.h - 0.02, 2 * ribs + 1)
    swell = 0.86 + 0.1 * np.sin(np.linspace(0.2, 2.9, 2 * ribs + 1) * 2.0)
    outline = [
        (0, low),
        *((s * (1.0 if i % 2 else 0.93), v) for i, (s, v) in enumerate(zip(swell, z, strict=True))),
        (0, b.h - 0.02),
    ]
    b.add(primitives.revolve(outline, 20, crease_deg=10).scaled((b.w / 2, b.d / 2, 1)), paper)
    b.solid((0.75 * b.w, 0.75 * b.d, b.h), (0, 0, b.h / 2))
    for x in (-1, 1):
        for y in (-1, 1):
            at = (x * 0.3 * b.w, y * 0.3 * b.d)
            b.add(primitives.tube([(1.3 * at[0], 1.3 * at[1], 0), (*at, low + 0.02)], 0.014, 6), wood)
    b.add(forms.ring(0.97, 0.06, 20, 6).scaled((b.w / 2, b.d / 2, 0.4)), wood, (0, 0, low))
    b.add(forms.ring(0.6, 0.06, 16, 6).scaled((b.w / 2, b.d / 2, 0.4)), wood, (0, 0, b.h - 0.012))
    b.looks_like(paper)


def _shade(b: Builder, size: tuple[float, float], low: float, high: float, cloth: Material, top: float) -> None:
    """An open lamp shade with a bulb in it and its ring of wire; `top` is its upper width as a share of the lower."""
    plan = (size[0] / 2, size[1] / 2, 1.0)
    tall = high - low
    b.add(primitives.revolve([(1, low), (top, high)], 24).scaled(plan), cloth)
    lining = Material("fabric", "white", (1.0, 0.95, 0.82), glow=0.5)
    b.add(primitives.revolve([(top - 0.02, high), (0.98, low)], 24).scaled(plan), lining)
    b.add(primitives.revolve([(0.98, low), (1, low)], 24).scaled(plan), lining)
    b.add(primitives.revolve([(top, high), (top - 0.02, high)], 24).scaled(plan), lining)
    b.box((1.9 * top * plan[0], 0.004, 0.004), (0, 0, high - 0.15 * tall), materials.BRASS, solid=False)
    bulb = min(0.06, 0.4 * size[0])
    b.add(primitives.ellipsoid((bulb, bulb, 1.3 * bulb), 10, 6), materials.LAMP_LIGHT, (0, 0, low + 0.45 * tall))
    b.cylinder(0.006, 0.85 * tall, (0, 0, low + 0.425 * tall), materials.BRASS, sections=6, solid=False)
    b.solid((0.8 * size[0], 0.8 * size[1], tall), (0, 0, (low + high) / 2))


def _disc_foot(b: Builder, radii: tuple[float, float], metal: Material) -> None:
    profile = [(0, 0), (1, 0), (1, 0.014), (0.9, 0.022), (0.14, 0.034), (0.08, 0.05), (0, 0.05)]
    b.add(primitives.revolve(profile, 24).scaled((*radii, 1)), metal)
    b.solid((1.5 * radii[0], 1.5 * radii[1], 0.022), (0, 0, 0.011))


def _ring(width: float, depth: float, z: float) -> F64:
    outline = primitives.ellipse(width, depth, 24, 3.0)
    return np.column_stack([outline, np.full(len(outline), z)])


KINDS = {"DeskLamp": Kind(desk_lamp), "FloorLamp": Kind(floor_lamp, 5)}
