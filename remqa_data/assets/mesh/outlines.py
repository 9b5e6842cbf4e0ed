"""Plane outlines that solids are extruded, revolved and lofted from: points in metres, counter-clockwise."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from remqa_data.geometry.types import F64

Points2 = Sequence[tuple[float, float]] | F64


def ellipse(width: float, depth: float, count: int = 24, power: float = 2.0) -> F64:
    """Points of an ellipse (power 2) or a rounded rectangle (power 4 and more), (count, 2), counter-clockwise."""
    t = np.arange(count) * 2 * np.pi / count
    c, s = np.cos(t), np.sin(t)
    x = np.sign(c) * np.abs(c) ** (2 / power) * width / 2
    y = np.sign(s) * np.abs(s) ** (2 / power) * depth / 2
    return np.column_stack([x, y])


def rounded_rect(width: float, depth: float, radius: float, segments: int = 4) -> F64:
    """Corners of a rectangle with rounded corners, (n, 2), counter-clockwise."""
    radius = min(radius, 0.499 * min(width, depth))
    points = []
    for quadrant, (sx, sy) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        for a in np.linspace(0, np.pi / 2, segments + 1) + quadrant * np.pi / 2:
            points.append(
                (
                    sx * (width / 2 - radius) + radius * np.cos(a),
                    sy * (depth / 2 - radius) + radius * np.sin(a),
                )
            )
    return np.array(points)


def arc(centre: tuple[float, float], radius: float, start_deg: float, end_deg: float, count: int = 8) -> F64:
    """Points on an arc, (count, 2)."""
    t = np.radians(np.linspace(start_deg, end_deg, count))
    return np.column_stack([centre[0] + radius * np.cos(t), centre[1] + radius * np.sin(t)])
