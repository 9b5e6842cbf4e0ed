"""What one sees of the conditions that objects are in: stains, cracks, liquids, flames, water that runs, what glows.

Only pictures, depth and masks know of it; physics does not. What is painted over has texture coordinates of its own, as what
was built of a plain material has none.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from remqa_data.assets.core.fitting import surface, with_uv
from remqa_data.assets.core.model import Asset, Material, Surface
from remqa_data.assets.looks import materials
from remqa_data.assets.looks.textures import repeats, texture
from remqa_data.assets.mesh import primitives
from remqa_data.catalog import object_type, types_with
from remqa_data.geometry import arithmetic
from remqa_data.geometry.rotations import rotation_of
from remqa_data.geometry.types import F64, Vec3
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.view import Shapes
from remqa_data.thor.object_states.conditions import FILLED, Conditions

STAINS_M = 0.25
"""Metres that one repeat of the stains covers."""
BRITTLE = frozenset({"ceramic", "glass"})
"""If some of an object is of these, it is what breaks."""
DUST, DUSTED = (0.60, 0.52, 0.42), 0.3
"""What is dirty takes on this colour by so much."""
BROWNED = (0.55, 0.36, 0.22)
"""What is cooked has so much of its red, green and blue."""
LIQUIDS = {
    "water": Material("liquid", "blue", (0.62, 0.80, 0.90), gloss=0.9),
    "coffee": Material("liquid", "brown", (0.20, 0.11, 0.06), gloss=0.7),
    "wine": Material("liquid", "red", (0.40, 0.04, 0.10), gloss=0.8),
}
FULL = 0.75
"""A vessel is filled to this share of its depth."""
IN_BOTTLE = 0.6
"""Glass of what is filled has so much of the liquid's colour."""
SOAKED = 0.5
"""What light wet soil still throws back."""
HOT = Material("metal", "orange", (1.0, 0.36, 0.08), glow=1.0)
GAS = Material("fire", "blue", (0.30, 0.50, 1.0), glow=1.0)
FLAME = Material("fire", "yellow", (1.0, 0.82, 0.38), glow=1.0)
SCREEN = Material("glass", "blue", (0.62, 0.78, 1.0), glow=0.9)
INSIDE = Material("glass", "yellow", (1.0, 0.84, 0.50), glow=0.9)
"""A burner, a flame, a screen and the window of a microwave that are on."""
STREAM_M, JET_M, JETS, APART_M = 0.006, 0.0015, 6, 0.03
"""Radius of the water that runs from a faucet, and of a shower head's jets: one, and others around it so far away."""
THIN_M = 0.001
DIRECTIONS = 32
"""The edge of a liquid has so many corners."""
GAS_FLAMES = 16
FLAT_M = 0.012
"""What is so low is a place on a glass hob."""
FLAME_M = (0.010, 0.035)
"""How wide and high a flame is."""

Paint = Callable[[Material], Material]


def shapes_of(world: World, conditions: Conditions) -> Shapes:
    """What is drawn otherwise than it was built, because of the condition that it is in."""
    found: dict[str, Sequence[tuple[Surface, ...]]] = {}
    shown = {name: {"isToggled": False} for name in world.ids if _is_built_lit(world.assets[name], world.type_of(name))}
    for object_id, values in conditions.shown().items():
        shown[object_id] = {**shown.get(object_id, {}), **values}
    for object_id, values in shown.items():
        asset, type_ = world.assets[object_id], world.type_of(object_id)
        first, *others = _painted(asset, type_, tuple(sorted(values.items())))
        found[object_id] = [(*first, *_added(world, object_id, values)), *others]
    return found


@lru_cache(maxsize=1024)
def _is_built_lit(asset: Asset, type_: str) -> bool:
    """Whether something glows as it is built that can be switched, and is off, therefore, until it is switched on."""
    return object_type(type_).toggleable and any(one.material.glow for link in asset.links for one in link.surfaces)


@lru_cache(maxsize=256)
def _painted(asset: Asset, type_: str, values: tuple[tuple[str, Any], ...]) -> list[tuple[Surface, ...]]:
    """The links' surfaces as they are now; an asset in the same conditions gives the same, which a renderer knows."""
    paints = paints_of(asset, type_, dict(values))
    return [tuple(_repainted(one, paints) for one in link.surfaces) for link in asset.links]


def paints_of(asset: Asset, type_: str, values: Mapping[str, Any]) -> list[Paint]:
    """What is done, one after the other, to the materials of an object of a type in some conditions."""
    paints: list[Paint] = []
    if values.get("isCooked"):
        paints.append(_browned)
    if values.get(FILLED):
        liquid = LIQUIDS[str(values.get("fillLiquid") or "water")]
        paints.append(lambda material: _holding(material, type_, liquid))
    if "isToggled" in values:
        is_on = bool(values["isToggled"])
        if not (is_on and _burns_gas(asset)):
            paints.append(lambda material: _switched(material, type_, is_on))
    if values.get("isBroken"):
        brittle = {one.material.substance for link in asset.links for one in link.surfaces} & BRITTLE
        paints.append(lambda material: _cracked(material, max(asset.spec.size), brittle))
    if values.get("isDirty"):
        paints.append(_soiled)
    return paints


