"""The environment over cached views: beside the live one, in batches, and misused."""

import pickle
import re
import shutil
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from remqa_data.env import RemqaEnv
from remqa_data.env.actions import DISCRETE
from remqa_data.env.cached import ENV_ID, CachedRemqaEnv, CachedRemqaVectorEnv
from remqa_data.env.cached.walk import ACTIONS
from remqa_data.errors import ActionError, DatasetError, UnknownNameError
from remqa_data.views.build import Wanted, cache_views
from tests.helpers.live_walks import compare
from tests.helpers.small_rooms import WALK

LEFT, AHEAD, DONE = ACTIONS.index("RotateLeft"), ACTIONS.index("MoveAhead"), ACTIONS.index("Done")


@pytest.fixture
def env(small_rooms: Path, small_views: Path) -> Iterator[CachedRemqaEnv]:
    made = CachedRemqaEnv(small_rooms, small_views, "train", max_steps=5)
    yield made
    made.close()


@pytest.mark.filterwarnings("error")
def test_gymnasiums_checker_has_nothing_to_say(small_rooms: Path, small_views: Path) -> None:
    env = gymnasium.make(ENV_ID, root=small_rooms, views=small_views)
    check_env(env.unwrapped)
    env.close()


@pytest.mark.slow
@pytest.mark.parametrize("split", ["train", "test"])
def test_every_state_and_action_is_as_in_the_live_environment(small_rooms: Path, small_views: Path, split: str) -> None:
    compared = dict(compare(small_rooms, small_views, split, steps=200))
    assert len(compared) == 2
    for counts in compared.values():
        assert counts["frames"] >= 300
        assert counts["transitions"] == 10 * counts["frames"]
        assert min(counts[what] for what in ("refused", "rewarded", "truncated")) > 0
        assert 0 < counts["navigated"] < counts["episodes"]
    assert sum(counts["frames with patches"] for counts in compared.values()) > 100


@pytest.mark.slow
def test_two_real_rooms_are_as_in_the_live_environment(two_rooms: Path, tmp_path: Path) -> None:
    out = tmp_path / "views"
    cache_views(two_rooms, out, Wanted(split="train", configurations=(0,), size_px=32))
    cache_views(two_rooms, out, Wanted(split="test", configurations=(0, 1), size_px=32))
    compared = {**dict(compare(two_rooms, out, "train", 300)), **dict(compare(two_rooms, out, "test", 300))}
    assert set(compared) == {("FloorPlan212", 0), ("FloorPlan27", 0), ("FloorPlan27", 1)}
    for counts in compared.values():
        assert counts["frames"] > 1500
        assert min(counts[what] for what in ("refused", "rewarded", "truncated")) > 0


def test_walking_has_the_numbers_and_words_of_the_live_environment() -> None:
    assert ACTIONS[:-1] == DISCRETE[: len(ACTIONS) - 1]
    assert ACTIONS[-1] == "Done"
    assert set(ACTIONS) == {
        *("MoveAhead", "MoveBack", "MoveLeft", "MoveRight", "RotateLeft", "RotateRight", "LookUp", "LookDown"),
        *("Crouch", "Stand", "Done"),
    }


def test_the_page_names_every_observation(env: CachedRemqaEnv) -> None:
    page = (Path(__file__).parents[2] / "docs" / "AGENTS.md").read_text(encoding="utf-8")
    (told,) = re.findall(r"^- \*\*Observations\*\*:(.*?)^- ", page, re.MULTILINE | re.DOTALL)
    assert set(env.observation_space.spaces) <= set(re.findall(r"`(\w+)`", told))  # type: ignore[attr-defined]


def test_the_same_seed_draws_the_episodes_of_the_live_environment(small_rooms: Path, env: CachedRemqaEnv) -> None:
    live = RemqaEnv(small_rooms, "train", width=24, height=24)
    drawn = []
    for seed in (4, None, None, 5, None):
        (seen, info), (shown, said) = live.reset(seed=seed), env.reset(seed=seed)
        assert info == said
        assert seen["question"] == shown["question"]
        assert np.array_equal(seen["question_tokens"], shown["question_tokens"])
        drawn.append(info["episode_id"])
    assert len(set(drawn)) > 1
    live.close()


