"""Chairs, armchairs, sofas and stools: what one sits on or puts one's feet up on. All face -y."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import primitives
from remqa_data.assets.parts import forms
from remqa_data.geometry.types import Vec3

CLOTHS = (*materials.FABRICS, *materials.LEATHERS)
TIMBERS = (*materials.WOODS, *materials.PAINTED_WOODS)
FREE_ABOVE_M = 0.5


def chair(b: Builder) -> None:
    """A chair: ladder back, spindle back, upholstered, moulded shell, or an office chair on castors."""
    seat = b.level(min(0.46, 0.5 * b.h), 0.36 * b.h, 0.6 * b.h)
    draw = b.by_variant((_ladder_chair, _spindle_chair, _padded_chair, _shell_chair, _office_chair))
    draw(b, seat)
    deep = 0.78 * b.d
    b.space("seat", (0.86 * b.w, deep, FREE_ABOVE_M), (0, deep / 2 - b.d / 2, seat + FREE_ABOVE_M / 2))


def stool(b: Builder) -> None:
    """A stool: round on splayed legs, square, padded on a metal pedestal, or a saddle seat on a metal frame."""
    wood, metal, t = b.pick(TIMBERS), b.pick(materials.METALS), 0.035
    round_seat = primitives.ellipse(b.w, b.d, 24, 2.3)
    if b.variant == 2:
        foot = primitives.revolve([(0, 0), (1, 0), (1, 0.012), (0.3, 0.03), (0.12, 0.06), (0, 0.06)], 20)
        b.add(foot.scaled((0.42 * b.w, 0.42 * b.d, 1.0)), metal, solid=True)
        b.cylinder(0.025, b.h - 0.06, (0, 0, b.h / 2), materials.CHROME, sections=10)
        b.add(forms.ring(0.8, 0.1, 20, 6).scaled((0.4 * b.w, 0.4 * b.d, 0.2)), materials.CHROME, (0, 0, 0.35 * b.h))
        b.box((0.6 * b.w, 0.014, 0.014), (0, 0, 0.35 * b.h), materials.CHROME, solid=False)
        _pad(b, round_seat, b.h - 0.09, b.h, b.pick(CLOTHS))
    elif b.variant == 3:
        _splayed_legs(b, (b.w, b.d, b.h - 0.03), metal, 0.011, spread=0.78)
        for z in (0.3, 0.62):
            narrow = 1 - 0.22 * z
            _rails(b, (narrow * (b.w - 0.022), narrow * (b.d - 0.022)), z * b.h, 0.014, metal)
        b.add(
            primitives.prism(primitives.rounded_rect(0.94 * b.w, 0.94 * b.d, 0.05), 0.03),
            wood,
            (0, 0, b.h - 0.015),
            solid=True,
        )
    elif b.variant == 1:
        b.legs((b.w, b.d, b.h - 0.03), wood, thickness=t)
        for z in (0.28, 0.82):
            _rails(b, (b.w - t, b.d - t), z * b.h, 0.024, wood)
        b.box((b.w, b.d, 0.035), (0, 0, b.h - 0.0175), wood, radius=0.006)
    else:
        _splayed_legs(b, (b.w, b.d, b.h - 0.03), wood, 0.017, spread=0.62)
        _rails(b, (0.84 * b.w, 0.84 * b.d), 0.33 * b.h, 0.02, wood)
        b.add(primitives.prism(0.97 * round_seat, 0.036), wood, (0, 0, b.h - 0.018), solid=True)
    _top_space(b)


def ottoman(b: Builder) -> None:
    """An ottoman: padded block on legs, buttoned on turned feet, round pouf, or a storage cube with a lid."""
    cloth, wood = b.pick(CLOTHS), b.pick(materials.WOODS)
    if b.variant == 2:
        body = np.array([(0, 0), (0.9, 0), (1, 0.1), (1, 0.86), (0.97, 0.95), (0.88, 1), (0, 1)])
        b.add(primitives.revolve(body, 28).scaled((b.w / 2, b.d / 2, b.h)), cloth)
        for a in np.arange(12) * np.pi / 6:
            seam = [(0.502 * b.w * np.cos(a), 0.502 * b.d * np.sin(a), z * b.h) for z in (0.1, 0.5, 0.86)]
            b.add(primitives.tube(np.array(seam), 0.004, 4), materials.tinted(cloth, 0.7))
        b.solid((0.8 * b.w, 0.8 * b.d, b.h), (0, 0, b.h / 2))
    else:
        foot = b.by_variant((0.12, 0.09, 0.0, 0.03))
        lid = b.by_variant((0.12, 0.14, 0.0, 0.07))
        b.legs((b.w - 0.04, b.d - 0.04, foot), wood, thickness=0.05, taper=0.6, round_=b.variant == 1)
        b.box((b.w - 0.02, b.d - 0.02, b.h - lid - foot), (0, 0, (b.h - lid + foot) / 2), cloth, radius=0.015)
        b.box((b.w, b.d, lid), (0, 0, b.h - lid / 2), cloth, radius=0.4 * lid, segments=3)
        if b.variant == 1:
            buttons(b, 4, 3, (0.75 * b.w, 0.65 * b.d), (0, 0, b.h - 0.006), cloth, upright=False)
        elif b.variant == 3:
            for x in (-0.33, 0, 0.33):
                b.box(
                    (0.004, b.d - 0.012, b.h - lid - foot - 0.04),
                    (x * b.w, 0, (b.h - lid + foot) / 2),
                    materials.tinted(cloth, 0.7),
                    solid=False,
                )
            b.box((0.06, 0.008, 0.05), (0, -b.d / 2 + 0.006, b.h - lid), materials.LEATHERS[0], solid=False)
        else:
            b.box((b.w - 0.03, b.d - 0.03, 0.02), (0, 0, foot), wood, solid=False)
    b.looks_like(cloth)
    _top_space(b)


def footstool(b: Builder) -> None:
    """A footstool: wooden step, round and padded, square with a pad on legs, or a plastic step with a grip hole."""
    wood = b.pick(TIMBERS)
    t = min(0.025, 0.1 * b.h)
    if b.variant == 0:
        cut = primitives.arc((0.0, 0.0), 0.2 * b.d, 0, 180, 8)
        side = [
            (-b.d / 2, 0),
            *(tuple(p) for p in cut[::-1]),
            (b.d / 2, 0),
            (0.42 * b.d, b.h - t),
            (-0.42 * b.d, b.h - t),
        ]
        for x in (-1, 1):
            b.add(forms.side_cut(side, t), wood, (x * (0.42 * b.w - t / 2), 0, 0), solid=True)
        b.box((0.84 * b.w - 2 * t, t, 0.2 * b.h), (0, 0, 0.68 * b.h), wood)
        b.box((b.w, b.d, t), (0, 0, b.h - t / 2), wood, radius=0.004)
    elif b.variant == 3:
        plastic = b.pick(materials.PLASTICS)
        foot = primitives.rounded_rect(b.w, b.d, 0.04)
        rings = [np.column_stack([f * foot, np.full(len(foot), z * b.h)]) for f, z in ((1, 0), (0.86, 0.9), (0.82, 1))]
        b.add(primitives.loft(rings), plastic, solid=True)
        slot = primitives.rounded_rect(0.34 * b.w, 0.14 * b.d, 0.02)
        b.add(primitives.prism(slot, 0.004), materials.SHADOW_GAP, (0, 0, b.h - 0.0015))
        for strip in (-0.27, 0.27):
            b.box((0.12 * b.w, 0.5 * b.d, 0.003), (strip * b.w, 0, b.h - 0.001), materials.RUBBER, solid=False)
        arch = np.vstack([primitives.arc((0.0, 0.25 * b.h), 0.2 * b.w, 0, 180, 9), [(-0.2 * b.w, 0), (0.2 * b.w, 0)]])
        taper = 0.5 * 0.14 / 0.9 * b.d / b.h
        opening = forms.leaning(primitives.prism(arch, 0.004).pointed("-y"), taper)
        b.add(opening, materials.tinted(plastic, 0.45), (0, -b.d / 2, 0))
        b.looks_like(plastic)
    else:
        cloth = b.pick(CLOTHS)
        pad = 0.32 * b.h
        outline = primitives.ellipse(b.w, b.d, 24, 2.0 if b.variant == 1 else 8.0)
        b.add(primitives.prism(0.94 * outline, 0.14 * b.h), wood, (0, 0, b.h - pad - 0.07 * b.h))
        _pad(b, outline, b.h - pad, b.h, cloth)
        inside = 0.66 if b.variant == 1 else 0.92
        b.legs(
            (inside * b.w, inside * b.d, b.h - pad - 0.1 * b.h), wood, thickness=0.036, taper=0.6, round_=b.variant == 1
        )
        if b.variant == 2:
            _rails(b, (inside * b.w - 0.036, inside * b.d - 0.036), 0.2 * b.h, 0.018, wood)
        b.looks_like(cloth)
    _top_space(b)


def _ladder_chair(b: Builder, seat: float) -> None:
    wood, t, sag = b.pick(TIMBERS), 0.036, 0.018
    lean = min(0.07, 0.13 * b.d)
    back = b.d / 2 - t / 2 - sag
    knots = [(back + sag, 0.0), (back - lean, seat), (back, b.h)]
    outline = [(y - t / 2, z) for y, z in knots] + [(y + t / 2, z) for y, z in knots[::-1]]
    for side in (-1, 1):
        x = side * (b.w - t) / 2
        b.add(forms.side_cut(outline, t), wood, (x, 0, 0), grain="z")
        b.solid((t, t, b.h), (x, back - lean / 2, b.h / 2))
        b.box((t, t, seat - 0.02), (x, (t - b.d) / 2, (seat - 0.02) / 2), wood)
    slats = 3 if b.h - seat < 0.45 else 4
    for i in range(slats):
        f = 0.3 + 0.62 * i / (slats - 1)
        tall = 0.13 if i == slats - 1 else 0.09
        y = back - lean * (1 - f)
        board = _arched(b.w - 2 * t + 0.01, sag, 0.018, tall * (b.h - seat))
        b.add(board, wood, (0, y, seat + f * (b.h - seat)), solid=True, grain="x")
    _apron(b, (b.w - t, back - lean + b.d / 2 - t / 2), seat - 0.06, wood)
    deep = back - lean + b.d / 2 + t / 2
    b.box((b.w, deep, 0.02), (0, deep / 2 - b.d / 2, seat - 0.03), wood, radius=0.004)
    b.box(
        (b.w - 0.03, deep - 0.03, 0.03), (0, deep / 2 - b.d / 2, seat - 0.015), b.pick(CLOTHS), radius=0.012, segments=2
    )
    b.looks_like(wood)


def _spindle_chair(b: Builder, seat: float) -> None:
    wood = b.pick(TIMBERS)
    _splayed_legs(b, (b.w, b.d, seat - 0.02), wood, 0.018, spread=0.66)
    _rails(b, (0.8 * b.w, 0.8 * b.d), 0.4 * seat, 0.018, wood, sides="x")
    b.box((0.014, 0.8 * b.d, 0.014), (0, 0, 0.4 * seat), wood, solid=False)
    outline = primitives.ellipse(b.w, 0.96 * b.d, 28, 3.6)
    b.add(primitives.prism(outline, 0.034), wood, (0, -0.02 * b.d, seat - 0.017), solid=True, grain="x")
    foot_y, top_y, r = 0.36 * b.d, b.d / 2 - 0.012, 0.012
    tall = b.h - seat - r
    bow = primitives.ellipse(0.86 * b.w, 2 * tall, 28, 3.2)
    hoop = np.array([(x, foot_y + (top_y - foot_y) * z / tall, seat + z) for x, z in bow if z > -1e-9])
    b.add(primitives.tube(hoop, r, 8), wood)
    for f in np.linspace(-0.66, 0.66, 6 if b.w > 0.42 else 5):
        x = f * 0.43 * b.w
        reach = tall * (1 - abs(f) ** 3.2) ** (1 / 3.2)
        end = (x * 1.02, foot_y + (top_y - foot_y) * reach / tall, seat + reach)
        b.add(primitives.tube([(0.9 * x, foot_y, seat - 0.01), end], 0.007, 6), wood)
    b.solid((0.8 * b.w, 0.03, tall), (0, (foot_y + top_y) / 2, seat + tall / 2))


def _padded_chair(b: Builder, seat: float) -> None:
    cloth, wood = b.pick(CLOTHS), b.pick(materials.WOODS)
    thick = 0.07
    b.legs((b.w - 0.01, b.d - 0.01, seat - 0.1), wood, thickness=0.042, taper=0.6)
    b.box((b.w, b.d - 0.02, 0.11), (0, -0.01, seat - 0.055), cloth, radius=0.03, segments=2)
    tall = b.h - seat + 0.06
    lean = min(0.16, 0.2 * b.d / tall)
    back = forms.leaning(primitives.rounded_box((b.w - 0.02, thick, tall), 0.028, 2), lean)
    y = b.d / 2 - thick / 2 - lean * tall / 2
    b.add(back, cloth, (0, y, b.h - tall / 2), solid=True)
    for f in (-0.25, 0.0, 0.25):  # stitched channels
        seam = [(f * b.w, y - thick / 2 + lean * z * tall, b.h - tall / 2 + z * tall) for z in (-0.3, 0.4)]
        b.add(primitives.tube(seam, 0.004, 5), materials.tinted(cloth, 0.7))
    b.looks_like(cloth)


def _shell_chair(b: Builder, seat: float) -> None:
    plastic = b.pick(materials.PLASTICS)
    legs = b.pick((materials.OAK, materials.PINE, materials.BLACK_METAL, materials.CHROME))
    curl = 0.035
    path = [
        (-b.d / 2 + 0.006, seat - 0.045),
        (-0.44 * b.d, seat - 0.015),
        (-0.3 * b.d, seat),
        (0.1 * b.d, seat - 0.012),
        (0.27 * b.d, seat + 0.005),
        (0.36 * b.d, seat + 0.06),
        (0.42 * b.d, seat + 0.45 * (b.h - seat)),
        (0.455 * b.d, seat + 0.8 * (b.h - seat)),
        (0.475 * b.d, seat + 0.92 * (b.h - seat)),
        (0.485 * b.d, seat + 0.975 * (b.h - seat)),
        (b.d / 2 - 0.006, b.h),
    ]
    widths = b.w * np.array([0.8, 0.92, 0.98, 1.0, 1.0, 0.98, 0.92, 0.88, 0.8, 0.68, 0.5])
    b.add(forms.bent_panel(path, list(widths), 0.012, curl), plastic)
    deep = 0.86 * b.d
    b.solid((0.9 * b.w, deep, 0.03), (0, deep / 2 - b.d / 2, seat - 0.015))
    b.solid((0.8 * b.w, 0.05, b.h - seat), (0, 0.43 * b.d, (b.h + seat) / 2))
    _splayed_legs(b, (b.w, 0.92 * b.d, seat - 0.02), legs, 0.014, spread=0.5)
    _rails(b, (0.62 * b.w, 0.56 * b.d), 0.78 * seat, 0.009, materials.BLACK_METAL)
    b.looks_like(plastic)


def _office_chair(b: Builder, seat: float) -> None:
    cloth, frame = b.pick(CLOTHS), b.pick((materials.BLACK_PLASTIC, materials.GRAY_PLASTIC, materials.CHROME))
    for a in np.radians(np.arange(5) * 72.0 - 90.0):
        x, y = (b.w / 2 - 0.025) * np.cos(a), (b.d / 2 - 0.025) * np.sin(a)
        b.add(primitives.tube([(0, 0, 0.12), (0.5 * x, 0.5 * y, 0.105), (x, y, 0.07)], [0.024, 0.02, 0.014], 6), frame)
        b.add(primitives.cylinder(0.028, 0.034, sections=10).pointed("x"), materials.BLACK_PLASTIC, (x, y, 0.028))
    b.solid((0.75 * b.w, 0.75 * b.d, 0.1), (0, 0, 0.05))
    b.cylinder(0.025, seat - 0.16, (0, 0, (seat + 0.04) / 2), materials.CHROME, sections=10)
    b.box((0.2, 0.2, 0.03), (0, 0, seat - 0.09), materials.BLACK_PLASTIC)
    b.box((0.86 * b.w, 0.86 * b.d, 0.08), (0, -0.07 * b.d, seat - 0.04), cloth, radius=0.036, segments=3)
    low = seat + 0.12 * (b.h - seat)
    tall = b.h - low
    back = forms.leaning(primitives.rounded_box((0.82 * b.w, 0.07, tall), 0.034, 3), 0.1)
    y = b.d / 2 - 0.036 - 0.05 * tall
    b.add(back, cloth, (0, y, low + tall / 2), solid=True)
    spine = [(0, 0.1 * b.d, seat - 0.08), (0, y + 0.01, seat - 0.06), (0, y + 0.02, low + 0.3 * tall)]
    b.add(primitives.tube(spine, 0.018, 6), frame)
    for side in (-1, 1):
        x, rest = side * (b.w / 2 - 0.025), seat + min(0.2, 0.45 * (b.h - seat))
        arm = [(0.6 * x, 0, seat - 0.07), (x, 0, seat - 0.05), (x, 0, rest - 0.02)]
        b.add(primitives.tube(arm, 0.014, 6), frame)
        b.box((0.05, 0.5 * b.d, 0.03), (x, -0.02, rest - 0.015), materials.BLACK_PLASTIC, radius=0.012)
    b.looks_like(cloth)


def _arched(width: float, sag: float, thickness: float, height: float) -> primitives.Mesh:
    """A board across a chair's back, bent backwards in its middle."""
    x = np.linspace(-0.5, 0.5, 7)
    y = sag * (1 - (2 * x) ** 2)
    front, back = np.column_stack([x * width, y - thickness / 2]), np.column_stack([x * width, y + thickness / 2])
    return primitives.prism(np.vstack([front, back[::-1]]), height)


