"""Which object each pixel shows, and how far away it is, against Embree."""

from __future__ import annotations

import pytest

from remqa_data.sim.render.camera import Camera, TopDownCamera
from remqa_data.sim.render.renderer import Renderer
from tests.helpers.embree_oracle import compare, trace
from tests.helpers.meshes import furnished_room

CAMERAS = {
    "corner": Camera((0.3, 0.3, 1.576), 45, 30),
    "wall": Camera((2.5, 0.2, 1.576), 90, 0),
    "low": Camera((4.6, 3.6, 0.3), 220, -10),
    "narrow": Camera((0.3, 3.7, 2.0), -30, 25, fov_deg=40, width=400, height=240),
    "map": TopDownCamera((2.5, 2.0), 2.0, 5.0),
}


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_room_agrees_with_embree(seed):
    parts, poses = furnished_room(seed)
    renderer = Renderer(parts, poses)
    for name, camera in CAMERAS.items():
        agreement = compare(renderer.render(camera), *trace(parts, poses, camera))
        assert agreement.other_instance <= 1e-4, name
        assert agreement.depth_error_p999_m < 1e-3, name
