"""How things look: marked in one colour, shown alone, made of other materials, in other light. Nothing else changes."""

from __future__ import annotations

import colorsys
from dataclasses import replace
from typing import NamedTuple, get_args

from remqa_data.assets.core.model import Material
from remqa_data.assets.looks import materials
from remqa_data.catalog import Room
from remqa_data.floorplans.ithor.building import paints_of
from remqa_data.geometry.types import Vec3
from remqa_data.sim.agent.results import ActionResult
from remqa_data.thor.actions.targets import not_there
from remqa_data.thor.state.dispatch import ActionFunction
from remqa_data.thor.state.looks import Lighting, Look
from remqa_data.thor.state.simulator import SimulatorState

PALETTES: dict[str, tuple[Material, ...]] = {
    "ceramic": materials.CERAMICS,
    "fabric": materials.FABRICS,
    "leather": materials.LEATHERS,
    "metal": (materials.STEEL, materials.BLACK_METAL, materials.WHITE_METAL, materials.BRASS, materials.COPPER),
    "plastic": materials.PLASTICS,
    "stone": materials.STONES,
    "wooden": materials.WOODS + materials.PAINTED_WOODS,
}
"""What a thing of a substance can be made of instead; what is of another substance only gets another shade."""
SHADES = {"train": (1.0, 0.85, 0.7), "val": (0.92, 0.77), "test": (0.96, 0.8)}
"""How light a material is where it is said to come from; no two of these have a shade in common."""
SPLIT_ENDS = {"train": 20, "val": 25, "test": 30}
"""The last floor plan of each split, of the thirty of a room type."""
TILES = ("tile", "subway")
"""Textures of floors and walls, which are as pale as painted walls are."""
BRIGHTNESS, HUE, SATURATION = (0.5, 1.5), (0.0, 1.0), (0.5, 1.0)
"""Between these AI2-THOR draws how bright lamps are, and their colours."""


def mask_object(simulator: SimulatorState, objectId: str) -> ActionResult:
    """Draw an object in plain magenta; what is before it still hides it."""
    look = simulator.room.looks.look
    return not_there(simulator, objectId) or _show(simulator, replace(look, masked=look.masked | {objectId}))


def unmask_object(simulator: SimulatorState, objectId: str) -> ActionResult:
    """Draw an object as it was."""
    look = simulator.room.looks.look
    return not_there(simulator, objectId) or _show(simulator, replace(look, masked=look.masked - {objectId}))


def emphasize_object(simulator: SimulatorState, objectId: str) -> ActionResult:
    """Draw an object in plain magenta, and nothing else."""
    look = replace(simulator.room.looks.look, emphasized=objectId)
    return not_there(simulator, objectId) or _show(simulator, look)


def unemphasize_all(simulator: SimulatorState) -> ActionResult:
    """Draw everything again, as it was."""
    return _show(simulator, replace(simulator.room.looks.look, masked=frozenset(), emphasized=None))


def hide_object(simulator: SimulatorState, objectId: str) -> ActionResult:
    """Leave an object out of all pictures, with what is in it if it can be opened; it is there all the same."""
    look = simulator.room.looks.look
    return not_there(simulator, objectId) or _show(
        simulator, replace(look, hidden=look.hidden | _with_what_is_inside(simulator, objectId))
    )


def unhide_object(simulator: SimulatorState, objectId: str) -> ActionResult:
    """Let an object be in pictures again, with what is in it if it can be opened."""
    look = simulator.room.looks.look
    return not_there(simulator, objectId) or _show(
        simulator, replace(look, hidden=look.hidden - _with_what_is_inside(simulator, objectId))
    )


def unhide_all_objects(simulator: SimulatorState) -> ActionResult:
    """Let all that was hidden be in pictures again."""
    return _show(simulator, replace(simulator.room.looks.look, hidden=frozenset()))


