"""Turned parts along the longest side of an object: bats, dumbbells, pens."""

from __future__ import annotations

from collections.abc import Sequence

from remqa_data.assets.core.model import Material
from remqa_data.assets.core.posed import Posed
from remqa_data.assets.mesh import primitives


def spindle(board: Posed, profile: Sequence[tuple[float, float]], material: Material, sections: int = 12) -> None:
    """Draw a part turned about the long axis of a board, stretched to the board's section.

    Parameters
    ----------
    profile : sequence of (radius, place)
        Radius in halves of the section, place in lengths from the lower end of the long axis, in rising order.
    """
    points = [(radius, (place - 0.5) * board.d) for radius, place in profile]
    mesh = primitives.revolve(points, sections).pointed("y").scaled((board.w / 2, 1.0, board.h / 2))
    board.add(mesh, material, (0, 0, board.h / 2), grain="y")
