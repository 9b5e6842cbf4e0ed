"""Palettes: named materials that builders pick from. Colour words are the basic ones that people use in a question."""

from __future__ import annotations

from dataclasses import replace

from remqa_data.assets.core.model import Material
from remqa_data.geometry.types import Vec3

COLORS: dict[str, Vec3] = {
    "white": (0.94, 0.94, 0.92),
    "black": (0.11, 0.11, 0.12),
    "gray": (0.52, 0.53, 0.55),
    "red": (0.76, 0.19, 0.17),
    "orange": (0.90, 0.52, 0.18),
    "yellow": (0.92, 0.78, 0.28),
    "green": (0.30, 0.56, 0.34),
    "blue": (0.22, 0.41, 0.66),
    "purple": (0.47, 0.31, 0.58),
    "pink": (0.88, 0.58, 0.64),
    "brown": (0.47, 0.31, 0.20),
    "beige": (0.84, 0.77, 0.64),
}


def paint(color: str, substance: str = "plastic", gloss: float = 0.25, rgb: Vec3 | None = None) -> Material:
    """A plain coloured material; `rgb` gives a shade of the named colour."""
    return Material(substance, color, rgb or COLORS[color], gloss=gloss)


def fabric(color: str, texture: str = "fabric", repeat_m: float = 0.25, rgb: Vec3 | None = None) -> Material:
    """Cloth of a colour: texture `fabric`, `knit`, `towel`, `carpet` or `wicker`."""
    return Material("fabric", color, rgb or COLORS[color], texture, repeat_m)


def ceramic(color: str, rgb: Vec3 | None = None) -> Material:
    """Glazed ceramic."""
    return Material("ceramic", color, rgb or COLORS[color], gloss=0.5)


def picture(name: str, color: str = "white", substance: str = "paper") -> Material:
    """A full-colour image stretched once over a surface; use with meshes that carry their own uv."""
    return Material(substance, color, (1.0, 1.0, 1.0), name, None)


def tinted(material: Material, factor: float) -> Material:
    """The same material, darker (factor below 1) or lighter."""
    r, g, b = (min(1.0, channel * factor) for channel in material.rgb)
    return replace(material, rgb=(r, g, b))


OAK = Material("wooden", "brown", (0.80, 0.61, 0.40), "wood", 0.8, 0.12)
PINE = Material("wooden", "beige", (0.93, 0.80, 0.60), "wood", 0.8, 0.12)
WALNUT = Material("wooden", "brown", (0.50, 0.33, 0.21), "wood", 0.8, 0.15)
CHERRY = Material("wooden", "brown", (0.62, 0.34, 0.21), "wood", 0.8, 0.18)
EBONY = Material("wooden", "black", (0.20, 0.16, 0.14), "wood", 0.8, 0.18)
WHITE_WOOD = Material("wooden", "white", (0.95, 0.94, 0.91), "wood", 0.8, 0.15)
GRAY_WOOD = Material("wooden", "gray", (0.62, 0.62, 0.61), "wood", 0.8, 0.12)
BLUE_WOOD = Material("wooden", "blue", (0.40, 0.53, 0.64), "wood", 0.8, 0.12)
GREEN_WOOD = Material("wooden", "green", (0.46, 0.58, 0.48), "wood", 0.8, 0.12)
WOODS = (OAK, PINE, WALNUT, CHERRY, EBONY)
PAINTED_WOODS = (WHITE_WOOD, GRAY_WOOD, BLUE_WOOD, GREEN_WOOD)

STEEL = Material("metal", "gray", (0.74, 0.75, 0.77), "brushed", 0.3, 0.55)
CHROME = Material("metal", "gray", (0.80, 0.82, 0.85), gloss=0.8)
BLACK_METAL = Material("metal", "black", (0.13, 0.13, 0.14), gloss=0.4)
WHITE_METAL = Material("metal", "white", (0.93, 0.93, 0.93), gloss=0.4)
BRASS = Material("metal", "yellow", (0.78, 0.63, 0.32), gloss=0.6)
COPPER = Material("metal", "orange", (0.76, 0.45, 0.30), gloss=0.6)
METALS = (STEEL, BLACK_METAL, WHITE_METAL)

WHITE_CERAMIC = ceramic("white", (0.96, 0.96, 0.95))
CERAMICS = tuple(ceramic(color) for color in ("white", "blue", "red", "green", "yellow", "black"))
PLASTICS = tuple(paint(color) for color in ("white", "black", "red", "blue", "green", "yellow", "gray"))
FABRICS = tuple(
    fabric(color, rgb=rgb)
    for color, rgb in (
        ("blue", (0.33, 0.43, 0.58)),
        ("gray", (0.55, 0.55, 0.56)),
        ("beige", (0.80, 0.73, 0.61)),
        ("red", (0.62, 0.24, 0.22)),
        ("green", (0.36, 0.48, 0.38)),
        ("brown", (0.45, 0.33, 0.25)),
    )
)
LEATHERS = tuple(
    Material("leather", color, rgb, "leather", 0.4, 0.25)
    for color, rgb in (
        ("brown", (0.42, 0.26, 0.17)),
        ("black", (0.16, 0.15, 0.15)),
        ("white", (0.88, 0.86, 0.82)),
        ("red", (0.50, 0.15, 0.13)),
    )
)
STONES = (
    Material("stone", "white", (0.95, 0.95, 0.94), "marble", 1.2, 0.35),
    Material("stone", "gray", (0.58, 0.58, 0.58), "granite", 0.6, 0.30),
    Material("stone", "black", (0.24, 0.24, 0.26), "granite", 0.6, 0.35),
    Material("stone", "beige", (0.86, 0.79, 0.68), "granite", 0.6, 0.30),
)

WHITE_PLASTIC = paint("white")
BLACK_PLASTIC = paint("black")
GRAY_PLASTIC = paint("gray")
RUBBER = Material("rubber", "black", (0.13, 0.13, 0.13))
CARDBOARD = Material("cardboard", "brown", (0.76, 0.59, 0.40), "cardboard", 0.5)
PAPER = Material("paper", "white", (0.95, 0.94, 0.90))
WICKER = Material("wicker", "brown", (0.74, 0.56, 0.36), "wicker", 0.2)
DARK_GLASS = Material("glass", "black", (0.07, 0.08, 0.10), gloss=0.8)
CLEAR_GLASS = Material("glass", "blue", (0.74, 0.85, 0.88), gloss=0.7)
FROSTED_GLASS = Material("glass", "white", (0.84, 0.91, 0.92), gloss=0.4)
GREEN_GLASS = Material("glass", "green", (0.13, 0.33, 0.17), gloss=0.7)
BROWN_GLASS = Material("glass", "brown", (0.40, 0.22, 0.09), gloss=0.7)
MIRROR_GLASS = Material("glass", "gray", (1.0, 1.0, 1.0), "mirror", None, gloss=0.6, mirror=0.88)
SHADOW_GAP = Material("plastic", "black", (0.10, 0.10, 0.10))
LAMP_LIGHT = Material("glass", "white", (1.0, 0.96, 0.84), glow=1.0)
LEAF = Material("organic", "green", (0.28, 0.52, 0.24))
SOIL = Material("organic", "brown", (0.25, 0.18, 0.13))
