"""Baked light against what is known of it: closed rooms whose light has a formula, and paths traced by another library."""

import numpy as np
import pytest
import trimesh

from remqa_data.floorplans.ithor.scenes import load_scene
from remqa_data.sim.light import bake as bake_module
from remqa_data.sim.light.bake import GLOW, SKY, VOXEL, Lamps, _directions, _empty, bake
from remqa_data.sim.light.gather import gather
from remqa_data.sim.light.patches import light_faces, patches, sample_of
from remqa_data.sim.light.volume import BEYOND, IN_AIR, NEAR_SURFACE, Volume, light_at, places_of
from remqa_data.sim.light.voxels import Faces, surface_points, voxelise
from remqa_data.sim.navigation.grid import reachable_grid
from remqa_data.sim.physics.world import World
from remqa_data.sim.render.renderer import room_lights
from remqa_data.sim.render.room_light import LEVEL, _asked, _balanced, _exposed, static_faces

NO_LAMPS = Lamps(np.zeros((0, 3)), np.zeros(0, np.float32), 4.0)


def room(*, albedo: float, glow: float = 0.0, lit: str = "all") -> Faces:
    """A box of 4 x 3 x 2.5 m that looks inwards; what is lit glows."""
    mesh = trimesh.creation.box((4.0, 3.0, 2.5))
    mesh.invert()
    corners = mesh.triangles.astype(np.float32)
    normals = trimesh.triangles.normals(corners)[0].astype(np.float32)
    glows = np.full(12, glow, np.float32)
    if lit == "ceiling":
        glows[normals[:, 2] > -0.5] = 0.0
    count = len(corners)
    return Faces(
        corners,
        normals,
        np.full((count, 3), albedo, np.float32),
        glows,
        np.zeros(count, dtype=np.bool_),
        np.zeros((count, 3), np.float32),
    )


def received(volume: Volume, at: tuple[float, float, float], normal: tuple[float, float, float]) -> np.ndarray:
    out = np.zeros(3, np.float32)
    if not light_at(volume, *at, *normal, out):
        out[:] = volume.least  # as what is drawn there
    return out


def test_points_cover_each_face_by_its_area() -> None:
    faces = room(albedo=0.5)
    points = surface_points(faces)
    areas = np.bincount(points.face, weights=points.area, minlength=12)
    assert areas == pytest.approx(trimesh.triangles.area(faces.corners), rel=1e-5)
    assert len(points.face) >= areas.sum() / 0.025**2


@pytest.mark.slow
def test_in_an_evenly_glowing_room_every_surface_receives_the_same() -> None:
    volume = bake(room(albedo=0.5, glow=1.0), NO_LAMPS, (-2, -1.5, -1.25), (2, 1.5, 1.25), 0.4)
    for at, normal in (((0, 0, -1.25), (0, 0, 1)), ((1.9, 1.4, -1.2), (-1, 0, 0)), ((0, 1.5, 0), (0, -1, 0))):
        assert received(volume, at, normal) == pytest.approx([0.4] * 3, rel=0.01)


@pytest.mark.slow
def test_a_glowing_ceiling_lights_what_is_below_it_as_view_factors_say() -> None:
    """A dark room of 4 x 3 m: what looks up receives by the configuration factor of the ceiling 2.5 m and 1.25 m above."""
    volume = bake(room(albedo=1e-3, glow=1.0, lit="ceiling"), NO_LAMPS, (-2, -1.5, -1.25), (2, 1.5, 1.25), 0.4)
    low, middle = (received(volume, (0, 0, z), (0, 0, 1))[0] for z in (-1.25, 0.0))
    assert low / middle == pytest.approx(_above(2.5) / _above(1.25), rel=0.05)


def _above(height_m: float) -> float:
    """Configuration factor of a rectangle of 4 x 3 m over its middle: four times that over a corner (Howell, B-4)."""
    x, y = 2.0 / height_m, 1.5 / height_m
    part = x / np.hypot(1, x) * np.arctan(y / np.hypot(1, x)) + y / np.hypot(1, y) * np.arctan(x / np.hypot(1, y))
    return float(4 * part / (2 * np.pi))


@pytest.mark.slow
def test_no_light_comes_through_the_walls_of_a_closed_room() -> None:
    """Cubes are so large that the points on a face leave no hole: nothing sends light, and nothing of the sky comes in."""
    faces, low, high = room(albedo=0.5), np.array((-2.0, -1.5, -1.25)), np.array((2.0, 1.5, 1.25))
    volume = _empty((-2.0, -1.5, -1.25), (2.0, 1.5, 1.25), 0.0)
    voxels = voxelise(faces, surface_points(faces), low - 0.3, high + 0.3, volume.spacing_m * VOXEL)
    places = places_of(voxels, volume, low, high)
    gather(voxels, volume, _directions(128), _directions(32), SKY, places)
    assert volume.is_valid.sum() > 0.8 * (places != BEYOND).sum()
    assert volume.light.max() == 0.0


