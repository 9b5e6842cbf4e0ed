"""Toilet paper, its holder, and boxes of tissues."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import cloth, primitives
from remqa_data.assets.mesh.primitives import Axis, Mesh, Points2
from remqa_data.assets.parts import forms

TISSUE = Material("paper", "white", (0.97, 0.97, 0.95))
TOILET_PAPERS = (
    Material("paper", "white", (0.96, 0.96, 0.94)),
    Material("paper", "white", (0.96, 0.96, 0.94)),
    Material("paper", "pink", (0.93, 0.76, 0.77)),
    Material("paper", "beige", (0.92, 0.87, 0.77)),
)
PRINTS = tuple(materials.paint(color) for color in ("blue", "green", "white", "orange", "pink", "yellow", "purple"))
BANDS = materials.paint("blue", "paper", 0.1, (0.62, 0.78, 0.88))


def toilet_paper(b: Builder) -> None:
    """A roll of toilet paper, upright or lying: with a loose sheet, wrapped, folded to a point, or part used.

    A thin box is that of the cardboard tube of a roll that is used up.
    """
    sides = (b.w, b.d, b.h)
    axis: Axis = ("x", "y", "z")[int(np.argmax(sides))]
    across = {"x": (b.h / 2, b.d / 2, 1.0), "y": (b.w / 2, b.h / 2, 1.0), "z": (b.w / 2, b.d / 2, 1.0)}[axis]
    radius, length = min(across[:2]), max(sides)
    b.solid(sides, (0, 0, b.h / 2))

    def draw(mesh: Mesh, material: Material) -> None:
        b.add(mesh.scaled(across).pointed(axis), material, (0, 0, b.h / 2))

    def turned(profile: Points2, material: Material, sections: int = 24) -> None:
        draw(primitives.revolve(profile, sections), material)

    if radius < 0.24 * length:
        wall = 0.07
        turned(_tube(1 - wall, 1.0, length), materials.CARDBOARD)
        scrap = materials.PAPER
        turned(_sleeve(1.004, b.by_variant((0.16, 0.3, 0.1, 0.5)) * length), scrap)
        b.looks_like(materials.CARDBOARD)
        return
    paper = b.pick(TOILET_PAPERS)
    hole = min(0.021 / radius, 0.45)
    turned(_tube(hole, 1.0, length, 0.02), paper)
    turned(_tube(hole - 0.03, hole + 0.004, length + 0.0008), materials.CARDBOARD, 12)
    layer = primitives.disc(0.72, 0.69, 18)  # a hint of the wound layers on the ends
    for end in (layer, layer.pointed("-z")):
        draw(end.moved((0, 0, end.normals[0, 2] * (length / 2 + 0.0004))), materials.tinted(paper, 0.86))
    if b.variant == 1:
        label = b.pick(PRINTS)
        turned(_sleeve(1.004, 0.42 * length), label)
        turned(_sleeve(1.008, 0.10 * length), materials.WHITE_PLASTIC)
    elif b.variant == 3:
        for x in (-0.3, 0.0, 0.3):
            line = primitives.revolve(_sleeve(1.004, 0.035 * length), 24)
            draw(line.moved((0, 0, x * length)), BANDS)
    else:
        draw(_loose_sheet(length, pointed=b.variant == 2), materials.tinted(paper, 1.03))
    b.looks_like(paper)


def toilet_paper_hanger(b: Builder) -> None:
    """A holder for toilet paper: a rod on two posts, an open arm, a hooded one, or a wooden rod; high ones hang."""
    metal = b.pick((materials.CHROME, materials.STEEL, materials.BRASS, materials.BLACK_METAL))
    rod = b.pick(materials.WOODS[:3]) if b.variant == 3 else metal
    radius = min(0.011, 0.3 * b.h, 0.12 * b.d)
    y, z = -b.d / 2 + 1.6 * radius, max(1.6 * radius, min(0.03, 0.5 * b.h))
    post = min(0.024, 0.1 * b.w)
    if b.variant == 2:
        _hood(b, radius, z, metal)
    elif b.h > 0.1:
        _bail(b, radius, (y, z), metal)
    else:
        _posts(b, radius, (y, z), metal)
    b.cylinder(radius, b.w - post, (0, y, z), rod, axis="x", sections=14)
    for side in {1: (1,), 2: ()}.get(b.variant, (-1, 1)):
        knob = primitives.ellipsoid((post, 3.2 * radius, 3.2 * radius), 12, 6)
        b.add(knob, metal, (side * (b.w / 2 - post / 2), y, z))
    b.space("rod", (0.13, 0.11, 0.11), (0, y, z))
    b.looks_like(metal)


def tissue_box(b: Builder) -> None:
    """A box with a tissue sticking out: printed card, patterned card, a wooden cover, or an oval box."""
    main = b.pick(PRINTS)
    height = 0.58 * b.h
    if b.variant == 2:
        main = b.pick(materials.WOODS)
        b.box((b.w, b.d, height), (0, 0, height / 2), main, radius=0.008, segments=2)
    elif b.variant == 3:
        main = Material("cardboard", main.color, main.rgb, gloss=0.15)
        plan = primitives.ellipse(b.w, b.d, 24, 3.0)
        b.add(primitives.prism(plan, height), main, (0, 0, height / 2), solid=True)
        b.add(primitives.prism(plan * 1.004, 0.3 * height), TISSUE, (0, 0, 0.3 * height))
    else:
        texture = ("wallpaper_damask", "wallpaper_stripe")[int(b.rng.integers(2))] if b.variant == 1 else None
        main = Material("cardboard", main.color, main.rgb, texture, 0.14, 0.15)
        b.box((b.w, b.d, height), (0, 0, height / 2), main, radius=0.0015)
        if b.variant == 0:
            _printed_bands(b, height)
    slit = primitives.ellipse(0.58 * b.w, 0.42 * b.d, 16)
    b.add(primitives.prism(slit, 0.002), materials.tinted(main, 0.55), (0, 0, height))
    b.add(primitives.prism(slit * 0.86, 0.003), TISSUE, (0, 0, height))
    _tissue(b, height)
    b.looks_like(main)


def _tube(inner: float, outer: float, length: float, bevel: float = 0.0) -> list[tuple[float, float]]:
    """Profile of a hollow cylinder around the middle of its axis."""
    half, z = length / 2, length / 2 * (1 - bevel)
    return [
        (inner, -half),
        (outer - bevel, -half),
        (outer, -z),
        (outer, z),
        (outer - bevel, half),
        (inner, half),
        (inner, -half),
    ]


def _sleeve(radius: float, length: float) -> list[tuple[float, float]]:
    """Profile of a band around a cylinder."""
    return [(radius, -length / 2), (radius, length / 2)]


def _loose_sheet(length: float, *, pointed: bool) -> Mesh:
    """The end of the paper on a roll of radius 1 about z: it comes round from -x and leaves the roll at -y."""
    t = np.linspace(0.0, 1.0, 9)
    around = np.radians(np.clip(120 * t, 0, 90))
    x = np.where(t < 0.75, -1.006 * np.cos(around), (t - 0.75) * 2.6)
    y = -1.006 * np.sin(around)
    half = length / 2 * (np.clip((1.02 - t) / 0.27, 0.02, 1.0) if pointed else np.ones_like(t))
    grid = np.stack([np.tile(x, (2, 1)), np.tile(y, (2, 1)), np.stack([half, -half])], axis=2)
    return cloth.slab(grid[:, ::-1], 0.01)


def _hood(b: Builder, radius: float, z: float, metal: Material) -> None:
    """A wall plate, a curved cover and two cheeks at the ends of the rod."""
    plate, cheek = min(0.010, 0.14 * b.d), min(0.012, 0.05 * b.w)
    b.box((b.w, plate, b.h), (0, b.d / 2 - plate / 2, b.h / 2), metal, radius=0.003)
    for side in (-1, 1):
        b.box((cheek, b.d, 3.2 * radius), (side * (b.w - cheek) / 2, 0, z), metal, radius=0.003)
    bend = primitives.arc((0.0, 0.0), 1.0, 90, 0, 8)
    cover = np.column_stack([b.d / 2 - (b.d - 0.001) * bend[:, 0], b.h - 0.002 - 0.45 * (b.h - z) * (1 - bend[:, 1])])
    b.add(forms.side_cut(np.vstack([cover, cover[::-1] - [0.0, 0.003]]), 0.9 * b.w), metal)


def _bail(b: Builder, radius: float, at: tuple[float, float], metal: Material) -> None:
    """A bent wire that hangs from a rosette and carries the rod; on one side only where the arm is open."""
    y, z = at
    wire = 0.55 * radius
    x, top = b.w / 2 - radius, b.h - wire
    corner = min(0.02, 0.2 * (top - z))
    bend = [(x, z), (x, top - corner), (x - 0.3 * corner, top - 0.3 * corner), (x - corner, top)]
    half = np.array([(px, y, pz) for px, pz in bend])
    mirrored = half[::-1] * [-1, 1, 1]
    path = np.vstack([half, mirrored if b.variant != 1 else [[0.0, y, top]]]) * [-1, 1, 1]
    b.add(primitives.tube(path, wire, 8), metal)
    b.solid((b.w, 2 * wire, 2 * wire), (0, y, top))
    b.cylinder(wire * 1.2, b.d, (0, 0, top), metal, axis="y", sections=10)
    rosette, plate = min(0.035, 0.25 * b.h, 0.45 * b.w), min(0.010, 0.14 * b.d)
    b.cylinder(
        rosette,
        plate,
        (0, b.d / 2 - plate / 2, b.h - rosette),
        metal,
        axis="-y",
        top_radius=0.85 * rosette,
        sections=20,
    )


def _posts(b: Builder, radius: float, at: tuple[float, float], metal: Material) -> None:
    """Arms from rosettes on the wall; one where the rod is open at its other end."""
    y, z = at
    plate, post = min(0.010, 0.14 * b.d), min(0.024, 0.1 * b.w)
    broad = min(b.h, 0.4 * b.w)
    for side in (-1,) if b.variant == 1 else (-1, 1):
        x = side * (b.w - post) / 2
        if b.variant == 3:
            b.box((post / 2, b.d, 3 * radius), (side * (b.w / 2 - post / 4), 0, z), metal, radius=0.003)
        else:
            arm = [(x, b.d / 2, z), (x, y + 0.25 * b.d, z), (x, y + radius, z), (x - 0.004 * side, y, z)]
            b.add(primitives.tube(arm, radius * 0.75, 8), metal, solid=True)
        disc = primitives.cylinder(0.5, plate, 0.44, 20).scaled((broad, b.h, 1)).pointed("-y")
        b.add(disc, metal, (side * (b.w / 2 - max(post / 2, broad / 2)), b.d / 2 - plate / 2, b.h / 2))


def _printed_bands(b: Builder, height: float) -> None:
    band = materials.paint("white", "cardboard", 0.15)
    stripe = b.pick(PRINTS)
    for z, share, material in ((0.5, 0.36, band), (0.25, 0.06, stripe)):
        b.box((b.w + 0.001, b.d + 0.001, share * height), (0, 0, z * height), material, solid=False)
    for x in (-0.25, 0.0, 0.25):
        b.cylinder(
            0.09 * height,
            0.002,
            (x * b.w, -b.d / 2 - 0.0005, 0.5 * height),
            stripe,
            axis="-y",
            sections=10,
            solid=False,
        )


def _tissue(b: Builder, low: float) -> None:
    """Two crossing folds of tissue that rise from the slit and spread to irregular tips."""
    tall = b.h - low
    u = np.linspace(-1, 1, 8)
    t = np.linspace(0, 1, 4)
    for sign, phase in ((1, 0.0), (-1, 1.3)):
        width = (0.17 + 0.12 * t[None, :] ** 0.7) * b.w
        x = u[:, None] * width + sign * 0.02 * b.w
        lift = 1 - 0.30 * np.abs(u - 0.25 * sign) - 0.16 * np.abs(np.sin(3.3 * u + phase))
        lift = lift / lift.max() * (1.0 if sign > 0 else 0.86)
        z = low + lift[:, None] * t[None, :] * tall
        y = sign * (0.02 + 0.16 * t[None, :]) * b.d + 0.07 * b.d * np.sin(4.2 * u + phase)[:, None] * t[None, :]
        b.add(cloth.slab(np.stack(np.broadcast_arrays(x, y, z), axis=2), 0.0012), TISSUE)


KINDS = {
    "ToiletPaper": Kind(toilet_paper),
    "ToiletPaperHanger": Kind(toilet_paper_hanger),
    "TissueBox": Kind(tissue_box),
}
