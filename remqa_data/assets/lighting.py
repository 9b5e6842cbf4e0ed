"""Candles and light switches."""

from __future__ import annotations

import numpy as np

from remqa_data.assets import forms, materials, primitives
from remqa_data.assets.builder import Builder
from remqa_data.assets.kind import Kind
from remqa_data.assets.model import Material
from remqa_data.assets.posed import Posed

METALS = (materials.BLACK_METAL, materials.WHITE_METAL, materials.BRASS, materials.CHROME, materials.COPPER)
WAXES = tuple(
    Material("wax", color, rgb, gloss=0.15)
    for color, rgb in (
        ("white", (0.95, 0.93, 0.86)),
        ("red", (0.68, 0.16, 0.15)),
        ("yellow", (0.93, 0.80, 0.45)),
        ("purple", (0.60, 0.46, 0.66)),
        ("green", (0.42, 0.56, 0.42)),
        ("pink", (0.88, 0.62, 0.64)),
    )
)
PLATES = (*3 * (materials.WHITE_PLASTIC,), materials.paint("beige"), materials.STEEL, materials.BLACK_PLASTIC)
WICK = materials.paint("black", "fabric", 0.0)


def candle(b: Builder) -> None:
    """A candle: pillar with drips, in a dish with a finger ring, in a glass jar, or twisted; thin ones are tapers."""
    p = Posed(b, upright=True)  # some lie in drawers
    wax = b.pick(WAXES)
    half = (p.w / 2, p.d / 2, 1.0)
    wick = min(0.014, 0.1 * p.h)
    if min(p.w, p.d) < 0.25 * p.h:
        _taper(b, p, wax, wick)
    elif b.variant == 2:
        rim = [(1, 0.84 * p.h), (1, 0.95 * p.h), (0.92, 0.95 * p.h), (0.9, 0.86 * p.h)]
        filled = [(0, 0), (0.92, 0), (1, 0.04 * p.h), (1, 0.84 * p.h)]
        p.add(primitives.revolve(rim, 20).scaled(half), b.pick((materials.FROSTED_GLASS, materials.CLEAR_GLASS)))
        p.add(primitives.revolve(filled, 20).scaled(half), wax)
        p.add(primitives.revolve([(0.9, 0.86 * p.h), (0, 0.85 * p.h)], 20).scaled(half), materials.tinted(wax, 1.1))
        label = primitives.revolve([(1.003, 0.2 * p.h), (1.003, 0.6 * p.h)], 20).scaled(half)
        p.add(label, materials.PAPER)
        p.add(primitives.revolve([(1.006, 0.32 * p.h), (1.006, 0.48 * p.h)], 20).scaled(half), b.pick(WAXES))
        p.add(primitives.tube([(0, 0, 0.84 * p.h), (0.001, 0, p.h)], 0.0016, 5), WICK)
    else:
        dish = b.variant == 1
        floor, r = (0.1 * p.h, 0.6) if dish else (0.0, 0.97)
        top = p.h - wick
        if dish:
            metal = b.pick(METALS)
            plate = [
                (0, 0),
                (0.6, 0),
                (0.95, 0.5 * floor),
                (0.95, 1.4 * floor),
                (0.85, 1.4 * floor),
                (0.6, floor),
                (0, floor),
            ]
            p.add(primitives.revolve(plate, 20).scaled(half), metal)
            p.add(primitives.cylinder(0.68, 0.12 * p.h, sections=16).scaled(half), metal, (0, 0, floor + 0.05 * p.h))
            loop = forms.ring(min(0.12 * p.h, 0.2 * p.w), min(0.02 * p.h, 0.03 * p.w), 12, 5).turned(
                primitives.turn("x", 90)
            )
            p.add(loop, metal, (0.86 * p.w / 2, 0, 2.2 * floor))
        if b.variant == 3:
            p.add(_twisted(r, floor, top).scaled(half), wax)
        else:
            p.add(primitives.revolve(_pillar(r, floor, top), 18).scaled(half), wax)
            _drips(p, wax, r, top)
        p.add(primitives.tube([(0, 0, top - 0.1 * p.h), (0, 0, top), (0.001, 0, p.h)], 0.0016, 5), WICK)
    b.looks_like(wax)
    p.solid((p.w, p.d, 0.98 * p.h), (0, 0, 0.49 * p.h))