def test_each_set_of_directions_looks_everywhere_alike() -> None:
    """Means over the sphere: 0 of a coordinate, and 1/3 of its square."""
    sets = _directions(32)
    assert len(sets) > 1
    for chosen in sets:
        assert np.linalg.norm(chosen, axis=1) == pytest.approx(np.ones(32))
        assert chosen.mean(axis=0) == pytest.approx(np.zeros(3), abs=0.05)
        assert np.square(chosen).mean(axis=0) == pytest.approx(np.full(3, 1 / 3), abs=0.03)


def test_the_colour_that_all_light_has_is_mostly_taken_away() -> None:
    """By hand: three quarters of the way from (2, 1, 1) times the mean 4/3 over each to grey."""
    light = np.tile(np.array((2.0, 1.0, 1.0), np.float32), (2, 2, 2, 6, 1))
    volume = Volume(np.zeros(3), light, 1.0, np.ones((2, 2, 2), np.bool_), 0.1)
    balanced = _balanced(volume).light[0, 0, 0, 0]
    assert balanced == pytest.approx((2 * (1 - 0.75 / 3), 1 + 0.75 / 3, 1 + 0.75 / 3), rel=1e-5)


def test_the_dark_is_shown_brighter_than_it_is_and_still_darker_than_the_rest() -> None:
    """By hand: 1.3 times as bright at the mean, and what is 16 times darker is shown 4 times darker."""
    light = np.full((2, 1, 1, 6, 3), LEVEL, np.float32)
    light[1] /= 16
    volume = Volume(np.zeros(3), light, 1.0, np.ones((2, 1, 1), np.bool_), LEVEL / 81)
    exposed = _exposed(volume)
    assert exposed.light[0, 0, 0, 0] == pytest.approx(np.full(3, 1.3 * LEVEL), rel=1e-5)
    assert exposed.light[1, 0, 0, 0] == pytest.approx(np.full(3, 1.3 * LEVEL / 4), rel=1e-5)
    assert exposed.least == pytest.approx(1.3 * LEVEL / 9)


@pytest.mark.slow
def test_baking_twice_gives_the_same_bits() -> None:
    faces = room(albedo=0.6)
    lamps = Lamps(np.array([(0.5, 0.2, 1.0)]), np.ones(1, np.float32), 4.0)
    first, second = (bake(faces, lamps, (-2, -1.5, -1.25), (2, 1.5, 1.25), 0.4) for _ in range(2))
    assert np.array_equal(first.light, second.light)
    assert np.array_equal(first.is_valid, second.is_valid)


