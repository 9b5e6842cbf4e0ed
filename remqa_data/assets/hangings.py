"""Blinds and curtains: what hangs in front of a window."""

from __future__ import annotations

import numpy as np

from remqa_data.assets import cloth, forms, materials, primitives
from remqa_data.assets.builder import Builder
from remqa_data.assets.kind import Kind
from remqa_data.assets.model import F64, Material
from remqa_data.assets.primitives import Mesh

SHORT_BLINDS_M = 0.45
"""Lower than this, the recorded box is that of blinds that are pulled up."""
STACK_PITCH_M = 0.0052
"""Height that each slat takes up in the bundle of blinds that are pulled up."""

CURTAIN_FABRICS = (
    materials.fabric("beige", rgb=(0.86, 0.79, 0.66)),
    materials.fabric("blue", rgb=(0.36, 0.47, 0.62)),
    materials.fabric("red", rgb=(0.60, 0.22, 0.22)),
    materials.fabric("green", rgb=(0.42, 0.54, 0.43)),
    materials.fabric("gray", rgb=(0.63, 0.63, 0.64)),
    materials.fabric("purple", rgb=(0.47, 0.36, 0.55)),
    materials.fabric("yellow", rgb=(0.88, 0.74, 0.38)),
)
SLAT_COLORS = tuple(materials.paint(color, "metal") for color in ("white", "gray", "beige"))


def blinds(b: Builder) -> None:
    """Blinds: metal slats, wooden slats with tapes, pleated cloth or a roman shade.

    A tall box is that of blinds let down: they open by rising into a bundle under the head rail. A short box is that of
    such a bundle, and opening lets it down, which is what AI2-THOR calls open blinds.
    """
    slat = b.pick(b.by_variant((SLAT_COLORS, materials.WOODS, CURTAIN_FABRICS, CURTAIN_FABRICS)))
    rail_material = b.by_variant((slat, slat, materials.WHITE_PLASTIC, materials.WHITE_PLASTIC))
    rail, hem = min(0.036, 0.22 * b.h), min(0.016, 0.1 * b.h)
    room = b.h - rail - hem
    is_short = b.h < SHORT_BLINDS_M
    tall = b.by_variant((0.050, 0.056, 0.060, 0.090))
    if is_short:
        tall = min(tall, 0.6 * room)
        count = 1 + max(3, int((room - tall) / STACK_PITCH_M))
    else:
        tall = max(tall, room / 24)
        count = 1 + int(np.ceil((room - tall) / (0.96 * tall)))
    pitch = (room - tall) / (count - 1)
    travel = 0.96 * tall - pitch if is_short else pitch - STACK_PITCH_M
    b.box((b.w, b.d, rail), (0, 0, b.h - rail / 2), rail_material, radius=0.003)
    y = 0.002
    mesh = _slat(b, b.w - 0.012, min(b.d - 0.006, 0.06), tall)
    for i in range(count):
        z = b.h - rail - tall / 2 - i * pitch
        if i == 0:
            _draw_slat(b, mesh, slat, (y, z), tall)
            continue
        with b.link(f"slat_{i}", "prismatic", axis="-z" if is_short else "z", upper=i * travel):
            _draw_slat(b, mesh, slat, (y, z), tall)
            if i == count - 1:
                b.box((b.w - 0.006, b.d - 0.004, hem), (0, 0, hem / 2), rail_material, radius=0.003)
    cord = min(0.7 * room, 0.8)
    x = 0.5 * b.w - min(0.06, 0.08 * b.w)
    b.cylinder(0.0015, cord, (x, -b.d / 2 + 0.0016, b.h - rail - cord / 2), materials.PAPER, sections=5, solid=False)
    tassel = primitives.cylinder(0.004, 0.024, 0.002, 8).scaled((1, 0.5, 1))
    b.add(tassel, rail_material, (x, -b.d / 2 + 0.002, b.h - rail - cord))
    b.looks_like(slat)


