"""Materials that the machines of a kitchen share."""

from __future__ import annotations

from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials

BODIES = (
    materials.WHITE_METAL,
    materials.STEEL,
    materials.BLACK_METAL,
    materials.WHITE_METAL,
    materials.STEEL,
)
RETRO = tuple(
    materials.paint(color, "metal", 0.5, rgb)
    for color, rgb in (
        ("red", (0.70, 0.16, 0.15)),
        ("blue", (0.52, 0.72, 0.78)),
        ("beige", (0.92, 0.86, 0.72)),
        ("green", (0.60, 0.76, 0.62)),
    )
)
LINER = Material("plastic", "white", (0.93, 0.95, 0.96), gloss=0.3, glow=0.3)
"""The inside of a fridge or oven, lit by its own lamp."""
DISPLAY = Material("glass", "green", (0.25, 0.75, 0.60), glow=0.7)
