"""From parts to the flat arrays that the kernels read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from remqa_data.assets.core.fitting import surface, with_uv
from remqa_data.assets.core.model import Material, Surface
from remqa_data.assets.looks.textures import repeats, texture
from remqa_data.assets.mesh import primitives
from remqa_data.geometry import arithmetic
from remqa_data.geometry.boxes import corners
from remqa_data.geometry.types import F64, I32, Flags
from remqa_data.scene import Scene, StructureBox, StructureKind
from remqa_data.sim.render.mipmap import CLAMPED, SIZE_BITS, levels
from remqa_data.sim.render.raster import Geometry
from remqa_data.sim.render.shade import Materials

_Number = TypeVar("_Number", bound=np.generic)

_WELD_M = 1e-6


@dataclass(frozen=True)
class RenderPart:
    """One rigid link of one object; its geometry is given in its own frame.

    Attributes
    ----------
    surfaces : tuple of Surface
        What is drawn.
    instance : int
        The id that its pixels get; parts may share one.
    """

    surfaces: tuple[Surface, ...]
    instance: int


def build_geometry(parts: Sequence[RenderPart]) -> Geometry:
    """Join the meshes of all parts."""
    surfaces = [surface for part in parts for surface in part.surfaces]
    vertex_start = _offsets([len(surface.vertices) for surface in surfaces])
    faces = _join([s.faces + start for s, start in zip(surfaces, vertex_start, strict=False)], (0, 3), np.int32)
    vertices = _join([surface.vertices for surface in surfaces], (0, 3), np.float32)
    return Geometry(
        vertices=np.ascontiguousarray(vertices.T),
        normals=_join([surface.normals for surface in surfaces], (0, 3), np.float32),
        uv=_join([surface.uv for surface in surfaces], (0, 2), np.float32),
        faces=faces,
        face_surface=np.repeat(np.arange(len(surfaces)), [len(s.faces) for s in surfaces]).astype(np.int32),
        face_of_solid=_join([solid_faces(surface) for surface in surfaces], (0,), np.bool_),
        surface_start=_offsets([len(surface.faces) for surface in surfaces]),
        part_vertex_start=_offsets([sum(len(s.vertices) for s in part.surfaces) for part in parts]),
        part_surface_start=_offsets([len(part.surfaces) for part in parts]),
        part_corners=np.stack([_corners(tuple(part.surfaces)) for part in parts]) if parts else np.empty((0, 8, 3)),
    )


def build_materials(parts: Sequence[RenderPart]) -> tuple[Materials, I32]:
    """Materials of all surfaces, and the texels of the textures they name, which get the numbers 1, 2, ..."""
    return materials_and_texels([surface.material for part in parts for surface in part.surfaces])


def materials_and_texels(materials: Sequence[Material]) -> tuple[Materials, I32]:
    """The same for a list of materials, one for each surface."""
    names = sorted({material.texture for material in materials if material.texture is not None})
    number = {name: i + 1 if repeats(name) else i + 1 + CLAMPED for i, name in enumerate(names)}
    return (
        Materials(
            albedo=_join([np.array([m.rgb]) ** 2 for m in materials], (0, 3), np.float32),
            texture=np.array([number[m.texture] if m.texture else 0 for m in materials], dtype=np.int32),
            gloss=np.array([m.gloss for m in materials], dtype=np.float32),
            glow=np.array([m.glow for m in materials], dtype=np.float32),
            mirror=np.array([m.mirror for m in materials], dtype=np.float32),
        ),
        np.concatenate([_texels(name) for name in (None, *names)]),
    )


@lru_cache(maxsize=64)  # half a megabyte each; a room has about 13
def _texels(name: str | None) -> I32:
    """All levels of a texture; plain white for surfaces without one."""
    white = np.full((1 << SIZE_BITS, 1 << SIZE_BITS, 3), 255, dtype=np.uint8)
    return levels(white if name is None else texture(name))


def surface_instances(parts: Sequence[RenderPart]) -> I32:
    """Instance id of each surface."""
    return np.array([part.instance for part in parts for _ in part.surfaces], dtype=np.int32)


@lru_cache(maxsize=1 << 12)  # a room has some 300 surfaces and is loaded many times
def solid_faces(surface: Surface) -> Flags:
    """(m,) whether each face bounds a solid, so that its back can never be seen from outside.

    A connected piece of the mesh bounds a solid when every edge, after welding equal points, is used as often in one
    direction as in the other, and the enclosed volume is positive.
    """
    points, faces = _weld(surface)
    if len(faces) == 0:
        return np.zeros(0, dtype=np.bool_)
    piece = _pieces(faces, len(points))
    starts, ends = faces[:, [0, 1, 2]].ravel(), faces[:, [1, 2, 0]].ravel()
    # Each edge adds +1 from its lower to its higher point and -1 the other way: balanced edges sum to zero.
    edge = np.minimum(starts, ends) * len(points) + np.maximum(starts, ends)
    edges, edge_index = np.unique(edge, return_inverse=True)
    balance = np.bincount(edge_index, weights=np.sign(ends - starts), minlength=len(edges))
    is_open = np.bincount(np.repeat(piece, 3), weights=balance[edge_index] != 0, minlength=len(points)) > 0
    a, b, c = (points[faces[:, corner]] - points.mean(axis=0) for corner in range(3))
    volume = np.bincount(piece, weights=arithmetic.dot(a, arithmetic.cross(b, c)), minlength=len(points))
    solid: Flags = (~is_open & (volume > 0))[piece]
    return solid


def structure_surfaces(scene: Scene) -> list[tuple[Surface, ...]]:
    """Surfaces of the building in groups that are culled together."""
    return [(surface,) for _, surface in structure_groups(scene)]


def structure_groups(scene: Scene) -> list[tuple[StructureKind, Surface]]:
    """Each wall panel of the building, the rest by kind and finish."""
    groups: dict[tuple[object, ...], list[StructureBox]] = {}
    for index, part in enumerate(scene.structure):
        key = (part.kind, index) if part.kind in ("wall", "outside", "ceiling") else (part.kind, part.finish)
        groups.setdefault(key, []).append(part)
    return [(parts[0].kind, _boxes(tuple(parts))) for parts in groups.values()]


@lru_cache(maxsize=1 << 10)
def _boxes(parts: tuple[StructureBox, ...]) -> Surface:
    material: Material = parts[0].finish
    meshes = []
    for part in parts:
        low, high = np.asarray(part.box[:3]), np.asarray(part.box[3:])
        mesh = primitives.box(tuple(high - low)).moved((low + high) / 2)
        meshes.append(with_uv(mesh, material, None))
    return surface(primitives.joined(meshes), material)


def _weld(surface: Surface) -> tuple[F64, npt.NDArray[np.int64]]:
    """Points without doubles, and the faces that index them."""
    grid = np.round(surface.vertices.astype(np.float64) / _WELD_M).astype(np.int64)
    order = np.lexsort(grid.T)
    is_new = np.concatenate([[False], (np.diff(grid[order], axis=0) != 0).any(axis=1)])
    index = np.empty(len(grid), dtype=np.int64)
    index[order] = np.cumsum(is_new)
    points = np.empty((int(index.max(initial=-1)) + 1, 3))
    points[index] = surface.vertices
    return points, index[surface.faces]


def _pieces(faces: npt.NDArray[np.int64], points: int) -> npt.NDArray[np.int64]:
    """Label of the connected piece that each face belongs to: the least index of its points."""
    label = np.arange(points)
    while True:
        least = label[faces].min(axis=1)
        lowered = label.copy()
        np.minimum.at(lowered, faces.ravel(), np.repeat(least, 3))
        lowered = lowered[lowered]
        if np.array_equal(lowered, label):
            return label[faces[:, 0]]
        label = lowered


@lru_cache(maxsize=1 << 12)
def _corners(surfaces: tuple[Surface, ...]) -> F64:
    """(8, 3) corners of the box around a part's surfaces; a part without vertices is a point at its origin."""
    points = [s.vertices.astype(np.float64) for s in surfaces if len(s.vertices)]
    stacked = np.vstack(points) if points else np.zeros((1, 3))
    return corners([stacked.min(axis=0), stacked.max(axis=0)])


def _offsets(lengths: Sequence[int]) -> I32:
    """Start of each range, and the end of the last."""
    return np.concatenate([[0], np.cumsum(lengths)]).astype(np.int32)


def _join(arrays: Sequence[npt.ArrayLike], empty: tuple[int, ...], dtype: type[_Number]) -> npt.NDArray[_Number]:
    """Stack arrays; one of shape `empty` where there are none."""
    return np.concatenate([np.asarray(array) for array in arrays] or [np.empty(empty)]).astype(dtype, copy=False)