def _apron(b: Builder, size: tuple[float, float], z: float, wood: Material) -> None:
    width, depth = size
    for y in (0, 1):
        b.box((width, 0.018, 0.06), (0, y * depth - b.d / 2 + 0.018, z), wood, solid=False)
    for x in (-1, 1):
        b.box((0.018, depth, 0.06), (x * width / 2, depth / 2 - b.d / 2 + 0.018, z), wood, solid=False)


def _splayed_legs(b: Builder, size: Vec3, material: Material, radius: float, *, spread: float) -> None:
    """Four round legs whose feet stand at the corners of a plan and whose tops stand closer together."""
    width, depth, height = size
    for sx in (-1, 1):
        for sy in (-1, 1):
            foot = (sx * (width / 2 - radius), sy * (depth / 2 - radius), 0.0)
            top = (spread * foot[0], spread * foot[1], height)
            b.add(primitives.tube([foot, top], [0.75 * radius, radius], 8), material)
    b.solid((0.8 * width, 0.8 * depth, height), (0, 0, height / 2))


def _rails(b: Builder, plan: tuple[float, float], z: float, size: float, material: Material, sides: str = "xy") -> None:
    """Rails between legs at a height, along the edges of a plan; `sides` names those across x ("x") or y ("y")."""
    width, depth = plan
    for side in (-1, 1):
        if "y" in sides:
            b.box((width, 0.8 * size, size), (0, side * depth / 2, z), material, solid=False)
        if "x" in sides:
            b.box((0.8 * size, depth, size), (side * width / 2, 0, z), material, solid=False)


