"""Every texture: its form, its seams, its brightness, and that it is the same everywhere."""

from __future__ import annotations

import hashlib
import subprocess
import sys

import numpy as np
import pytest

from remqa_data.assets.looks.textures import TEXTURE_NAMES, repeats, texture
from remqa_data.errors import UnknownNameError

TILES = [name for name in TEXTURE_NAMES if repeats(name)]
PICTURES = [name for name in TEXTURE_NAMES if not repeats(name)]


@pytest.mark.slow
@pytest.mark.parametrize("name", TEXTURE_NAMES)
def test_texture_is_a_square_colour_image_with_something_on_it(name):
    pixels = texture(name)
    assert pixels.shape == (256, 256, 3)
    assert pixels.dtype == np.uint8
    assert pixels.std() > 0.5


@pytest.mark.parametrize("name", TILES)
def test_tile_has_no_seam(name):
    pixels = texture(name).astype(float)
    for axis in (0, 1):
        inside = np.abs(np.diff(pixels, axis=axis)).mean(axis=(1 - axis, 2))
        seam = np.abs(np.take(pixels, 0, axis) - np.take(pixels, -1, axis)).mean()
        # As large a step as the largest between two rows inside, such as from a board to the gap beside it.
        assert seam <= inside.max() + 1.0


@pytest.mark.parametrize("name", TILES)
def test_tile_is_light_enough_to_tint_a_material(name):
    assert 0.72 < texture(name).mean() / 255 < 0.96


@pytest.mark.slow
def test_pictures_differ_from_each_other():
    assert len({texture(name).tobytes() for name in TEXTURE_NAMES}) == len(TEXTURE_NAMES)
    assert len(PICTURES) >= 30


def test_texture_is_read_only_and_drawn_once():
    assert texture("wood") is texture("wood")
    with pytest.raises(ValueError, match="read-only"):
        texture("wood")[0, 0, 0] = 0


def test_unknown_name_is_refused_with_the_nearest_one():
    with pytest.raises(UnknownNameError, match="did you mean 'marble'"):
        texture("marbel")


@pytest.mark.slow
def test_another_process_draws_the_same_pixels():
    code = (
        "import hashlib; from remqa_data.assets.looks.textures import *;"
        "print(hashlib.sha256(b''.join(texture(n).tobytes() for n in TEXTURE_NAMES)).hexdigest())"
    )
    other = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    here = hashlib.sha256(b"".join(texture(name).tobytes() for name in TEXTURE_NAMES)).hexdigest()
    assert other.stdout.strip() == here
