"""Assets as glTF files (.glb), for viewers and other simulators; trimesh writes them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import trimesh

from remqa_data.assets import TYPES, Asset, AssetSpec, build, variant_count
from remqa_data.assets.core.model import Material, Surface
from remqa_data.assets.core.sizes import typical_size
from remqa_data.assets.looks.textures import texture
from remqa_data.files import atomic_path

Y_UP = trimesh.transformations.rotation_matrix(-np.pi / 2, (1, 0, 0))
"""glTF has y up and looks at the front from +z; assets have z up and their front at -y."""


def write_meshes(
    directory: Path, types: Sequence[str] = (), progress: Callable[[str], None] | None = None
) -> list[Path]:
    """Write each variant of some types, closed and in its typical size, as `Mug-0.glb`, `Mug-1.glb` and so on.

    Parameters
    ----------
    directory : Path
        Where the files go; made if missing.
    types : sequence of str
        Object types; all when empty.
    progress : callable, optional
        Called with each type before it is written.

    Raises
    ------
    UnknownNameError
        If a type is not known; nothing is written then.
    """
    counts = {type_: variant_count(type_) for type_ in types or TYPES}
    directory.mkdir(parents=True, exist_ok=True)
    written = []
    for type_, count in counts.items():
        if progress is not None:
            progress(type_)
        for variant in range(count):
            path = directory / f"{type_}-{variant}.glb"
            asset = build(AssetSpec(type_, typical_size(type_), variant, seed=variant))
            with atomic_path(path) as temporary:
                temporary.write_bytes(asset_scene(asset).export(file_type="glb"))
            written.append(path)
    return written


def asset_scene(asset: Asset, openness: float = 0.0) -> trimesh.Scene:
    """An asset as a trimesh scene in metres, y up: one node for each surface, named after its link.

    Textures become their mean colour; gloss and glow are kept.
    """
    scene = trimesh.Scene()
    for link, pose in zip(asset.links, asset.link_poses(openness), strict=True):
        for number, surface in enumerate(link.surfaces):
            scene.add_geometry(_mesh(surface), node_name=f"{link.name}/{number}", transform=Y_UP @ pose)
    return scene


def _mesh(surface: Surface) -> trimesh.Trimesh:
    visual = trimesh.visual.TextureVisuals(material=_material(surface.material))
    return trimesh.Trimesh(
        surface.vertices, surface.faces, vertex_normals=surface.normals, visual=visual, process=False
    )


def _material(material: Material) -> trimesh.visual.material.PBRMaterial:
    shown = np.ones(3) if material.texture is None else texture(material.texture).mean(axis=(0, 1)) / 255
    srgb = np.clip(shown * material.rgb, 0.0, 1.0)
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)  # as glTF wants it
    return trimesh.visual.material.PBRMaterial(
        name=f"{material.color} {material.substance}",
        baseColorFactor=[*linear.tolist(), 1.0],
        emissiveFactor=(material.glow * linear).tolist(),
        metallicFactor=0.0,
        roughnessFactor=1.0 - material.gloss,
    )
