"""Statues: figures, animals and abstract forms on a plinth."""

from __future__ import annotations

import numpy as np

from remqa_data.assets.core.builder import Builder
from remqa_data.assets.core.kind import Kind
from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh import primitives
from remqa_data.assets.mesh.primitives import Mesh
from remqa_data.assets.parts import forms
from remqa_data.assets.parts.forms import limb
from remqa_data.geometry.types import Vec3

SUBSTANCES = (
    Material("stone", "white", (0.93, 0.92, 0.89), "marble", 0.8, 0.25),
    Material("stone", "gray", (0.60, 0.60, 0.59), "granite", 0.5, 0.15),
    Material("stone", "black", (0.20, 0.20, 0.21), "granite", 0.5, 0.35),
    Material("metal", "brown", (0.47, 0.33, 0.20), gloss=0.5),
    Material("metal", "yellow", (0.80, 0.64, 0.30), gloss=0.6),
    Material("metal", "green", (0.35, 0.52, 0.45), gloss=0.25),
)
PLINTHS = (materials.EBONY, materials.WALNUT, materials.STONES[0], materials.STONES[2])


def statue(b: Builder) -> None:
    """A statue: bust, standing figure, abstract form or sitting cat; wide ones elephant, horse, knot or lying lion."""
    body, base = b.pick(SUBSTANCES), b.pick(PLINTHS)
    tall = b.h > 1.2 * max(b.w, b.d)
    shape = b.by_variant((_bust, _robed_figure, _pierced_form, _cat) if tall else (_elephant, _horse, _knot, _lion))
    mesh = shape(b)
    extent = np.ptp(mesh.vertices, axis=0)
    slab = min(0.1 * b.h, 0.04) if tall else min(0.14 * b.h, 0.03)
    room = 1.2 * float(extent[2]) * min(0.94 * b.w / float(extent[0]), 0.94 * b.d / float(extent[1]))
    foot = max(slab, min(0.42 * b.h, b.h - room))  # a pedestal, so that nobody is drawn too thin
    b.box((b.w, b.d, slab), (0, 0, slab / 2), base, radius=0.003)
    if foot > slab:
        b.box((0.8 * b.w, 0.8 * b.d, foot - slab), (0, 0, (foot + slab) / 2), base, radius=0.003)
    natural = (b.h - foot) / float(extent[2])
    half = [min(0.47 * space, 0.65 * natural * float(size)) for space, size in zip((b.w, b.d), extent[:2], strict=True)]
    forms.draw_fitted(b, [(mesh, body)], (-half[0], -half[1], foot), (half[0], half[1], b.h))
    b.solid((1.5 * half[0], 1.5 * half[1], 0.97 * b.h - foot), (0, 0, (0.97 * b.h + foot) / 2))
    b.looks_like(body)


def twist(height: float) -> primitives.Mesh:
    """A square column that winds up and swells: abstract sculpture."""
    rings = []
    for s in np.linspace(0, 1, 25):
        plan = primitives.ellipse(1, 1, 16, 5.0) * (0.28 + 0.26 * np.sin(np.pi * s) ** 2 * (1 - 0.4 * s))
        turn = primitives.turn("z", 200 * s)[:2, :2]
        rings.append(np.column_stack([plan @ turn.T, np.full(16, s * height)]))
    return primitives.loft(rings)


def _bust(b: Builder) -> Mesh:
    chest = [
        (0, 0),
        (0.14, 0),
        (0.16, 0.03),
        (0.09, 0.06),
        (0.08, 0.1),
        (0.19, 0.17),
        (0.3, 0.3),
        (0.33, 0.38),
        (0.26, 0.46),
        (0.1, 0.52),
    ]
    parts = [
        primitives.revolve([*chest, (0, 0.53)], 16).scaled((1, 0.62, 1)),
        limb((0, 0.02, 0.44), (0, 0, 0.66), 0.085, 0.075, 8),
        _ball((0.24, 0.28, 0.34), (0, 0, 0.79), 14, 9),
        _ball((0.27, 0.28, 0.24), (0, 0.035, 0.87), 12, 6),
        _ball((0.28, 0.16, 0.3), (0, 0.09, 0.78), 10, 6),
        limb((0, -0.135, 0.83), (0, -0.17, 0.765), 0.015, 0.026, 6),
        _ball((0.17, 0.05, 0.03), (0, -0.125, 0.845), 8, 4),
        _ball((0.08, 0.04, 0.03), (0, -0.13, 0.705), 8, 4),
        _ball((0.09, 0.08, 0.08), (0, -0.1, 0.66), 8, 4),
    ]
    if b.rng.random() < 0.5:  # a beard
        parts.append(_ball((0.19, 0.14, 0.2), (0, -0.085, 0.64), 9, 5))
    for s in (-1, 1):
        parts += [
            _ball((0.03, 0.06, 0.09), (s * 0.125, 0.01, 0.78), 6, 4),
            _ball((0.05, 0.03, 0.03), (s * 0.055, -0.125, 0.805), 6, 3),
        ]
    return primitives.joined(parts)


