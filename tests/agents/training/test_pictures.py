import numpy as np
import pytest

from remqa_data.agents.training.pictures import Picture, varied


def margins(instances: np.ndarray, axis: int) -> tuple[int, int]:
    """Rows or columns before and behind what a square shows of a picture."""
    shown = np.flatnonzero(instances.any(axis=1 - axis))
    return int(shown[0]), instances.shape[axis] - 1 - int(shown[-1])


@pytest.mark.parametrize("size", [(300, 300), (150, 150), (150, 400), (600, 600)])
def test_a_part_of_a_picture_of_any_size_lies_inside_or_has_all_of_it_in_its_middle(size: tuple[int, int]) -> None:
    picture = Picture(np.full((*size, 3), 128, np.uint8), np.ones(size, np.int32), np.zeros(1, np.int64))
    found = []
    for seed in range(40):
        part = varied(picture, 192, np.random.default_rng(seed)).instances
        found += [margins(part, axis) for axis in (0, 1)]
    assert all(abs(before - behind) <= 3 for before, behind in found)  # but for pixels at its edges
    assert any(before == behind == 0 for before, behind in found)
