"""Shakers, foil, sponges, paper towels: what lies about beside the sink."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.core.posed import Posed
from remqa_data.assets.looks import materials
from remqa_data.assets.looks.materials import paint
from remqa_data.assets.mesh import primitives
from remqa_data.assets.parts.turnery import Piece, Profile, radius_at, rounded, turned

SALT = Material("glass", "white", (0.95, 0.95, 0.93), gloss=0.5)
PEPPER = Material("glass", "black", (0.24, 0.20, 0.17), "granite", 0.05, gloss=0.4)
FOIL = Material("metal", "gray", (0.64, 0.65, 0.68), gloss=0.8)
CRINKLED = Material("metal", "gray", (0.74, 0.75, 0.78), "brushed", 0.15, gloss=0.6)
WRAPS = tuple(paint(color, "cardboard", 0.15) for color in ("blue", "red", "green", "yellow", "purple"))
KRAFT = Material("paper", "brown", (0.72, 0.58, 0.42), "towel", 0.12)
KITCHEN_PAPER = Material("paper", "white", (0.96, 0.96, 0.95), "towel", 0.12)
FOAMS = tuple(
    Material("sponge", color, rgb, "plaster", 0.05)
    for color, rgb in (
        ("yellow", (0.94, 0.80, 0.26)),
        ("blue", (0.36, 0.60, 0.82)),
        ("pink", (0.92, 0.56, 0.62)),
        ("green", (0.55, 0.76, 0.36)),
        ("orange", (0.93, 0.58, 0.26)),
    )
)
SCOURERS = tuple(
    Material("sponge", color, rgb, "carpet", 0.05)
    for color, rgb in (("green", (0.16, 0.42, 0.24)), ("blue", (0.16, 0.28, 0.50)), ("gray", (0.50, 0.50, 0.52)))
)
DARK_CERAMICS = (
    materials.ceramic("black"),
    materials.ceramic("gray", (0.33, 0.34, 0.36)),
    materials.ceramic("brown", (0.34, 0.23, 0.17)),
)

S_STROKE = (
    (0.42, 0.36),
    (0.20, 0.5),
    (-0.2, 0.5),
    (-0.42, 0.32),
    (-0.30, 0.10),
    (0.30, -0.10),
    (0.42, -0.32),
    (0.2, -0.5),
)
S_LETTER = ((*S_STROKE, (-0.2, -0.5), (-0.42, -0.36)),)
P_LETTER = (
    ((-0.36, -0.5), (-0.36, 0.5)),
    ((-0.36, 0.5), (0.12, 0.5), (0.40, 0.38), (0.40, 0.12), (0.12, 0.0), (-0.36, 0.0)),
)


def salt_shaker(b: Builder) -> None:
    """A salt shaker, light, marked S: glass with a metal cap; pear-shaped ceramic; wooden mill; square."""
    body = b.by_variant((SALT, materials.WHITE_CERAMIC, b.pick((materials.PINE, materials.WHITE_WOOD)), SALT))
    cap = b.by_variant((materials.CHROME, materials.CHROME, materials.CHROME, materials.WHITE_PLASTIC))
    ink = b.pick((materials.BLACK_PLASTIC, paint("blue")))
    _shaker(b, body, cap, ink, S_LETTER)


def pepper_shaker(b: Builder) -> None:
    """A pepper shaker, dark, marked P: glass with a black cap; pear-shaped ceramic; wooden mill; square."""
    body = b.by_variant((PEPPER, b.pick(DARK_CERAMICS), b.pick((materials.WALNUT, materials.EBONY)), PEPPER))
    cap = b.by_variant((materials.BLACK_METAL, materials.CHROME, materials.BRASS, materials.BLACK_PLASTIC))
    _shaker(b, body, cap, materials.WHITE_PLASTIC, P_LETTER)


def aluminum_foil(b: Builder) -> None:
    """Aluminium foil: carton with a sheet hanging out; bare roll; open carton with the roll in it; roll in a sleeve."""
    p = Posed(b)
    wrap = b.pick(WRAPS)
    if b.variant in (0, 2):
        _foil_carton(b, p, wrap)
    else:
        _foil_roll(p, p.h / 2, -p.w / 2 + p.h / 2, p.h / 2, p.d)
        if b.variant == 3:
            _foil_roll(p, p.h / 2, -p.w / 2 + p.h / 2, p.h / 2 + 0.0006, 0.5 * p.d, wrap)
        reach = np.linspace(0, 1, 7)
        x, y = np.meshgrid(
            -p.w / 2 + p.h / 2 + reach * (p.w - p.h / 2), np.linspace(-0.5, 0.5, 5) * p.d * 0.99, indexing="ij"
        )
        wave = 0.0016 + 0.06 * p.h * (1 - np.cos(11 * x / p.w + 60 * y)) * (reach[:, None] > 0.1)
        p.add(primitives.sheet(x, y, wave, 0.0006), CRINKLED)
        p.solid((p.h * 0.8, p.d, p.h), (-p.w / 2 + p.h / 2, 0, p.h / 2))
        p.solid((p.w, p.d, 0.003), (0, 0, 0.0015))
    b.looks_like(FOIL)


def dish_sponge(b: Builder) -> None:
    """A dish sponge: two layers, the scourer below; waisted; plain with pores; wavy edge."""
    p = Posed(b, flat=True)
    foam = b.pick(FOAMS)
    scourer = b.pick([s for s in SCOURERS if s.color != foam.color])
    under = b.by_variant((0.30, 0.32, 0.0, 0.28)) * p.h
    outline = primitives.rounded_rect(p.w, p.d, 0.008, 3)
    if b.variant in (1, 3):
        t = np.linspace(-0.5, 0.5, 11 if b.variant == 1 else 21)
        waist = 0.11 * p.w * np.cos(2 * np.pi * t) if b.variant == 1 else 0.035 * p.w * np.cos(14 * np.pi * t)
        inset = np.maximum(waist - waist.min(), 0.0) if b.variant == 3 else np.maximum(waist, 0.0)
        right = np.column_stack([p.w / 2 - inset, t * p.d])
        outline = np.vstack([right, -right])
    p.add(primitives.prism(outline, p.h - under), foam, (0, 0, (p.h + under) / 2))
    if b.variant != 2:
        p.add(primitives.prism(outline * 0.995, under), scourer, (0, 0, under / 2))
    else:
        dark, pore = materials.tinted(foam, 0.55), primitives.ellipsoid((1.0, 0.8, 0.2), 6, 2)
        on_side = pore.turned(primitives.turn("y", 90))
        for _ in range(24):
            x, y, z = b.between(-0.44, 0.44) * p.w, b.between(-0.46, 0.46) * p.d, b.between(0.2, 0.8) * p.h
            size = b.between(0.002, 0.006)
            p.add(pore.scaled((size, size, 0.004)), dark, (x, y, p.h))
            p.add(on_side.scaled((0.004, size, size)), dark, (p.w / 2 if x > 0 else -p.w / 2, y, z))
    p.rest(1.0, 1.0)
    b.looks_like(foam)


def paper_towel_roll(b: Builder) -> None:
    """A roll of paper towels: plain; printed with bands; on a wooden stand; brown with a sleeve."""
    p = Posed(b, upright=True)
    paper = KRAFT if b.variant == 3 else KITCHEN_PAPER
    accent = b.pick(WRAPS)
    wide, r = max(p.w, p.d), min(p.w, p.d) / 2
    turn = primitives.turn("z", 0 if p.w >= p.d else -90)
    core = min(0.020, 0.55 * r)
    low, high = (0.05 * p.h, 0.90 * p.h) if b.variant == 2 else (0.0, p.h)
    bands = b.by_variant(((), (0.10, 0.15, 0.85, 0.90), (), (0.25, 0.75)))
    heights = [low, *(low + t * (high - low) for t in bands), high]
    x = r - wide / 2
    at = (x, 0.0, 0.0) if p.w >= p.d else (0.0, -x, 0.0)
    pieces: list[Piece] = [(paper, [(core, low), (r, low)])]
    t = np.linspace(0, 1, 5)
    for i, (start, end) in enumerate(pairwise(heights)):
        print_ = accent if i % 2 else paper
        pieces.append((print_, [(r, end)]))
        flap_x, flap_z = np.meshgrid(x + t * (wide / 2 - x), np.array([start, end]), indexing="ij")
        flap_y = np.repeat((r - 0.0004 - 0.10 * r * np.sin(np.pi * t) * t)[:, None], 2, axis=1)
        flap = primitives.sheet(flap_x, flap_z, flap_y, 0.0008).turned(primitives.turn("x", 90))
        p.add(flap.turned(turn), print_)
    pieces += [(paper, [(core + 0.0015, high)]), (materials.CARDBOARD, [(core, high), (core, low)])]
    turned(p, pieces, at)
    if b.variant == 2:
        wood = b.pick((materials.OAK, materials.WALNUT, materials.PINE))
        base: Profile = [(0, 0), (r, 0), (r, 0.04 * p.h), (0.30 * core, 0.05 * p.h), (0.30 * core, 0.93 * p.h)]
        knob = rounded([(0.30 * core, 0.93 * p.h), (0.62 * core, 0.94 * p.h), (0.62 * core, 0.995 * p.h), (0.0, p.h)])
        turned(p, [(wood, [*base, *knob])], at, sections=16)
    p.rest(0.75, 1.0)
    b.looks_like(paper)


def _shaker(
    b: Builder, body: Material, cap: Material, ink: Material, letter: tuple[tuple[tuple[float, float], ...], ...]
) -> None:
    """A shaker of a body and a cap, with its letter on the front and holes in the top."""
    r, h = min(b.w, b.d) / 2, b.h
    glass = materials.CLEAR_GLASS
    power = b.by_variant((2.0, 2.0, 2.0, 5.0))
    shape = b.by_variant(
        (
            [(0.88, 0.0), (1.0, 0.04), (0.94, 0.30), (0.80, 0.62), (0.76, 0.72)],
            [(0.74, 0.0), (0.98, 0.05), (1.0, 0.28), (0.80, 0.58), (0.56, 0.84)],
            [(0.98, 0.0), (1.0, 0.12), (0.62, 0.32), (0.58, 0.44), (0.88, 0.64), (0.80, 0.72)],
            [(0.97, 0.0), (1.0, 0.02), (1.0, 0.70), (0.96, 0.74)],
        )
    )
    side = [(p * r, z * h) for p, z in shape]
    fine = rounded(side) if b.variant in (1, 2) else np.asarray(side)
    top = b.by_variant(
        (
            [(0.84, 0.72), (0.84, 0.88), (0.70, 0.97), (0.40, 1.0), (0.0, 1.0)],
            [(0.56, 0.84), (0.57, 0.90), (0.48, 0.97), (0.25, 1.0), (0.0, 1.0)],
            [(0.30, 0.73), (0.70, 0.76), (0.86, 0.82), (0.74, 0.91), (0.20, 0.935)],
            [(0.88, 0.74), (0.90, 0.96), (0.84, 1.0), (0.0, 1.0)],
        )
    )
    lid = [(p * r, z * h) for p, z in top]
    if b.variant in (0, 3):  # one sees through the glass how full it is
        level = 0.52 * h
        full = [point for point in fine if point[1] < level]
        rest = [point for point in fine if point[1] >= level]
        at_level = (radius_at(fine, level), level)
        turned(b, [(body, [(0, 0), *full, at_level]), (glass, [*rest, (0.0, rest[-1][1])])], sections=18, power=power)
        turned(b, [(cap, lid if b.variant == 3 else [rest[-1], *lid])], sections=18)
    elif b.variant == 1:
        turned(b, [(body, [(0, 0), *fine]), (cap, lid)], sections=18)
    else:
        knob = [(0.20, 0.935), (0.30, 0.95), (0.30, 0.985), (0.18, 1.0), (0.0, 1.0)]
        turned(b, [(body, [(0, 0), *fine, *lid]), (cap, [(p * r, z * h) for p, z in knob])], sections=18)
    if b.variant != 2:
        for i in range(5):
            x, y = 0.22 * r * np.cos(1.26 * i), 0.22 * r * np.sin(1.26 * i)
            b.cylinder(0.0014, 0.002, (x, y, h - 0.0006), materials.SHADOW_GAP, sections=6, solid=False)
    size, z = b.by_variant(((0.62, 0.28), (0.74, 0.30), (0.50, 0.14), (0.80, 0.30)))
    size = min(size * r, 0.22 * h)
    for stroke in letter:
        corners = np.array(stroke)
        dense = np.linspace(0, len(corners) - 1, 2 * len(corners) - 1)
        path = []
        for t in dense:
            u, v = (float(np.interp(t, np.arange(len(corners)), corners[:, i])) for i in (0, 1))
            px, pz = u * size, z * h + v * size * 1.2
            radius = radius_at(fine, pz) * (1.0 if power == 2.0 else 1.05)
            py = -np.sqrt(max(radius**2 - px**2, 0.0)) if power == 2.0 else -radius / 1.05 + 0.001
            path.append((px, py, pz))
        b.add(primitives.tube(path, 0.085 * size + 0.0004, 4), ink)
    b.solid((1.5 * r, 1.5 * r, h), (0, 0, h / 2))
    b.looks_like(body)


def _foil_roll(p: Posed, radius: float, x: float, outer: float, length: float, wrap: Material = FOIL) -> None:
    """A roll along y with its cardboard core, or only its sleeve."""
    core, half = 0.55 * radius, length / 2
    pieces: list[Piece] = [(wrap, [(core, -half), (outer, -half), (outer, half), (core, half)])]
    if wrap is FOIL:
        pieces.append((materials.CARDBOARD, [(core - 0.001, half), (core - 0.001, -half), (core, -half)]))
    turned(p, pieces, (x, 0, radius), sections=16, axis="y")


def _foil_carton(b: Builder, p: Posed, wrap: Material) -> None:
    wall, deep = 0.0015, p.w - 0.003
    x = -0.0015
    if b.variant == 0:
        body = primitives.box((deep, p.d, p.h - 0.002))
        p.add(body, wrap, (x, 0, (p.h - 0.002) / 2))
        p.add(primitives.box((deep * 0.98, p.d, 0.002)), materials.tinted(wrap, 0.85), (x, 0, p.h - 0.001))
        for sign in (-1, 1):  # the roll shows at the ends
            for radius, material in ((0.42 * p.h, FOIL), (0.22 * p.h, materials.CARDBOARD)):
                end = primitives.cylinder(radius, 0.001, sections=12).pointed("y")
                p.add(end, material, (x, sign * (p.d / 2 - 0.0004 + (material is not FOIL) * 0.0004), p.h / 2 - 0.001))
    else:
        tall = 0.72 * p.h
        for sign in (-1, 1):
            p.add(primitives.box((wall, p.d, tall)), wrap, (x + sign * (deep - wall) / 2, 0, tall / 2))
            p.add(primitives.box((deep - 2 * wall, wall, tall)), wrap, (x, sign * (p.d - wall) / 2, tall / 2))
        p.add(primitives.box((deep - 2 * wall, p.d - 2 * wall, wall)), materials.CARDBOARD, (x, 0, wall / 2))
        r = (p.h - wall) / 2
        roll = primitives.cylinder(r, p.d * 0.97, sections=16).pointed("y")
        p.add(roll, FOIL, (x, 0, wall + r))
        for sign in (-1, 1):
            core = primitives.cylinder(0.5 * r, 0.002, sections=12).pointed("y")
            p.add(core, materials.CARDBOARD, (x, sign * p.d * 0.485, wall + r))
    front = p.w / 2
    top = p.h if b.variant == 2 else 0.86 * p.h
    teeth = [(y, 0.22 * p.h + (0.04 * p.h if i % 2 else 0.0)) for i, y in enumerate(np.linspace(0.42, -0.42, 25) * p.d)]
    tongue = primitives.prism([(-0.42 * p.d, top - 0.25 * p.h), (0.42 * p.d, top - 0.25 * p.h), *teeth], 0.001)
    upright = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    p.add(tongue.turned(upright), CRINKLED, (front - 0.0006, 0, 0))
    if b.variant == 2:
        x0 = x + 0.2 * p.h
        slope = [(x0, 0.97 * p.h), (front, 0.75 * p.h - 0.002), (front - 0.001, 0.73 * p.h), (x0, 0.95 * p.h)]
        sheet = primitives.prism(slope, 0.84 * p.d).turned(primitives.turn("x", 90))
        p.add(sheet, CRINKLED)
    else:
        lip = primitives.box((0.002, 0.84 * p.d, 0.27 * p.h))
        p.add(lip, CRINKLED, (front - 0.002, 0, top - 0.13 * p.h))
        stripe = primitives.box((0.55 * deep, 0.62 * p.d, 0.001))
        p.add(stripe, FOIL, (x, 0.08 * p.d, p.h))
    p.rest(1.0, 1.0)


KINDS = {
    "SaltShaker": Kind(salt_shaker),
    "PepperShaker": Kind(pepper_shaker),
    "AluminumFoil": Kind(aluminum_foil),
    "DishSponge": Kind(dish_sponge),
    "PaperTowelRoll": Kind(paper_towel_roll),
}
