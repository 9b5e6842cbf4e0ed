"""Arithmetic in a fixed order agrees with the libraries that it stands in for, to about the last digit."""

import math

import mpmath
import numpy as np
import pytest

from remqa_data.geometry import arithmetic

LAST_DIGIT = 2.3e-16


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(0)


def test_sine_and_cosine_are_those_of_a_hundred_digits(rng: np.random.Generator) -> None:
    angles = [*rng.uniform(-10, 10, 200), *rng.uniform(-1e4, 1e4, 50), 0.0, math.pi / 2, math.pi, 1e-9]
    sines, cosines = arithmetic.sin_cos(angles)
    assert len(sines) == len(cosines) == len(angles) > 250
    with mpmath.workdps(100):
        for angle, sine, cosine in zip(angles, sines, cosines, strict=True):
            assert abs(mpmath.sin(angle) - mpmath.mpf(float(sine))) < LAST_DIGIT
            assert abs(mpmath.cos(angle) - mpmath.mpf(float(cosine))) < LAST_DIGIT


def test_sines_of_degrees_are_exact_along_the_axes() -> None:
    sines, cosines = arithmetic.sin_cos_deg([-360, -90, 0, 90, 180, 270, 450])
    assert sines.tolist() == [0, -1, 0, 1, 0, -1, 1]
    assert cosines.tolist() == [1, 0, 1, 0, -1, 0, 0]
    assert not np.signbit(sines[[0, 2, 4]]).any()
    degrees = np.arange(-400.0, 400.0, 7.5)
    np.testing.assert_allclose(arithmetic.sin_cos_deg(degrees)[0], np.sin(np.radians(degrees)), atol=1e-15)


def test_angles_of_directions(rng: np.random.Generator) -> None:
    y, x = rng.normal(size=(2, 2000))
    np.testing.assert_allclose(arithmetic.arctan2(y, x), np.arctan2(y, x), rtol=4e-16)
    axes = [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0), (0.0, 0.0), (1.0, 1.0)]
    expected = [0.0, math.pi / 2, math.pi, -math.pi / 2, 0.0, math.pi / 4]
    assert arithmetic.arctan2(*np.transpose(axes)).tolist() == expected
    pairs = [*zip(y.tolist(), x.tolist(), strict=True), *axes, (-0.0, -1.0), (math.inf, 1.0)]
    one_by_one = [float(arithmetic.arctan2(*pair)) for pair in pairs]
    with np.errstate(invalid="ignore"):
        together = arithmetic.arctan2(*np.transpose(pairs))
    assert np.array_equal(one_by_one, together, equal_nan=True)


def test_angles_of_cosines(rng: np.random.Generator) -> None:
    cosines = np.append(rng.uniform(-1, 1, 2000), [-1.0, 0.0, 1.0])
    np.testing.assert_allclose(arithmetic.arccos(cosines), np.arccos(cosines), rtol=1e-15, atol=1e-15)
    with np.errstate(invalid="ignore"):
        assert np.isnan(arithmetic.arccos(1.5))


def test_powers_of_e(rng: np.random.Generator) -> None:
    powers = np.append(rng.uniform(-700, 700, 2000), [0.0, 1.0])
    np.testing.assert_allclose(arithmetic.exp(powers), np.exp(powers), rtol=5e-16)
    assert arithmetic.exp(0.0) == 1.0


def test_products_are_those_of_matrices(rng: np.random.Generator) -> None:
    a, b = rng.normal(size=(5, 1, 4, 3)), rng.normal(size=(7, 3, 2))
    np.testing.assert_allclose(arithmetic.product(a, b), a @ b, atol=1e-14)
    points, rotation = rng.normal(size=(6, 3)), rng.normal(size=(3, 3))
    np.testing.assert_allclose(arithmetic.turned(points, rotation), points @ rotation.T, atol=1e-14)
    np.testing.assert_allclose(arithmetic.turned_back(points, rotation), points @ rotation, atol=1e-14)
    np.testing.assert_allclose(arithmetic.dot(points, points[0]), points @ points[0], atol=1e-14)
    np.testing.assert_allclose(arithmetic.length(points), np.linalg.norm(points, axis=1), atol=1e-14)


@pytest.mark.parametrize(("first", "second"), [((3,), (3,)), ((7, 3), (7, 3)), ((7, 3), (3,)), ((4, 1, 3), (5, 3))])
@pytest.mark.parametrize("kind", [np.float64, np.float32, np.int64])
def test_vector_products_are_numpys_to_the_bit(
    rng: np.random.Generator, first: tuple[int, ...], second: tuple[int, ...], kind: type
) -> None:
    a, b = (rng.normal(scale=100.0, size=shape).astype(kind) for shape in (first, second))
    found, expected = arithmetic.cross(a, b), np.cross(a, b)
    assert (found.dtype, found.shape) == (expected.dtype, expected.shape)
    assert found.tobytes() == np.ascontiguousarray(expected).tobytes()


def test_a_pose_and_its_inverse_undo_each_other(rng: np.random.Generator) -> None:
    poses = np.tile(np.eye(4), (4, 1, 1))
    poses[:, :3, :3] = np.linalg.qr(rng.normal(size=(4, 3, 3)))[0]
    poses[:, :3, 3] = rng.normal(size=(4, 3))
    points = rng.normal(size=(4, 3))
    np.testing.assert_allclose(
        arithmetic.product(poses, arithmetic.inverse(poses)), np.tile(np.eye(4), (4, 1, 1)), atol=1e-14
    )
    np.testing.assert_allclose(arithmetic.moved_back(arithmetic.moved(points, poses), poses), points, atol=1e-14)


def test_what_differs_by_rounding_is_snapped_to_the_same_number(rng: np.random.Generator) -> None:
    values = rng.uniform(-5, 5, 10_000)
    snapped = arithmetic.snapped(values)
    np.testing.assert_array_equal(snapped, arithmetic.snapped(np.nextafter(values, np.inf)))
    np.testing.assert_array_equal(snapped, arithmetic.snapped(snapped))
    assert np.abs(snapped - values).max() <= arithmetic.LENGTH_STEP_M / 2
    assert not np.signbit(arithmetic.snapped(-1e-17))


def test_one_of_many_and_one_alone_give_the_same_bits(rng: np.random.Generator) -> None:
    poses, others, points = rng.normal(size=(500, 4, 4)), rng.normal(size=(500, 4, 4)), rng.normal(size=(500, 3))
    poses[:, 3] = others[:, 3] = 0.0, 0.0, 0.0, 1.0
    angles = np.concatenate([rng.uniform(-10, 10, 400), 45.0 * np.arange(-50, 50)])
    cases = [(arithmetic.product, (poses, others)), (arithmetic.inverse, (poses,))]
    cases += [(function, (points, poses)) for function in (arithmetic.moved, arithmetic.moved_back)]
    cases += [(function, (points, poses[:, :3, :3])) for function in (arithmetic.turned, arithmetic.turned_back)]
    for function, arguments in cases:
        alone = [function(*one) for one in zip(*arguments, strict=True)]
        assert np.stack(alone).tobytes() == function(*arguments).tobytes(), function.__name__
    for function in (arithmetic.sin_cos, arithmetic.sin_cos_deg):
        alone = [function(angle) for angle in angles.tolist()]
        assert np.transpose(alone).tobytes() == np.stack(function(angles)).tobytes(), function.__name__
