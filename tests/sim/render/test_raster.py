"""What the renderer draws, against geometry worked out by hand."""

from __future__ import annotations

import hashlib
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from remqa_data.sim.render import scene_arrays
from remqa_data.sim.render.camera import Camera, TopDownCamera
from remqa_data.sim.render.mipmap import levels
from remqa_data.sim.render.renderer import Renderer, RenderPart
from remqa_data.sim.render.scene_arrays import solid_faces
from tests.helpers.meshes import GREY, at, box, from_trimesh, furnished_room, quad, sphere

LAMP = (0.0, 0.0, 2.4)
GLOWING = replace(GREY, rgb=(1.0, 1.0, 1.0), glow=1.0)
BLACK = (0.0, 0.0, 0.0)


def render(surfaces, camera, **options):
    """A frame of a scene in which every surface is a part of its own."""
    parts = [RenderPart((surface,), instance) for instance, surface in enumerate(surfaces)]
    poses = np.tile(np.eye(4), (len(parts), 1, 1))
    return Renderer(parts, poses, lights=[LAMP], background=BLACK).render(camera, **options)


def test_cube_covers_the_pixels_that_its_front_face_does():
    cube = Renderer([RenderPart((box((0.96, 0.96, 0.96)),), 7)], [at(2.48, 0, 0)])
    frame = cube.render(Camera((0, 0, 0), 0))
    # The front face is 2 m away and 0.96 m wide: 0.96 / 2 * 150 = 72 pixels, from 114 to 186.
    expected = np.full((300, 300), -1)
    expected[114:186, 114:186] = 7
    np.testing.assert_array_equal(frame.instances, expected)
    np.testing.assert_allclose(frame.depth[expected == 7], 2.0, atol=1e-6)
    assert (frame.depth[expected == -1] == 0).all()


def test_depth_of_a_slanted_plane_is_exact():
    plane = quad((1.0, -20, -20), (8.0, 40, 0), (0, 0, 40))
    camera = Camera((0, 0, 0), 0)
    points = camera.unproject(render([plane], camera).depth)
    # The plane holds the points with x = 1 + (y + 20) / 5.
    error = points[..., 0] - 1 - (points[..., 1] + 20) / 5
    assert np.abs(error).max() < 1e-4


def test_floor_that_passes_under_the_camera_is_not_torn_at_the_near_plane():
    floor = quad((-30, -30, 0), (60, 0, 0), (0, 60, 0))
    frame = render([floor], Camera((0.1, 0.2, 0.3), 33))
    rows = np.arange(150, 300) + 0.5 - 150
    np.testing.assert_array_equal(frame.instances[154:], 0)
    np.testing.assert_array_equal(frame.instances[:150], -1)
    # A pixel r rows under the horizon looks down at r / 150: it meets the floor 0.3 m below at depth 45 / r.
    np.testing.assert_allclose(frame.depth[170:], np.tile(45.0 / rows[20:, None], (1, 300)), rtol=1e-5)


def test_nothing_nearer_than_the_near_plane_is_drawn():
    near, far = quad((0.015, -1, -1), (0, 2, 0), (0, 0, 2)), quad((0.025, -1, -1), (0, 2, 0), (0, 0, 2))
    assert (render([near], Camera((0, 0, 0), 0)).instances == -1).all()
    assert (render([far], Camera((0, 0, 0), 0)).instances == 0).all()


def test_camera_inside_a_solid_sees_its_inside():
    frame = render([box((1.0, 1.0, 1.0))], Camera((0.1, 0, 0), 0, 20))
    assert (frame.instances == 0).all()
    assert frame.depth.max() < 1.0


def test_map_cuts_off_what_is_above_it_and_shows_the_inside_of_what_it_cuts():
    floor, tall, low = (
        quad((-3, -3, 0), (6, 0, 0), (0, 6, 0)),
        box((1, 1, 6)),
        quad((-2, -2, 0.5), (0.5, 0, 0), (0, 0.5, 0)),
    )
    frame = render([floor, tall, low], TopDownCamera((0, 0), 2.0, 6.0))
    # 50 pixels a metre, y up; the tall box's bottom, at z = -3, lies under the floor.
    assert frame.instances[150, 150] == 0
    assert frame.instances[int((3 + 1.75) * 50), int((3 - 1.75) * 50)] == 2
    assert frame.depth[10, 10] == pytest.approx(2.0, abs=1e-5)
    assert frame.depth[int((3 + 1.75) * 50), int((3 - 1.75) * 50)] == pytest.approx(1.5, abs=1e-5)