def test_who_walks_to_the_goal_is_rewarded(small_rooms: Path, small_views: Path) -> None:
    env = CachedRemqaEnv(small_rooms, small_views, "train")
    env.reset(options={"episode": "Small1-q0"})
    walked = [env.step(action) for action in (*WALK, "Done")]
    assert [reward for _, reward, *_ in walked] == [0.0] * len(WALK) + [1.0]
    info = walked[-1][-1]
    assert (info["S_N"], info["SPL"], info["path_length_m"], info["distance_to_goal_m"]) == (True, 1.0, 1.5, 0.0)
    env.reset(options={"episode": "Small1-q0"})
    _, reward, terminated, _, info = env.step("Done")
    assert (reward, terminated, info["S_N"], info["SPL"]) == (0.0, True, False, 0.0)


def test_an_agent_is_told_what_kind_of_thing_it_looks_for(env: CachedRemqaEnv) -> None:
    from remqa_data.catalog import catalog

    seen, _ = env.reset()
    assert list(catalog())[seen["target"] - 1] == "Fridge"


def test_an_episode_ends_with_done_or_after_the_last_step(env: CachedRemqaEnv) -> None:
    with pytest.raises(ActionError, match="call reset"):
        env.step(LEFT)
    env.reset(seed=0)
    assert env.step(DONE)[2:4] == (True, False)
    with pytest.raises(ActionError, match="call reset"):
        env.step(LEFT)
    env.reset(seed=0)
    assert [env.step("RotateLeft")[2:4] for _ in range(5)] == [(False, False)] * 4 + [(False, True)]


def test_after_it_was_closed_an_episode_must_begin(env: CachedRemqaEnv) -> None:
    env.reset(seed=0)
    env.close()
    with pytest.raises(ActionError, match="call reset"):
        env.step(AHEAD)


@pytest.mark.parametrize("action", [len(ACTIONS), -1, 1.5, None, "OpenObject Fridge|1", "Answer yes", "MoveAhead 0.1"])
def test_what_only_the_live_environment_can_do_is_misuse_and_the_episode_goes_on(
    env: CachedRemqaEnv, action: Any
) -> None:
    env.reset(seed=0)
    with pytest.raises(ActionError, match="is not an action: give a number below 11 or one of MoveAhead"):
        env.step(action)
    assert env.step(np.int64(LEFT))[-1]["success"]


def test_reset_knows_its_episodes_and_its_option(env: CachedRemqaEnv) -> None:
    with pytest.raises(UnknownNameError, match="did you mean 'Small1-q3'"):
        env.reset(options={"episode": "Small1-q"})
    with pytest.raises(ActionError, match="option 'episode'"):
        env.reset(options={"scene": "Small1"})


def test_an_observation_is_the_agents_own_or_a_view_that_cannot_be_written_to(
    small_rooms: Path, small_views: Path, env: CachedRemqaEnv
) -> None:
    own, _ = env.reset(options={"episode": "Small1-q0"})
    views = CachedRemqaEnv(small_rooms, small_views, "train", copy=False)
    seen, _ = views.reset(options={"episode": "Small1-q0"})
    assert same(own, seen)
    assert np.shares_memory(seen["rgb"], views.walk.room.frames)
    own["rgb"][:] = own["pose"][:] = own["question_tokens"][:] = 0
    assert not same(own, env.reset(options={"episode": "Small1-q0"})[0])
    for key in ("rgb", "pose", "question_tokens"):
        with pytest.raises(ValueError, match="read-only"):
            seen[key][:] = 0