def curtains(b: Builder) -> None:
    """Curtains on a rod: straight with rings, tied back, with a border, or under a pelmet; low ones are a valance."""
    fabric = b.pick(CURTAIN_FABRICS)
    second = b.pick([other for other in CURTAIN_FABRICS if other.color != fabric.color])
    if b.variant == 3:
        texture = b.pick(("wallpaper_stripe", "wallpaper_damask"))
        fabric = Material("fabric", fabric.color, fabric.rgb, texture, 0.5)
    metal = b.pick((materials.BLACK_METAL, materials.BRASS, materials.STEEL, materials.WALNUT))
    is_valance = b.h < 0.6
    pelmet = min(0.22, 0.3 * b.h) if b.variant == 3 and not is_valance else 0.0
    radius = min(0.013, 0.16 * b.d)
    rod_z = b.h - 1.7 * radius - pelmet
    if pelmet:
        _pelmet(b, pelmet, fabric, second)
    else:
        _rod(b, rod_z, radius, metal)
    rings = not is_valance and not pelmet and b.variant != 2
    top = rod_z - 2.2 * radius if rings else b.h - (pelmet or 0.3 * radius)
    spans = [(-b.w / 2, b.w / 2)] if is_valance else _spans(b.w)
    folds_each = max(2, min(round((spans[0][1] - spans[0][0]) / 0.11), (10 if b.variant == 1 else 17) // len(spans)))
    for left, right in spans:
        grid = _panel(b, left, right, top, folds_each, is_tied=b.variant == 1 and not is_valance)
        if is_valance:
            grid[:, :, 2] += _scallops(b, grid)
        b.add(cloth.slab(grid, 0.005), fabric)
        b.solid((right - left, 0.6 * b.d, top), ((left + right) / 2, 0, top / 2))
        if b.variant == 2 and not is_valance:
            b.add(cloth.slab(_lower(grid, 0.12), 0.009), second)
        if b.variant == 1 and not is_valance:
            _tie(b, grid, second)
        for x in np.linspace(left + 0.02, right - 0.02, folds_each + 1) if rings else ():
            _ring(b, float(x), rod_z, radius, metal)
    b.looks_like(fabric)


def _slat(b: Builder, width: float, depth: float, tall: float) -> Mesh:
    """One slat along x; each kind nests into the next one when they are bundled."""
    front, back, half = -depth / 2, depth / 2, tall / 2
    if b.variant < 2:
        t = 0.0032
        outline = [(front, -half), (front, -half + t), (back, half), (back, half - t)]
    elif b.variant == 2:
        t = 0.004
        outline = [
            (back, half),
            (front, t / 2),
            (front, -t / 2),
            (back, -half),
            (back, t - half),
            (front + t, 0),
            (back, half - t),
        ]
    else:
        bow = primitives.arc((0, 0), 1.0, -90, 90, 7)
        outer = np.column_stack([back - depth * bow[:, 0], half * bow[:, 1]])
        inner = np.column_stack([back - (depth - 0.003) * bow[:, 0], (half - 0.003) * bow[:, 1]])
        outline = [(float(y), float(z)) for y, z in np.vstack([outer, inner[::-1]])]
    return forms.side_cut(outline, width)


def _draw_slat(b: Builder, mesh: Mesh, material: Material, at: tuple[float, float], tall: float) -> None:
    y, z = at
    b.add(mesh, material, (0, y, z), solid=True, grain="x")
    if b.variant > 1:
        return
    tape = (0.004, materials.PAPER) if b.variant == 0 else (0.024, materials.tinted(material, 0.75))
    for x in (-0.32 * b.w, 0.32 * b.w):
        b.box((tape[0], 0.001, tall), (x, y - min(b.d - 0.006, 0.06) / 2 - 0.001, z), tape[1], solid=False)


def _spans(width: float) -> list[tuple[float, float]]:
    """Where the panels hang: narrow curtains are one panel, wider ones leave the window behind their middle free."""
    half, share = width / 2, min(0.27 * width, 0.85)
    if width < 1.25:
        return [(-half, half)]
    ends = [(-half, -half + share), (half - share, half)]
    return ends if width < 4.5 else [ends[0], (-0.5 * share, 0.5 * share), ends[1]]


def _panel(b: Builder, left: float, right: float, top: float, folds: int, *, is_tied: bool) -> F64:
    """A grid of points of a pleated panel; tied ones are narrow at the waist, towards the nearer end of the rod."""
    u = np.linspace(0.0, 1.0, 5 * folds + 1)
    t = np.linspace(0.0, 1.0, 7 if is_tied else 4)
    deep = (b.d / 2 - 0.004) * (0.75 + 0.25 * np.cos(np.pi * t)[None, :])
    sway = 0.12 * np.sin(2 * np.pi * (0.9 * t[None, :] + 3.1 * u[:, None]))
    y = deep * np.sin(2 * np.pi * folds * u[:, None] + sway)
    narrow = np.ones_like(t)
    if is_tied:
        narrow = np.interp(t, (0, 0.25, 0.42, 0.62, 1), (0.62, 0.46, 0.34, 0.78, 1.0))
    pull = 0.0 if left + right < -1e-6 else 1.0 if left + right > 1e-6 else 0.5
    x = left + (right - left) * (pull + (u[:, None] - pull) * narrow)
    return np.stack(np.broadcast_arrays(x, y, top * t[None, :]), axis=2)


def _scallops(b: Builder, grid: F64) -> F64:
    """How far the hem of a valance rises between its points."""
    arches = max(2, round(b.w / 0.35))
    lift = 0.35 * b.h * (1 - np.abs(np.cos(np.pi * arches * (grid[:, :, 0] / b.w + 0.5))))
    return np.asarray(lift * (1 - grid[:, :, 2] / grid[:, :, 2].max()))


def _lower(grid: F64, share: float) -> F64:
    """The lowest part of a panel's grid, for a border."""
    height = float(grid[0, -1, 2])
    levels = grid[0, :, 2]
    wanted = np.array([0.0, share]) * height
    y = np.array([np.interp(wanted, levels, column[:, 1]) for column in grid])
    x = np.array([np.interp(wanted, levels, column[:, 0]) for column in grid])
    return np.stack([x, y, np.broadcast_to(wanted, x.shape)], axis=2)


def _tie(b: Builder, grid: F64, material: Material) -> None:
    row = int(np.argmin(np.ptp(grid[:, :, 0], axis=0)))
    low, high = float(grid[:, row, 0].min()), float(grid[:, row, 0].max())
    z = float(grid[0, row, 2])
    band = primitives.prism(primitives.ellipse(high - low + 0.02, b.d * 0.98, 20, 3.0), min(0.06, 0.05 * b.h))
    b.add(band, material, ((low + high) / 2, 0, z))


def _rod(b: Builder, z: float, radius: float, metal: Material) -> None:
    b.cylinder(radius, b.w - 3.2 * radius, (0, 0, z), metal, axis="x", sections=12)
    for side in (-1, 1):
        knob = primitives.ellipsoid((3.4 * radius, 3.4 * radius, 3.4 * radius), 10, 5)
        b.add(knob, metal, (side * (b.w / 2 - 1.7 * radius), 0, z))
        x = side * (b.w / 2 - min(0.05, 0.1 * b.w))
        b.box((0.014, b.d / 2, 0.014), (x, b.d / 4, z), metal)
        b.box((0.03, 0.006, min(0.07, 0.1 * b.h)), (x, b.d / 2 - 0.003, z - 0.01), metal)


def _ring(b: Builder, x: float, rod_z: float, radius: float, metal: Material) -> None:
    ring = primitives.cylinder(1.6 * radius, 0.5 * radius, sections=8).pointed("x")
    b.add(ring, metal, (x, 0, rod_z - 0.4 * radius))


def _pelmet(b: Builder, tall: float, fabric: Material, trim: Material) -> None:
    """A board across the top, covered with the cloth, with a trim along its lower edge."""
    z = b.h - tall / 2
    b.box((b.w, 0.02, tall), (0, -b.d / 2 + 0.012, z), fabric, radius=0.004)
    b.box((b.w, b.d - 0.024, 0.02), (0, 0.01, b.h - 0.011), fabric)
    for side in (-1, 1):
        b.box((0.02, b.d - 0.024, tall - 0.02), (side * (b.w / 2 - 0.010), 0.01, z - 0.011), fabric)
    b.box((b.w, 0.004, 0.025), (0, -b.d / 2 + 0.001, b.h - tall + 0.02), trim, solid=False)


KINDS = {"Blinds": Kind(blinds), "Curtains": Kind(curtains)}