def test_faces_that_share_an_edge_leave_no_gap_and_no_pixel_to_what_is_behind():
    rng = np.random.default_rng(3)
    ball = sphere(1.0, subdivisions=4)
    for _ in range(10):
        eye = rng.normal(size=3)
        eye *= 1.3 / np.linalg.norm(eye)
        frame = render([ball, box((0.5, 0.5, 0.5))], Camera.look_at(tuple(eye), (0, 0, 0)))
        assert (frame.instances != 1).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    "camera", [Camera((0.4, 0.4, 1.5), 45, 25), TopDownCamera((2.5, 2.0), 2.3, 5.0)], ids=["room", "map"]
)
def test_antialiasing_changes_colours_at_edges_only_and_no_depth_or_instance(camera):
    parts, poses = furnished_room(1)
    renderer = Renderer(parts, poses, lights=[(2.5, 2.0, 2.4)])
    sharp, smooth = (renderer.render(camera, antialias=on) for on in (False, True))
    np.testing.assert_array_equal(sharp.depth, smooth.depth)
    np.testing.assert_array_equal(sharp.instances, smooth.instances)
    changed = (sharp.rgb != smooth.rgb).any(axis=2)
    assert 0.005 < changed.mean() < 0.3


def test_instances_alone_are_those_of_the_whole_frame():
    parts, poses = furnished_room(1)
    renderer = Renderer(parts, poses)
    camera = Camera((0.4, 0.4, 1.5), 45, 25)
    depth, instances = renderer.render_instances(camera)
    frame = renderer.render(camera)
    np.testing.assert_array_equal(depth, frame.depth)
    np.testing.assert_array_equal(instances, frame.instances)


def test_antialiased_edge_is_as_bright_as_the_share_of_the_pixel_that_it_covers():
    # White right of a line that passes through the middle of the image and moves 0.37 pixels a row.
    slope = 0.37
    half_plane = quad((1.0, 10 * slope, -10), (0, -30, 0), (0, -20 * slope, 20), GLOWING)
    frame = render([half_plane], Camera((0, 0, 0), 0, width=100, height=100))
    light = (frame.rgb[..., 0] / 255.0) ** 2
    # At 1 m depth a metre is 50 pixels; y is to the left and z up, so the line is x - 50 = -0.37 (y - 50).
    x, y = np.meshgrid((np.arange(1600) + 0.5) / 16, (np.arange(1600) + 0.5) / 16)
    covered = x - 50 > -slope * (y - 50)
    coverage = covered.reshape(100, 16, 100, 16).mean(axis=(1, 3))
    # Four samples: off by up to a quarter, and a little more where the line cuts off a corner.
    assert np.abs(light - coverage).max() < 0.3
    assert abs((light - coverage).mean()) < 2e-4
    sharp = render([half_plane], Camera((0, 0, 0), 0, width=100, height=100), antialias=False)
    jagged = (sharp.rgb[..., 0] / 255.0) ** 2
    assert np.square(light - coverage).sum() < 0.25 * np.square(jagged - coverage).sum()


def test_floor_under_a_bar_shows_in_the_pixels_that_the_bar_covers_in_part():
    floor = quad((0, -30, 0), (60, 0, 0), (0, 60, 0), GLOWING)
    # 2 m ahead and 75 pixels a metre: the lower edge is 60.6 pixels under the horizon. In its pixel row the floor is
    # farther than in the next row, and hidden at the centre.
    bar = quad((2.0, 1.0, 1 - 60.6 / 75), (0, -2, 0), (0, 0, 0.1), replace(GLOWING, rgb=BLACK))
    frame = render([floor, bar], Camera((0, 0, 1), 0))
    light = (frame.rgb[208:213, 150, 0] / 255.0) ** 2
    np.testing.assert_allclose(light, [0.0, 0.0, 0.5, 1.0, 1.0], atol=0.01)  # 2 of 4 samples lie below 0.6 of a pixel


