"""Golden values from pycocotools."""

import numpy as np
import pytest

from remqa_data.export.rle import compressed, run_lengths

mask = pytest.importorskip("pycocotools.mask")


@pytest.mark.slow
@pytest.mark.parametrize("shape", [(1, 1), (3, 7), (150, 150), (300, 200)])
@pytest.mark.parametrize("labels", [1, 2, 5, 1000])
def test_every_label_has_the_text_that_pycocotools_writes(shape, labels) -> None:
    image = np.random.default_rng(0).integers(labels, size=shape).astype(np.uint16)
    found = run_lengths(image)
    assert set(found) == set(image.ravel().tolist())
    for label, lengths in list(found.items())[:50]:
        expected = mask.encode(np.asfortranarray(image == label, dtype=np.uint8))
        assert compressed(lengths) == expected["counts"].decode()


def test_masks_with_long_runs_have_it_too() -> None:
    image = np.zeros((700, 900), dtype=np.uint16)
    image[40:200, 50:640], image[600:, 600:] = 1, 2
    found = run_lengths(image)
    assert len(found) == 3
    for label, lengths in found.items():
        expected = mask.encode(np.asfortranarray(image == label, dtype=np.uint8))
        assert compressed(lengths) == expected["counts"].decode()
