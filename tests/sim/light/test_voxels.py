"""Rays through cubes against the intersection of lines with boxes."""

import numpy as np
import pytest

from remqa_data.sim.light.voxels import Faces, Voxels, cast, surface_points, voxelise

SIDE = 12
"""Cubes along each edge of the space that is tried."""


def specks(rng: np.random.Generator, count: int) -> Voxels:
    """Small triangles, seen from both sides, in cubes of 1 m."""
    middles = rng.uniform(0.0, SIDE, (count, 1, 3))
    corners = (middles + rng.uniform(-0.01, 0.01, (count, 3, 3))).astype(np.float32)
    normals = rng.normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    faces = Faces(
        corners,
        normals.astype(np.float32),
        np.ones((count, 3), np.float32),
        np.zeros(count, np.float32),
        np.ones(count, dtype=np.bool_),
        np.zeros((count, 3), np.float32),
    )
    return voxelise(faces, surface_points(faces), np.zeros(3), np.full(3, float(SIDE)), 1.0)


def first_of(voxels: Voxels, start: np.ndarray, direction: np.ndarray) -> int:
    """The cube into which the line comes first, by slabs; -2 if into none."""
    cubes = np.argwhere(voxels.number >= 0)
    a, b = (cubes - start) / direction, (cubes + 1 - start) / direction
    enters, leaves = np.minimum(a, b).max(axis=1), np.maximum(a, b).min(axis=1)
    enters[(enters >= leaves) | (enters < 0)] = np.inf
    nearest = int(enters.argmin())
    return int(voxels.number[tuple(cubes[nearest])]) if np.isfinite(enters[nearest]) else -2


@pytest.mark.parametrize("count", [5, 60, 400])
def test_a_ray_meets_the_first_cube_in_its_way(count: int) -> None:
    rng = np.random.default_rng(count)
    voxels = specks(rng, count)
    met = set()
    for _ in range(400):
        start, direction = rng.uniform(0.0, SIDE, 3), rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        cube, facing = cast(voxels, *start, *direction, 1e6, 0.0)
        assert cube == first_of(voxels, start, direction)
        assert (facing > 0) == (cube >= 0)
        met.add(cube)
    assert len(met) > 4


def test_a_ray_that_starts_outside_comes_in_only_from_beside_the_room() -> None:
    voxels = specks(np.random.default_rng(0), 400)
    inward, outward = (1.0, 0.0, 0.0), (-1.0, 0.0, 0.0)
    row = np.flatnonzero(voxels.number[:, 5, 5] >= 0)
    assert cast(voxels, -0.5, 5.5, 5.5, *inward, 1e6, 0.0)[0] == voxels.number[row[0], 5, 5]
    for start in (-0.5, -1.5, -70.0):
        assert cast(voxels, start, 5.5, 5.5, *outward, 1e6, 0.0)[0] == -2
    assert cast(voxels, -70.0, 5.5, 5.5, *inward, 1e6, 0.0)[0] == -2


def test_a_ray_is_followed_no_farther_than_asked_and_meets_nothing_before_its_skip() -> None:
    voxels = specks(np.random.default_rng(0), 2000)
    first, second = np.flatnonzero(voxels.number[:, 5, 5] >= 0)[:2]
    assert cast(voxels, -0.5, 5.5, 5.5, 1.0, 0.0, 0.0, first + 0.4, 0.0)[0] == -1
    assert cast(voxels, -0.5, 5.5, 5.5, 1.0, 0.0, 0.0, first + 0.6, 0.0)[0] == voxels.number[first, 5, 5]
    assert cast(voxels, -0.5, 5.5, 5.5, 1.0, 0.0, 0.0, 1e6, first + 0.6)[0] == voxels.number[second, 5, 5]