@pytest.mark.slow
def test_only_questions_whose_room_is_cached_are_played(small_rooms: Path, tmp_path: Path) -> None:
    out = tmp_path / "views"
    cache_views(small_rooms, out, Wanted(split="train", configurations=(1,), size_px=16))
    env = CachedRemqaEnv(small_rooms, out, "train")
    assert env.episode_ids == ("Small1-q2", "Small1-q3")
    with pytest.raises(DatasetError, match=r"has no Small1, configuration 0, which Small1-q0 is about"):
        CachedRemqaEnv(small_rooms, out, "train", question_ids=["Small1-q0"])
    with pytest.raises(DatasetError, match="has no room that split test asks about"):
        CachedRemqaEnv(small_rooms, out, "test")
    env.reset(options={"episode": "Small1-q2"})
    many = CachedRemqaVectorEnv(2, small_rooms, out, "train")
    many.reset(seed=0)
    for asked, action in ((env, LEFT), (many, [LEFT, LEFT])):
        with pytest.raises(DatasetError, match="Small1"):
            asked.reset(options={"episode": "Small1-q0"})
        with pytest.raises(ActionError, match="call reset"):
            asked.step(action)
    with pytest.raises(DatasetError, match="has no features; add some"):
        CachedRemqaEnv(small_rooms, out, "train", features=True)


def test_a_start_that_cannot_be_reached_is_an_error(small_rooms: Path, small_views: Path) -> None:
    env = CachedRemqaEnv(small_rooms, small_views, "train")
    task = env.tasks.task("Small1-q0")
    object.__setattr__(task, "start", (9.0, 9.0, 0.0, 0.0))
    with pytest.raises(DatasetError, match=r"question Small1-q0, field initial_pose: .* cannot be reached in Small1"):
        env.reset(options={"episode": "Small1-q0"})


def walked(envs: Any, steps: int, seed: int = 3) -> list[Any]:
    """What an environment of three gives from a seed on, for actions that are drawn."""
    actions = np.random.default_rng(seed).choice([LEFT, AHEAD, AHEAD, DONE], (steps, 3))
    given = [envs.reset(seed=seed)[0]]
    for action in actions:
        seen, rewards, terminated, truncated, info = envs.step(action)
        given += [seen, rewards, terminated, truncated, {key: info.get(key) for key in ("S_N", "SPL", "episode_id")}]
    envs.close()
    return given


def same(a: Any, b: Any) -> bool:
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(same(a[key], b[key]) for key in a)
    return bool(np.array_equal(a, b)) and np.asarray(a).dtype == np.asarray(b).dtype


def test_a_batch_is_what_gymnasium_makes_of_environments_one_by_one(
    small_rooms: Path, small_views: Path, tmp_path: Path
) -> None:
    views = Path(shutil.copytree(small_views, tmp_path / "views"))
    name = "tests.helpers.small_network:brightness"
    cache_views(small_rooms, views, Wanted(size_px=24, features=name))
    options = {"root": small_rooms, "views": views, "max_steps": 6, "features": True}
    batch = gymnasium.make_vec(ENV_ID, num_envs=3, **options)
    assert isinstance(batch, CachedRemqaVectorEnv)
    one_by_one = gymnasium.vector.SyncVectorEnv([partial(CachedRemqaEnv, **options)] * 3)
    assert batch.observation_space == one_by_one.observation_space
    assert batch.action_space == one_by_one.action_space
    assert batch.autoreset_mode == one_by_one.autoreset_mode  # type: ignore[attr-defined]
    assert batch.reset(seed=1)[0] in batch.observation_space
    given, expected = walked(batch, 60), walked(one_by_one, 60)
    assert sum(entry.any() for entry in given if isinstance(entry, np.ndarray)) > 10
    assert all(same(a, b) for a, b in zip(given, expected, strict=True))


def test_a_batch_is_reset_and_seeded_as_gymnasium_does_it(small_rooms: Path, small_views: Path) -> None:
    make = partial(CachedRemqaEnv, small_rooms, small_views, max_steps=9)
    batch = CachedRemqaVectorEnv(3, small_rooms, small_views, max_steps=9)
    one_by_one = gymnasium.vector.SyncVectorEnv([make] * 3)
    mask = np.array([True, False, True])
    with pytest.raises(ActionError, match="no episodes going on yet"):
        batch.reset(options={"reset_mask": mask})
    told = []
    for envs in (batch, one_by_one):
        first = envs.reset(seed=5)
        assert envs.np_random_seed == (5, 6, 7)
        envs.step(np.array([AHEAD] * 3))
        again = envs.reset(seed=8, options={"reset_mask": mask.copy()})
        after = envs.step(np.array([LEFT, AHEAD, DONE]))
        told.append((first, again, [generator.random() for generator in envs.np_random], after[:4]))
    assert batch.np_random_seed == one_by_one.np_random_seed == (8, 6, 10)
    for one, two in zip(*told, strict=True):
        assert all(same(a, b) for a, b in zip(one, two, strict=True))
    for wrong in (mask[:2], mask.astype(int), ~(mask | ~mask), "all"):
        with pytest.raises(ActionError, match="reset_mask"):
            batch.reset(options={"reset_mask": wrong})