def _pad(b: Builder, outline: primitives.Points2, low: float, high: float, cloth: Material) -> None:
    """A padded seat with a round edge over an outline."""
    points, tall = np.asarray(outline, float), high - low
    soft = min(0.45 * tall, 0.03)
    edge = ((0.97, low), (1.0, low + 0.5 * soft), (1.0, high - soft), (0.975, high - 0.3 * soft), (0.93, high))
    rings = [np.column_stack([f * points, np.full(len(points), z)]) for f, z in edge]
    b.add(primitives.loft(rings), cloth)
    width, depth = np.ptp(points, axis=0)
    b.solid((0.85 * float(width), 0.85 * float(depth), tall), (0, 0, (low + high) / 2))


def buttons(
    b: Builder, columns: int, rows: int, size: tuple[float, float], at: Vec3, cloth: Material, *, upright: bool
) -> None:
    """A grid of upholstery buttons over a field of a size, facing -y when upright and up otherwise."""
    button = primitives.ellipsoid((0.028, 0.028, 0.014), 6, 3).pointed("-y" if upright else "z")
    for i in range(rows):
        shift = 0.5 * (i % 2)
        for j in range(columns - i % 2):
            u, v = (j + shift) / (columns - 1) - 0.5, i / max(rows - 1, 1) - 0.5
            offset = (u * size[0], 0, v * size[1]) if upright else (u * size[0], v * size[1], 0)
            b.add(button, materials.tinted(cloth, 0.75), (at[0] + offset[0], at[1] + offset[1], at[2] + offset[2]))


def _top_space(b: Builder) -> None:
    b.space("seat", (0.9 * b.w, 0.9 * b.d, FREE_ABOVE_M), (0, 0, b.h + FREE_ABOVE_M / 2))


KINDS = {
    "Chair": Kind(chair, 5),
    "Footstool": Kind(footstool),
    "Ottoman": Kind(ottoman),
    "Stool": Kind(stool),
}
