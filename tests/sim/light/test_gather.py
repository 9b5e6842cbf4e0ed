"""Rays of many probes at once against one ray after another, each followed by itself."""

import numpy as np
import pytest
import trimesh

from remqa_data.sim.light.gather import BACKS, gather
from remqa_data.sim.light.volume import BEYOND, IN_AIR, NEAR_SURFACE, Volume
from remqa_data.sim.light.voxels import GATE, Faces, Voxels, cast, surface_points, voxelise

SKY = 0.7


def shelves(rng: np.random.Generator, cube_m: float) -> Voxels:
    """A room of 32 x 24 x 16 cubes without one wall, with boxes in random colours, one of which opens."""
    size = np.array((32.0, 24.0, 16.0)) * cube_m
    room = trimesh.creation.box(bounds=(np.zeros(3), size))
    room.update_faces(room.face_normals[:, 0] < 0.5)
    room.invert()
    boxes = [
        trimesh.creation.box(bounds=np.sort(rng.uniform(0.1, 0.9, (2, 3)) * size, axis=0) * (0.5 + 0.5 * rng.random()))
        for _ in range(6)
    ]
    meshes = [room, *boxes]
    mesh = trimesh.util.concatenate(meshes)
    front = np.zeros((len(mesh.faces), 3), np.float32)
    front[-12:] = (-1.0, 0.0, 0.0)
    faces = Faces(
        mesh.triangles.astype(np.float32),
        mesh.face_normals.astype(np.float32),
        np.ones((len(mesh.faces), 3), np.float32),
        np.zeros(len(mesh.faces), np.float32),
        np.zeros(len(mesh.faces), np.bool_),
        front,
    )
    voxels = voxelise(faces, surface_points(faces), np.full(3, -6.0 * cube_m), size + 6.0 * cube_m, cube_m)
    voxels.sent[:] = rng.random(voxels.sent.shape)
    return voxels


def one_by_one(voxels: Voxels, volume: Volume, near: np.ndarray, in_air: np.ndarray, places: np.ndarray) -> Volume:
    """The same as `gather` by its definition: each ray of each probe from its own place."""
    light, is_valid = np.zeros_like(volume.light), np.zeros_like(volume.is_valid)
    for i, j, m in np.argwhere(places != BEYOND):
        start = (volume.origin + np.array((i, j, m)) * volume.spacing_m - voxels.origin) / voxels.size_m
        if voxels.number[tuple(np.floor(start).astype(int))] >= 0:
            continue
        rays = (in_air if places[i, j, m] == IN_AIR else near)[(i % 2 + 2 * (j % 2) + 4 * (m % 2)) % len(near)]
        total, weight, backs = np.zeros((6, 3)), np.zeros(6), 0
        for ray in rays:
            cube, facing = cast(voxels, *start, *ray, 1e6, 0.0)
            against = [2 * axis + int(along > 0) for axis, along in enumerate(ray)]
            come = np.full(3, SKY if cube == -2 else 0.0)
            if facing > 0.0:
                parts = [abs(ray[axis]) * np.float64(voxels.cover[cube, against[axis]]) / facing for axis in range(3)]
                x, y, z = (voxels.sent[cube, side].astype(np.float64) for side in against)
                come = parts[0] * x + parts[1] * y + parts[2] * z
            backs += int(cube >= 0 and facing <= 0.0)
            for axis, along in enumerate(ray):
                side = 2 * axis + int(along <= 0)
                weight[side] += abs(along)
                total[side] += abs(along) * come
        if backs <= BACKS * len(rays):
            is_valid[i, j, m] = True
            light[i, j, m] = total / np.maximum(weight, 1e-9)[:, None]
    return volume._replace(light=light, is_valid=is_valid)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_probes_receive_to_the_bit_what_their_rays_bring_one_by_one(seed: int) -> None:
    """Probes 25 / 8 of a cube apart, as in rooms: some on faces and edges of cubes; some rays go along axes or diagonals."""
    rng = np.random.default_rng(seed)
    spacing_m = 0.125
    voxels = shelves(rng, 0.32 * spacing_m)
    shape = (12, 9, 7)
    volume = Volume(
        np.full(3, -2.0 * spacing_m), np.zeros((*shape, 6, 3), np.float32), spacing_m, np.ones(shape, np.bool_), 0.0
    )
    near, in_air = (rng.normal(size=(8, count, 3)) for count in (9, 4))
    near[:, 0] = (0.0, 0.6, -0.8)
    near[:, 1] = (0.0, 0.0, 1.0)
    near[:, 2] = (-0.6, 0.6, 0.4)
    near, in_air = (rays / np.linalg.norm(rays, axis=2, keepdims=True) for rays in (near, in_air))
    places = rng.choice([BEYOND, NEAR_SURFACE, IN_AIR], shape).astype(np.uint8)
    expected = one_by_one(voxels, volume, near, in_air, places)
    gather(voxels, volume, near, in_air, SKY, places)
    assert (voxels.kind == GATE).any()
    assert 20 < volume.is_valid.sum() < (places != BEYOND).sum()
    assert np.array_equal(volume.is_valid, expected.is_valid)
    assert np.array_equal(volume.light[volume.is_valid], expected.light[volume.is_valid])