def test_an_observation_of_a_batch_is_its_own(small_rooms: Path, small_views: Path) -> None:
    envs = CachedRemqaVectorEnv(2, small_rooms, small_views)
    with pytest.raises(ActionError, match="call reset"):
        envs.step([LEFT, LEFT])
    first, _ = envs.reset(seed=3)
    target, tokens = first["target"].copy(), first["question_tokens"].copy()
    first["target"][:], first["question_tokens"][:] = 0, 0
    second = envs.step([LEFT, LEFT])[0]
    assert np.array_equal(second["target"], target)
    assert np.array_equal(second["question_tokens"], tokens)


def test_a_batch_refuses_what_does_not_fit_it(small_rooms: Path, small_views: Path) -> None:
    envs = CachedRemqaVectorEnv(2, small_rooms, small_views)
    with pytest.raises(ActionError, match="3 seeds for 2"):
        envs.reset(seed=[1, 2, 3])
    envs.reset(seed=[1, None])
    with pytest.raises(ActionError, match="3 actions for 2"):
        envs.step([LEFT, LEFT, LEFT])
    with pytest.raises(ActionError, match="is not an action"):
        envs.step([LEFT, 99])
    with pytest.raises(ActionError, match="is not an action"):
        envs.step(None)
    envs.close()
    with pytest.raises(ActionError, match="call reset"):
        envs.step([LEFT, LEFT])
    with pytest.raises(ActionError, match=r"seed is 1\.5"):
        envs.reset(seed=1.5)
    for wrong in ({"features": "x"}, {"vocabulary": 3}):
        for make in (CachedRemqaEnv, partial(CachedRemqaVectorEnv, 2)):
            with pytest.raises(ActionError, match=f"{next(iter(wrong))} is "):
                make(small_rooms, small_views, **wrong)
    for count in (0, 2.5, True, "2"):
        with pytest.raises(ActionError, match=f"num_envs is {count!r}"):
            CachedRemqaVectorEnv(count, small_rooms, small_views)
        with pytest.raises(ActionError, match=f"max_steps is {count!r}"):
            CachedRemqaEnv(small_rooms, small_views, max_steps=count)


def test_seeds_of_numpy_are_seeds(small_rooms: Path, small_views: Path) -> None:
    envs = CachedRemqaVectorEnv(2, small_rooms, small_views)
    for seed in (3, np.int64(3), np.array(3), [3, 4], np.array([3, 4]), [np.int32(3), np.int64(4)]):
        envs.reset(seed=seed)
        assert envs.np_random_seed == (3, 4)
        assert {type(one) for one in envs.np_random_seed} == {int}


@pytest.mark.parametrize("seed", [1.5, "ab", [1, 2.5], [3, "4"], np.array([1.0, 2.0]), np.array([[1, 2], [3, 4]])])
def test_seeds_that_are_none_are_refused_before_any_is_taken(small_rooms: Path, small_views: Path, seed: Any) -> None:
    envs = CachedRemqaVectorEnv(2, small_rooms, small_views)
    envs.reset(seed=7)
    with pytest.raises(ActionError, match=r"seed is .*: give a whole number, or one for each environment"):
        envs.reset(seed=seed)
    assert envs.np_random_seed == (7, 8)


