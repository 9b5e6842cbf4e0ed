import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from remqa_data.assets.mesh import primitives
from remqa_data.assets.mesh.primitives import Mesh

SIZE = st.floats(0.01, 3.0)

CLOSED: dict[str, Mesh] = {
    "box": primitives.box((1, 2, 3)),
    "rounded_box": primitives.rounded_box((1, 2, 3), 0.1, 3),
    "revolve": primitives.revolve([(0, 0), (1, 0), (1, 1), (0.9, 1), (0.8, 0.1), (0, 0.1)]),
    "cylinder": primitives.cylinder(1, 2, 0.5),
    "ellipsoid": primitives.ellipsoid((1, 2, 3)),
    "tube": primitives.tube([(0, 0, 0), (0, 0, 1), (0, 1, 2)], 0.1),
    "prism": primitives.prism([(0, 0), (2, 0), (2, 2), (0, 2)], 1),
    "loft": primitives.loft([np.column_stack([primitives.ellipse(1, 2), np.full(24, z)]) for z in (0, 0.5, 1)]),
}


def as_trimesh(mesh: Mesh) -> trimesh.Trimesh:
    solid = trimesh.Trimesh(mesh.vertices, mesh.faces)
    solid.merge_vertices(merge_tex=True, merge_norm=True)
    return solid


@pytest.mark.parametrize("name", CLOSED)
def test_closed_shapes_are_watertight_and_face_outwards(name: str) -> None:
    solid = as_trimesh(CLOSED[name])
    assert solid.is_watertight
    assert solid.volume > 0


@pytest.mark.parametrize("name", CLOSED)
def test_normals_agree_with_the_winding(name: str) -> None:
    mesh = CLOSED[name]
    corners = mesh.vertices[mesh.faces]
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(face, axis=1)
    agreement = np.sum(face * mesh.normals[mesh.faces].mean(axis=1), axis=1)
    assert np.all(agreement[area > 1e-9] > 0)
    assert np.allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-6)


@pytest.mark.parametrize(
    ("mesh", "volume"),
    [
        (primitives.box((1, 2, 3)), 6.0),
        (primitives.cylinder(1, 2, sections=256), 2 * np.pi),
        (primitives.cylinder(2, 3, 1, sections=256), np.pi * 3 / 3 * (4 + 2 + 1)),
        (primitives.ellipsoid((2, 4, 6), sections=128, rings=64), 4 / 3 * np.pi * 1 * 2 * 3),
        (
            primitives.prism([(0, 0), (2, 0), (2, 2), (0, 2)], 1, [[(0.5, 0.5), (1.5, 0.5), (1.5, 1.5), (0.5, 1.5)]]),
            3.0,
        ),
    ],
)
def test_volumes_are_those_of_geometry_books(mesh: Mesh, volume: float) -> None:
    assert trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).volume == pytest.approx(volume, rel=2e-3)


@pytest.mark.slow
@given(SIZE, SIZE, SIZE, st.floats(0, 1), st.integers(1, 3))
def test_rounded_box_fills_its_box(w: float, d: float, h: float, radius: float, segments: int) -> None:
    mesh = primitives.rounded_box((w, d, h), radius * min(w, d, h), segments)
    assert np.allclose(mesh.vertices.max(axis=0) * 2, (w, d, h))
    assert np.allclose(mesh.vertices.min(axis=0) * 2, (-w, -d, -h))


@pytest.mark.parametrize("axis", ["x", "y", "z", "-x", "-y", "-z"])
def test_pointed_turns_z_to_the_axis(axis: primitives.Axis) -> None:
    tip = Mesh(np.array([[0.0, 0, 1]]), np.array([[0.0, 0, 1]]), np.zeros((0, 3), dtype=np.int64)).pointed(axis)
    assert np.allclose(tip.vertices[0], primitives.AXES[axis], atol=1e-12)


def test_turn_is_right_handed() -> None:
    assert np.allclose(primitives.turn("z", 90) @ [1, 0, 0], [0, 1, 0])