def set_random_seed(simulator: SimulatorState, seed: int) -> ActionResult:
    """Let what is random from now on follow from a seed."""
    simulator.seed(seed)
    return ActionResult(True)


def randomize_materials(
    simulator: SimulatorState,
    useTrainMaterials: bool | None = None,
    useValMaterials: bool | None = None,
    useTestMaterials: bool | None = None,
    useExternalMaterials: bool | None = None,
    inRoomTypes: list[str] | None = None,
) -> ActionResult:
    """Give everything that was built of one material another one of the same substance."""
    room, split = simulator.room, _split(simulator.room.scene)
    wanted = {"train": useTrainMaterials, "val": useValMaterials, "test": useTestMaterials}
    if wanted[split] is False:
        name = f"use{split.capitalize()}Materials"
        return ActionResult(False, f"{name} cannot be false in {room.scene}, which is a {split} scene")
    chosen = {name: name == split if flag is None else flag for name, flag in wanted.items()}
    types = _thor_room_types() if inRoomTypes is None else [name.lower() for name in inRoomTypes]
    problem = _problem_of_types(types, room.world.scene.room_type, room.scene)
    if problem:
        return ActionResult(False, problem)
    shades = [shade for name, is_used in chosen.items() if is_used for shade in SHADES[name]]
    ours = {_thor_room_type(room_type): room_type for room_type in get_args(Room)}
    paints = [rgb for name in types if name in ours for rgb in paints_of(ours[name])]
    choices = {own: _choices(own, shades, paints) for own in room.looks.built_of}
    drawn = {own: some[int(simulator.rng.integers(len(some)))] for own, some in choices.items() if some}
    _show(simulator, replace(room.looks.look, materials=drawn))
    value = {
        "chosenRoomTypes": types,
        **{f"use{name.capitalize()}Materials": is_used for name, is_used in chosen.items()},
        "useExternalMaterials": split == "train" if useExternalMaterials is None else useExternalMaterials,
        "totalMaterialsConsidered": len({material for some in choices.values() for material in some}),
    }
    return ActionResult(True, value=value)


def reset_materials(simulator: SimulatorState) -> ActionResult:
    """Let everything be made of what it was built of."""
    return _show(simulator, replace(simulator.room.looks.look, materials={}))


def randomize_colors(simulator: SimulatorState) -> ActionResult:
    """Give everything that was built of one material some colour."""
    looks = simulator.room.looks
    colors: dict[Material, Vec3] = {}
    for own in looks.built_of:
        r, g, b = simulator.rng.uniform(size=3).tolist()
        colors[own] = (r, g, b)
    return _show(simulator, replace(looks.look, colors=colors))


def reset_colors(simulator: SimulatorState) -> ActionResult:
    """Let everything have the colour of what it is made of."""
    return _show(simulator, replace(simulator.room.looks.look, colors={}))


def randomize_lighting(
    simulator: SimulatorState,
    synchronized: bool = False,
    brightness: list[float] | None = None,
    randomizeColor: bool = True,
    hue: list[float] | None = None,
    saturation: list[float] | None = None,
) -> ActionResult:
    """Let each lamp shine more or less, in some colour; all alike if they are synchronized."""
    for name, given in (("hue", hue), ("saturation", saturation)):
        if given is not None and not randomizeColor:
            return ActionResult(False, f"{name} is given, but randomizeColor is false")
    bounds = _Bounds(
        tuple(BRIGHTNESS if brightness is None else brightness),
        tuple(HUE if hue is None else hue),
        tuple(SATURATION if saturation is None else saturation),
    )
    if problem := bounds.problem():
        return ActionResult(False, problem)
    looks, rng = simulator.room.looks, simulator.rng

    def lamp() -> tuple[float, Vec3]:
        level, h, s = (float(rng.uniform(min(pair), max(pair))) for pair in bounds)
        return level, colorsys.hsv_to_rgb(h, s, 1.0) if randomizeColor else (1.0, 1.0, 1.0)

    drawn = [lamp()] * looks.lamps if synchronized else [lamp() for _ in range(looks.lamps)]
    lighting = Lighting(tuple(level for level, _ in drawn), tuple(color for _, color in drawn))
    return _show(simulator, replace(looks.look, lighting=lighting))


