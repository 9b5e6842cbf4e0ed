"""What fruit, vegetables, bread and eggs become when they are sliced: no room begins with any of it.

A slice is as thick as its width (x), and has the skin of a whole one of its variant and seed.
"""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import primitives
from remqa_data.assets.types.kitchen.food import (
    APPLES,
    CRUMB,
    CRUSTS,
    SKINS,
    TOMATOES,
    egg_shell,
    lettuce_greens,
    loaf_section,
)
from remqa_data.geometry.types import F64

APPLE_FLESH = Material("organic", "white", (0.96, 0.93, 0.78), gloss=0.2)
POTATO_FLESH = Material("organic", "yellow", (0.95, 0.88, 0.60), gloss=0.15)
TOMATO_FLESH = Material("organic", "red", (0.90, 0.30, 0.20), gloss=0.5)
TOMATO_JELLY = Material("organic", "orange", (0.86, 0.48, 0.22), gloss=0.6)
LETTUCE_HEART = Material("organic", "green", (0.86, 0.91, 0.62), gloss=0.1)
PIP = Material("organic", "brown", (0.26, 0.15, 0.08), gloss=0.3)
EGG_WHITE = Material("organic", "white", (0.96, 0.96, 0.92), gloss=0.6)
YOLK = Material("organic", "yellow", (0.98, 0.72, 0.12), gloss=0.7)
RIM = 0.92
"""The flesh takes up so much of a cut, across and down; the rest is skin."""
PROUD_M = 0.0006


def apple_slice(b: Builder) -> None:
    """Pale flesh with a core and two pips, in the apple's skin."""
    skin, _ = b.pick((APPLES[b.variant], APPLES[(b.variant + 1) % 4]))
    outline = primitives.ellipse(b.d, b.h, 28)
    _slab(b, outline, skin, APPLE_FLESH)
    _spots(b, 0.22, 5, 0.07, materials.tinted(APPLE_FLESH, 0.88))
    _spots(b, 0.09, 2, 0.045, PIP)


def bread_slice(b: Builder) -> None:
    """Crumb within the loaf's crust."""
    _slab(b, loaf_section(b.d, b.h) - [0.0, b.h / 2], b.pick(CRUSTS), CRUMB, is_plain=True)


def lettuce_slice(b: Builder) -> None:
    """Layers of leaves, paler towards the heart."""
    outer, middle, heart = lettuce_greens(b)
    _slab(b, _wavy(b, 0.06, 9), outer, middle)
    for share, material, layer in ((0.66, LETTUCE_HEART, 1.3), (0.42, heart, 1.6), (0.22, LETTUCE_HEART, 2.0)):
        _faces(b, _wavy(b, 0.08, 7) * share, material, layer)


def potato_slice(b: Builder) -> None:
    """Yellow flesh within the skin."""
    _slab(b, _wavy(b, 0.025, 3), b.pick(SKINS), POTATO_FLESH, is_plain=True)


def tomato_slice(b: Builder) -> None:
    """Red flesh with chambers of jelly around the middle."""
    _slab(b, _wavy(b, 0.02, 6), b.pick(TOMATOES), TOMATO_FLESH)
    _spots(b, 0.52, 6, 0.17, TOMATO_JELLY)


def cracked_egg(b: Builder) -> None:
    """White and yolk that have run out, and the halves of the shell beside them."""
    shell = egg_shell(b)
    thick = 0.12 * b.h
    pool = _wavy(b, 0.10, 5)
    flat = np.column_stack([pool[:, 0] * b.w / b.d, pool[:, 1] * b.d / b.h])
    b.add(primitives.prism(flat, thick), EGG_WHITE, (0, 0, thick / 2))
    yolk = 0.36 * min(b.w, b.d)
    b.add(primitives.ellipsoid((yolk, yolk, 0.5 * b.h), 16, 8), YOLK, (-0.08 * b.w, 0, 0.75 * thick))
    cup = [(0.0, 0.0), (0.6, 0.12), (0.92, 0.5), (1.0, 1.0), (0.93, 1.0), (0.85, 0.5), (0.5, 0.18), (0.0, 0.06)]
    half = (0.17 * b.d, 0.17 * b.d, b.h - thick)
    for y in (-0.2, 0.2):
        b.add(primitives.revolve(cup, 16).scaled(half), shell, (0.28 * b.w, y * b.d, thick))
    b.solid((0.8 * b.w, 0.8 * b.d, 0.6 * b.h), (0, 0, 0.3 * b.h))
    b.looks_like(EGG_WHITE)


def _slab(b: Builder, outline: F64, skin: Material, flesh: Material, *, is_plain: bool = False) -> None:
    """A slice of skin to an outline of (y, z) points around its middle, with flesh on both faces; plain if nothing more."""
    b.add(primitives.prism(_from_side(outline), b.w - 4 * PROUD_M).pointed("x"), skin, (0, 0, b.h / 2))
    _faces(b, outline * RIM, flesh, 2.0 if is_plain else 1.0)
    b.solid((b.w, 0.8 * b.d, 0.8 * b.h), (0, 0, b.h / 2))
    b.looks_like(flesh)


def _faces(b: Builder, outline: F64, material: Material, layer: float) -> None:
    """Thin plates on both faces of a slice, of which a higher layer lies on a lower one."""
    thick = layer * PROUD_M
    for side in (-1, 1):
        plate = primitives.prism(_from_side(outline), thick).pointed("x")
        b.add(plate, material, (side * (b.w / 2 - 2 * PROUD_M + thick / 2), 0, b.h / 2))


def _spots(b: Builder, around: float, count: int, size: float, material: Material) -> None:
    """Round spots on a circle around the middle of both faces; lengths as shares of the slice's."""
    for spot in range(count):
        turn = 2 * np.pi * spot / count
        middle = around / 2 * np.array([np.cos(turn) * b.d, np.sin(turn) * b.h])
        _faces(b, primitives.ellipse(size * b.d, size * b.h, 12) + middle, material, 2.0)


def _wavy(b: Builder, depth: float, waves: int) -> F64:
    """(n, 2) an uneven round outline that fills the slice's depth and height."""
    turns = np.arange(36) * 2 * np.pi / 36
    shape = 1 + depth * np.sin(waves * turns + b.between(0, 6.28))
    points = np.column_stack([np.cos(turns), np.sin(turns)]) * shape[:, None]
    low, high = points.min(axis=0), points.max(axis=0)
    return np.asarray(((points - low) / (high - low) - 0.5) * [b.d, b.h])


def _from_side(outline: F64) -> F64:
    """The outline of what points along x, of (y, z) points."""
    return np.column_stack([-outline[:, 1], outline[:, 0]])


SLICES = {
    "AppleSliced": Kind(apple_slice),
    "BreadSliced": Kind(bread_slice),
    "EggCracked": Kind(cracked_egg),
    "LettuceSliced": Kind(lettuce_slice),
    "PotatoSliced": Kind(potato_slice),
    "TomatoSliced": Kind(tomato_slice),
}