def test_far_checker_board_fades_to_its_mean_instead_of_flickering(monkeypatch):
    checker = np.kron(np.indices((64, 64)).sum(axis=0) % 2, np.ones((4, 4)))[..., None] * np.array([255, 255, 255])
    monkeypatch.setattr(scene_arrays, "_texels", lambda name: levels(checker.astype(np.uint8)))
    board = replace(GLOWING, texture="tile")
    floor = quad((0, -40, 0), (80, 0, 0), (0, 80, 0), board, 80.0)
    pictures = [
        render([floor], Camera((0.3, shift, 1.0), 0, 10), antialias=False).rgb[..., 0].astype(float)
        for shift in (0.0, 0.011, 0.023)
    ]
    far = slice(140, 150)  # 25 to 80 m away: a pixel covers more than a square
    assert np.abs(pictures[0][far] - 127).max() < 6
    assert max(np.abs(p - pictures[0])[far].max() for p in pictures) < 4
    near = slice(280, 300)
    assert pictures[0][near].std() > 60


def test_shadow_falls_where_the_lamp_the_plate_and_the_floor_say():
    floor = quad((-2, -2, 0), (4, 0, 0), (0, 4, 0))
    plate = quad((-0.2, -0.2, 1.2), (0.4, 0, 0), (0, 0.4, 0))
    camera = TopDownCamera((0, 0), height_m=1.1, extent_m=4.0, width=400, height=400)
    dark, bright = (render([floor, plate], camera, shadows=on).rgb[..., 0].astype(int) for on in (True, False))
    # The lamp is 2.4 m above the floor and the plate half way: the shadow is twice as wide, 0.8 m or 80 pixels.
    ratio = dark / bright
    assert (ratio[165:235, 165:235] < 0.8).all()
    outside = np.ones((400, 400), dtype=bool)
    outside[155:245, 155:245] = False
    assert (ratio[outside] == 1.0).all()
    edge = np.abs(np.flatnonzero(np.diff((ratio[200] < 0.9).astype(int))) - np.array([159.5, 239.5]))
    assert edge.max() <= 1.5


def test_empty_room_and_ball_have_no_shadow_where_nothing_is_in_the_way():
    ball = Renderer([RenderPart((sphere(0.5, subdivisions=4),), 0)], [at(0, 0, 1.0)], lights=[LAMP])
    camera = Camera((0, 0, 2.39), 0, 90)
    with_shadows, without = ball.render(camera), ball.render(camera, shadows=False)
    assert np.abs(with_shadows.rgb.astype(int) - without.rgb).max() <= 2


def test_moved_part_and_its_shadow_move():
    floor = RenderPart((quad((-2, -2, 0), (4, 0, 0), (0, 4, 0)),), 0)
    plate = RenderPart((quad((-0.2, -0.2, 0), (0.4, 0, 0), (0, 0.4, 0)),), 1)
    renderer = Renderer([floor, plate], [np.eye(4), at(0, 0, 1.2)], lights=[LAMP])
    camera = TopDownCamera((0, 0), 2.0, 4.0, 400, 400)
    before = renderer.render(camera)
    renderer.set_pose(1, at(0.5, 0.25, 1.2))
    after = renderer.render(camera)
    assert np.argwhere(before.instances == 1).mean(axis=0) == pytest.approx([199.5, 199.5], abs=0.6)
    assert np.argwhere(after.instances == 1).mean(axis=0) == pytest.approx([174.5, 249.5], abs=0.6)
    fresh = Renderer([floor, plate], [np.eye(4), at(0.5, 0.25, 1.2)], lights=[LAMP]).render(camera)
    np.testing.assert_array_equal(after.rgb, fresh.rgb)


