"""Sofas and armchairs: upholstered seats with a back and two arms, facing -y."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import primitives
from remqa_data.assets.parts import forms
from remqa_data.assets.types.furniture.seating import CLOTHS, FREE_ABOVE_M, buttons

CHAISE_FROM_M = 1.3
"""A sofa deeper than this is L-shaped."""


def sofa(b: Builder) -> None:
    """A sofa: square arms, rolled arms with buttons, slim on tapered legs, or curved back and skirt; an L when deep."""
    seat = b.level(0.48 * b.h, 0.3 * b.h, 0.66 * b.h)
    depth = b.d if b.d <= CHAISE_FROM_M else min(max(0.9, 0.55 * b.d), 1.05)
    arm = min(max(0.085 * b.w, 0.13), 0.24) * b.by_variant((1.0, 1.1, 0.62, 1.0))
    draw = b.by_variant((_square, _rolled, _slim, _skirted))
    draw(b, _Plan(b, seat, depth, arm))


def armchair(b: Builder) -> None:
    """An armchair: square club chair, wing chair, round tub chair, open wooden frame, or rolled leather arms."""
    seat = b.level(min(0.46, 0.5 * b.h), 0.34 * b.h, 0.64 * b.h)
    arm = min(max(0.16 * b.w, 0.1), 0.24) * b.by_variant((1.0, 0.6, 0.8, 0.5, 1.0))
    draw = b.by_variant((_square, _wing, _tub, _open_frame, _rolled))
    draw(b, _Plan(b, seat, b.d, arm))


class _Plan:
    """Where the parts of a sofa or armchair are; all lengths in metres, drawing coordinates."""

    def __init__(self, b: Builder, seat: float, depth: float, arm: float) -> None:
        self.seat, self.depth, self.arm = seat, depth, arm
        self.inner = b.w - 2 * arm
        self.front = b.d / 2 - depth
        self.back = min(max(0.22 * depth, 0.14), 0.26)
        self.cushion = min(0.17, 0.4 * seat)
        self.rest = seat + min(0.2, 0.55 * (b.h - seat))
        self.places = max(1, round(self.inner / 0.7)) if b.w > 1.55 else 1
        self.chaise = self.inner / self.places + arm if depth < b.d else 0.0
        self.chaise_side = 1 if b.spec.seed % 2 else -1

    def place(self, i: int) -> tuple[float, float]:
        """Centre x and width of a seat."""
        width = self.inner / self.places
        return (i - (self.places - 1) / 2) * width, width


def _square(b: Builder, plan: _Plan) -> None:
    cloth, wood = b.pick(CLOTHS), b.pick(materials.WOODS)
    foot = min(0.08, 0.2 * plan.seat)
    _feet(b, plan, wood, foot, thickness=0.05)
    _seat(b, plan, cloth, foot)
    for side in (-1, 1):
        x, tall = side * (b.w - plan.arm) / 2, plan.rest - foot
        y = plan.front + plan.depth / 2
        b.box(
            (plan.arm, plan.depth, tall), (x, y, foot + tall / 2), cloth, radius=min(0.03, 0.3 * plan.arm), segments=2
        )
    _back_board(b, plan, cloth, foot, b.h - 0.05)
    _back_cushions(b, plan, cloth, b.h)
    b.looks_like(cloth)


def _rolled(b: Builder, plan: _Plan) -> None:
    cloth, wood = b.pick((*materials.LEATHERS, *materials.FABRICS[:4])), b.pick(materials.WOODS)
    foot = min(0.09, 0.22 * plan.seat)
    _feet(b, plan, wood, foot, thickness=0.07, round_=True)
    _seat(b, plan, cloth, foot)
    roll = 0.56 * plan.arm
    for side in (-1, 1):
        x, y = side * (b.w / 2 - roll), plan.front + plan.depth / 2
        upright = plan.rest - roll - foot
        b.box(
            (0.8 * plan.arm, plan.depth - 0.02, upright),
            (side * (b.w / 2 - plan.arm * 0.55), y, foot + upright / 2),
            cloth,
            radius=0.02,
        )
        b.cylinder(roll, plan.depth, (x, y, plan.rest - roll), cloth, axis="y", sections=18)
        b.cylinder(
            0.55 * roll,
            0.012,
            (x, plan.front - 0.001, plan.rest - roll),
            materials.tinted(cloth, 0.75),
            axis="y",
            sections=14,
            solid=False,
        )
    thick = min(0.1, 0.45 * plan.back)
    y = b.d / 2 - plan.back / 2
    _back_board(b, plan, cloth, foot, b.h - thick)
    b.cylinder(thick, b.w - 0.7 * plan.arm, (0, b.d / 2 - thick, b.h - thick), cloth, axis="x", sections=18)
    field = (0.94 * plan.inner, max(0.3 * (b.h - plan.seat), 0.02))
    middle = (plan.seat + b.h - 2 * thick) / 2 + 0.03
    buttons(b, min(max(3, 3 * plan.places), 9), 3, field, (0, y - plan.back / 2 - 0.002, middle), cloth, upright=True)
    b.looks_like(cloth)


def _slim(b: Builder, plan: _Plan) -> None:
    cloth, wood = b.pick(CLOTHS), b.pick(materials.WOODS[:4])
    foot = 0.45 * plan.seat
    _feet(b, plan, wood, foot, thickness=0.045, round_=True)
    _seat(b, plan, cloth, foot, frame=wood)
    for side in (-1, 1):
        x, tall = side * (b.w - plan.arm) / 2, plan.rest - foot
        b.box(
            (plan.arm, plan.depth - 0.04, tall),
            (x, plan.front + plan.depth / 2, foot + tall / 2),
            cloth,
            radius=0.4 * plan.arm,
            segments=3,
        )
    tall = b.h - foot
    lean = min(0.09, 0.25 * plan.back / tall)
    back = forms.leaning(primitives.rounded_box((b.w - 0.02, 0.7 * plan.back, tall), 0.05, 3), lean)
    y = b.d / 2 - 0.35 * plan.back - lean * tall / 2
    b.add(back, cloth, (0, y, foot + tall / 2), solid=True)
    channels = max(4, 3 * plan.places)
    for i in range(1, channels):
        x = plan.inner * (i / channels - 0.5)
        ends = [(x, y - 0.35 * plan.back + lean * (z - foot - tall / 2), z) for z in (plan.seat - 0.02, b.h - 0.06)]
        b.add(primitives.tube(ends, 0.005, 5), materials.tinted(cloth, 0.7))
    b.looks_like(cloth)


def _skirted(b: Builder, plan: _Plan) -> None:
    cloth = b.pick(CLOTHS[:6])
    _seat(b, plan, cloth, 0.0)
    top = plan.rest
    for side in (-1, 1):
        x = side * (b.w - plan.arm) / 2
        y0, y1 = plan.front, b.d / 2 - 0.01
        slope = [
            (y0, 0.005),
            (y1, 0.005),
            (y1, top + 0.05),
            (y0 + 0.5 * plan.depth, top),
            (y0 + 0.06, top - 0.06),
            (y0, top - 0.12),
        ]
        b.add(forms.side_cut(slope, plan.arm - 0.01), cloth, (x, 0, 0))
        b.solid((plan.arm, plan.depth, top - 0.05), (x, plan.front + plan.depth / 2, (top - 0.05) / 2))
    shoulder = plan.rest + 0.55 * (b.h - plan.rest)
    u = np.linspace(-1, 1, 17)
    hump = shoulder + (b.h - shoulder) * (0.5 + 0.5 * np.cos(np.pi * u)) ** 0.8
    outline = np.vstack([[(-b.w / 2, 0.0), (b.w / 2, 0.0)], np.column_stack([u * b.w / 2, hump])[::-1]])
    board = primitives.prism(outline, 0.6 * plan.back).pointed("-y")
    b.add(board, cloth, (0, b.d / 2 - 0.3 * plan.back, 0))
    b.solid((b.w, plan.back, shoulder), (0, b.d / 2 - plan.back / 2, shoulder / 2))
    _back_cushions(b, plan, cloth, shoulder + 0.02)
    step = 0.11
    for x in np.arange(-b.w / 2 + step / 2, b.w / 2, step):  # pleats of the skirt
        b.box(
            (0.006, 0.006, 0.16 * b.h),
            (float(x), plan.front + 0.024, 0.085 * b.h),
            materials.tinted(cloth, 0.72),
            solid=False,
        )
    b.looks_like(cloth)


def _wing(b: Builder, plan: _Plan) -> None:
    cloth, wood = b.pick(CLOTHS), b.pick(materials.WOODS)
    foot = 0.36 * plan.seat
    _feet(b, plan, wood, foot, thickness=0.055, round_=True)
    _seat(b, plan, cloth, foot)
    top, y0, y1, wing = plan.rest, -b.d / 2 + 0.03, b.d / 2 - 0.02, b.h - 0.03
    front = y1 - 0.36 * b.d
    curve = ((0.06, 0.0), (0.0, 0.08), (-0.04, 0.25), (-0.06, 0.5), (-0.04, 0.74), (0.02, 0.91), (0.1, 1.0))
    sweep = [(front + u * b.d, top + v * (wing - top)) for u, v in curve]
    outline = [(y0, foot), (y1, foot), (y1, wing), *sweep[::-1], (y0 + 0.04, top), (y0, top - 0.04)]
    for side in (-1, 1):
        x = side * (b.w / 2 - plan.arm / 2 - 0.2 * plan.arm)
        b.add(forms.side_cut(outline, 0.9 * plan.arm), cloth, (x, 0, 0))
        b.solid((plan.arm, b.d, top - foot), (x, 0, (top + foot) / 2))
        b.cylinder(
            0.6 * plan.arm,
            0.7 * b.d,
            (side * (b.w / 2 - 0.6 * plan.arm), y0 + 0.32 * b.d, top - 0.4 * plan.arm),
            cloth,
            axis="y",
            solid=False,
        )
    _back_board(b, plan, cloth, foot, b.h)
    buttons(
        b,
        4,
        3,
        (0.6 * plan.inner, 0.45 * (b.h - plan.seat)),
        (0, b.d / 2 - plan.back - 0.004, (plan.seat + b.h) / 2 + 0.05),
        cloth,
        upright=True,
    )
    b.looks_like(cloth)


def _tub(b: Builder, plan: _Plan) -> None:
    cloth, wood = b.pick(CLOTHS), b.pick(materials.WOODS)
    foot = min(0.12, 0.3 * plan.seat)
    _feet(b, plan, wood, foot, thickness=0.045, inset=0.2 * min(b.w, b.d))
    turn = np.radians(np.linspace(-45, 225, 30))
    outer = np.column_stack([np.cos(turn), np.sin(turn)])
    outer = np.sign(outer) * np.abs(outer) ** 0.72 * [b.w / 2, b.d / 2]
    inner = np.sign(outer) * np.maximum(np.abs(outer) - plan.arm, 0.0)
    inner[:, 1] = np.where(outer[:, 1] < 0, outer[:, 1], inner[:, 1])
    wall = primitives.prism(np.vstack([outer, inner[::-1]]), 1.0, crease_deg=50)
    s = np.clip((wall.vertices[:, 1] + 0.3 * b.d) / (0.8 * b.d), 0, 1)
    low = 0.85 * plan.rest
    height = low + (b.h - low) * s * s * (3 - 2 * s) - foot - 0.5 * plan.arm
    wall.vertices[:, 2] = foot + (wall.vertices[:, 2] + 0.5) * height
    b.add(wall, cloth)
    middle = (outer + inner) / 2
    u = np.clip((middle[:, 1] + 0.3 * b.d) / (0.8 * b.d - 0.5 * plan.arm), 0, 1)
    roll = 0.5 * plan.arm + 0.004
    rim = np.column_stack([middle, low + (b.h - low) * u * u * (3 - 2 * u) - roll])
    b.add(primitives.tube(rim, roll, 10), cloth)
    for end in (rim[0], rim[-1]):
        b.add(
            primitives.ellipsoid((2.2 * roll, 2.2 * roll, 2.2 * roll), 12, 8),
            cloth,
            (float(end[0]), float(end[1]), float(end[2])),
        )
    seat = primitives.ellipse(b.w - 1.6 * plan.arm, 0.94 * b.d, 28, 3.0)
    seat[:, 1] = np.maximum(seat[:, 1] - 0.02 * b.d, -b.d / 2)
    base = primitives.prism(0.98 * seat, plan.seat - plan.cushion - foot)
    b.add(base, cloth, (0, 0, (plan.seat - plan.cushion + foot) / 2))
    pad = [
        (0.98, plan.seat - plan.cushion),
        (1, plan.seat - 0.6 * plan.cushion),
        (0.98, plan.seat - 0.02),
        (0.93, plan.seat),
    ]
    b.add(primitives.loft([np.column_stack([f * seat, np.full(28, z)]) for f, z in pad]), cloth)
    for across, deep in ((1.0, 0.6), (0.7, 0.94)):  # the seat is round
        b.solid((across * plan.inner, deep * b.d, plan.seat), (0, -0.02 * b.d, plan.seat / 2))
    _seat_space(b, plan, 0.78 * b.w - 2 * plan.arm)  # the arms come together towards the front
    bends = rim[np.linspace(0, len(rim) - 1, 10).astype(int)]
    for start, end in pairwise(bends):
        x, y, top = (float(value) for value in (start + end) / 2 + [0, 0, roll])
        along = end - start
        turned = primitives.turn("z", float(np.degrees(np.arctan2(along[1], along[0]))))
        size = (float(np.hypot(*along[:2])), plan.arm, top - foot)
        b.solid(size, (x, y, (top + foot) / 2), turned)
    b.looks_like(cloth)


def _open_frame(b: Builder, plan: _Plan) -> None:
    wood, cloth = b.pick(materials.WOODS), b.pick(CLOTHS)
    t, wide = 0.045, 0.06
    for side in (-1, 1):
        x = side * (b.w - wide) / 2
        legs = (
            [(-b.d / 2 + 0.06, 0), (-b.d / 2 + 0.06 + t, 0), (-b.d / 2 + t, plan.rest), (-b.d / 2, plan.rest)],
            [
                (b.d / 2 - 0.12 - t, 0),
                (b.d / 2 - 0.12, 0),
                (b.d / 2 - 0.16, plan.rest),
                (b.d / 2 - 0.16 - t, plan.rest),
            ],
        )
        for leg in legs:
            b.add(forms.side_cut(leg, 0.7 * wide), wood, (x, 0, 0), solid=True, grain="z")
        b.box((wide, b.d - 0.1, 0.028), (x, -0.05, plan.rest - 0.014), wood, radius=0.01)
        b.box((0.7 * wide, b.d - 0.2, t), (x, -0.03, plan.seat - plan.cushion - t / 2), wood)
    inner, under = b.w - 1.9 * wide, plan.seat - plan.cushion
    for y in (-0.4, -0.1, 0.2):
        b.box((inner, 0.06, 0.025), (0, y * b.d, under - 0.0125), wood, solid=False)
    pad = b.d - 0.1
    b.box(
        (inner - 0.02, pad, plan.cushion),
        (0, pad / 2 - b.d / 2, plan.seat - plan.cushion / 2),
        cloth,
        radius=0.4 * plan.cushion,
        segments=3,
    )
    tall = b.h - plan.seat + 0.04
    lean = min(0.3, 0.2 * b.d / tall)
    for part, thick, y, high in ((cloth, 0.13, 0.065 + 0.03, tall - 0.02), (wood, 0.025, 0.0125, tall)):
        board = primitives.rounded_box((inner - (0.02 if part is cloth else 0.0), thick, high), 0.45 * thick, 2)
        b.add(forms.leaning(board, lean), part, (0, b.d / 2 - y - lean * tall / 2, b.h - high / 2 - (tall - high)))
    b.solid((inner, 0.14, tall), (0, b.d / 2 - 0.1 - lean * tall / 2, b.h - tall / 2))
    b.looks_like(cloth)
    _seat_space(b, plan)


def _seat(b: Builder, plan: _Plan, cloth: Material, foot: float, frame: Material | None = None) -> None:
    """Base, seat cushions and, on a deep sofa, the chaise."""
    low, lip = plan.seat - plan.cushion, 0.025
    base = (b.w - 0.6 * plan.arm, plan.depth - lip - 0.01, low - foot)
    b.box(base, (0, plan.front + lip + base[1] / 2, (low + foot) / 2), frame or cloth, radius=0.008, solid=False)
    if plan.chaise:
        out = b.d - plan.depth
        x = plan.chaise_side * (b.w - plan.chaise) / 2
        b.box(
            (plan.chaise, out + 0.1, low - foot),
            (x, -b.d / 2 + out / 2 + 0.05, (low + foot) / 2),
            frame or cloth,
            radius=0.008,
            solid=False,
        )
    radius = min(0.055, 0.4 * plan.cushion)
    for i in range(plan.places):
        x, width = plan.place(i)
        y0, y1 = plan.front, b.d / 2 - 0.6 * plan.back
        if plan.chaise and plan.chaise_side * i == max(plan.chaise_side * j for j in (0, plan.places - 1)):
            _chaise_pad(b, plan, cloth, radius)
        b.box(
            (width - 0.005, y1 - y0, plan.cushion),
            (x, (y0 + y1) / 2, plan.seat - plan.cushion / 2),
            cloth,
            radius=radius,
            segments=3,
            solid=False,
        )
    _solid_seat(b, plan)


def _chaise_pad(b: Builder, plan: _Plan, cloth: Material, radius: float) -> None:
    out = b.d - plan.depth
    x = plan.chaise_side * (b.w - plan.chaise) / 2
    size = (plan.chaise - 0.005, out - 0.005, plan.cushion)
    b.box(size, (x, -b.d / 2 + out / 2, plan.seat - plan.cushion / 2), cloth, radius=radius, segments=3, solid=False)
    b.solid((plan.chaise, out, plan.seat), (x, -b.d / 2 + out / 2, plan.seat / 2))
    space = (plan.chaise - 0.05, out - 0.05, FREE_ABOVE_M)
    b.space("chaise", space, (x, -b.d / 2 + out / 2, plan.seat + FREE_ABOVE_M / 2))


def _solid_seat(b: Builder, plan: _Plan) -> None:
    b.solid((plan.inner, plan.depth, plan.seat), (0, plan.front + plan.depth / 2, plan.seat / 2))
    _seat_space(b, plan)


def _seat_space(b: Builder, plan: _Plan, width: float | None = None) -> None:
    deep = plan.depth - plan.back - 0.16
    size = (width or 0.94 * plan.inner, deep, FREE_ABOVE_M)
    b.space("seat", size, (0, plan.front + 0.02 + deep / 2, plan.seat + FREE_ABOVE_M / 2))


def _back_board(b: Builder, plan: _Plan, cloth: Material, low: float, high: float) -> None:
    width = b.w - plan.arm * 0.8
    at = (0.0, b.d / 2 - plan.back / 2, (low + high) / 2)
    b.box((width, plan.back, high - low), at, cloth, radius=min(0.05, 0.3 * plan.back), segments=2)


def _back_cushions(b: Builder, plan: _Plan, cloth: Material, top: float) -> None:
    """Loose cushions that lean against the back, one for each seat, up to a height."""
    tall = top - plan.seat
    thick = min(0.17, 0.9 * plan.back)
    for i in range(plan.places):
        x, width = plan.place(i)
        pad = forms.leaning(primitives.rounded_box((width - 0.008, thick, tall), 0.4 * thick, 3), 0.12)
        at = (x, b.d / 2 - plan.back - 0.28 * thick, plan.seat + tall / 2)
        b.add(pad, cloth, at)
        b.solid((width, thick, 0.9 * tall), at)


def _feet(
    b: Builder,
    plan: _Plan,
    wood: Material,
    height: float,
    *,
    thickness: float,
    round_: bool = False,
    inset: float = 0.05,
) -> None:
    """Legs under the four corners, and under the end of a chaise."""
    xs = [-(b.w / 2 - inset), b.w / 2 - inset]
    spots = [(x, y) for x in xs for y in (plan.front + inset, b.d / 2 - inset)]
    if plan.chaise:
        edge = plan.chaise_side * (b.w / 2 - inset)
        spots += [(edge, -b.d / 2 + inset), (edge - plan.chaise_side * (plan.chaise - 2 * inset), -b.d / 2 + inset)]
    for x, y in spots:
        if round_:
            b.cylinder(
                0.28 * thickness,
                height + 0.01,
                (x, y, (height + 0.01) / 2),
                wood,
                top_radius=thickness / 2,
                sections=10,
            )
        else:
            b.box((thickness, thickness, height + 0.01), (x, y, (height + 0.01) / 2), wood)


KINDS = {"ArmChair": Kind(armchair, 5), "Sofa": Kind(sofa)}