def _browned(own: Material) -> Material:
    return replace(own, rgb=_product(own.rgb, BROWNED), gloss=own.gloss / 2)


def _soiled(own: Material) -> Material:
    return replace(
        own,
        rgb=_mixed(_mean_rgb(own), DUST, DUSTED),
        texture="cracked" if own.texture == "cracked" else "soiled",
        repeat_m=own.repeat_m if own.texture == "cracked" else STAINS_M,
        gloss=own.gloss / 4,
        mirror=own.mirror / 2,
    )


def _cracked(own: Material, size_m: float, brittle: Collection[str]) -> Material:
    if brittle and own.substance not in brittle:
        return own
    return replace(
        own,
        rgb=_mean_rgb(own),
        texture="cracked",
        repeat_m=size_m,
        gloss=own.gloss / 2,
        glow=own.glow / 4,
        mirror=own.mirror / 2,
    )


def _mean_rgb(own: Material) -> Vec3:
    """The colour that a picture has on average, where another texture is to come in its place."""
    if own.texture is None or repeats(own.texture):
        return own.rgb
    r, g, b = (texture(own.texture).mean(axis=(0, 1)) / 255).tolist()
    return _product(own.rgb, (r, g, b))


def _holding(own: Material, type_: str, liquid: Material) -> Material:
    """Bottles are seen through, and the soil of a plant is wet; of other vessels one sees the liquid itself."""
    if type_ in ("Bottle", "WineBottle") and own.substance == "glass":
        return replace(own, rgb=_mixed(own.rgb, liquid.rgb, IN_BOTTLE))
    if type_ == "HousePlant" and own == materials.SOIL:
        return replace(own, rgb=_product(own.rgb, (SOAKED,) * 3), gloss=0.3)
    return own


def _switched(own: Material, type_: str, is_on: bool) -> Material:
    """What glows goes out, what is dark glass lights up, and a burner without gas glows all over."""
    if not is_on:
        return materials.DARK_GLASS if own.glow and own.substance == "glass" and own.texture else replace(own, glow=0.0)
    if type_ in types_with("burner"):
        return replace(HOT, gloss=own.gloss) if own.substance in ("metal", "glass") else own
    if type_ == "Toaster" and own == materials.SHADOW_GAP:
        return HOT
    if own.substance == "glass" and own.color == "black" and not own.glow:
        return INSIDE if type_ == "Microwave" else SCREEN
    return replace(own, glow=max(own.glow, 0.9)) if own.glow else own


def _repainted(own: Surface, paints: Sequence[Paint]) -> Surface:
    material = own.material
    for paint in paints:
        material = paint(material)
    if material == own.material:
        return own
    if material.texture == own.material.texture or material.repeat_m is None:
        return replace(own, material=material)
    mesh = primitives.Mesh(
        own.vertices.astype(np.float64),
        own.normals.astype(np.float64),
        own.faces.astype(np.int64),
        own.uv.astype(np.float64),
    )
    return surface(with_uv(mesh, material, None), material)


# ---- what is added


def _added(world: World, object_id: str, values: Mapping[str, Any]) -> tuple[Surface, ...]:
    """Liquid, flame and running water, in the asset's frame."""
    asset, type_ = world.assets[object_id], world.type_of(object_id)
    added: tuple[Surface | None, ...] = ()
    if values.get(FILLED):
        added += (liquid_in(asset, str(values.get("fillLiquid") or "water")),)
    if values.get("isToggled") and type_ in types_with("burns_with_flame"):
        added += (_flame_on(asset),)
    if values.get("isToggled") and _burns_gas(asset):
        added += (_gas_flames(asset),)
    if values.get("isToggled") and type_ in types_with("runs_water"):
        added += (_water_from(world, object_id),)
    return tuple(one for one in added if one is not None)


@lru_cache(maxsize=256)
def liquid_in(asset: Asset, liquid: str) -> Surface | None:
    """The surface of a liquid in an open vessel; None where none would be seen.

    It fills what a horizontal cut through the vessel leaves free around the middle of the space that things lie in.
    """
    if not asset.spaces or asset.spaces[0].enclosed:
        return None
    x0, y0, low, x1, y1, _ = asset.spaces[0].box
    middle = np.array([(x0 + x1) / 2, (y0 + y1) / 2])
    level = low + FULL * (float(asset.bounds()[1, 2]) - low)
    rim = _inner_outline(asset, middle, level)
    if rim is None:
        return None
    outline = [(float(x), float(y)) for x, y in rim]
    return _at(primitives.prism(outline, THIN_M), (0.0, 0.0, level), LIQUIDS[liquid])


