"""Books open flat on the table they lie on, with their pages up."""

import numpy as np
import pytest

from remqa_data.assets import AssetSpec, build
from remqa_data.assets.types.small.books import LINE

SIZES = ((0.13, 0.22, 0.015), (0.22, 0.30, 0.030), (0.425, 0.33, 0.061))


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("variant", range(4))
def test_opening_book_stays_on_the_table_and_ends_flat(size: tuple[float, float, float], variant: int) -> None:
    asset = build(AssetSpec("Book", size, variant))
    for openness in np.linspace(0, 1, 13):
        low, _ = asset.bounds(float(openness))
        assert low[2] > -size[2] / 2 - 5e-4, openness
    low, high = asset.bounds(1.0)
    assert high[0] - low[0] > 1.95 * size[0]
    assert high[2] - low[2] < size[2] / 2 + 0.1 * size[0]


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("variant", range(4))
def test_halves_of_a_book_do_not_cut_each_other(size: tuple[float, float, float], variant: int) -> None:
    asset = build(AssetSpec("Book", size, variant))
    upper = np.vstack([surface.vertices for surface in asset.links[1].surfaces])
    assert asset.links[0].boxes
    for openness in np.linspace(0, 1, 13):
        pose = asset.link_poses(float(openness))[1]
        points = upper @ pose[:3, :3].T + pose[:3, 3]
        for box in asset.links[0].boxes:
            inside = np.abs(points - box.centre) < np.array(box.size) / 2 - 3e-4
            assert not inside.all(axis=1).any(), (openness, box)


def test_text_is_hidden_when_shut_and_faces_up_when_open() -> None:
    asset = build(AssetSpec("Book", SIZES[1], 0))
    assert len(asset.links) == 2
    for link, pose in zip(asset.links, asset.link_poses(1.0), strict=True):
        text = next(surface for surface in link.surfaces if surface.material == LINE)
        assert (text.normals @ pose[:3, :3].T)[:, 2].min() > 0.99
        assert np.abs(text.vertices[:, 2]).max() < 1e-3  # shut: in the middle of the book
