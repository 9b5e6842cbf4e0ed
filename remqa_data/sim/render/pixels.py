"""Scratch for shading: what is known about up to `BLOCK_PX` neighbouring pixels of an image row.

A sheet is a flat array; quantity Q of pixel i is `sheet[Q + i]`. Because the distance between two quantities is a
constant, the compiler sees that they do not overlap, and turns loops over pixels into vector instructions.
"""

from __future__ import annotations

BLOCK_PX = 320
"""Most pixels that are shaded at once; small enough for everything to stay in the first-level cache."""

# float32: texture look-up, material, place, light.
TEXTURE, U, V, STRETCH, RED, GREEN, BLUE, GLOSS, GLOW = (row * BLOCK_PX for row in range(9))
NORMAL_X, NORMAL_Y, NORMAL_Z, X, Y, Z, DEPTH = (row * BLOCK_PX for row in range(9, 16))
LIT, LIMIT, SHIFT_X, SHIFT_Y = (row * BLOCK_PX for row in range(16, 20))
LIGHT_RED, LIGHT_GREEN, LIGHT_BLUE, FLOATS = (row * BLOCK_PX for row in range(20, 24))
STEPS, WEIGHT_CORNER, WEIGHT_ACROSS, WEIGHT_ALONG = LIT, LIMIT, SHIFT_X, SHIFT_Y
"""Of the samples of baked light; done with before shadows are looked up."""

# int32: addresses in the atlas or the shadow maps, and weights in 1 / 256.
ADDRESS, ACROSS, ALONG, COARSE, INTS = (row * BLOCK_PX for row in (0, 8, 10, 12, 13))
ADDRESS_OF_TILE = BLOCK_PX
"""Shadows need one address in the maps, and this one; textures need eight."""
