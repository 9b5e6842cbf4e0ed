"""Which types of things can be hidden in a place, and how many pixels they would show there."""

from __future__ import annotations

import numpy as np

from remqa_data.floorplans.ithor.placements import probability
from remqa_data.generators.arrangement.areas import Area
from remqa_data.generators.arrangement.fill_ratios import fill_ratios
from remqa_data.generators.arrangement.hiding_check import goal_camera
from remqa_data.generators.arrangement.hiding_place import HidingPlace
from remqa_data.generators.arrangement.hiding_rules import hiding_rules, largest_size
from remqa_data.generators.arrangement.plausible import plausible_types, types_beside
from remqa_data.geometry import arithmetic
from remqa_data.geometry.types import Vec3
from remqa_data.sim.navigation.viewpoints import FRAME_PX

MOST_CLEAR = 1.5
"""A type that shows more pixels than so many times as many as are aimed at is not preferred any more."""
UNUSUAL = 0.05
"""Weight of a type that is found elsewhere in such rooms."""


def fitting_types(
    place: HidingPlace, room_type: str, count: int | None = None, *, others: bool = False
) -> list[tuple[str, float]]:
    """The types of things that can be hidden in or under a place, of those that are found there, with weights.

    Parameters
    ----------
    place : HidingPlace
        Where.
    room_type : str
        kitchen, living_room, bedroom or bathroom.
    count : int, optional
        How many things of the type must fit at the same time; by default three, or as many as the place has spots.
    others : bool
        Whether to add what is found elsewhere in such rooms, with small weights.

    Returns
    -------
    Pairs of type and weight, sorted by type: the more of its things were recorded in such a place, the more; what shows few
    pixels weighs less.
    """
    rules = hiding_rules()
    wanted = min(3, len(place.spots)) if count is None else count
    found = []
    usual = plausible_types(place.type, place.relation, room_type)
    kept = types_beside(place.type, place.relation, room_type) if others else usual & place.provable
    for type_ in sorted(kept - {place.type}):
        fits = [_fits(area, place, type_, largest_size(type_)) for area in place.areas]
        if sum(count for count, _ in fits) >= wanted:
            clearness = min(max(pixels for _, pixels in fits) / rules.aim_evidence_px, MOST_CLEAR)
            weight = 1.0 + probability(type_, place.type, room_type) if type_ in usual else UNUSUAL
            found.append((type_, weight * clearness * clearness))
    return found


def visible_pixels(place: HidingPlace, area: Area, type_: str, size: Vec3) -> float:
    """About how many pixels of a 300 x 300 frame a thing shows from the goal, wherever it lies on an area: the least.

    Notes
    -----
    A small face of area A at distance r and depth d along the camera's axis, seen under the angle a to its normal,
    shows A cos(a) f^2 r / d^3 pixels; the thing is taken for the top and the narrower side of its box, as far as its
    shape fills them, and only as far as it reaches above the height from which on the area is seen.
    """
    camera = goal_camera(place)
    eye, forward = np.array(camera.position), camera.rotation()[2]
    flat = area.lattice(max(area.half)).reshape(-1, 2)
    away = area.to_room(np.column_stack([flat, np.full(len(flat), size[2] / 2)])) - eye
    r = arithmetic.length(away)
    depth = np.maximum(arithmetic.dot(away, forward), 0.1)
    from_above, from_beside = fill_ratios(type_)
    top = from_above * size[0] * size[1] * np.maximum(-away[:, 2], 0.0) / r
    raised = max(size[2] - area.seen_from_m, 0.0)
    side = from_beside * min(size[0], size[1]) * raised * arithmetic.length(away[:, :2]) / r
    return float(np.median((top * (area.seen_from_m == 0.0) + side) * (FRAME_PX / 2) ** 2 * r / depth**3))


def _fits(area: Area, place: HidingPlace, type_: str, size: Vec3) -> tuple[int, float]:
    """How many things of a size can lie in an area and are seen there, and how many pixels each shows at least."""
    rules = hiding_rules()
    if size[2] <= area.seen_from_m:
        return 0, 0.0
    grown = 1.0 + rules.size_spread
    smallest = (size[0] / grown**2, size[1] / grown**2, size[2] / grown**2)
    pixels = visible_pixels(place, area, type_, smallest)
    if pixels < rules.pixel_margin * rules.min_evidence_px:
        return 0, 0.0
    return area.capacity(size, rules.gap_m), pixels