def _robed_figure(b: Builder) -> Mesh:
    rings = []
    for z, r in ((0.0, 0.17), (0.02, 0.175), (0.2, 0.15), (0.4, 0.125), (0.52, 0.105), (0.56, 0.085)):
        a = np.arange(24) * np.pi / 12
        folds = r * (1 + 0.09 * np.cos(8 * a) * max(0.0, 1 - z / 0.56))
        rings.append(np.column_stack([folds * np.cos(a), 0.75 * folds * np.sin(a), np.full(24, z)]))
    side = 1 if b.rng.random() < 0.5 else -1
    parts = [
        primitives.loft(rings),
        limb((0, 0, 0.55), (0, 0, 0.72), 0.08, 0.1, 10),
        limb((-0.11, 0, 0.755), (0.11, 0, 0.755), 0.045, 0.045, 8),
        limb((0, 0, 0.76), (0, 0, 0.85), 0.035, 0.03, 7),
        _ball((0.105, 0.12, 0.15), (0, -0.005, 0.9), 12, 7),
        _ball((0.12, 0.12, 0.11), (0, 0.015, 0.93), 10, 5),
        _ball((0.06, 0.07, 0.06), (0, 0.075, 0.93), 8, 4),
        limb((side * 0.14, 0, 0.75), (side * 0.21, -0.03, 0.62), 0.036, 0.03, 7),
        limb((side * 0.21, -0.03, 0.62), (side * 0.1, -0.12, 0.58), 0.03, 0.024, 7),
        limb((-side * 0.14, 0, 0.75), (-side * 0.23, -0.02, 0.86), 0.036, 0.03, 7),
        limb((-side * 0.23, -0.02, 0.86), (-side * 0.2, -0.04, 1.02), 0.03, 0.022, 7),
        _ball((0.09, 0.09, 0.09), (-side * 0.2, -0.04, 1.07), 8, 5),
    ]
    return primitives.joined([Mesh(part.vertices, part.normals, part.faces) for part in parts])


def _pierced_form(b: Builder) -> Mesh:
    if b.rng.random() < 0.5:
        return twist(1.6)
    hoop = forms.ring(0.5, 0.34, 26, 10)
    heavy = 1 + 0.25 * hoop.vertices[:, 1:2]
    hoop = Mesh(hoop.vertices * heavy, hoop.normals, hoop.faces).turned(primitives.turn("x", -90)).scaled((1, 0.9, 1.7))
    return primitives.joined([_plain(hoop), _plain(limb((0, 0, -1.1), (0, 0, -0.72), 0.1, 0.14, 8))])


def _cat(b: Builder) -> Mesh:
    parts = [
        _ball((0.46, 0.52, 0.42), (0, 0.1, 0.21), 12, 7),
        limb((0, 0.1, 0.3), (0, -0.04, 0.52), 0.2, 0.14, 10),
        _ball((0.34, 0.31, 0.29), (0, -0.1, 0.74), 12, 8),
        _ball((0.15, 0.08, 0.1), (0, -0.235, 0.69), 8, 4),
        primitives.tube(
            [(0, 0.34, 0.07), (0.2, 0.3, 0.05), (0.28, 0.08, 0.045), (0.25, -0.16, 0.045)], [0.05, 0.05, 0.045, 0.03], 7
        ),
    ]
    for s in (-1, 1):
        parts += [
            limb((s * 0.07, -0.08, 0.44), (s * 0.075, -0.17, 0.05), 0.085, 0.058, 8),
            _ball((0.12, 0.17, 0.08), (s * 0.08, -0.2, 0.04), 8, 4),
            _ball((0.17, 0.36, 0.27), (s * 0.17, 0.06, 0.145), 9, 5),
            primitives.cylinder(0.085, 0.15, 0.006, 8).scaled((1, 0.5, 1)).moved((s * 0.1, -0.08, 0.91)),
        ]
    return primitives.joined([_plain(part) for part in parts])