def _inner_outline(asset: Asset, middle: F64, level: float) -> F64 | None:
    """(DIRECTIONS, 2) where rays from a point in plan first meet the base link at a height; None if one meets nothing."""
    surfaces = asset.links[0].surfaces
    triangles = np.concatenate([one.vertices[one.faces] for one in surfaces], dtype=np.float64)
    is_above = triangles[..., 2] > level
    count = is_above.sum(1)
    cut, is_above = triangles[(count == 1) | (count == 2)], is_above[(count == 1) | (count == 2)]
    alone = np.where(is_above.sum(1) == 1, is_above.argmax(1), is_above.argmin(1))
    rows = np.arange(len(cut))
    tip, ends = cut[rows, alone], [cut[rows, (alone + step) % 3] for step in (1, 2)]
    shares = [(level - tip[:, 2]) / (end[:, 2] - tip[:, 2]) for end in ends]
    start, stop = (
        (tip + share[:, None] * (end - tip))[:, :2] - middle for end, share in zip(ends, shares, strict=True)
    )
    along = stop - start
    rays = np.array(_around(DIRECTIONS, 1.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        slant = _cross(rays[:, None], along)
        far = _cross(start, along) / slant
        at = _cross(start, rays[:, None]) / slant
    far = np.where((far > 0) & (at >= 0) & (at <= 1), far, np.inf).min(1, initial=np.inf)
    return arithmetic.snapped(rays * far[:, None] + middle) if np.isfinite(far).all() else None


def _cross(first: F64, second: F64) -> F64:
    """Cross products in the plane."""
    return np.asarray(first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0])


def _burns_gas(asset: Asset) -> bool:
    """Whether it is a burner with a grate that stands above its crown."""
    return asset.spec.type == "StoveBurner" and asset.spec.variant in (0, 3) and asset.spec.size[2] >= FLAT_M


def _gas_flames(asset: Asset) -> Surface:
    """A ring of small flames around the crown of a burner."""
    width, depth, height = asset.spec.size
    around, radius = 0.27 * min(width, depth), 0.12 * min(width, depth) / 2
    flame = primitives.revolve([(0.0, 0.0), (radius, 0.15 * height), (0.0, 0.75 * height)], 8)
    ring = [flame.moved((x, y, 0.0)) for x, y in _around(GAS_FLAMES, around)]
    return _at(primitives.joined(ring), (0.0, 0.0, -0.2 * height), GAS)


def _flame_on(asset: Asset) -> Surface | None:
    """A flame on the wick of a candle that stands."""
    width, depth, height = asset.spec.size
    if height < max(width, depth) / 2:
        return None
    radius, tall = FLAME_M[0] / 2, FLAME_M[1]
    drop = [(0.0, 0.0), (0.8 * radius, 0.15 * tall), (radius, 0.35 * tall), (0.5 * radius, 0.7 * tall), (0.0, tall)]
    return _at(primitives.revolve(drop, 10), (0.0, 0.0, height / 2 - 0.2 * tall), FLAME)


def _water_from(world: World, object_id: str) -> Surface | None:
    """The water that runs from a faucet's spout or a shower head, down to what it meets."""
    state, asset = world.state(object_id), world.assets[object_id]
    turn = rotation_of(state.quaternion)
    is_shower = world.type_of(object_id) == "ShowerHead"
    spout = _spout(asset, is_shower=is_shower)
    start = turn @ spout + np.asarray(state.position)
    below: Vec3 = (float(start[0]), float(start[1]), world.scene.floor_z)
    with world.without_collisions(object_id):
        met = world.first_hit((below[0], below[1], float(start[2])), below)
    fall = float(start[2]) - (below[2] if met is None else met[1][2])
    if fall <= 0.0:
        return None
    jet = primitives.cylinder(JET_M, fall, sections=6) if is_shower else primitives.cylinder(STREAM_M, fall)
    jets = [jet.moved((x, y, -fall / 2)) for x, y in [(0.0, 0.0), *(_around(JETS, APART_M) if is_shower else ())]]
    return _at(primitives.joined(jets).turned(turn.T), spout, LIQUIDS["water"])


def _around(count: int, radius_m: float) -> list[tuple[float, float]]:
    """Points on a circle in plan."""
    turns = [arithmetic.sin_cos_deg(360.0 * turn / count) for turn in range(count)]
    return [(float(cosine) * radius_m, float(sine) * radius_m) for sine, cosine in turns]


def _spout(asset: Asset, *, is_shower: bool) -> F64:
    """Where water leaves: the lowest point of the half that is farther from the wall, which is behind."""
    points = np.concatenate([one.vertices for one in asset.links[0].surfaces]).astype(np.float64)
    low, high = points[:, 1].min(), points[:, 1].max()
    front = points[points[:, 1] <= low + (0.6 if is_shower else 0.15) * (high - low)]
    bottom = front[:, 2].min()
    rim = front[front[:, 2] <= bottom + 0.004]
    return np.array([*(rim[:, :2].min(0) + rim[:, :2].max(0)) / 2, bottom])


def _at(mesh: primitives.Mesh, place: Vec3 | F64, material: Material) -> Surface:
    return surface(with_uv(mesh.moved(place), material, None), material)


def _mixed(first: Vec3, second: Vec3, share: float) -> Vec3:
    r, g, b = ((1.0 - share) * x + share * y for x, y in zip(first, second, strict=True))
    return r, g, b


def _product(first: Vec3, second: Vec3) -> Vec3:
    r, g, b = (x * y for x, y in zip(first, second, strict=True))
    return r, g, b
