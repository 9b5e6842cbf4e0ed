"""Checksums of what a processor could change, one line each: `python -m tests.helpers.fingerprints meshes rooms`.

With `--shaken` all sines, powers and the like are wrong in the last digit at random, as on a processor for which numpy or
the C library has other ones; so this machine can stand for processors that it does not have.
"""

import hashlib
import math
import random
import sys
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

NUMPY = "sin cos tan arctan arctan2 arcsin arccos exp log power hypot cbrt tanh"
LIBRARY = "sin cos tan atan atan2 asin acos exp log pow"


def main() -> None:
    """Print the lines that are asked for."""
    wanted = sys.argv[1:]
    if "--shaken" in wanted:
        shake()
    for kind, find in {"textures": textures, "meshes": meshes, "rooms": rooms, "frames": frames}.items():
        if kind in wanted:
            for name, parts in find():
                digest = hashlib.sha256(b"".join(parts)).hexdigest()
                print(kind, name, digest[:16], sep="\t")


def shake() -> None:
    """Make numpy's and the C library's functions wrong in the last digit, one time in two."""
    noise, coin = np.random.default_rng(0), random.Random(0)

    def shaken_array(function: Callable[..., Any]) -> Callable[..., Any]:
        def wrong(*arguments: Any, **options: Any) -> Any:
            right = np.asarray(function(*arguments, **options))
            towards = noise.choice(np.array([-np.inf, np.inf]), right.shape).astype(right.dtype)
            is_right = (right == 0) | (np.abs(right) == 1) | (noise.random(right.shape) < 0.5)
            return np.where(is_right, right, np.nextafter(right, towards)).astype(right.dtype)[()]

        return wrong

    def shaken_number(function: Callable[..., float]) -> Callable[..., float]:
        def wrong(*arguments: float) -> float:
            right = function(*arguments)
            is_right = right in (-1.0, 0.0, 1.0) or coin.random() < 0.5
            return right if is_right else math.nextafter(right, coin.choice([-math.inf, math.inf]))

        return wrong

    for name in NUMPY.split():
        setattr(np, name, shaken_array(getattr(np, name)))
    for name in LIBRARY.split():
        setattr(math, name, shaken_number(getattr(math, name)))


def textures() -> Iterator[tuple[str, list[bytes]]]:
    """Pixels of all textures."""
    from remqa_data.assets.looks.textures import TEXTURE_NAMES, texture

    for name in TEXTURE_NAMES:
        yield name, [texture(name).tobytes()]


def meshes() -> Iterator[tuple[str, list[bytes]]]:
    """All types of objects in all variants: meshes, collision boxes, joints, spaces and words."""
    from remqa_data.assets import TYPES, AssetSpec, build, variant_count
    from remqa_data.assets.core.sizes import typical_size

    for type_ in TYPES:
        for variant in range(variant_count(type_)):
            asset = build(AssetSpec(type_, typical_size(type_), variant, seed=variant))
            rest = [(link.name, link.parent, link.joint, link.boxes) for link in asset.links]
            parts = [repr((rest, asset.spaces, asset.color, asset.substance)).encode()]
            for surface in (surface for link in asset.links for surface in link.surfaces):
                arrays = (surface.vertices, surface.normals, surface.uv, surface.faces)
                parts += [repr(surface.material).encode(), *(array.tobytes() for array in arrays)]
            yield f"{type_} {variant}", parts


def rooms() -> Iterator[tuple[str, list[bytes]]]:
    """Rooms as planned, and as they are when loose things have come to rest and everything has been opened."""
    from remqa_data.floorplans.load import load_scene
    from remqa_data.sim.physics.world import World

    for name in ("FloorPlan4", "FloorPlan212", "FloorPlan308", "FloorPlan427"):
        yield f"{name} planned", [load_scene(name).to_json()]
        with World(load_scene(name)) as world:
            world.settle()
            yield f"{name} settled", [world.to_scene().to_json()]
            for object_id in world.ids:
                if world.assets[object_id].is_openable:
                    world.open(object_id, 0.7)
            world.settle()
            yield f"{name} opened", [world.to_scene().to_json(), *(world.box(i).tobytes() for i in world.ids)]


def frames() -> Iterator[tuple[str, list[bytes]]]:
    """What is seen in two rooms, with doors and drawers open."""
    from remqa_data.floorplans.load import load_scene
    from remqa_data.sim.navigation.grid import reachable_grid
    from remqa_data.sim.navigation.viewpoints import AgentPose
    from remqa_data.sim.physics.world import World
    from remqa_data.sim.render.view import WorldView

    for name in ("FloorPlan4", "FloorPlan427"):
        with World(load_scene(name)) as world:
            grid, view = reachable_grid(world), WorldView(world)
            for object_id in world.ids:
                if world.assets[object_id].is_openable:
                    world.open(object_id, 0.7)
            for i, cell in enumerate(grid.cells[:: len(grid.cells) // 8]):
                seen = view.render(AgentPose(cell, 90 * i % 360, 30 * (i % 2)).camera(grid))
                yield f"{name} {cell}", [seen.rgb.tobytes(), seen.depth.tobytes(), seen.objects.tobytes()]


if __name__ == "__main__":
    main()