def test_none_is_the_only_render_mode(small_rooms: Path, small_views: Path) -> None:
    how = {"root": small_rooms, "views": small_views, "render_mode": None}
    for made in (gymnasium.make(ENV_ID, **how), gymnasium.make_vec(ENV_ID, 2, **how)):
        assert made.render_mode is None
        made.close()
    for make in (CachedRemqaEnv, partial(CachedRemqaVectorEnv, 2)):
        with pytest.raises(ActionError, match="render_mode is 'rgb_array': give None"):
            make(small_rooms, small_views, render_mode="rgb_array")


def test_a_batch_is_truncated_after_the_steps_that_gymnasium_is_told(small_rooms: Path, small_views: Path) -> None:
    how = {"root": small_rooms, "views": small_views}
    for limits, last in (({"max_episode_steps": 2}, 2), ({"max_episode_steps": 4, "max_steps": 3}, 3)):
        lengths = []
        for mode in (None, "sync"):
            envs = gymnasium.make_vec(ENV_ID, 2, vectorization_mode=mode, **how, **limits)
            envs.reset(seed=0)
            lengths.append([envs.step([LEFT, LEFT])[3].tolist() for _ in range(last)])
            envs.close()
        assert lengths == [[[False, False]] * (last - 1) + [[True, True]]] * 2
    for none in (None, -1):
        CachedRemqaVectorEnv(2, **how, max_episode_steps=none)
    with pytest.raises(ActionError, match="max_episode_steps is 0: give a positive whole number"):
        CachedRemqaVectorEnv(2, **how, max_episode_steps=0)


def test_info_of_a_batch_has_what_gymnasiums_has_but_words(small_rooms: Path, small_views: Path) -> None:
    how = {"root": small_rooms, "views": small_views}
    batch, one_by_one = (gymnasium.make_vec(ENV_ID, 2, vectorization_mode=mode, **how) for mode in (None, "sync"))
    words = {"action", "error", "_action", "_error"}
    batch.reset(seed=0)
    one_by_one.reset(seed=0)
    for actions in ([LEFT, DONE], [LEFT, LEFT], [DONE, DONE], [LEFT, LEFT], [LEFT, AHEAD]):
        info, expected = (envs.step(np.array(actions))[-1] for envs in (batch, one_by_one))
        assert {key: value.tolist() for key, value in info.items()} == {
            key: value.tolist() for key, value in expected.items() if key not in words
        }
    one_by_one.close()


def test_a_copy_in_the_middle_of_an_episode_goes_on_and_is_no_copy_of_the_cache(env: CachedRemqaEnv) -> None:
    before = len(pickle.dumps(env))
    env.reset(seed=4)
    env.step(AHEAD)
    stored = pickle.dumps(env)
    assert len(stored) < before + 2_000
    other = pickle.loads(stored)
    for action in (LEFT, AHEAD, DONE):
        one, two = env.step(action), other.step(action)
        assert all(same(a, b) for a, b in zip(one, two, strict=True))


def test_a_copy_in_another_process_is_the_same(env: CachedRemqaEnv) -> None:
    other = pickle.loads(pickle.dumps(env))
    for one in (env, other):
        one.reset(seed=4)
    seen, again = env.step(LEFT)[0], other.step(LEFT)[0]
    assert all(np.array_equal(value, again[key]) for key, value in seen.items())


@pytest.mark.parametrize("is_batch", [False, True])
def test_gymnasium_keeps_statistics_of_many_episodes_side_by_side(
    small_rooms: Path, small_views: Path, is_batch: bool
) -> None:
    how = {"root": small_rooms, "views": small_views, "split": "test", "max_steps": 7}
    envs = gymnasium.make_vec("remqa_data/CachedRemqa-v0", 3, vectorization_mode=None if is_batch else "sync", **how)
    envs = gymnasium.wrappers.vector.RecordEpisodeStatistics(envs)
    envs.reset(seed=3)
    rng, lengths = np.random.default_rng(0), []
    for _ in range(40):
        chosen = rng.integers(LEFT, LEFT + 2, 3)
        chosen[rng.random(3) < 0.3] = DONE
        info = envs.step(chosen)[-1]
        lengths += info["episode"]["l"][info["_episode"]].tolist() if "episode" in info else []
    assert len(lengths) > 10
    assert min(lengths) >= 1
    assert max(lengths) <= 7
    envs.close()
