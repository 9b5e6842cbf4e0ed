import numpy as np
import pytest

from remqa_data.assets import AssetSpec, build
from remqa_data.assets.core.sizes import typical_size
from remqa_data.assets.looks.materials import COLORS, paint
from remqa_data.assets.looks.seen_colors import MIXED, colors_of, inner_colors, mean_color
from remqa_data.assets.types.furniture.seating import CLOTHS


@pytest.mark.parametrize("word", COLORS)
def test_plain_paint_is_of_its_colour(word) -> None:
    assert word in colors_of(paint(word))


def test_a_vase_of_clear_glass_is_not_called_blue() -> None:
    vases = [build(AssetSpec("Vase", typical_size("Vase"), 0, seed)) for seed in range(12)]
    clear = [v for v in vases if v.substance == "glass"]
    assert clear
    assert {v.color for v in clear} == {MIXED}
    assert {v.color for v in vases} - {MIXED}


@pytest.mark.parametrize(("variant", "count"), [(0, 0), (1, 1), (2, 0), (3, 1)], ids=str)
def test_a_sofa_has_no_pillows_of_its_own(variant, count) -> None:
    # They were of another cloth than the sofa, and nobody could tell them from the pillow that a question asks about.
    sofa = build(AssetSpec("Sofa", typical_size("Sofa"), variant))
    cloths = {s.material.color for link in sofa.links for s in link.surfaces if s.material.substance == "fabric"}
    assert len(CLOTHS) > 1
    assert len(cloths) == count  # the others are of leather


def test_what_things_in_a_cabinet_lie_on_has_a_colour_of_its_own() -> None:
    # Pans vanished on white shelves of black cabinets while one compared them with the front.
    cabinets = [build(AssetSpec("Cabinet", typical_size("Cabinet"), 6, seed)) for seed in range(12)]
    apart = [np.linalg.norm(color - mean_color(c)) for c in cabinets for color in inner_colors(c)]
    assert max(apart) > 40
    assert min(apart) < 20


def test_the_mean_colour_of_a_plain_thing_is_its_own() -> None:
    egg = build(AssetSpec("Egg", typical_size("Egg"), 0, 1))
    lightness, *tint = mean_color(egg)
    assert lightness > 60
    assert np.linalg.norm(tint) < 40
    assert np.allclose(inner_colors(egg), [mean_color(egg)])