def test_hidden_part_is_not_drawn_and_casts_no_shadow():
    floor = RenderPart((quad((-2, -2, 0), (4, 0, 0), (0, 4, 0)),), 0)
    ball = RenderPart((sphere(0.3),), 1)
    camera = TopDownCamera((0, 0), 2.2, 4.0)
    renderer = Renderer([floor, ball], [np.eye(4), at(0, 0, 0.5)], lights=[LAMP])
    shown = renderer.render(camera)
    renderer.set_visible(1, False)
    hidden = renderer.render(camera)
    alone = Renderer([floor], [np.eye(4)], lights=[LAMP]).render(camera)
    assert (shown.instances == 1).any()
    np.testing.assert_array_equal(hidden.rgb, alone.rgb)
    renderer.set_visible(1, True)
    np.testing.assert_array_equal(renderer.render(camera).rgb, shown.rgb)


def test_glowing_surface_shows_its_own_colour_and_both_sides_of_a_sheet_are_lit():
    glow = replace(GREY, rgb=(0.2, 0.5, 0.9), glow=1.0)
    frame = render([quad((1, -2, -2), (0, 4, 0), (0, 0, 4), glow)], Camera((0, 0, 0), 0))
    np.testing.assert_allclose(frame.rgb[150, 150] / 255, glow.rgb, atol=0.005)
    sheets = [quad((1, -2, -2), (0, 4, 0), (0, 0, 4)), quad((1, -2, -2), (0, 0, 4), (0, 4, 0))]
    front, back = (render([sheet], Camera((0, 0, 0), 0), shadows=False).rgb for sheet in sheets)
    np.testing.assert_array_equal(front, back)


def test_picture_of_a_room_is_neither_murky_nor_burnt_out():
    parts, poses = furnished_room(5)
    frame = Renderer(parts, poses, lights=[(2.5, 2.0, 2.4)]).render(Camera((0.4, 0.4, 1.576), 45, 15))
    assert 0.4 < frame.rgb.mean() / 255 < 0.65
    assert frame.rgb.max(axis=2).min() > 15


def test_only_closed_outward_meshes_count_as_solid():
    cube = trimesh.creation.box()
    inside_out = cube.copy()
    inside_out.invert()
    open_box = cube.submesh([np.arange(11)], append=True)
    assert solid_faces(from_trimesh(cube)).all()
    assert solid_faces(sphere(1.0)).all()
    assert not solid_faces(from_trimesh(inside_out)).any()
    assert not solid_faces(from_trimesh(open_box)).any()
    both = from_trimesh(trimesh.util.concatenate([cube, open_box.apply_translation((3, 0, 0))]))
    np.testing.assert_array_equal(solid_faces(both), [True] * 12 + [False] * 11)


@pytest.mark.parametrize("lamps", [0, 4])
def test_one_to_three_lamps(lamps):
    with pytest.raises(ValueError, match="one to three lamps"):
        Renderer([], np.empty((0, 4, 4)), lights=[LAMP] * lamps)


def test_scene_without_parts_is_all_background():
    frame = Renderer([], np.empty((0, 4, 4)), background=(1.0, 0.0, 0.0)).render(Camera((0, 0, 0), 0))
    assert (frame.rgb == (255, 0, 0)).all()
    assert (frame.instances == -1).all()


def test_wide_and_odd_frames_are_drawn_to_the_border():
    floor = quad((-30, -30, 0), (60, 0, 0), (0, 60, 0))
    for width, height in ((641, 37), (1, 1), (319, 200)):
        frame = render([floor], Camera((0, 0, 1), 0, 90, width=width, height=height))
        assert frame.rgb.shape == (height, width, 3)
        assert (frame.instances == 0).all()
        assert (frame.rgb > 0).all()


DIGEST = """
from tests.sim.render.test_raster import digest
print(digest())
"""


def digest():
    """Hash of one frame of a furnished room."""
    parts, poses = furnished_room(2)
    frame = Renderer(parts, poses, lights=[(2.5, 2.0, 2.4), (1.0, 1.0, 2.4)]).render(Camera((0.4, 0.4, 1.5), 45, 25))
    return hashlib.sha256(frame.rgb.tobytes() + frame.depth.tobytes() + frame.instances.tobytes()).hexdigest()


@pytest.mark.slow
def test_another_process_draws_the_same_bytes():
    command = [sys.executable, "-c", DIGEST]
    other = subprocess.run(command, capture_output=True, text=True, check=True, cwd=Path(__file__).parents[3])
    assert other.stdout.strip() == digest()
