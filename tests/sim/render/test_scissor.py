"""A part of a picture, and of a shadow map, is what the whole one shows there."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from remqa_data.opencv import cv2
from remqa_data.sim.render.camera import AnyCamera, Camera, Scissor, TopDownCamera, scissor_around
from remqa_data.sim.render.renderer import Renderer
from tests.helpers.meshes import at, furnished_room

LAMP = (2.5, 2.0, 2.4)
CAMERAS = (
    Camera((0.4, 0.5, 1.5), 40, 20, width=120, height=90),
    Camera((4.2, 3.1, 1.2), 200, 45, width=120, height=90),
    TopDownCamera((2.5, 2.0), 2.2, 5.0, 120, 90),
)
BORDER_PX = 2
"""Pixels so near to the border of a scissor may be smoothed otherwise."""

sides = st.tuples(st.integers(0, 119), st.integers(0, 119), st.integers(0, 89), st.integers(0, 89))


@pytest.fixture(scope="module")
def renderer() -> Renderer:
    parts, poses = furnished_room(3)
    return Renderer(parts, poses, lights=[LAMP])


@pytest.mark.slow
@pytest.mark.parametrize("camera", CAMERAS)
@given(sides)
def test_within_a_scissor_all_is_as_in_the_whole_picture(
    renderer: Renderer, camera: AnyCamera, sides: tuple[int, int, int, int]
) -> None:
    scissor = Scissor(*sorted(sides[:2]), *sorted(sides[2:]))
    whole, cut = renderer.render(camera), renderer.render(camera, scissor=scissor)
    assert len(np.unique(whole.instances)) > 5
    inside = np.zeros((90, 120), dtype=bool)
    inside[scissor.top : scissor.bottom + 1, scissor.left : scissor.right + 1] = True
    assert np.array_equal(cut.depth, np.where(inside, whole.depth, 0))
    assert np.array_equal(cut.instances, np.where(inside, whole.instances, -1))
    assert not cut.rgb[~inside].any()
    near = np.ones((90 + 2, 120 + 2), dtype=np.uint8)  # the border of the picture is none of the scissor's
    near[1:-1, 1:-1] = inside
    inner = cv2.erode(near, np.ones((2 * BORDER_PX + 1,) * 2, dtype=np.uint8))[1:-1, 1:-1] > 0
    assert np.array_equal(cut.rgb[inner], whole.rgb[inner])
    assert np.array_equal(renderer.render_depth(camera, scissor=scissor), cut.depth)
    labels = renderer.labels_of_surfaces(np.arange(61, dtype=np.int32))
    assert np.array_equal(renderer.render_labels(camera, labels, scissor=scissor), cut.instances)


@pytest.mark.slow
@pytest.mark.parametrize("camera", CAMERAS)
def test_shadows_of_what_moved_and_came_back_are_those_of_a_new_room(camera: AnyCamera) -> None:
    parts, poses = furnished_room(4)
    renderer, rng = Renderer(parts, poses, lights=[LAMP]), np.random.default_rng(0)
    first = renderer.render(camera)
    now = np.array(poses)
    for _ in range(12):
        part = int(rng.integers(1, len(parts)))
        if rng.random() < 0.3:
            renderer.set_visible(part, False)
            renderer.render(camera)
            renderer.set_visible(part, True)
        now[part] = at(*rng.uniform((0.3, 0.3, 0.2), (4.7, 3.7, 2.5)), rng.uniform(0, 360))
        renderer.set_pose(part, now[part])
        moved = renderer.render(camera)
    fresh = Renderer(parts, now, lights=[LAMP])
    assert np.array_equal(moved.rgb, fresh.render(camera).rgb)
    for ours, theirs in zip(renderer._shadows[:2], fresh._shadows[:2], strict=True):
        assert np.array_equal(ours, theirs)
    renderer.set_poses(range(len(parts)), poses)
    assert np.array_equal(renderer.render(camera).rgb, first.rgb)
    assert not np.array_equal(first.rgb, moved.rgb)


def test_a_scissor_around_points_shows_them_all_and_little_more(renderer: Renderer) -> None:
    camera, rng = CAMERAS[0], np.random.default_rng(1)
    points = camera.unproject(np.full((90, 120), 2.0))[30:50, 40:70].reshape(-1, 3)
    assert scissor_around(camera.view(), points) == (39, 70, 29, 50)
    assert scissor_around(camera.view(), points, 50) == (0, 119, 0, 89)
    whole = Scissor.whole(120, 90)
    assert scissor_around(camera.view(), np.vstack([points, np.add(camera.position, 1e-3)])) == whole
    behind = camera.unproject(np.full((90, 120), -2.0)).reshape(-1, 3)
    assert scissor_around(camera.view(), behind[rng.integers(len(behind), size=5)]) == whole
    beside = camera.unproject(np.full((90, 120), 2.0))[40, 119] * 3 - points[0] * 2
    scissor = scissor_around(camera.view(), beside[None])
    assert (scissor.left, scissor.right) == (120, 119)  # nothing of it is in the picture
    assert not renderer.render(camera, scissor=scissor).depth.any()
    assert not renderer.render_depth(camera, scissor=scissor).any()


@pytest.mark.parametrize("scissor", [(0, 120, 0, 5), (-1, 3, 0, 5), (9, 7, 0, 5), (0, 3, 0, 90), (0, 3, 8, 6)])
def test_what_is_no_part_of_the_picture_is_refused(renderer: Renderer, scissor: tuple[int, int, int, int]) -> None:
    with pytest.raises(ValueError, match=r"is no part of 120 x 90 pixels"):
        renderer.render_depth(CAMERAS[0], scissor=Scissor(*scissor))


def test_a_scissor_may_be_a_tuple(renderer: Renderer) -> None:
    cut = renderer.render(CAMERAS[0], scissor=(20, 60, 10, 50))  # type: ignore[arg-type]
    assert np.array_equal(cut.rgb, renderer.render(CAMERAS[0], scissor=Scissor(20, 60, 10, 50)).rgb)
