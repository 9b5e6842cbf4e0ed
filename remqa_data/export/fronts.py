"""Which side of a face is its front: our rasteriser draws the back of what is no solid, too, and other programs do not."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from remqa_data.assets.core.model import Surface
from remqa_data.sim.render.scene_arrays import solid_faces


@lru_cache(maxsize=1 << 12)
def outward(surface: Surface) -> Surface:
    """A surface as it leaves for other programs, its fronts where they are to be seen; the same one where they are.

    Shapes are part of the data, so what is wound wrongly in them is mended here: a closed piece that is inside out is turned,
    faces and normals, and an open face that all its normals point away from is wound the other way.
    """
    is_solid = solid_faces(surface)
    if is_solid.all():
        return surface
    turned = surface.faces[:, ::-1]
    is_inside_out = ~is_solid & solid_faces(replace(surface, faces=turned))
    a, b, c = (surface.vertices[surface.faces[:, corner]].astype(np.float64) for corner in range(3))
    towards = np.einsum("fk,fck->fc", np.cross(b - a, c - a), surface.normals[surface.faces])
    is_against = ~is_solid & ~is_inside_out & (towards < 0).all(axis=1)
    normals = surface.normals.copy()
    normals[np.unique(surface.faces[is_inside_out])] *= -1
    faces = np.where((is_inside_out | is_against)[:, None], turned, surface.faces)
    return replace(surface, faces=faces, normals=normals)


def is_two_sided(surface: Surface) -> bool:
    """Whether any face of a surface, as an asset has it, is drawn from behind, too: it bounds no solid."""
    return not solid_faces(surface).all()
