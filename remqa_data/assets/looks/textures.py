"""Procedural textures by name: seamless tiles that tint a material, and pictures that stand for themselves.

Each is drawn from a seed of its own, so the same name gives the same pixels in every process.
"""

from __future__ import annotations

import zlib
from functools import cache

import numpy as np

from remqa_data.assets.looks.pictures import PICTURES
from remqa_data.assets.looks.tiles import TILES
from remqa_data.errors import UnknownNameError
from remqa_data.geometry.types import U8

TEXTURE_NAMES = (*TILES, *PICTURES)
"""Every name that `texture` knows."""


@cache
def texture(name: str) -> U8:
    """Pixels of a texture.

    Parameters
    ----------
    name : str
        One of `TEXTURE_NAMES`.

    Returns
    -------
    (256, 256, 3) uint8, sRGB, read-only. The first row is the top of the picture, where the texture coordinate v is 0.

    Raises
    ------
    UnknownNameError
        No texture has this name.
    """
    drawn = TILES.get(name) or PICTURES.get(name)
    if drawn is None:
        raise UnknownNameError("texture", name, TEXTURE_NAMES)
    pixels = drawn(np.random.default_rng(zlib.crc32(name.encode())))
    pixels.setflags(write=False)
    return pixels


def repeats(name: str) -> bool:
    """Whether a texture is a seamless tile; a picture is not, and its border goes on beyond 0..1."""
    return name in TILES
