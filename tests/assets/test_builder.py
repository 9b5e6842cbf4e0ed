import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from remqa_data.assets import AssetSpec, build
from remqa_data.assets.core.builder import Builder
from remqa_data.assets.looks import materials
from remqa_data.assets.mesh.cutting import solid_around
from remqa_data.errors import AssetError, UnknownNameError
from remqa_data.geometry.rotations import quaternion_of, rotation_of
from remqa_data.geometry.types import Box

COORDINATE = st.integers(0, 20).map(lambda n: n / 10)


@st.composite
def boxes(draw: st.DrawFn) -> Box:
    x, y, z = (sorted(draw(st.lists(COORDINATE, min_size=2, max_size=2, unique=True))) for _ in range(3))
    return x[0], y[0], z[0], x[1], y[1], z[1]


def volume(box: Box) -> float:
    return float(np.prod(np.subtract(box[3:], box[:3])))


def inside(points: np.ndarray, box: Box) -> np.ndarray:
    return np.all((points > box[:3]) & (points < box[3:]), axis=1)


@pytest.mark.slow
@given(boxes(), st.lists(boxes(), max_size=4))
def test_solid_around_covers_exactly_what_no_pocket_takes(whole: Box, pockets: list[Box]) -> None:
    cut = solid_around(whole, pockets)
    points = np.random.default_rng(0).uniform(0, 2, (400, 3)) + 1e-7
    wanted = inside(points, whole) & ~np.any([inside(points, p) for p in pockets] or [[False] * 400], axis=0)
    counts = np.sum([inside(points, c) for c in cut], axis=0) if cut else np.zeros(400)
    assert np.array_equal(counts, wanted.astype(int))


@given(st.lists(st.floats(-1, 1), min_size=4, max_size=4).filter(lambda q: np.linalg.norm(q) > 0.1))
def test_quaternion_and_matrix_agree(raw: list[float]) -> None:
    q = np.array(raw) / np.linalg.norm(raw)
    back = np.array(quaternion_of(rotation_of(tuple(q))))
    assert np.allclose(back, q, atol=1e-7) or np.allclose(back, -q, atol=1e-7)


def test_quarter_turn_about_z_is_the_textbook_quaternion() -> None:
    half = np.sqrt(0.5)
    assert np.allclose(rotation_of((0, 0, half, half)) @ [1, 0, 0], [0, 1, 0])


def blank(size: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> Builder:
    return Builder(AssetSpec("Box", size))


def test_finish_fits_the_mesh_and_everything_with_it_to_the_box() -> None:
    b = blank((1.0, 1.0, 1.0))
    b.box((0.9, 0.9, 0.9), (0, 0, 0.45), materials.OAK)
    b.space("inside", (0.9, 0.9, 0.45), (0, 0, 0.225))
    asset = b.finish()
    assert np.allclose(asset.bounds(), [[-0.5] * 3, [0.5] * 3])
    assert np.allclose(asset.links[0].boxes[0].size, 1.0)
    assert np.allclose(asset.spaces[0].box, (-0.5, -0.5, -0.5, 0.5, 0.5, 0.0))


def test_finish_refuses_what_is_far_from_the_asked_size() -> None:
    b = blank()
    b.box((0.5, 1.0, 1.0), (0, 0, 0.5), materials.OAK)
    with pytest.raises(AssetError, match=r"Box variant 0: drawn \[0.5, 1.0, 1.0\] m for a box of"):
        b.finish()


def test_finish_refuses_nothing() -> None:
    with pytest.raises(AssetError, match="drew nothing"):
        blank().finish()


def test_hinge_moves_the_door_about_its_edge() -> None:
    b = blank()
    b.box((1.0, 0.98, 1.0), (0, 0.01, 0.5), materials.OAK)
    b.door("door", (1.0, 0.02, 1.0), (0, -0.49, 0.5), materials.OAK, hinge="-x", degrees=90)
    asset = b.finish()
    low, high = asset.bounds(1.0)
    assert low[1] == pytest.approx(-1.48, abs=0.03)
    assert high[0] == pytest.approx(0.5, abs=1e-6)


def test_shell_is_hollow_and_open() -> None:
    b = blank()
    b.shell((1, 1, 1), (0, 0, 0.5), 0.1, materials.OAK, open_side="z")
    solids = b.finish().links[0].boxes
    total = sum(float(np.prod(box.size)) for box in solids)
    assert total == pytest.approx(1 - 0.8 * 0.8 * 0.9, abs=2e-5)  # sizes are snapped to a micrometre


def test_unknown_types_and_variants_are_named() -> None:
    with pytest.raises(UnknownNameError, match="did you mean 'Mug'"):
        build(AssetSpec("Mugg", (0.1, 0.1, 0.1)))
    with pytest.raises(AssetError, match="Mug has variants 0 to 3, not 9"):
        build(AssetSpec("Mug", (0.1, 0.1, 0.1), variant=9))
    with pytest.raises(AssetError, match="must be positive"):
        build(AssetSpec("Mug", (0.1, 0.0, 0.1)))
