"""House plants, and the cut stems that stand in tall vases."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import primitives
from remqa_data.assets.mesh.primitives import Mesh
from remqa_data.assets.parts import forms
from remqa_data.assets.parts.forms import Part
from remqa_data.geometry import arithmetic

TERRACOTTA = Material("ceramic", "orange", (0.76, 0.44, 0.29), "plaster", 0.3)
GREENS = tuple(
    Material("organic", "green", rgb)
    for rgb in ((0.24, 0.48, 0.20), (0.33, 0.56, 0.26), (0.18, 0.40, 0.24), (0.42, 0.58, 0.30))
)
BARK = Material("organic", "brown", (0.38, 0.27, 0.19))
STRAW = Material("organic", "beige", (0.86, 0.76, 0.58))
BLOSSOMS = tuple(
    Material("organic", color, rgb)
    for color, rgb in (("pink", (0.93, 0.66, 0.72)), ("white", (0.97, 0.95, 0.92)), ("red", (0.78, 0.20, 0.18)))
)
POTS = (TERRACOTTA, *materials.CERAMICS, materials.WICKER, materials.STONES[1])


def house_plant(b: Builder) -> None:
    """A house plant in a pot: broad leaves, sword leaves, fern, or a small tree."""
    green, pot = b.pick(GREENS), b.pick(POTS)
    tall = min(max(0.3 * b.h, 0.1), 0.4 * b.h, 0.34)
    radius = min(0.36 * min(b.w, b.d), 0.75 * tall)
    _pot(b, radius, tall, pot)
    grow = b.by_variant((_broad_leaves, _sword_leaves, _fern, _small_tree))
    forms.draw_fitted(b, grow(b, green), (-b.w / 2, -b.d / 2, 0.9 * tall), (b.w / 2, b.d / 2, b.h), rooted=True)
    b.solid((1.7 * radius, 1.7 * radius, tall), (0, 0, tall / 2))
    b.solid((0.6 * b.w, 0.6 * b.d, b.h - tall), (0, 0, (b.h + tall) / 2))
    b.looks_like(green)


def branches(b: Builder) -> list[Part]:
    """Bare branches with blossoms."""
    bloom = b.pick(BLOSSOMS)
    parts: list[Part] = []
    for i in range(7):
        yaw = np.radians(51.4 * i + b.between(-15, 15))
        out = np.array([np.cos(yaw), np.sin(yaw), 0.0])
        lean, rise = b.between(0.3, 0.6), b.between(1.1, 1.5)
        stem = np.array(
            [
                out * lean * s**1.6 + [0.03 * np.sin(5 * s + i), 0.03 * np.cos(4 * s + i), rise * s]
                for s in np.linspace(0, 1, 6)
            ]
        )
        parts.append((primitives.tube(stem, list(np.linspace(0.022, 0.008, 6)), 5), BARK))
        for k in (3, 4):
            twig = stem[k] + [0.16 * np.cos(yaw + 1.5 * k), 0.16 * np.sin(yaw + 1.5 * k), 0.2]
            parts.append((primitives.tube(np.array([stem[k], twig]), [0.009, 0.006], 3), BARK))
            parts.append((primitives.ellipsoid((0.11, 0.11, 0.09), 6, 3).moved(twig), bloom))
        parts += [(primitives.ellipsoid((0.11, 0.11, 0.09), 6, 3).moved(stem[k]), bloom) for k in (2, 4, 5)]
    return parts


def pampas(b: Builder) -> list[Part]:
    """Stalks with feathery plumes."""
    parts: list[Part] = []
    for i in range(9):
        yaw = np.radians(137.5 * i)
        lean, rise = 0.08 + 0.3 * i / 9, b.between(0.75, 1.0)
        base, neck = np.zeros(3), np.array([lean * 0.7 * np.cos(yaw), lean * 0.7 * np.sin(yaw), rise])
        tip = neck + np.array([0.5 * lean * np.cos(yaw), 0.5 * lean * np.sin(yaw), 0.42])
        parts.append((primitives.tube(np.array([base, neck]), 0.008, 4), STRAW))
        plume = np.array([neck + (tip - neck) * s for s in np.linspace(-0.15, 1, 7)])
        tone = materials.tinted(STRAW, b.between(0.9, 1.15))
        parts.append((primitives.tube(plume, [0.01, 0.045, 0.06, 0.058, 0.045, 0.028, 0.004], 7), tone))
    return parts


def _pot(b: Builder, radius: float, tall: float, material: Material) -> None:
    """A flower pot with soil: rimmed, rounded, straight, or square."""
    style = int(b.rng.integers(4))
    if style == 3:
        plan = primitives.rounded_rect(1.7 * radius, 1.7 * radius, 0.1 * radius, 2)
        rings = [np.column_stack([f * plan, np.full(len(plan), z)]) for f, z in ((0.78, 0.0), (1.0, tall))]
        b.add(primitives.loft(rings), material)
        b.add(primitives.prism(0.9 * plan, 0.004), materials.SOIL, (0, 0, tall))
        return
    outside = (
        [(0.66, 0), (0.86, 0.78), (1, 0.78), (1, 1)],
        [(0.6, 0), (0.9, 0.2), (1, 0.5), (0.92, 0.85), (0.9, 1)],
        [(0.92, 0), (0.94, 0.04), (0.96, 1)],
    )[style]
    rim = outside[-1][0] - 0.08
    profile = [(0, 0), *outside, (rim, 1), (rim, 0.92)]
    b.add(primitives.revolve(profile, 20).scaled((radius, radius, tall)), material)
    b.add(primitives.revolve([(rim, 0.92), (0, 0.94)], 16).scaled((radius, radius, tall)), materials.SOIL)


def _broad_leaves(b: Builder, green: Material) -> list[Part]:
    """Big leaves on stalks that spread from the soil."""
    parts: list[Part] = []
    light = materials.tinted(green, 1.25)
    for i in range(16):
        yaw = 137.5 * i
        reach, rise = 0.16 + 0.3 * b.between(0.5, 1) * (1 - i / 32), 0.35 + 0.5 * i / 15
        x, y = reach * np.cos(np.radians(yaw)), reach * np.sin(np.radians(yaw))
        parts.append((primitives.tube([(0, 0, 0), (0.5 * x, 0.5 * y, 0.75 * rise), (x, y, rise)], 0.008, 4), green))
        size = b.between(0.34, 0.46)
        parts.append((forms.leaf((x, y, rise), yaw, 28, size, 0.62 * size, 75, 0.38), light if i % 3 == 0 else green))
    return parts


def _sword_leaves(b: Builder, green: Material) -> list[Part]:
    """Upright stiff leaves with pale margins: a snake plant; an aloe where there is little height."""
    flat = b.h < 1.5 * max(b.w, b.d)
    parts: list[Part] = []
    pale = materials.tinted(green, 1.3)
    for i in range(17):
        ring = i / 16
        yaw = 137.5 * i
        pitch = 86 - (55 if flat else 22) * ring
        base = (0.06 * np.cos(np.radians(yaw)) * ring, 0.06 * np.sin(np.radians(yaw)) * ring, 0.0)
        length = b.between(0.7, 1.0) * (1 - 0.3 * ring)
        parts.append(
            (forms.leaf(base, yaw, pitch, length, 0.15, -12 if flat else 6, 0.3), pale if i % 4 == 0 else green)
        )
    return parts


def _fern(b: Builder, green: Material) -> list[Part]:
    """Arching fronds with leaflets on both sides."""
    tones = (green, materials.tinted(green, 1.25), materials.tinted(green, 0.85))
    return [(_frond(137.5 * i, 90 - 2.2 * i, b.between(0.85, 1.1)), tones[i % 3]) for i in range(18)]


def _frond(yaw_deg: float, pitch_deg: float, length: float) -> Mesh:
    """A bent stalk with a pointed leaflet to each side at every step; one triangle a leaflet, one open sheet."""
    leaflets = 11
    t = np.linspace(0, 1, leaflets + 1)
    bend = np.radians(pitch_deg - 95 * t)
    yaw = np.radians(yaw_deg)
    out, side = np.array([np.cos(yaw), np.sin(yaw), 0.0]), np.array([-np.sin(yaw), np.cos(yaw), 0.0])
    along = np.cos(bend)[:, None] * out + np.sin(bend)[:, None] * [0.0, 0.0, 1.0]
    spine = np.vstack([np.zeros(3), np.cumsum(along[1:] * length / leaflets, axis=0)])
    up = arithmetic.cross(along, side)
    reach = 0.24 * np.sin(np.pi * (0.12 + 0.86 * t[:-1]))[:, None]
    stalk = 0.008 * side
    corners, normals = [], []
    for sign in (-1.0, 1.0):
        tips = spine[:-1] + reach * (sign * side + 0.45 * along[:-1] - 0.15 * up[:-1])
        corners.append(np.stack([spine[:-1] + sign * stalk, spine[1:] + sign * stalk, tips][:: int(-sign)], axis=1))
        corners.append(
            np.stack([spine[:-1] - sign * stalk, spine[1:], spine[:-1] + sign * stalk][:: int(-sign)], axis=1)
        )
        normals += [np.repeat(up[:-1], 3, axis=0)] * 2
    vertices = np.vstack(corners).reshape(-1, 3)
    return Mesh(vertices, np.vstack(normals), np.arange(len(vertices)).reshape(-1, 3))


def _small_tree(b: Builder, green: Material) -> list[Part]:
    """A trunk that forks under a round crown of leaves."""
    parts: list[Part] = [
        (primitives.tube([(0, 0, 0), (0.03, 0.01, 0.3), (-0.01, 0, 0.62)], [0.045, 0.035, 0.025], 7), BARK)
    ]
    for a in (0.4, 2.4, 4.5):
        parts.append(
            (primitives.tube([(0, 0, 0.5), (0.2 * np.cos(a), 0.2 * np.sin(a), 0.85)], [0.022, 0.012], 5), BARK)
        )
    tones = (green, materials.tinted(green, 1.25), materials.tinted(green, 0.8))
    count = 60
    for i in range(count):
        z = 1 - 2 * (i + 0.5) / count
        yaw = 137.5 * i
        r = np.sqrt(1 - z * z) * 0.36
        at = (r * np.cos(np.radians(yaw)), r * np.sin(np.radians(yaw)), 0.92 + 0.34 * z)
        parts.append((forms.leaf(at, yaw + b.between(-40, 40), 65 * z + 5, 0.28, 0.18, 50, 0.45, 2), tones[i % 3]))
    parts.append((primitives.ellipsoid((0.62, 0.62, 0.58), 9, 5).moved((0, 0, 0.92)), tones[2]))
    return parts


KINDS = {"HousePlant": Kind(house_plant)}
