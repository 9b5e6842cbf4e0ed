"""What is seen before and after a manipulation, and what it brings to light."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from remqa_data.geometry.types import F32, F64
from remqa_data.sim.metadata import ObjectMetadata
from remqa_data.sim.physics.world import Snapshot
from remqa_data.sim.render.camera import Camera
from remqa_data.sim.render.view import Observation

Looks = tuple[tuple[Camera, F32], ...]
"""Cameras and what they see as depth images."""


class Views(NamedTuple):
    """What is seen from a goal pose before and after a manipulation, and what the manipulation does.

    `motion` holds the (4, 4) motions of the object's links, `revealed` the (2, 3) boxes of what comes to light, `state` the
    room afterwards, and `records` what is known of it.
    """

    before: Observation
    after: Observation
    motion: F64
    revealed: tuple[F64, ...]
    state: Snapshot
    records: Mapping[str, ObjectMetadata]
