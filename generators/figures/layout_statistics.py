"""Recorded and sampled rooms side by side.

`python -m remqa_data.generators.figures.layout_statistics` writes it into docs/LAYOUTS.md; takes about five minutes.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import astuple, dataclass, fields
from pathlib import Path
from statistics import median

from remqa_data.catalog import object_type
from remqa_data.files import atomic_path
from remqa_data.floorplans.ithor.scenes import load_scene, scene_names
from remqa_data.floorplans.sampled.naming import ROOM_TYPES
from remqa_data.floorplans.sampled.scenes import out_of_reach, sampled_scene
from remqa_data.scene import Scene
from remqa_data.sim.navigation.grid import reachable_grid
from remqa_data.sim.physics.world import World

BEGIN, END = "<!-- table: begin -->\n", "<!-- table: end -->\n"
SAMPLED_ROOMS, SEED = 120, 0


@dataclass(frozen=True)
class RoomFigures:
    """What is counted in a room.

    Attributes
    ----------
    objects, types : int
        Number of objects, and of types among them.
    area_m2 : float
        Of the floor, without inner walls and the missing corner of an L.
    cells : int
        That the agent can walk to, 0.25 m apart.
    receptacles, drawers, cabinets : int
        Number of objects that hold others, and of two types of them.
    out_of_reach : int
        Of the drawers, cabinets and other things that can be opened, those that the agent's arm does not get to.
    """

    objects: int
    types: int
    area_m2: float
    cells: int
    receptacles: int
    drawers: int
    cabinets: int
    out_of_reach: int


def room_figures(scene: Scene) -> RoomFigures:
    """Count what is in a room."""
    with World(scene) as world:
        world.settle()
        cells = len(reachable_grid(world).cells)
    types = [o.type for o in scene.objects]
    return RoomFigures(
        objects=len(types),
        types=len(set(types)),
        area_m2=_floor_area(scene),
        cells=cells,
        receptacles=sum(object_type(name).receptacle for name in types),
        drawers=types.count("Drawer"),
        cabinets=types.count("Cabinet"),
        out_of_reach=len(out_of_reach(scene)),
    )


def side_by_side(recorded: Mapping[str, Sequence[RoomFigures]], sampled: Mapping[str, Sequence[RoomFigures]]) -> str:
    """A Markdown table of medians (means in brackets) by room type."""
    lines = ["| room type | per room | recorded | sampled | medians differ by |", "|---|---|---|---|---|"]
    for room_type in ROOM_TYPES:
        columns = (zip(*map(astuple, rooms[room_type]), strict=True) for rooms in (recorded, sampled))
        for field, ours, theirs in zip(fields(RoomFigures), *reversed(list(columns)), strict=True):
            change = f"{median(ours) / median(theirs) - 1:+.0%}" if median(theirs) else ""
            name = field.name.replace("_m2", " (m²)").replace("_", " ")
            lines.append(f"| {room_type} | {name} | {_summary(theirs)} | {_summary(ours)} | {change} |")
    return "\n".join(lines) + "\n"


def write_table(path: Path, table: str) -> None:
    """Put the table where the page wants it."""
    before, _, rest = path.read_text(encoding="utf-8").partition(BEGIN)
    with atomic_path(path) as temporary:
        temporary.write_text(before + BEGIN + table + END + rest.partition(END)[2], encoding="utf-8")


def _floor_area(scene: Scene) -> float:
    x0, y0, x1, y1 = scene.bounds
    inner = 0.0
    for part in scene.structure:
        if part.kind == "wall" and part.box[2] < scene.floor_z + 0.1:
            width = min(part.box[3], x1) - max(part.box[0], x0)
            depth = min(part.box[4], y1) - max(part.box[1], y0)
            inner += max(width, 0.0) * max(depth, 0.0)
    return (x1 - x0) * (y1 - y0) - inner


def _summary(values: Sequence[float]) -> str:
    return f"{median(values):.4g} ({sum(values) / len(values):.1f})"


def _by_type(scenes: Iterable[Scene]) -> dict[str, list[RoomFigures]]:
    found: dict[str, list[RoomFigures]] = {room_type: [] for room_type in ROOM_TYPES}
    for scene in scenes:
        found[scene.room_type].append(room_figures(scene))
    return found


if __name__ == "__main__":
    page = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parents[2] / "docs" / "LAYOUTS.md"
    recorded_rooms = _by_type(map(load_scene, scene_names()))
    sampled_rooms = _by_type(sampled_scene(index, SEED) for index in range(SAMPLED_ROOMS))
    write_table(page, side_by_side(recorded_rooms, sampled_rooms))
