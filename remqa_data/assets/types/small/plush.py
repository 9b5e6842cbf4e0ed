"""Pillows and teddy bears: soft things that lie and sit about."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import primitives
from remqa_data.assets.mesh.primitives import Mesh
from remqa_data.assets.parts import forms
from remqa_data.assets.types.furniture.beds import SHEET
from remqa_data.geometry.types import F64, Vec3

GRID = 10
"""Grid steps a side of a pillow."""

PILLOW_CLOTHS = (
    SHEET,
    *materials.FABRICS,
    *(materials.fabric(color) for color in ("yellow", "orange", "pink", "purple")),
    materials.fabric("blue", "wallpaper_stripe", 0.25, (0.66, 0.75, 0.88)),
    materials.fabric("beige", "wallpaper_damask", 0.3),
    materials.fabric("red", "knit", 0.15),
    materials.fabric("gray", "knit", 0.15),
)
FURS: tuple[tuple[str, Vec3], ...] = (
    ("brown", (0.55, 0.36, 0.22)),
    ("brown", (0.70, 0.50, 0.30)),
    ("white", (0.92, 0.90, 0.86)),
    ("gray", (0.62, 0.60, 0.60)),
)


def pillow(b: Builder) -> None:
    """A pillow: plain with a hem, piped edge, broad stripes, or a button in its middle; lies on its largest side."""
    cloth = b.pick(PILLOW_CLOTHS)
    accent = b.pick([other for other in PILLOW_CLOTHS[:11] if other.color != cloth.color])
    thin = int(np.argmin((b.w, b.d, b.h)))
    flat = {0: (b.h, b.d, b.w), 1: (b.w, b.h, b.d), 2: (b.w, b.d, b.h)}[thin]
    stand = {0: primitives.turn("y", 90), 1: primitives.turn("x", 90), 2: np.eye(3)}[thin]
    soft = _soft(flat, b.by_variant((0.5, 0.25, 0.35, 0.25)))
    parts = [(soft, cloth)]
    if b.variant == 0:
        hem = primitives.rounded_rect(flat[0], flat[1], 0.12 * min(flat[:2]))
        parts = [(soft.scaled((0.95, 0.93, 1)), cloth), (primitives.prism(hem, 0.006), materials.tinted(cloth, 0.94))]
    elif b.variant == 2:
        parts = [(mesh, accent if i % 2 else cloth) for i, mesh in enumerate(_striped(soft, 5))]
    elif b.variant == 1:
        parts.append((primitives.tube(_seam(soft), 0.007, 4), accent))
    else:
        parts = [(_dented(soft, flat), cloth)]
        top = 0.5 * 0.65 * flat[2]
        button = primitives.ellipsoid((0.05, 0.05, 0.024), 10, 4)
        parts += [(button.moved((0, 0, z)), accent) for z in (-top, top)]
    half = (b.w / 2, b.d / 2)
    forms.draw_fitted(
        b, [(mesh.turned(stand), material) for mesh, material in parts], (-half[0], -half[1], 0), (*half, b.h)
    )
    b.solid((0.8 * b.w, 0.8 * b.d, 0.92 * b.h), (0, 0, 0.46 * b.h))
    b.looks_like(cloth)


def teddy_bear(b: Builder) -> None:
    """A sitting teddy bear: plain, with a bow tie, in a pullover, or with a scarf."""
    fur = b.pick([materials.fabric(color, "towel", 0.15, rgb) for color, rgb in FURS])
    light = materials.tinted(materials.fabric("beige", "towel", 0.15), 1.1)
    dark, cloth = (
        materials.BLACK_PLASTIC,
        b.pick([materials.fabric(color) for color in ("red", "blue", "green", "purple")]),
    )
    ball = primitives.ellipsoid
    sole = primitives.cylinder(0.08, 0.03, 0.065, 12).pointed("-y")
    jumper = cloth if b.variant == 2 else fur
    parts = [
        (ball((0.5, 0.42, 0.52), 14, 8).moved((0, 0.05, 0.27)), jumper),
        (ball((0.44, 0.38, 0.38), 14, 8).moved((0, 0, 0.68)), fur),
    ]
    if b.variant != 2:
        parts.append((ball((0.34, 0.1, 0.36), 12, 6).moved((0, -0.135, 0.26)), light))
    for s in (-1, 1):
        parts += [
            (ball((0.16, 0.09, 0.16), 9, 5).moved((s * 0.19, 0.02, 0.85)), fur),
            (ball((0.09, 0.06, 0.09), 7, 3).moved((s * 0.19, -0.018, 0.85)), light),
            (forms.limb((s * 0.2, 0.0, 0.42), (s * 0.33, -0.14, 0.22), 0.085, 0.075, 8), jumper),
            (forms.limb((s * 0.14, 0.0, 0.1), (s * 0.23, -0.3, 0.1), 0.1, 0.1, 8), fur),
            (sole.moved((s * 0.24, -0.395, 0.1)), light),
            (ball((0.042, 0.03, 0.046), 7, 3).moved((s * 0.08, -0.175, 0.73)), dark),
        ]
    parts += [
        (ball((0.2, 0.16, 0.15), 9, 5).moved((0, -0.17, 0.63)), light),
        (ball((0.07, 0.05, 0.05), 7, 3).moved((0, -0.25, 0.66)), dark),
    ]
    if b.variant == 1:
        wings = [forms.limb((s * 0.01, -0.19, 0.49), (s * 0.1, -0.19, 0.49), 0.018, 0.05, 6) for s in (-1, 1)]
        parts += [(wing, cloth) for wing in (*wings, ball((0.05, 0.05, 0.05), 7, 3).moved((0, -0.2, 0.49)))]
    elif b.variant == 3:
        parts.append((forms.ring(0.2, 0.09, 14, 5).moved((0, 0.01, 0.5)), cloth))
        parts.append((forms.limb((0.08, -0.16, 0.48), (0.12, -0.23, 0.28), 0.04, 0.045, 6).scaled((1, 0.9, 1)), cloth))
    forms.draw_fitted(b, parts, (-b.w / 2, -b.d / 2, 0), (b.w / 2, b.d / 2, b.h))
    b.solid((0.8 * b.w, 0.9 * b.d, 0.22 * b.h), (0, 0, 0.11 * b.h))
    b.solid((0.6 * b.w, 0.5 * b.d, 0.98 * b.h), (0, 0.15 * b.d, 0.49 * b.h))
    b.looks_like(fur)


def _soft(size: Vec3, puff: float) -> Mesh:
    """A cushion whose four corners are drawn in a little."""
    mesh = primitives.cushion(size, puff, GRID)
    vertices = mesh.vertices.copy()
    corner = np.prod(np.abs(vertices[:, :2] / [size[0] / 2, size[1] / 2]), axis=1)
    vertices[:, :2] *= 1 - 0.09 * corner[:, None] ** 3
    return Mesh(vertices, mesh.normals, mesh.faces, mesh.uv)


def _seam(soft: Mesh) -> F64:
    """Points around the rim of a cushion, every second one of its grid, closed."""
    index = np.arange((GRID + 1) ** 2).reshape(GRID + 1, GRID + 1)
    rim = np.concatenate([index[:-1, 0], index[-1, :-1], index[:0:-1, -1], index[0, :0:-1]])[::2]
    path: F64 = soft.vertices[np.concatenate([rim, rim[:2]])].copy()
    path[:, 2] = 0.0
    return path


def _striped(soft: Mesh, count: int) -> list[Mesh]:
    """A cushion cut into bands of its grid's columns."""
    cells = GRID * GRID
    column = np.arange(len(soft.faces)) % cells // GRID
    return [Mesh(soft.vertices, soft.normals, soft.faces[column * count // GRID == i]) for i in range(count)]


def _dented(soft: Mesh, size: Vec3) -> Mesh:
    """The cushion pressed in at its middle, from both sides."""
    r2 = (soft.vertices[:, 0] / size[0]) ** 2 + (soft.vertices[:, 1] / size[1]) ** 2
    vertices = soft.vertices.copy()
    vertices[:, 2] *= 1 - 0.35 * np.exp(-r2 / 0.015)
    return Mesh(vertices, soft.normals, soft.faces, soft.uv)


KINDS = {"Pillow": Kind(pillow), "TeddyBear": Kind(teddy_bear)}
