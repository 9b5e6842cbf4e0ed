"""What holds what: for each object of a world, the receptacle that it rests in or on.

An object belongs to a space when its centre is in it and its bottom is not below the space's floor. Spaces overlap:
what lies in a bowl on a table is also in the room above the table, and a desk's things may be in the room above the
seat of a chair that is pushed under it. Of all spaces, the one with the highest floor is the one that the object
would meet first on its way down, so this one holds it; of equally high floors, the smallest space.

Agents bring about what rooms do not come with: things across the rims of basins, mugs in the dips of plates. Whoever acts asks
for these to be told apart; the dataset, whose version is final, never does.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, ConfigDict, Field

from remqa_data.catalog import TypeName, object_type, types_with
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import F64, Flags
from remqa_data.yaml_files import template_rules

if TYPE_CHECKING:
    from remqa_data.assets.core.model import Space
    from remqa_data.sim.physics.world import World

SupportKind = Literal["in", "on"]
SOURCE = "support.yaml"


class SupportRules(BaseModel):
    """When an object is held by a space of another, metres. The file says what each number means.

    Attributes
    ----------
    vessels : mapping of str to tuple of str
        By type, the first words of the names of its spaces that have walls around them but are not closed.
    hangs : mapping of str to tuple of str
        By type of what things hang on, the types that do.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    side_margin_m: float = Field(ge=0)
    sunk_m: float = Field(ge=0)
    overhang_m: float = Field(ge=0)
    contact_m: float = Field(ge=0)
    pile_m: float = Field(ge=0)
    rim_m: float = Field(ge=0)
    vessels: dict[TypeName, tuple[str, ...]]
    hangs: dict[TypeName, tuple[TypeName, ...]]


@lru_cache(maxsize=1)
def support_rules() -> SupportRules:
    """The rules of `templates/support.yaml`, read once."""
    return template_rules(SupportRules, SOURCE)


@dataclass(frozen=True)
class Support:
    """What holds an object, and how: "in" what encloses it or has walls around it, else "on"."""

    id: str
    kind: SupportKind


def supports(world: World, boxes: Mapping[str, F64] | None = None, *, by_agents: bool = False) -> dict[str, Support]:
    """What holds each object that something holds.

    Parameters
    ----------
    world : World
        The room; what an agent holds neither holds nor is held.
    boxes : mapping of str to (2, 3) array, optional
        The box of every object; by default `world.box`.
    by_agents : bool
        Whether what lies across the rim of a basin, and is not in or on something loose, is in it; whether of two things of
        which each seems to be in the other the lower one is not; and whether what stands on a space's floor is on it, however
        high it is, or has come to rest as high as that floor in the outline of what has the space (at the edge of an oval
        table), if nothing else holds it.

    Returns
    -------
    Support by object id; no entry for what rests on nothing known.
    """
    rules = support_rules()
    boxes = {name: world.box(name) for name in world.ids} if boxes is None else boxes
    spaces = _all_spaces(world)
    floor = next((object_id for object_id in world.ids if world.type_of(object_id) == "Floor"), None)
    # The space of what things hang on reaches below it.
    undersides = np.minimum([boxes[owner][0, 2] for owner in spaces.owners], spaces.floor_z)
    held_by: dict[str, Support] = {}
    names = [object_id for object_id in boxes if object_id not in world.held and len(spaces.owners)]
    if not names:
        return held_by
    low, high = np.moveaxis(np.array([boxes[object_id] for object_id in names]), 1, 0)
    kinds = [object_type(world.type_of(object_id)) for object_id in names]
    is_loose = np.array([kind.is_loose for kind in kinds])[:, None]
    centre, bottom = (low + high) / 2, low[:, 2, None]
    local = arithmetic.moved_back(centre[:, None], spaces.poses)
    beside = (np.abs(local[..., :2] - spaces.middle[:, :2]) <= spaces.half[:, :2] + rules.side_margin_m).all(axis=-1)
    is_another = np.array(names, dtype=np.object_)[:, None] != spaces.owners
    beside &= is_another
    fits = beside & (bottom >= spaces.floor_z - rules.sunk_m)
    fits &= local[..., 2] <= spaces.middle[:, 2] + spaces.half[:, 2] + rules.overhang_m
    fits &= centre[:, 2, None] >= undersides  # what lies beneath is not in it
    above = bottom - spaces.floor_z
    lies_there = spaces.enclosed | (above <= rules.pile_m)
    fits &= np.where(is_loose, lies_there, spaces.is_floor & (above <= rules.contact_m))
    if by_agents:
        _leave_out_lower_ones(fits, names, bottom[:, 0], spaces.owners)
        stands_there = is_loose & beside & ~spaces.enclosed & (np.abs(above) <= rules.contact_m)
        fits |= stands_there & ~fits.any(axis=1)[:, None]
        over_edge = is_another & (np.abs(local[..., :2]) <= spaces.outline).all(axis=-1)
        has_come_to_rest = np.array([not world.state(name).is_fixed for name in names])[:, None]
        over_edge &= is_loose & has_come_to_rest & ~spaces.enclosed & (np.abs(above) <= rules.sunk_m)
        fits |= over_edge & ~fits.any(axis=1)[:, None]
    order = np.lexsort((spaces.volume, -spaces.floor_z))
    first = order[np.argmax(fits[:, order], axis=1)]
    if by_agents:
        lies_across = is_loose & spaces.is_basin & (bottom >= spaces.floor_z)
        lies_across &= (np.abs(local[..., :2] - spaces.middle[:, :2]) <= spaces.half[:, :2]).all(axis=-1)
        lies_across &= bottom <= spaces.floor_z + 2 * spaces.half[:, 2] + rules.rim_m
        # What bears it there, if anything, is built in: a sink or a worktop.
        lies_across &= ~(fits.any(axis=1) & (spaces.surrounds | spaces.is_loose)[first])[:, None]
        first = np.where(lies_across.any(axis=1), np.argmax(lies_across, axis=1), first)
        fits |= lies_across
    for object_id, best, fits_anywhere, height in zip(names, first, fits.any(axis=1), bottom[:, 0], strict=True):
        if fits_anywhere:
            held_by[object_id] = Support(str(spaces.owners[best]), "in" if spaces.surrounds[best] else "on")
        elif floor not in (None, object_id) and abs(height - world.scene.floor_z) <= rules.contact_m:
            held_by[object_id] = Support(str(floor), "on")  # in an alcove, beside the floor's own box
    return held_by