@pytest.mark.slow
def test_probes_that_no_surface_looks_at_need_no_light_for_the_second_reflection(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    scene = load_scene("FloorPlan412")
    usual = bake(*_asked(scene))
    places = np.full((9, 9, 9), IN_AIR, np.uint8)
    places[4, 4, 4] = NEAR_SURFACE
    assert (bake_module._looked_up(places) != BEYOND).sum() == 27
    monkeypatch.setattr(bake_module, "_looked_up", lambda places: places)
    whole = bake(*_asked(scene))
    assert np.array_equal(usual.light, whole.light)
    assert np.array_equal(usual.is_valid, whole.is_valid)


@pytest.mark.slow
def test_faces_that_share_a_vertex_share_its_light() -> None:
    """What is looked up for all faces at once is what each finds alone."""
    volume = bake(room(albedo=0.5, glow=1.0, lit="ceiling"), NO_LAMPS, (-2, -1.5, -1.25), (2, 1.5, 1.25), 0.4)
    ball = trimesh.creation.icosphere(subdivisions=1, radius=0.3)
    vertices = np.ascontiguousarray(ball.vertices.T, np.float32)
    faces, normals = ball.faces.astype(np.int32), ball.vertex_normals.astype(np.float32)
    is_solid = np.arange(len(faces)) % 2 == 0
    together, alone = (patches(vertices, faces) for _ in range(2))
    light_faces(together, volume, vertices, normals, faces, is_solid, 0, len(faces))
    assert len(faces) == 80
    for face in range(len(faces)):
        light_faces(alone, volume, vertices, normals, faces, is_solid, face, face + 1)
    assert np.array_equal(together.light, alone.light)
    assert np.ptp(together.light) > 0.1


@pytest.mark.slow
def test_samples_of_a_face_lie_in_rows_from_its_third_corner() -> None:
    assert [sample_of(*np.int32([2, i, j])) for i in range(3) for j in range(3 - i)] == [0, 1, 2, 3, 4, 5]
    vertices = np.array([(0, 0, 0), (1, 0, 0), (0, 0.1, 0)], np.float32).T
    made = patches(np.ascontiguousarray(vertices), np.array([[0, 1, 2]], np.int32))
    assert made.steps.tolist() == [6]
    assert len(made.light) == 28
    volume = bake(room(albedo=0.5, glow=1.0), NO_LAMPS, (-2, -1.5, -1.25), (2, 1.5, 1.25), 0.4)
    up = np.tile(np.array([0, 0, 1], np.float32), (3, 1))
    light_faces(
        made, volume, np.ascontiguousarray(vertices), up, np.array([[0, 1, 2]], np.int32), np.ones(1, bool), 0, 1
    )
    assert made.light == pytest.approx(0.4, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["FloorPlan1", "FloorPlan2", "FloorPlan10", "FloorPlan412"])
def test_a_room_is_lit_as_traced_paths_say(name: str) -> None:
    """Relative RMS error below 12 % of paths of four reflections, traced by Embree, where one sees when one walks about."""
    scene = load_scene(name)
    faces, volume = static_faces(scene), bake(*_asked(scene))
    rng = np.random.default_rng(0)
    tracer = tracer_of(faces)
    points, normals = seen_points(faces, tracer, scene, rng)
    truth = traced(faces, tracer, scene, points, normals, rng)
    ours = np.array([received(volume, tuple(p), tuple(n)) for p, n in zip(points, normals, strict=True)])
    ours *= truth.sum() / ours.sum()  # exposure
    assert np.sqrt(np.mean(np.square(ours - truth))) / truth.mean() < 0.12


def tracer_of(faces: Faces):
    mesh = trimesh.Trimesh(
        faces.corners.reshape(-1, 3), np.arange(3 * len(faces.corners)).reshape(-1, 3), process=False
    )
    return trimesh.ray.ray_pyembree.RayMeshIntersector(mesh)


def seen_points(
    faces: Faces, tracer, scene, rng: np.random.Generator, count: int = 300
) -> tuple[np.ndarray, np.ndarray]:
    """What rays in all directions from eyes over the reachable floor meet first, and its normals on their side."""
    with World(scene) as world:
        grid = reachable_grid(world)
    cells = [grid.cells[k] for k in rng.integers(len(grid.cells), size=count)]
    eyes = np.array([(*grid.position(cell), grid.floor_z + 1.5) for cell in cells])
    direction = rng.normal(size=eyes.shape)
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    places, rays, hit = tracer.intersects_location(eyes, direction, multiple_hits=False)
    normals = faces.normals[hit].astype(float)
    normals[np.sum(normals * direction[rays], axis=1) > 0] *= -1
    return places, normals


def traced(
    faces: Faces, tracer, scene, origins: np.ndarray, normals: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """(n, 3) light that points receive from surfaces: means of paths of up to four segments."""
    lights = room_lights(scene.lights)
    paths = 256
    start, normal = np.repeat(origins, paths, axis=0).astype(float), np.repeat(normals, paths, axis=0).astype(float)
    weight, total = np.ones((len(start), 3)), np.zeros((len(start), 3))
    for _ in range(4):
        direction = rng.normal(size=start.shape)
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        direction = normal + direction  # cosine distributed
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        hit = np.full(len(start), -1)
        begin = start + 1e-4 * normal
        hit = tracer.intersects_first(begin, direction)
        where = hit >= 0
        total[~where] += weight[~where] * SKY
        weight[~where] = 0.0
        f = np.where(where, hit, 0)
        n = faces.normals[f].astype(float)
        a = faces.corners[f, 0].astype(float)
        t = np.sum((a - begin) * n, axis=1) / np.where(
            np.abs(np.sum(direction * n, axis=1)) < 1e-9, 1e-9, np.sum(direction * n, axis=1)
        )
        at = begin + t[:, None] * direction
        facing = np.sum(direction * n, axis=1) < 0
        n = np.where((~facing & faces.is_open[f])[:, None], -n, n)
        weight[~facing & ~faces.is_open[f]] = 0.0
        albedo, glow = faces.albedo[f].astype(float), faces.glow[f].astype(float)[:, None]
        direct = np.zeros(len(start))
        for lamp, strength in zip(lights.positions, lights.strength, strict=True):
            to = lamp - at
            distance = np.linalg.norm(to, axis=1)
            to /= distance[:, None]
            cosine = np.maximum(np.sum(n * to, axis=1), 0.0)
            blocked = tracer.intersects_any(at + 1e-3 * n, to) & (
                _first_hit_m(tracer, at + 1e-3 * n, to) < distance - 0.1
            )
            direct += np.where(blocked, 0.0, strength * cosine / (1.0 + np.square(distance / lights.reach_m)))
        total += weight * albedo * ((1 - glow) * direct[:, None] + GLOW * glow)
        weight *= albedo * (1 - glow)
        start, normal = at, n
    return total.reshape(len(origins), paths, 3).mean(axis=1)


def _first_hit_m(tracer, start: np.ndarray, direction: np.ndarray) -> np.ndarray:
    places, rays, _ = tracer.intersects_location(start, direction, multiple_hits=False)
    found = np.full(len(start), np.inf)
    found[rays] = np.linalg.norm(places - start[rays], axis=1)
    return found
