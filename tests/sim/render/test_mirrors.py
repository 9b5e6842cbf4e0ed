"""Mirrors against rays that are reflected and met with boxes one by one."""

from dataclasses import replace

import numpy as np
import pytest

from remqa_data.assets.core.model import AssetSpec, Material
from remqa_data.scene import Scene, SceneObject, StructureBox
from remqa_data.sim.physics.world import World
from remqa_data.sim.render import room_mirrors
from remqa_data.sim.render.camera import Camera, Scissor
from remqa_data.sim.render.view import Observation, WorldView

RED, GREEN, BLUE, WHITE, YELLOW = (
    Material("plastic", color, rgb)
    for color, rgb in (
        ("red", (0.8, 0.25, 0.2)),
        ("green", (0.25, 0.7, 0.3)),
        ("blue", (0.25, 0.35, 0.8)),
        ("white", (0.8, 0.8, 0.8)),
        ("yellow", (0.85, 0.8, 0.15)),
    )
)
FINISHES = (RED, GREEN, BLUE, YELLOW, WHITE)
BUILDING = (
    StructureBox("wall", (-2, -1.6, 0, 2, -1.5, 2.5), RED),
    StructureBox("wall", (2, -1.5, 0, 2.1, 1.5, 2.5), BLUE),
    StructureBox("wall", (-2.1, -1.5, 0, -2, 1.5, 2.5), GREEN),
    StructureBox("wall", (-2, 1.5, 0, 2, 1.6, 2.5), WHITE),
    StructureBox("floor", (-2, -1.5, -0.1, 2, 1.5, 0), WHITE),
    StructureBox("ceiling", (-2, -1.5, 2.5, 2, 1.5, 2.6), WHITE),
    StructureBox("wall", (0.5, -1.2, 0, 0.8, -0.9, 2.5), YELLOW),
)
MIRROR = SceneObject("Mirror|1", AssetSpec("Mirror", (1.0, 0.05, 0.8), 3, 1), (0.0, 1.475, 1.4))
FRIDGE = SceneObject("Fridge|1", AssetSpec("Fridge", (0.6, 0.6, 1.4), 0, 1), (-1.5, 1.15, 0.7))
MUG = SceneObject("Mug|1", AssetSpec("Mug", (0.1, 0.09, 0.1), 1, 5, levels=(0.01,)), (0.3, -0.5, 0.05), is_fixed=False)
AHEAD = Camera((0.1, 0.3, 1.4), 90.0, width=120, height=120)
ASIDE = Camera.look_at((-0.9, 0.7, 1.5), (0.0, 1.45, 1.4), width=120, height=120)
FAR = Camera.look_at((-1.2, -0.8, 1.6), (0.0, 1.45, 1.4), fov_deg=45.0, width=120, height=120)
ROOM = Scene(
    "Test", "bathroom", (-2.0, -1.5, 2.0, 1.5), 0.0, 2.5, ((0.0, 0.0, 2.4),), BUILDING, (MIRROR, FRIDGE), light="baked"
)


def seen(scene: Scene, camera: Camera) -> Observation:
    with World(scene) as world:
        return WorldView(world).render(camera)


def glass(frame: Observation, camera: Camera) -> np.ndarray:
    """(h, w) which pixels show the glass, well within its frame."""
    x, _, z = np.moveaxis(camera.unproject(frame.depth), 2, 0)
    return (frame.objects == 0) & (abs(x) < 0.38) & (z > 1.12) & (z < 1.56)


