"""Upright vacuum cleaners."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.looks.materials import BLACK_PLASTIC, paint
from remqa_data.assets.mesh import primitives
from remqa_data.assets.types.small.electronics import SILVER


def vacuum_cleaner(b: Builder) -> None:
    """An upright vacuum cleaner: with a cloth bag, a clear dust bin, a ball, or a slim stick with a hand unit."""
    shade = paint(b.pick(("red", "blue", "green", "purple", "orange", "gray")), gloss=0.4)
    head = min(0.12, 0.14 * b.h)
    deep = b.by_variant((0.76, 0.72, 0.68, 0.62)) * b.d
    y = b.d / 2 - 0.28 * b.d
    b.box((b.w, deep, head * 0.8), (0, -b.d / 2 + deep / 2, head * 0.5), shade, radius=0.02, segments=2)
    b.box((0.94 * b.w, 0.02, head * 0.3), (0, -b.d / 2 + 0.008, head * 0.2), BLACK_PLASTIC, solid=False)
    b.box((0.5 * b.w, 0.8 * b.d, head * 0.6), (0, 0.06 * b.d, head * 0.42), BLACK_PLASTIC, radius=0.015)
    for x in (-1, 1):
        radius = head * 0.5
        b.cylinder(radius, 0.03, (x * 0.36 * b.w, b.d / 2 - radius, radius), BLACK_PLASTIC, axis="x", sections=14)
    (_bag_body, _cyclone_body, _ball_body, _stick_body)[b.variant](b, y, head, shade)
    reach = min(0.4 * b.d, 0.12)
    loop = [(0.0, y - 0.1 * reach, 0.86), (0.0, y + 0.1 * reach, 0.93), (0.0, y, 0.975), (0.0, y - 0.3 * reach, 0.988)]
    loop += [
        (0.0, y - 0.75 * reach, 0.975),
        (0.0, y - reach, 0.95),
        (0.0, y - 0.9 * reach, 0.92),
        (0.0, y - 0.1 * reach, 0.86),
    ]
    b.add(primitives.tube(np.array(loop) * [1, 1, b.h], 0.012, 8), BLACK_PLASTIC)
    b.cylinder(0.013, 0.3 * b.h, (0, y, 0.73 * b.h), SILVER, sections=10, solid=False)
    b.solid((0.03, 0.03, 0.4 * b.h), (0, y, 0.8 * b.h))
    b.looks_like(shade)


def _bag_body(b: Builder, y: float, head: float, shade: Material) -> None:
    cloth = materials.fabric(shade.color)
    b.box((0.34 * b.w, 0.3 * b.d, 0.24 * b.h), (0, y, head + 0.10 * b.h), BLACK_PLASTIC, radius=0.03, segments=2)
    middle = np.array([0, y - 0.05 * b.d, 0])
    rings = [
        middle + np.column_stack([primitives.ellipse(k * 0.62 * b.w, k * 0.5 * b.d, 16, 2.6), np.full(16, z * b.h)])
        for k, z in ((0.6, 0.25), (0.97, 0.29), (1.0, 0.42), (0.86, 0.62), (0.6, 0.74), (0.2, 0.77))
    ]
    b.add(primitives.loft(np.array(rings)), cloth, solid=True)
    b.box((0.3 * b.w, 0.004, 0.035 * b.h), (0, y - 0.295 * b.d, 0.40 * b.h), BLACK_PLASTIC, solid=False)
    b.cylinder(0.055 * b.w, 0.05 * b.h, (0, y - 0.05 * b.d, 0.77 * b.h), BLACK_PLASTIC, sections=10, solid=False)


def _cyclone_body(b: Builder, y: float, head: float, shade: Material) -> None:
    radius = 0.26 * b.w
    y -= 0.08 * b.d
    b.cylinder(radius * 0.9, 0.16 * b.h, (0, y, head + 0.06 * b.h), shade, sections=18)
    b.cylinder(radius, 0.26 * b.h, (0, y, head + 0.27 * b.h), materials.CLEAR_GLASS, sections=18)
    b.cylinder(radius * 1.06, 0.03 * b.h, (0, y, head + 0.15 * b.h), BLACK_PLASTIC, sections=18)
    b.cylinder(radius, 0.12 * b.h, (0, y, head + 0.46 * b.h), shade, top_radius=radius * 0.45, sections=18)
    b.box((0.10 * b.w, 0.1 * b.d, 0.56 * b.h), (0, y + radius, head + 0.27 * b.h), BLACK_PLASTIC, radius=0.012)


def _ball_body(b: Builder, y: float, head: float, shade: Material) -> None:
    radius = min(0.36 * b.w, 0.36 * b.d, 0.14 * b.h)
    b.add(primitives.ellipsoid((2 * radius,) * 3, 18, 10), shade, (0, b.d / 2 - radius, radius), solid=True)
    z = radius * 1.6
    b.cylinder(0.2 * b.w, 0.1 * b.h, (0, y, z + 0.05 * b.h), BLACK_PLASTIC, sections=16)
    b.cylinder(0.22 * b.w, 0.2 * b.h, (0, y, z + 0.2 * b.h), materials.CLEAR_GLASS, sections=16)
    for i in range(6):
        angle = np.radians(60 * i)
        at = (0.14 * b.w * np.cos(angle), y + 0.14 * b.w * np.sin(angle), z + 0.34 * b.h)
        b.cylinder(0.07 * b.w, 0.12 * b.h, at, shade, top_radius=0.03 * b.w, sections=8, solid=False)
    b.box((0.08 * b.w, 0.08 * b.d, 0.5 * b.h), (0, y, 0.42 * b.h), SILVER, radius=0.01)


def _stick_body(b: Builder, y: float, head: float, shade: Material) -> None:
    b.cylinder(0.02, 0.56 * b.h, (0, y, head + 0.25 * b.h), SILVER, sections=12)
    z = 0.72 * b.h
    b.cylinder(0.16 * b.w, 0.2 * b.h, (0, y - 0.08 * b.d, z), materials.CLEAR_GLASS, sections=16)
    b.cylinder(0.17 * b.w, 0.07 * b.h, (0, y - 0.08 * b.d, z + 0.12 * b.h), shade, sections=16)
    b.cylinder(0.17 * b.w, 0.03 * b.h, (0, y - 0.08 * b.d, z - 0.1 * b.h), shade, sections=16)
    b.box((0.12 * b.w, 0.16 * b.d, 0.12 * b.h), (0, y, 0.86 * b.h), BLACK_PLASTIC, radius=0.015)


KINDS = {"VacuumCleaner": Kind(vacuum_cleaner)}