def _elephant(b: Builder) -> Mesh:
    up = b.rng.random() < 0.5
    tip = (
        [(-0.86, 0, 0.52), (-0.98, 0, 0.66), (-0.94, 0, 0.86)]
        if up
        else [(-0.84, 0, 0.44), (-0.86, 0, 0.24), (-0.96, 0, 0.14)]
    )
    parts = [
        _ball((1.0, 0.56, 0.6), (0.08, 0, 0.58), 14, 8),
        _ball((0.44, 0.4, 0.46), (-0.5, 0, 0.72), 12, 7),
        primitives.tube([(-0.6, 0, 0.68), (-0.76, 0, 0.58), *tip], [0.14, 0.11, 0.08, 0.06, 0.045], 8),
        limb((0.55, 0, 0.66), (0.64, 0, 0.36), 0.02, 0.028, 5),
    ]
    for s in (-1, 1):
        ear = primitives.ellipsoid((0.34, 0.05, 0.46), 10, 6).turned(primitives.turn("z", -s * 28))
        parts += [
            ear.moved((-0.36, s * 0.24, 0.72)),
            limb((-0.64, s * 0.11, 0.56), (-0.84, s * 0.13, 0.54), 0.035, 0.012, 6),
            limb((-0.26, s * 0.15, 0.5), (-0.26 - s * 0.05, s * 0.15, 0.1), 0.13, 0.1, 8),
            limb((0.4, s * 0.15, 0.5), (0.4 + s * 0.05, s * 0.15, 0.1), 0.13, 0.1, 8),
        ]
    return primitives.joined([_plain(part) for part in parts])


def _horse(b: Builder) -> Mesh:
    parts = [
        limb((-0.26, 0, 0.74), (0.3, 0, 0.74), 0.19, 0.19, 10),
        limb((-0.36, 0, 0.82), (-0.6, 0, 1.16), 0.15, 0.09, 8),
        limb((-0.6, 0, 1.18), (-0.86, 0, 1.0), 0.095, 0.055, 8),
        primitives.tube(
            [(0.44, 0, 0.86), (0.6, 0, 0.82), (0.68, 0, 0.6), (0.66, 0, 0.36)], [0.04, 0.06, 0.07, 0.015], 6
        ),
        primitives.tube([(-0.56, 0, 1.3), (-0.4, 0, 1.14), (-0.26, 0, 0.94)], [0.03, 0.06, 0.03], 6),
    ]
    raised = b.rng.random() < 0.6
    for s in (-1, 1):
        parts.append(primitives.cylinder(0.03, 0.12, 0.004, 5).moved((-0.57, s * 0.05, 1.29)))
        knees = [
            ((-0.32, s * 0.1, 0.66), (-0.34, s * 0.1, 0.36), (-0.34, s * 0.1, 0.03)),
            ((0.36, s * 0.1, 0.66), (0.42, s * 0.1, 0.36), (0.38, s * 0.1, 0.03)),
        ]
        if raised and s < 0:
            knees[0] = ((-0.32, -0.1, 0.66), (-0.58, -0.1, 0.54), (-0.52, -0.1, 0.28))
        for hip, knee, hoof in knees:
            parts += [limb(hip, knee, 0.1, 0.05, 7), limb(knee, hoof, 0.048, 0.045, 6)]
    return primitives.joined([_plain(part) for part in parts])


def _knot(b: Builder) -> Mesh:
    """A trefoil knot that stands upright."""
    t = np.linspace(0, 2 * np.pi, 49)
    x, z = np.sin(t) + 2 * np.sin(2 * t), np.cos(t) - 2 * np.cos(2 * t)
    path = np.column_stack([x, -np.sin(3 * t), z]) / 5
    return primitives.tube(path, 0.13, 10)


def _lion(b: Builder) -> Mesh:
    parts = [
        limb((-0.3, 0, 0.3), (0.5, 0, 0.26), 0.22, 0.24, 12),
        _ball((0.52, 0.46, 0.56), (-0.46, 0, 0.54), 12, 8),
        _ball((0.3, 0.28, 0.32), (-0.66, 0, 0.58), 10, 6),
        _ball((0.2, 0.17, 0.15), (-0.8, 0, 0.52), 8, 5),
        primitives.tube([(0.7, 0, 0.16), (0.86, 0.1, 0.08), (0.7, 0.3, 0.06), (0.36, 0.34, 0.06)], 0.035, 6),
        _ball((0.14, 0.1, 0.1), (0.32, 0.34, 0.06), 6, 4),
    ]
    for s in (-1, 1):
        parts += [
            limb((-0.3, s * 0.16, 0.12), (-0.86, s * 0.16, 0.07), 0.1, 0.08, 8),
            _ball((0.5, 0.2, 0.42), (0.44, s * 0.2, 0.21), 10, 6),
            limb((0.4, s * 0.25, 0.06), (0.1, s * 0.26, 0.06), 0.07, 0.06, 6),
            _ball((0.08, 0.05, 0.1), (-0.52, s * 0.15, 0.745), 6, 4),
        ]
    return primitives.joined([_plain(part) for part in parts])


def _ball(size: Vec3, at: Vec3, sections: int, rings: int) -> Mesh:
    return _plain(primitives.ellipsoid(size, sections, rings).moved(at))


def _plain(mesh: Mesh) -> Mesh:
    """The mesh without texture coordinates of its own."""
    return Mesh(mesh.vertices, mesh.normals, mesh.faces)


KINDS = {"Statue": Kind(statue)}
