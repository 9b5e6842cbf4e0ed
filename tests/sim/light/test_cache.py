import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from remqa_data.floorplans.load import load_scene
from remqa_data.scene import Scene
from remqa_data.sim.light import cache
from remqa_data.sim.light.volume import Volume
from remqa_data.sim.render import room_light as rendering
from remqa_data.sim.render.room_light import room_light

Lit = Callable[[Scene], tuple[Volume, int]]


@pytest.fixture(scope="module")
def bathroom() -> Scene:
    return load_scene("FloorPlan405")


@pytest.fixture
def lit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Lit:
    """The light of a room as another process gets it, and how often rooms have been baked so far."""
    monkeypatch.setenv("REMQA_CACHE", str(tmp_path))
    baked = []
    bake = cache.bake
    monkeypatch.setattr(cache, "bake", lambda *asked: baked.append(asked) or bake(*asked))

    def light(scene: Scene) -> tuple[Volume, int]:
        rendering._baked.cache_clear()
        return room_light(scene), len(baked)

    return light


def assert_same(a: Volume, b: Volume) -> None:
    for one, other in zip(a, b, strict=True):
        assert np.asarray(one).dtype == np.asarray(other).dtype
        assert np.asarray(one).tobytes() == np.asarray(other).tobytes()


@pytest.mark.slow
def test_what_another_process_has_baked_is_read_to_the_bit(bathroom: Scene, lit: Lit) -> None:
    first, _ = lit(bathroom)
    again, baked = lit(bathroom)
    assert baked == 1
    assert_same(first, again)
    again.light[:] *= 2  # as if it were its own


@pytest.mark.slow
def test_other_lamps_bake_anew(bathroom: Scene, lit: Lit) -> None:
    lit(bathroom)
    (x, y, z), *others = bathroom.lights
    moved = replace(bathroom, lights=((x + 0.2, y, z), *others))
    volume, baked = lit(moved)
    assert baked == 2
    assert not np.array_equal(volume.light, lit(bathroom)[0].light)


@pytest.mark.slow
@pytest.mark.parametrize("harm", ["cut", "flip", "empty", "other"])
def test_what_is_damaged_is_baked_anew_and_mended(harm: str, bathroom: Scene, lit: Lit, tmp_path: Path) -> None:
    first, _ = lit(bathroom)
    (path,) = (tmp_path / "light").iterdir()
    whole = path.read_bytes()
    middle = len(whole) // 2
    flipped = whole[:middle] + bytes([whole[middle] ^ 1]) + whole[middle + 1 :]
    path.write_bytes({"cut": whole[:middle], "flip": flipped, "empty": b"", "other": b"no archive"}[harm])
    again, baked = lit(bathroom)
    assert baked == 2
    assert_same(first, again)
    assert path.read_bytes() == whole
    assert lit(bathroom)[1] == 2


@pytest.mark.slow
def test_where_nothing_can_be_kept_light_is_baked_all_the_same(
    bathroom: Scene, lit: Lit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("REMQA_CACHE", str(tmp_path / "file"))
    baked = cache.bake(*rendering._asked(rendering.static_scene(bathroom)))
    assert_same(lit(bathroom)[0], rendering._exposed(rendering._balanced(baked)))


def test_what_was_used_longest_ago_goes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("REMQA_CACHE", str(tmp_path))

    def volume() -> Volume:
        return Volume(
            np.zeros(3), np.ones((4, 4, 4, 6, 3), dtype=np.float32), 0.1, np.ones((4, 4, 4), dtype=np.bool_), 0.2
        )

    cache.cached("a", volume)
    size = (tmp_path / "light" / "a.npz").stat().st_size
    monkeypatch.setattr(cache, "MOST_BYTES", 2 * size)
    for key in ("b", "a", "c"):  # a is used again, so b is the oldest
        time.sleep(0.05)  # clocks of file systems are coarse
        cache.cached(key, volume)
    assert {path.stem for path in (tmp_path / "light").iterdir()} == {"a", "c"}