def light_switch(b: Builder) -> None:
    """A light switch on its plate: rocker, pair of rockers, toggle, or dimmer beside a rocker; wall at +y."""
    plate = b.pick(PLATES)
    key = (
        materials.WHITE_PLASTIC
        if plate is not materials.WHITE_PLASTIC
        else materials.paint("white", rgb=(0.88, 0.88, 0.86))
    )
    flat = b.d - min(0.015, 0.62 * b.d)
    gangs = max(b.by_variant((1, 2, 1, 2)), round(b.w / 0.085) - 1)
    front = b.d / 2 - flat
    b.box((b.w, flat, b.h), (0, front + flat / 2, b.h / 2), plate, radius=min(0.004, 0.45 * flat), solid=False)
    b.solid((b.w, b.d, b.h), (0, 0, b.h / 2))
    reach = b.d - flat
    pitch = b.w * 0.86 / gangs
    for i in range(gangs):
        x = (i - (gangs - 1) / 2) * pitch
        if b.variant == 2:
            b.box((0.02, 0.002, 0.042), (x, front - 0.001, b.h / 2), materials.SHADOW_GAP, solid=False)
            tilt = primitives.turn("x", -28)
            lever = primitives.rounded_box((0.011, reach * 1.12, 0.012), 0.003).turned(tilt)
            low = float(lever.vertices[:, 1].min())
            b.add(lever, key, (x, -b.d / 2 - low, b.h / 2 + 0.008))
        elif b.variant == 3 and i == 0:
            r = min(0.4 * pitch, 0.17 * b.h)
            b.cylinder(
                r * 1.15, 0.003, (x, front - 0.0015, b.h / 2), materials.tinted(plate, 0.8), axis="-y", solid=False
            )
            b.cylinder(r, reach, (x, front - reach / 2, b.h / 2), key, axis="-y", top_radius=0.85 * r, solid=False)
            b.box(
                (0.004, 0.002, 0.6 * r), (x, -b.d / 2 - 0.0005, b.h / 2 + 0.45 * r), materials.GRAY_PLASTIC, solid=False
            )
        else:
            size = (min(0.8 * pitch, 0.052), 0.62 * b.h)
            b.box(
                (size[0] + 0.006, 0.0024, size[1] + 0.006),
                (x, front - 0.0012, b.h / 2),
                materials.tinted(plate, 0.6),
                solid=False,
            )
            s = size[1] / 2
            rocker = [(front, -s), (front, s), (front - 0.3 * reach, s), (front - 0.45 * reach, 0.0), (-b.d / 2, -s)]
            b.add(forms.side_cut(rocker, size[0]), key, (x, 0, b.h / 2))
        for z in (0.09, 0.91):
            b.cylinder(
                0.0035, 0.002, (x, front - 0.0006, z * b.h), materials.CHROME, axis="-y", sections=8, solid=False
            )
    b.looks_like(plate)


def _pillar(radius: float, low: float, high: float) -> list[tuple[float, float]]:
    """Profile of a candle that has burnt down a little in its middle; radius as a share of the half width."""
    rim = 0.03 * (high - low)
    return [
        (0, low),
        (radius, low),
        (radius, high - rim),
        (0.9 * radius, high),
        (0.75 * radius, high - 0.5 * rim),
        (0, high - 2 * rim),
    ]


def _drips(p: Posed, wax: Material, radius: float, top: float) -> None:
    """Wax that has run down the side."""
    for turn, share in ((0.4, 0.22), (2.2, 0.34), (4.1, 0.42), (4.8, 0.2), (5.6, 0.3)):
        x, y = 0.48 * radius * p.w * np.cos(turn), 0.48 * radius * p.d * np.sin(turn)
        fat = 0.045 * (p.w + p.d) / 2
        p.add(forms.limb((x, y, top - fat), (x, y, top - share * top), fat, 1.15 * fat, 6), wax)


def _twisted(radius: float, low: float, high: float) -> primitives.Mesh:
    """A candle with four flutes that wind around it, at unit half width."""
    rings = []
    for s in np.linspace(0, 1, 13):
        a = np.arange(20) * np.pi / 10
        r = radius * (0.9 - 0.1 * np.cos(4 * (a - 1.6 * s))) * (1.0 if s < 0.97 else 0.9)
        rings.append(np.column_stack([r * np.cos(a), r * np.sin(a), np.full(20, low + s * (high - low))]))
    return primitives.loft(rings)


def _taper(b: Builder, p: Posed, wax: Material, wick: float) -> None:
    """A slim candle: plain, two-coloured, ringed, or twisted."""
    half, top = (p.w / 2, p.d / 2, 1.0), p.h - wick
    if b.variant == 3:
        p.add(_twisted(1.0, 0.0, top).scaled(half), wax)
    elif b.variant == 2:
        z = np.linspace(0, 0.96 * top, 19)
        ripple = [(0.86 if i % 2 else 1.0, float(v)) for i, v in enumerate(z)]
        p.add(primitives.revolve([(0, 0), *ripple, (0.5, top), (0, top)], 14, crease_deg=70).scaled(half), wax)
    else:
        band = b.pick([other for other in WAXES if other != wax]) if b.variant == 1 else wax
        p.add(primitives.revolve([(0, 0), (1, 0), (0.96, 0.4 * top)], 14).scaled(half), band)
        p.add(primitives.revolve([(0.96, 0.4 * top), (0.8, 0.95 * top), (0.4, top), (0, top)], 14).scaled(half), wax)
    p.add(primitives.tube([(0, 0, top - 0.005), (0, 0, top + 0.6 * wick), (0.0008, 0, p.h)], 0.0013, 5), WICK)


KINDS = {
    "Candle": Kind(candle),
    "LightSwitch": Kind(light_switch),
}