def met(origin: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """(n,) number of the first box of the building that rays meet, by the slab method."""
    distances = []
    for part in BUILDING:
        with np.errstate(divide="ignore"):
            sides = (np.array(part.box).reshape(2, 1, 3) - origin) / direction
        enters, leaves = sides.min(axis=0).max(axis=1), sides.max(axis=0).min(axis=1)
        distances.append(np.where((enters < leaves) & (enters > 1e-6), enters, np.inf))
    return np.argmin(distances, axis=0)


def expected(frame: Observation, camera: Camera) -> np.ndarray:
    """(h, w) finish that each glass pixel shows, else -1: the ray from the eye, thrown back by the wall's plane."""
    mask = glass(frame, camera)
    at = camera.unproject(frame.depth)[mask]
    numbers = np.full(mask.shape, -1)
    numbers[mask] = [FINISHES.index(BUILDING[box].finish) for box in met(at, (at - camera.position) * [1, -1, 1])]
    return numbers


def shown(frame: Observation) -> np.ndarray:
    """(h, w) which of the finishes but white the hue of each pixel is nearest to, in the light and in a shadow."""
    pixels, colours = hue(frame.rgb / 255.0), hue(np.array([finish.rgb for finish in FINISHES[:-1]]))
    return np.argmin(np.square(pixels[:, :, None] - colours).sum(axis=3), axis=2)


def hue(rgb: np.ndarray) -> np.ndarray:
    """Shares of linear red, green and blue in what is left of a colour when its grey is taken away."""
    light = np.square(rgb)
    light = light - light.min(axis=-1, keepdims=True)
    return light / np.maximum(light.sum(axis=-1, keepdims=True), 1e-9)


def agreement(boxes: np.ndarray, colours: np.ndarray) -> float:
    """Share of the glass pixels that look as they should, or as the pixel to the left or right should.

    White ones do not count: all light on them has a hue.
    """
    is_like = np.any([np.roll(boxes, step, axis=1) == colours for step in (-1, 0, 1)], axis=0)
    return float(is_like[(boxes >= 0) & (boxes != FINISHES.index(WHITE))].mean())


def test_what_stands_opposite_is_seen_from_ahead_and_the_wall_beside_it_from_aside() -> None:
    for camera, finish in ((AHEAD, RED), (ASIDE, BLUE)):
        frame = seen(ROOM, camera)
        mask = glass(frame, camera)
        assert np.bincount(expected(frame, camera)[mask]).argmax() == FINISHES.index(finish)
        assert np.bincount(shown(frame)[mask]).argmax() == FINISHES.index(finish)
        level = np.square(frame.rgb[mask] / 255.0).mean(axis=0)
        assert level.argmax() == np.argmax(finish.rgb)
        assert level.max() > 1.5 * np.median(level)


@pytest.mark.parametrize("camera", [AHEAD, ASIDE, FAR], ids=["ahead", "aside", "far"])
def test_each_pixel_shows_what_its_ray_meets_when_it_is_thrown_back(camera: Camera) -> None:
    frame = seen(ROOM, camera)
    boxes = expected(frame, camera)
    assert (np.unique(boxes[boxes >= 0], return_counts=True)[1] > 80).sum() >= 2
    assert agreement(boxes, shown(frame)) > 0.98


def test_a_picture_that_is_not_turned_left_to_right_would_be_told_from_it() -> None:
    frame = seen(ROOM, AHEAD)
    boxes = expected(frame, AHEAD)
    columns = np.flatnonzero((boxes >= 0).any(axis=0))
    across = slice(columns[0], columns[-1] + 1)
    assert agreement(boxes[:, across][:, ::-1], shown(frame)[:, across]) < 0.85


def test_nothing_that_lies_about_and_no_open_door_is_in_a_mirror() -> None:
    littered = ROOM.with_objects((MIRROR, replace(FRIDGE, openness=1.0), MUG))
    frame, other = seen(ROOM, AHEAD), seen(littered, AHEAD)
    mask = glass(frame, AHEAD)
    assert np.array_equal(frame.rgb[mask], other.rgb[mask])
    first = room_mirrors.room_mirrors(ROOM)
    room_mirrors._taken.cache_clear()
    again = room_mirrors.room_mirrors(littered)
    assert again is not first
    assert first.texels.tobytes() == again.texels.tobytes()
    assert first.frames.tobytes() == again.frames.tobytes()
    closed_and_fixed = ROOM.with_objects((MIRROR, FRIDGE, replace(MUG, is_fixed=True)))
    assert room_mirrors.room_mirrors(closed_and_fixed).texels.tobytes() != first.texels.tobytes()


def test_direct_light_knows_of_no_mirror_and_depth_and_ids_know_of_none_at_all() -> None:
    baked, direct = seen(ROOM, AHEAD), seen(replace(ROOM, light="direct"), AHEAD)
    assert np.array_equal(baked.depth, direct.depth)
    assert np.array_equal(baked.objects, direct.objects)
    mask = glass(direct, AHEAD)
    repainted = (replace(BUILDING[0], finish=BLUE), *BUILDING[1:])
    other = seen(replace(ROOM, light="direct", structure=repainted), AHEAD)
    assert np.array_equal(direct.rgb[mask], other.rgb[mask])
    assert not np.array_equal(direct.rgb[mask], baked.rgb[mask])


def test_a_room_without_mirrors_has_no_maps() -> None:
    made = room_mirrors.room_mirrors(ROOM.with_objects((FRIDGE,)))
    assert made.objects == ()
    assert made.texels.size == 0


def test_a_part_of_a_picture_shows_mirrors_as_the_whole_one_does() -> None:
    with World(ROOM) as world:
        view = WorldView(world)
        for camera in (AHEAD, ASIDE, FAR):
            whole = view.render(camera)
            assert np.count_nonzero(whole.objects == world.ids.index("Mirror|1")) > 500
            for left in range(3, 60, 7):
                cut = view.render(camera, scissor=Scissor(left, left + 50, 20, 100))
                inside = slice(22, 99), slice(left + 2, left + 49)  # without the border, which is not smoothed
                assert np.array_equal(cut.rgb[inside], whole.rgb[inside])
