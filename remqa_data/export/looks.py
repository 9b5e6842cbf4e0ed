"""How surfaces look elsewhere: textures as PNG, materials and meshes as glTF wants them."""

from __future__ import annotations

from functools import cache
from typing import BinaryIO

import numpy as np
import trimesh

from remqa_data.assets.core.model import Material, Surface
from remqa_data.assets.looks.textures import texture
from remqa_data.export.fronts import is_two_sided, outward
from remqa_data.geometry.types import F32, F64, U8
from remqa_data.opencv import cv2

_ZERO = np.zeros(3)


@cache
def texture_png(name: str) -> bytes:
    """A texture as a whole PNG file, 256 x 256."""
    return bytes(cv2.imencode(".png", texture(name)[..., ::-1])[1])


def upward_uv(surface: Surface) -> F32:
    """(n, 2) texture coordinates whose v points up, as OBJ and trimesh count; ours is 0 at the top of the picture."""
    return np.column_stack([surface.uv[:, 0], 1.0 - surface.uv[:, 1]]).astype(np.float32)


def gltf_mesh(surface: Surface, origin: F64 = _ZERO) -> trimesh.Trimesh:
    """A surface with its texture, its points counted from a (3,) point."""
    material = _gltf_material(surface.material, is_two_sided(surface))
    surface = outward(surface)
    return trimesh.Trimesh(
        surface.vertices - origin,
        surface.faces,
        vertex_normals=surface.normals,
        visual=trimesh.visual.TextureVisuals(uv=upward_uv(surface), material=material),
        process=False,
    )


@cache
def _gltf_material(material: Material, is_two_sided: bool) -> trimesh.visual.material.PBRMaterial:
    srgb = np.clip(material.rgb, 0.0, 1.0)
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)  # as glTF wants it
    picture = None if material.texture is None else _Png(texture_png(material.texture))
    return trimesh.visual.material.PBRMaterial(
        name=f"{material.color} {material.substance}",
        baseColorFactor=[*linear.tolist(), 1.0],
        baseColorTexture=picture,
        emissiveFactor=(material.glow * linear).tolist(),
        emissiveTexture=picture if material.glow else None,
        metallicFactor=0.0,
        roughnessFactor=1.0 - material.gloss,
        doubleSided=is_two_sided,
    )


class _Png:
    """A picture that is a PNG already, as trimesh's exporter takes one of Pillow's, which we do not need otherwise."""

    format = "PNG"

    def __init__(self, data: bytes) -> None:
        self._data = data

    def __array__(self, dtype: object = None, copy: object = None) -> U8:
        """By this trimesh tells materials apart."""
        return np.frombuffer(self._data, dtype=np.uint8)

    def save(self, file: BinaryIO, format: str) -> None:
        """Write the picture; it is asked for as PNG."""
        file.write(self._data)
