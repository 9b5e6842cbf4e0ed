"""What a room must be besides its types, so that whatever keeps `remqa_data.limits` is built in bounded time and memory."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from remqa_data import limits
from remqa_data.assets.core.model import AssetSpec, Material
from remqa_data.assets.looks.textures import TEXTURE_NAMES

if TYPE_CHECKING:
    from remqa_data.scene import Scene, SceneObject, StructureBox


def scene_problem(scene: Scene) -> str | None:
    """The first thing that must not be, with its place, or None."""
    return next(_scene_problems(scene), None)


def _scene_problems(scene: Scene) -> Iterator[str]:
    yield from _room(scene)
    for place, light in enumerate(scene.lights):
        yield from _near(f"lights.{place}", scene, light)
    for place, part in enumerate(scene.structure):
        yield from _structure_box(f"structure.{place}", scene, part)
    seen: set[str] = set()
    for place, thing in enumerate(scene.objects):
        if thing.id in seen:
            yield f"objects: id {thing.id!r} occurs twice"
        seen.add(thing.id)
        yield from _object(f"objects.{place}", scene, thing)
    sides = sum(max(thing.asset.size) for thing in scene.objects)
    yield from _within("objects: their longest sides together", [sides], 0.0, limits.MOST_ASSETS_M, " m")


def _room(scene: Scene) -> Iterator[str]:
    for field, items, most in (
        ("lights", scene.lights, limits.MOST_LIGHTS),
        ("structure", scene.structure, limits.MOST_STRUCTURE_BOXES),
        ("objects", scene.objects, limits.MOST_OBJECTS),
    ):
        if len(items) > most:
            yield f"{field}: there are {len(items):,}; at most {most:,} are read"
    yield from _text("name", scene.name)
    x0, y0, x1, y1 = scene.bounds
    yield from _within("bounds", (*scene.bounds, scene.floor_z), -limits.MOST_FAR_M, limits.MOST_FAR_M, " m")
    yield from _within("bounds: the sides of the room", (x1 - x0, y1 - y0), 0.1, limits.MOST_ROOM_M, " m")
    yield from _within("height", [scene.height], 0.1, limits.MOST_ROOM_HEIGHT_M, " m")


def _structure_box(where: str, scene: Scene, part: StructureBox) -> Iterator[str]:
    for corner in (part.box[:3], part.box[3:]):
        yield from _near(f"{where}.box", scene, corner)
    yield from _within(f"{where}.box: its sides", [part.box[i + 3] - part.box[i] for i in range(3)], 0.0, 1e3, " m")
    yield from _material(f"{where}.finish", part.finish)


def _material(where: str, finish: Material) -> Iterator[str]:
    yield from _within(f"{where}: rgb, gloss or glow", (*finish.rgb, finish.gloss, finish.glow), 0.0, 1.0)
    if finish.repeat_m is not None:
        yield from _within(f"{where}.repeat_m", [finish.repeat_m], 1e-3, limits.MOST_FAR_M, " m")
    if finish.texture is not None and finish.texture not in TEXTURE_NAMES:
        yield f"{where}.texture: there is no texture {finish.texture[:80]!r}"


def _object(where: str, scene: Scene, thing: SceneObject) -> Iterator[str]:
    yield from _text(f"{where}.id", thing.id)
    yield from _near(f"{where}.position", scene, thing.position)
    length = sum(number * number for number in thing.quaternion)
    yield from _within(f"{where}.quaternion: its length", [length], 0.99, 1.01)
    yield from _within(f"{where}.openness", [thing.openness], 0.0, 1.0)
    if len(thing.parents) > limits.MOST_ASSET_PARTS:
        yield f"{where}.parents: there are {len(thing.parents):,}; at most {limits.MOST_ASSET_PARTS} are read"
    yield from _asset(f"{where}.asset", thing.asset)


def _asset(where: str, asset: AssetSpec) -> Iterator[str]:
    yield from _within(f"{where}.size", asset.size, limits.LEAST_ASSET_M, limits.MOST_ASSET_M, " m")
    yield from _within(f"{where}.seed", [asset.seed], 0, limits.MOST_SEED)
    parts = len(asset.levels) + len(asset.pockets) + len(asset.footprint)
    if parts > limits.MOST_ASSET_PARTS:
        yield f"{where}: levels, pockets and footprint are {parts:,} together; at most {limits.MOST_ASSET_PARTS} are read"
    for field, numbers in (
        ("levels", asset.levels),
        ("pockets", [number for box in asset.pockets for number in box]),
        ("footprint", [number for rect in asset.footprint for number in rect]),
    ):
        yield from _within(f"{where}.{field}", numbers, -limits.MOST_ASSET_M, limits.MOST_ASSET_M, " m")


def _near(where: str, scene: Scene, point: Iterable[float]) -> Iterator[str]:
    """A point must lie in the room or not far from it."""
    x0, y0, x1, y1 = scene.bounds
    lows, highs = (x0, y0, scene.floor_z), (x1, y1, scene.floor_z + scene.height)
    far = limits.MOST_OUTSIDE_M
    for low, number, high in zip(lows, point, highs, strict=True):
        yield from _within(where, [number], low - far, high + far, " m")


def _text(where: str, text: str) -> Iterator[str]:
    if len(text) > limits.MOST_TEXT_BYTES:
        yield f"{where}: {len(text):,} characters; at most {limits.MOST_TEXT_BYTES:,} are read"


def _within(where: str, numbers: Iterable[float], low: float, high: float, unit: str = "") -> Iterator[str]:
    for number in numbers:
        if not low <= number <= high:  # so it is for nan, too
            yield f"{where}: {number:g}; expected {low:g} to {high:g}{unit}"
            return
