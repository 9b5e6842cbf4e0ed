"""Contact sheets: every variant of an object type, closed and open, so that a person can judge it.

`python -m remqa_data.generators.figures.asset_sheets DIR [TYPE ...]` writes one PNG for each type.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from remqa_data.assets import TYPES, Asset, AssetSpec, build, variant_count
from remqa_data.assets.core.sizes import typical_size
from remqa_data.geometry.types import U8, Vec3
from remqa_data.opencv import cv2, write_png

TILE_PX, BAND_PX, GROUND = 240, 28, 250
FRONT_YAW_DEG, DOWN_DEG, FOV_DEG = 62.0, 24.0, 30.0
"""Seen from the front, a little from the left and from above."""


def write_sheets(
    directory: Path,
    types: Sequence[str] = (),
    columns: int = 4,
    progress: Callable[[str], None] | None = None,
) -> list[Path]:
    """Write one contact sheet for each type.

    Parameters
    ----------
    directory : Path
        Where the PNG files go; made if missing.
    types : sequence of str
        Object types; all when empty.
    columns : int
        Variants side by side, the rest below; columns beyond their number repeat them with other seeds.
    progress : callable, optional
        Called with each type before it is drawn.

    Raises
    ------
    UnknownNameError
        If a type is not known; nothing is written then.
    """
    for type_ in types:
        variant_count(type_)
    directory.mkdir(parents=True, exist_ok=True)
    written = []
    for type_ in types or TYPES:
        if progress is not None:
            progress(type_)
        path = directory / f"{type_}.png"
        write_png(path, sheet(type_, columns))
        written.append(path)
    return written


def sheet(type_: str, columns: int = 4) -> U8:
    """The contact sheet of one type: variants side by side, below each other closed and (if it opens) half open and open."""
    count = variant_count(type_)
    size = typical_size(type_)
    assets = [build(AssetSpec(type_, _varied(size, i, type_), i % count, seed=i)) for i in range(max(columns, count))]
    lines = [_line(assets[first : first + columns], columns) for first in range(0, len(assets), columns)]
    title = _band(columns)
    _write(title, f"{type_}  {size[0]:.2f} x {size[1]:.2f} x {size[2]:.2f} m", 0)
    return np.vstack([title, *lines])


def _line(assets: Sequence[Asset], columns: int) -> U8:
    """Assets beside each other, in words and in pictures; where there are fewer than columns, the rest is white."""
    words = _band(columns)
    for column, asset in enumerate(assets):
        _write(words, f"{asset.color} {asset.substance} {asset.triangle_count}t", column)
    blank = [np.full((TILE_PX, TILE_PX, 3), GROUND, np.uint8)] * (columns - len(assets))
    rows = [[picture(asset, openness) for asset in assets] + blank for openness in _opennesses(assets[0])]
    return np.vstack([words, *map(np.hstack, rows)])


def _band(columns: int) -> U8:
    return np.full((BAND_PX, columns * TILE_PX, 3), 255, np.uint8)


def _write(band: U8, text: str, column: int) -> None:
    place = (column * TILE_PX + 6, 19)
    cv2.putText(band, text, place, cv2.FONT_HERSHEY_SIMPLEX, 0.42, (20, 20, 20), 1, cv2.LINE_AA)


def picture(asset: Asset, openness: float = 0.0, size_px: int = TILE_PX) -> U8:
    """One picture of an asset on a white ground, (size_px, size_px, 3) RGB."""
    from remqa_data.sim.render.camera import Camera
    from remqa_data.sim.render.renderer import Renderer, RenderPart

    closed, opened = asset.bounds(), asset.bounds(1.0)  # one frame for all openings, so that what moves is seen to move
    low, high = np.minimum(closed[0], opened[0]), np.maximum(closed[1], opened[1])
    centre, radius = (low + high) / 2, float(np.linalg.norm(high - low)) / 2
    yaw, pitch = np.radians(FRONT_YAW_DEG), np.radians(DOWN_DEG)
    away = np.array([-np.cos(yaw) * np.cos(pitch), -np.sin(yaw) * np.cos(pitch), np.sin(pitch)])
    # The renderer's near plane and shadow offsets are meant for rooms, so small things are shown enlarged.
    scale = 0.5 / radius
    eye = away * (1.04 * radius / np.tan(np.radians(FOV_DEG / 2))) * scale
    poses = asset.link_poses(openness)
    poses[:, :3, 3] = (poses[:, :3, 3] - centre) * scale
    parts = [
        RenderPart(tuple(replace(s, vertices=s.vertices * np.float32(scale)) for s in link.surfaces), i)
        for i, link in enumerate(asset.links)
    ]
    camera = Camera.look_at(tuple(eye), (0.0, 0.0, 0.0), fov_deg=FOV_DEG, width=size_px, height=size_px)
    light = tuple(eye * 0.8 + np.array([-0.5, 0.0, 1.1]))
    frame = Renderer(parts, poses, lights=[light]).render(camera)
    rgb = frame.rgb.copy()
    rgb[frame.instances < 0] = GROUND
    return rgb


def _opennesses(asset: Asset) -> tuple[float, ...]:
    return (0.0, 0.5, 1.0) if asset.is_openable else (0.0,)


def _varied(size: Vec3, column: int, type_: str) -> Vec3:
    """A little different in size from column to column, as in real rooms."""
    rng = np.random.default_rng([*map(ord, type_), column])
    factors = rng.uniform(0.9, 1.1, 3)
    return (size[0] * factors[0], size[1] * factors[1], size[2] * factors[2])


if __name__ == "__main__":
    for sheet_path in write_sheets(Path(sys.argv[1]), sys.argv[2:]):
        print(sheet_path)
