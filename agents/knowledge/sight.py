"""Where an object that the agent remembers is in what it sees now."""

from __future__ import annotations

import numpy as np

from remqa_data.agents.knowledge.instance import Instance
from remqa_data.geometry.types import F32, F64, Flags
from remqa_data.sim.render.camera import Camera

SLACK_M = 0.003
"""Depth and boxes are exact to a millimetre: what is farther outside the box is something else, and neighbours are near."""


def seen_of(instance: Instance, depth: F32, camera: Camera) -> Flags:
    """(h, w) which pixels show an object: those whose depth puts them into its remembered box.

    Parameters
    ----------
    instance : Instance
        The object.
    depth : (h, w) float32
        Metres along the camera's forward axis, 0 where nothing is.
    camera : Camera
        The agent's own.
    """
    return seen_within(np.array(instance.box[:3]) - SLACK_M, np.array(instance.box[3:]) + SLACK_M, depth, camera)


def seen_within(low: F64, high: F64, depth: F32, camera: Camera) -> Flags:
    """(h, w) which pixels of a depth image, see `seen_of`, lie in the box between two corners, metres."""
    points = camera.unproject(depth)
    return np.asarray((depth > 0) & np.all((points >= low) & (points <= high), axis=-1))