def reset_lighting(simulator: SimulatorState) -> ActionResult:
    """Let all lamps shine as they were built."""
    return _show(simulator, replace(simulator.room.looks.look, lighting=None))


ACTIONS: dict[str, ActionFunction] = {
    "ChangeColorOfMaterials": randomize_colors,
    "EmphasizeObject": emphasize_object,
    "HideObject": hide_object,
    "MaskObject": mask_object,
    "RandomizeColors": randomize_colors,
    "RandomizeLighting": randomize_lighting,
    "RandomizeMaterials": randomize_materials,
    "ResetColors": reset_colors,
    "ResetLighting": reset_lighting,
    "ResetMaterials": reset_materials,
    "SetRandomSeed": set_random_seed,
    "UnemphasizeAll": unemphasize_all,
    "UnhideAllObjects": unhide_all_objects,
    "UnhideObject": unhide_object,
    "UnmaskObject": unmask_object,
}


def _with_what_is_inside(simulator: SimulatorState, object_id: str) -> frozenset[str]:
    """An object and, if it can be opened, what is in it."""
    world = simulator.room.world
    return frozenset([object_id, *(world.contents(object_id) if world.assets[object_id].is_openable else ())])


def _show(simulator: SimulatorState, look: Look) -> ActionResult:
    simulator.room.looks.change(look)
    return ActionResult(True)


def _split(scene: str) -> str:
    number = int(scene.removeprefix("FloorPlan")) % 100
    return next(name for name, last in SPLIT_ENDS.items() if number <= last)


def _thor_room_type(room_type: str) -> str:
    """AI2-THOR's name of a room type: "livingroom" for "living_room"."""
    return room_type.replace("_", "")


def _thor_room_types() -> list[str]:
    return [*map(_thor_room_type, get_args(Room)), "robothor"]


def _problem_of_types(types: list[str], room_type: str, scene: str) -> str | None:
    known, own = _thor_room_types(), _thor_room_type(room_type)
    unknown = [name for name in types if name not in known]
    if unknown or not types:
        return f"inRoomTypes {unknown} must be some of {', '.join(known)}"
    return None if own in types else f"inRoomTypes must include {own} in {scene}, which is one"


def _choices(own: Material, shades: list[float], paints: list[Vec3]) -> list[Material]:
    """What a surface can be made of instead; nothing for what shines, mirrors or shows a picture."""
    if own.glow or own.mirror or own.repeat_m is None:
        return []
    if own.substance in ("painted", "tiled") or own.texture in TILES:
        palette: tuple[Material, ...] = tuple(replace(own, rgb=rgb) for rgb in paints)
    else:
        palette = PALETTES.get(own.substance, (own,))
    textures = {material.texture for material in palette}
    return [
        materials.tinted(
            replace(own, rgb=m.rgb, gloss=m.gloss, texture=m.texture if own.texture in textures else own.texture), shade
        )
        for m in palette
        for shade in shades
    ]


class _Bounds(NamedTuple):
    """Between which values lamps are drawn, in any order."""

    brightness: tuple[float, ...]
    hue: tuple[float, ...]
    saturation: tuple[float, ...]

    def problem(self) -> str | None:
        for name, pair in self._asdict().items():
            if len(pair) != 2:
                return f"{name} must have 2 values, not {len(pair)}"
            if min(pair) < 0.0 or (name != "brightness" and max(pair) > 1.0):
                limits = "0 or more" if name == "brightness" else "in [0:1]"
                return f"{name} must be {limits}, not {pair[0]:g} to {pair[1]:g}"
        return None