def directly_held(found: Mapping[str, Support], object_id: str) -> list[str]:
    """Ids of what rests in or on an object itself, of what has been found to support what."""
    return [name for name, support in found.items() if support.id == object_id]


def contents_of(found: Mapping[str, Support], object_id: str) -> list[str]:
    """Ids of what rests in or on an object, and of what rests in or on that, of what has been found to support what."""
    names: list[str] = []
    waiting = [object_id]
    while waiting:
        holder = waiting.pop()
        news = [name for name in directly_held(found, holder) if name not in names]
        names += news
        waiting += news
    return names


def _leave_out_lower_ones(fits: Flags, names: Sequence[str], bottom: F64, owners: npt.NDArray[np.object_]) -> None:
    """Of two things each of which fits into a space of the other, let the one that reaches farther down not fit."""
    place = {name: i for i, name in enumerate(names)}
    of_space = np.array([place.get(owner, -1) for owner in owners])
    pairs = {(i, int(of_space[k])) for i, k in np.argwhere(fits & (of_space >= 0)).tolist()}
    for i, j in pairs:
        if (j, i) in pairs and bottom[i] < bottom[j]:
            fits[i, of_space == j] = False


def surrounds(type_name: str, space: Space) -> bool:
    """Whether what lies in a space of a type is "in" it: it is enclosed, or has walls around it."""
    return space.enclosed or space.name.startswith(support_rules().vessels.get(type_name, ()))


@dataclass(frozen=True)
class _Spaces:
    """The spaces of all objects, one row each."""

    owners: npt.NDArray[np.object_]
    is_floor: npt.NDArray[np.bool_]
    is_loose: npt.NDArray[np.bool_]
    is_basin: npt.NDArray[np.bool_]
    enclosed: npt.NDArray[np.bool_]
    surrounds: npt.NDArray[np.bool_]
    poses: F64
    """(n, 4, 4) in the world, of the frames in which the boxes are given."""
    middle: F64
    half: F64
    outline: F64
    """(n, 2) half the width and depth of what has the space, in that frame; 0 in what moves."""
    floor_z: F64
    """(n,) height of the space's bottom in the world."""
    volume: F64


def _all_spaces(world: World) -> _Spaces:
    owners, is_floor, is_loose, is_basin, enclosed, walled, poses, low, high = [], [], [], [], [], [], [], [], []
    outline = []
    basins = types_with("basin")
    for object_id in world.ids:
        if object_id in world.held or not world.assets[object_id].spaces:
            continue
        type_name, links = world.type_of(object_id), world.link_poses(object_id)
        for space in world.assets[object_id].spaces:
            owners.append(object_id)
            is_floor.append(type_name == "Floor")
            is_loose.append(object_type(type_name).is_loose)
            is_basin.append(type_name in basins)
            enclosed.append(space.enclosed)
            walled.append(surrounds(type_name, space))
            poses.append(links[space.link])
            outline.append([0.5 * side if space.link == 0 else 0.0 for side in world.assets[object_id].spec.size[:2]])
            low.append(space.box[:3])
            high.append(space.box[3:])
    pose = np.array(poses, dtype=np.float64).reshape(-1, 4, 4)
    middle = (np.array(low).reshape(-1, 3) + np.array(high).reshape(-1, 3)) / 2
    half = np.array(high).reshape(-1, 3) - middle
    centre_z = arithmetic.dot(pose[:, 2, :3], middle) + pose[:, 2, 3]
    return _Spaces(
        owners=np.array(owners, dtype=np.object_),
        is_floor=np.array(is_floor, dtype=np.bool_),
        is_loose=np.array(is_loose, dtype=np.bool_),
        is_basin=np.array(is_basin, dtype=np.bool_),
        enclosed=np.array(enclosed, dtype=np.bool_),
        surrounds=np.array(walled, dtype=np.bool_),
        poses=pose,
        middle=middle,
        half=half,
        outline=np.array(outline).reshape(-1, 2),
        floor_z=centre_z - arithmetic.dot(np.abs(pose[:, 2, :3]), half),
        volume=np.prod(2 * half, axis=1),
    )
