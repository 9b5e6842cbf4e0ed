"""Assets as glTF files (.glb), for viewers and other simulators; trimesh writes them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import trimesh

from remqa_data.assets import TYPES, Asset, AssetSpec, build, variant_count
from remqa_data.assets.core.sizes import typical_size
from remqa_data.export.glb import Y_UP, add_asset, glb_bytes
from remqa_data.files import atomic_path


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
                temporary.write_bytes(glb_bytes(asset_scene(asset)))
            written.append(path)
    return written


def asset_scene(asset: Asset, openness: float = 0.0) -> trimesh.Scene:
    """An asset as a trimesh scene in metres, y up: a node for each link and, below it, for each surface, `LINK/NUMBER`."""
    scene = trimesh.Scene()
    scene.graph.update(asset.spec.type, matrix=Y_UP)
    add_asset(scene, asset, openness, asset.spec.type, prefix="")
    return scene
