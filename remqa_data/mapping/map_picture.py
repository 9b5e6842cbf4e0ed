"""A picture of a semantic plan: one colour for each object type, with a legend, the reachable cells and a path."""

from __future__ import annotations

import colorsys
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from remqa_data.catalog import catalog
from remqa_data.geometry.types import U8
from remqa_data.mapping.semantic_map import STRUCTURE, UNKNOWN, SemanticPlan
from remqa_data.opencv import cv2
from remqa_data.sim.navigation.embodiment import AGENT
from remqa_data.sim.navigation.grid import Cell, ReachableGrid

Color = tuple[int, int, int]

UNKNOWN_COLOR, STRUCTURE_COLOR, FLOOR_COLOR = (255, 255, 255), (85, 85, 92), (226, 221, 211)
CELL_COLOR, PATH_COLOR, TEXT_COLOR = (60, 140, 60), (215, 40, 40), (30, 30, 30)
LINE_PX, SWATCH_PX, LEGEND_PX, MARGIN_PX = 18, 12, 190, 10
TEXT_SIZE = 0.42


def draw_plan(
    plan: SemanticPlan,
    *,
    grid: ReachableGrid | None = None,
    path: Sequence[Cell] = (),
    title: str = "",
    voxel_px: int = 6,
) -> U8:
    """Draw a plan with +x to the right and +y up.

    Parameters
    ----------
    plan : SemanticPlan
        What is known of the room.
    grid : ReachableGrid, optional
        Cells to mark with dots, such as `plan.navigation_grid()`.
    path : sequence of Cell
        A way to draw, from a filled circle to an arrow head.
    title : str
        Written above.
    voxel_px : int
        Side of a column in pixels.

    Returns
    -------
    (h, w, 3) uint8 RGB. The legend lists the types from the largest area to the smallest.
    """
    image = paint_plan(plan).repeat(voxel_px, axis=0).repeat(voxel_px, axis=1)
    height = image.shape[0]

    def pixel(cell: Cell) -> tuple[int, int]:
        x, y = (v * AGENT.step_m / plan.voxel_m - first for v, first in zip(cell, plan.corner, strict=True))
        return round(x * voxel_px), round(height - y * voxel_px)

    for cell in grid.cells if grid is not None else ():
        cv2.circle(image, pixel(cell), max(2, voxel_px // 2), CELL_COLOR, -1, cv2.LINE_AA)
    if path:
        cv2.circle(image, pixel(path[0]), voxel_px, PATH_COLOR, -1, cv2.LINE_AA)
    for a, b in pairwise(path):
        cv2.line(image, pixel(a), pixel(b), PATH_COLOR, 2, cv2.LINE_AA)
    if len(path) > 1:
        cv2.arrowedLine(image, pixel(path[-2]), pixel(path[-1]), PATH_COLOR, 2, cv2.LINE_AA, tipLength=0.5)
    return _with_legend(image, plan, title)


def paint_plan(plan: SemanticPlan) -> U8:
    """The colours of a plan, (ny, nx, 3) uint8 RGB: one pixel for each column, +x to the right and +y up."""
    return _colors(plan)[plan.labels.T[::-1]]  # UNKNOWN, -1, takes the last colour


def plan_legend(plan: SemanticPlan) -> list[tuple[str, Color]]:
    """The names on a plan with their colours, from the largest area to the smallest."""
    colors = _colors(plan)
    labels, areas = np.unique(plan.labels[plan.labels != UNKNOWN], return_counts=True)
    by_area = labels[np.argsort(-areas, kind="stable")].tolist()
    return [(plan.names[label], tuple(colors[label].tolist())) for label in by_area]


def _colors(plan: SemanticPlan) -> U8:
    return np.array([type_color(name) for name in plan.names] + [UNKNOWN_COLOR], dtype=np.uint8)


def _with_legend(image: U8, plan: SemanticPlan, title: str) -> U8:
    legend = plan_legend(plan)
    top = MARGIN_PX + (LINE_PX if title else 0)
    per_column = max(1, (image.shape[0] - SWATCH_PX) // LINE_PX + 1)
    columns = -(-len(legend) // per_column)
    width = max(image.shape[1] + 2 * MARGIN_PX + columns * LEGEND_PX, 2 * MARGIN_PX + 9 * len(title))
    sheet = np.full((top + image.shape[0] + MARGIN_PX, width, 3), UNKNOWN_COLOR, dtype=np.uint8)
    sheet[top : top + image.shape[0], MARGIN_PX : MARGIN_PX + image.shape[1]] = image
    _write(sheet, title, MARGIN_PX, MARGIN_PX + 6)
    for place, (name, color) in enumerate(legend):
        x = image.shape[1] + 2 * MARGIN_PX + place // per_column * LEGEND_PX
        y = top + place % per_column * LINE_PX
        cv2.rectangle(sheet, (x, y), (x + SWATCH_PX, y + SWATCH_PX), color, -1)
        _write(sheet, name, x + SWATCH_PX + 6, y + SWATCH_PX - 1)
    return sheet


def _write(image: U8, text: str, x: int, y: int) -> None:
    cv2.putText(image, text, (x, y), cv2.FONT_HERSHEY_SIMPLEX, TEXT_SIZE, TEXT_COLOR, 1, cv2.LINE_AA)


def type_color(name: str) -> Color:
    """The colour of a type, the same in every picture: hues a golden ratio apart, in the catalogue's order."""
    if name == STRUCTURE:
        return STRUCTURE_COLOR
    if name == "Floor":
        return FLOOR_COLOR
    types = list(catalog())
    place = types.index(name) if name in types else len(types)
    red, green, blue = colorsys.hsv_to_rgb(place * 0.6180339887 % 1.0, *_TONES[place % len(_TONES)])
    return round(255 * red), round(255 * green), round(255 * blue)


_TONES = ((0.75, 0.92), (0.5, 0.75), (0.9, 0.62), (0.4, 0.95))
"""Saturation and value; neighbours in hue differ in tone."""
