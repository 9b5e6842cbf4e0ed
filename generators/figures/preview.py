"""A picture of a whole room: a map from above with the reachable cells, and eight views."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from remqa_data.export.rooms import find_scene
from remqa_data.geometry.types import U8
from remqa_data.opencv import check_png, cv2, write_png
from remqa_data.scene import Light, Scene
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.navigation.grid import ReachableGrid, reachable_grid
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.camera import Camera, TopDownCamera
from remqa_data.sim.render.view import WorldView

MAP_CUT_M = 1.95
"""The map shows what is below this height."""
VIEWS = 8
HORIZON_DEG = 15.0
SCOUT_PX, SCOUT_MIN_PX = 60, 6
"""Size of the images by which views are chosen, and pixels that count as seeing an object."""
CELL_COLOR, START_COLOR, WALL_COLOR, TEXT_COLOR = (60, 160, 60), (220, 60, 40), (70, 70, 75), (30, 30, 30)


def write_preview(scene_name: str, path: Path, size_px: int = 300, light: Light = "baked", seed: int = 0) -> None:
    """Write the preview sheet of a room that `find_scene` finds as PNG; `size_px` is the side of each view."""
    check_png(path)
    write_png(path, preview(replace(find_scene(scene_name, seed=seed), light=light), size_px))


def preview(scene: Scene, size_px: int = 300) -> U8:
    """A room as it stands: a map (twice as high as a view) beside two rows of four views, (2 * size, 6 * size, 3) RGB."""
    with World(scene) as world:
        view = WorldView(world)
        grid = reachable_grid(world)
        plan = room_map(scene, view, grid, 2 * size_px)
        cameras = spread_views(view, grid, size_px)
        pictures = [view.render(camera).rgb for camera in cameras]
    for number, camera in enumerate(cameras):
        _mark_camera(plan, scene, camera, number + 1)
        _label(pictures[number], str(number + 1))
    rows = [np.hstack(pictures[i : i + VIEWS // 2]) for i in range(0, VIEWS, VIEWS // 2)]
    kind = "" if scene.room_type in scene.name else f"  {scene.room_type}"
    _label(plan, f"{scene.name}{kind}  {len(scene.objects)} objects  {len(grid.cells)} reachable cells")
    return np.hstack([plan, np.vstack(rows)])


def room_map(scene: Scene, view: WorldView, grid: ReachableGrid, size_px: int) -> U8:
    """The room from above without its ceiling, with a dot on each reachable cell, (size, size, 3) RGB."""
    camera = _map_camera(scene, size_px)
    rendered = view.render(camera, shadows=False).rgb
    x0, y0, x1, y1 = scene.bounds
    (left, bottom), (right, top) = map_pixel(scene, size_px, x0, y0), map_pixel(scene, size_px, x1, y1)
    image = np.full_like(rendered, 255)
    image[top:bottom, left:right] = rendered[top:bottom, left:right]
    for part in scene.structure:
        if part.kind == "wall" and part.box[2] < camera.height_m < part.box[5]:
            corner = map_pixel(scene, size_px, part.box[0], part.box[1])
            cv2.rectangle(image, corner, map_pixel(scene, size_px, part.box[3], part.box[4]), WALL_COLOR, -1)
    scale = size_px / camera.extent_m
    for x, y in grid.positions():
        centre = map_pixel(scene, size_px, float(x), float(y))
        cv2.circle(image, centre, max(2, round(0.035 * scale)), CELL_COLOR, -1, cv2.LINE_AA)
    return image


def spread_views(view: WorldView, grid: ReachableGrid, size_px: int) -> list[Camera]:
    """`VIEWS` cameras spread over the reachable cells, each turned to where most objects are seen that no earlier one saw."""
    positions = grid.positions()
    x0, y0, x1, y1 = view.world.scene.bounds
    chosen = [int(np.argmax(np.linalg.norm(positions - [(x0 + x1) / 2, (y0 + y1) / 2], axis=1)))]
    while len(chosen) < VIEWS:
        gaps = np.min([np.linalg.norm(positions - positions[i], axis=1) for i in chosen], axis=0)
        chosen.append(int(np.argmax(gaps)))
    seen = np.zeros(len(view.world.ids), dtype=np.int64)
    cameras = []
    for index in chosen:
        x, y = positions[index]
        eye = (float(x), float(y), grid.floor_z + AGENT.camera_height_m)
        options = [Camera(eye, yaw, HORIZON_DEG, width=SCOUT_PX, height=SCOUT_PX) for yaw in range(0, 360, 30)]
        shown = [view.pixels(option) >= SCOUT_MIN_PX for option in options]
        best = max(range(len(options)), key=lambda i: float(np.sum(shown[i] / (1.0 + 2.0 * seen))))
        seen += shown[best]
        cameras.append(replace(options[best], width=size_px, height=size_px))
    return cameras


def _map_camera(scene: Scene, size_px: int) -> TopDownCamera:
    x0, y0, x1, y1 = scene.bounds
    extent = 1.2 * max(x1 - x0, y1 - y0)
    return TopDownCamera(
        ((x0 + x1) / 2, (y0 + y1) / 2), scene.floor_z + MAP_CUT_M, extent, width=size_px, height=size_px
    )


def map_pixel(scene: Scene, size_px: int, x: float, y: float) -> tuple[int, int]:
    """Where a point of the room is in `room_map`."""
    camera = _map_camera(scene, size_px)
    scale = size_px / camera.extent_m
    return (
        round(size_px / 2 + (x - camera.centre_xy[0]) * scale),
        round(size_px / 2 - (y - camera.centre_xy[1]) * scale),
    )


def _mark_camera(plan: U8, scene: Scene, camera: Camera, number: int) -> None:
    size = plan.shape[0]
    x, y, _ = camera.position
    yaw = np.radians(camera.yaw_deg)
    tip = (x + 1.4 * AGENT.step_m * np.cos(yaw), y + 1.4 * AGENT.step_m * np.sin(yaw))
    start, end = map_pixel(scene, size, x, y), map_pixel(scene, size, float(tip[0]), float(tip[1]))
    cv2.arrowedLine(plan, start, end, START_COLOR, 2, cv2.LINE_AA, tipLength=0.35)
    place = (start[0] + 4, start[1] - 4)
    cv2.putText(plan, str(number), place, cv2.FONT_HERSHEY_SIMPLEX, 0.5, START_COLOR, 2, cv2.LINE_AA)


def _label(image: U8, text: str) -> None:
    (length, _), _ = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, 0.45, 1)
    scale = 0.45 * min(1.0, (image.shape[1] - 12) / length)
    for color, width in (((255, 255, 255), 3), (TEXT_COLOR, 1)):
        cv2.putText(image, text, (6, 18), cv2.FONT_HERSHEY_SIMPLEX, scale, color, width, cv2.LINE_AA)
