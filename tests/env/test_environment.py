"""The Gymnasium environment: Gymnasium's own checker, and episodes of rooms and of a generated dataset."""

import copy
import gc
import math
import pickle
import re
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from remqa_data.env import ENV_ID, RemqaEnv
from remqa_data.env.actions import DISCRETE, PARAMETRISED, Command, command
from remqa_data.env.cached import CachedRemqaEnv
from remqa_data.env.video import write_film
from remqa_data.errors import ActionError, DatasetError, UnknownNameError
from remqa_data.sim.agent.actions import Action, parse_action
from remqa_data.sim.agent.third_person import PLACES
from remqa_data.sim.arm.arm import HOME
from tests.helpers.small_rooms import small_room

ROOM = "FloorPlan406"
BARE = replace(small_room("Small1", 0), name="Bare")
SMALL = {"scenes": [ROOM], "width": 64, "height": 48}
AHEAD, LEFT, DONE = DISCRETE.index("MoveAhead"), DISCRETE.index("RotateLeft"), DISCRETE.index("Done")


@pytest.fixture
def env() -> Iterator[RemqaEnv]:
    made = RemqaEnv(**SMALL, max_steps=5)
    yield made
    made.close()


def test_the_page_names_every_observation() -> None:
    page = (Path(__file__).parents[2] / "docs" / "ENVIRONMENT.md").read_text(encoding="utf-8")
    table = page.split("## What the agent gets\n")[1].split("\n## ")[0]
    env = RemqaEnv(**SMALL, privileged=True)
    assert set(re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE)) == set(env.observation_space.spaces)  # type: ignore[attr-defined]


@pytest.mark.slow
@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("mode", ["discrete", "parametrised"])
@pytest.mark.parametrize("privileged", [False, True])
def test_gymnasiums_checker_has_nothing_to_say(mode: str, privileged: bool) -> None:
    env = gymnasium.make(ENV_ID, action_mode=mode, privileged=privileged, render_mode="rgb_array", **SMALL)
    check_env(env.unwrapped)
    env.close()


@pytest.mark.slow
def test_the_same_seed_gives_the_same_episode_bit_for_bit(env: RemqaEnv) -> None:
    other = RemqaEnv(**SMALL, max_steps=5)
    for seed in (3, 4):
        pairs = [(env.reset(seed=seed), other.reset(seed=seed))]
        for action in (AHEAD, LEFT, AHEAD):
            pairs.append((env.step(action), other.step(action)))
        assert all(a[0] for a, _ in pairs)
        for a, b in pairs:
            for key, value in a[0].items():
                assert np.array_equal(value, b[0][key])
            assert a[-1] == b[-1]
    other.close()


@pytest.mark.slow
def test_a_room_is_as_it_was_when_it_is_played_again(env: RemqaEnv) -> None:
    first, _ = env.reset(seed=1)
    agent = env.agent
    door = next(name for name in agent.world.ids if agent.world.assets[name].is_openable)
    agent.open(door, force=True)
    cup = next(n for n in agent.world.ids if agent.world.type_of(n) in ("SoapBar", "ToiletPaper", "SoapBottle"))
    agent.pick_up(cup, force=True)
    agent.set_arm_base(0.9)
    again, _ = env.reset(seed=1)
    assert env.agent.arm.state == HOME
    for key, value in first.items():
        assert np.array_equal(value, again[key])


@pytest.mark.slow
def test_with_views_that_are_kept_everything_looks_the_same(env: RemqaEnv) -> None:
    """Also where something has been done, or an observation was written over, and more is seen than is kept."""
    other = RemqaEnv(**SMALL, max_steps=5, views_kept=3, privileged=True)
    doors: set[str] = set()
    for _ in range(2):
        for act in (None, "open", "pick up"):
            pairs = [(env.reset(seed=1)[0], other.reset(seed=1)[0])]
            for number, action in enumerate((LEFT, LEFT, LEFT, LEFT, AHEAD)):
                if act is not None and number == 1:
                    for agent in (env.agent, other.agent):
                        door = next(name for name in agent.world.ids if agent.world.assets[name].is_openable)
                        cup = next(n for n in agent.world.ids if agent.world.type_of(n) in ("SoapBar", "SoapBottle"))
                        done = agent.open(door, force=True) if act == "open" else agent.pick_up(cup, force=True)
                        assert done.success
                        doors.add(door)
                pairs.append((env.step(action)[0], other.step(action)[0]))
            for a, b in pairs:
                assert all(np.array_equal(value, b[key]) for key, value in a.items())
                b["rgb"][:] = 0  # it is the agent's own
    assert doors
    room = other._needed_room()
    assert len(room._kept) == 3
    drawn: list[object] = []
    room.view.render = drawn.append  # type: ignore[method-assign, assignment]
    again = other.reset(seed=1)[0]
    assert drawn == []
    assert again["rgb"].any()
    other.close()


@pytest.mark.slow
def test_an_episode_ends_with_done_or_after_the_last_step(env: RemqaEnv) -> None:
    env.reset(seed=0)
    assert env.step(DONE)[2:4] == (True, False)
    with pytest.raises(ActionError, match="call reset"):
        env.step(AHEAD)
    env.reset(seed=0)
    assert [env.step(LEFT)[2:4] for _ in range(5)] == [(False, False)] * 4 + [(False, True)]


def test_what_the_room_refuses_is_in_info_and_costs_a_step(env: RemqaEnv) -> None:
    env.reset(seed=0)
    info = env.step("MoveAhead 5.0")[-1]
    assert not info["success"]
    assert info["error"] == "something is blocking Agent from moving"
    assert env.steps == 1


@pytest.mark.slow
@pytest.mark.parametrize(
    ("action", "error"),
    [
        (len(DISCRETE), ActionError),
        (-1, ActionError),
        (1.5, ActionError),
        (None, ActionError),
        ({"action": 0}, ActionError),
        ("Jump", ActionError),
        ("Answer", ActionError),
        ("MoveAhead nan", ActionError),
        ("Teleport 0 0 90", ActionError),
        (Command(Action("OpenObject")), ActionError),
        (Command(Action("PushObject", (0.5, 0.01), (99.0,))), ActionError),
    ],
)
def test_misuse_is_an_exception_and_the_episode_goes_on(env: RemqaEnv, action: Any, error: type[Exception]) -> None:
    env.reset(seed=0)
    with pytest.raises(error):
        env.step(action)
    assert env.step(LEFT)[-1]["success"]


@pytest.mark.parametrize(
    ("arguments", "error", "why"),
    [
        ({}, ActionError, "one of them, not both"),
        ({"scenes": []}, DatasetError, "no scenes were given"),
        ({"root": "nowhere", "scenes": [ROOM]}, ActionError, "one of them, not both"),
        ({"root": "nowhere"}, DatasetError, "no such folder"),
        ({"scenes": [ROOM], "action_mode": "continuous"}, ActionError, "'continuous'"),
        ({"scenes": [ROOM], "render_mode": "human"}, ActionError, "render_mode is 'human': give None or 'rgb_array'"),
        ({"scenes": [ROOM], "width": 0}, ActionError, "width is 0"),
        ({"scenes": [ROOM], "width": True}, ActionError, "width is True"),
        ({"scenes": [ROOM], "width": 64.5}, ActionError, "width is 64.5"),
        ({"scenes": [ROOM], "width": 100_000}, ActionError, "give at most 4096 x 4096"),
        ({"scenes": [ROOM], "max_steps": None}, ActionError, "max_steps is None"),
        ({"scenes": [ROOM], "views_kept": -1}, ActionError, "views_kept is -1"),
        ({"scenes": [ROOM], "privileged": "no"}, ActionError, "privileged is 'no'"),
        ({"scenes": [ROOM], "vocabulary": 3}, ActionError, "vocabulary is 3"),
        ({"scenes": [ROOM], "hands": "x"}, ActionError, "'x' is none of"),
        ({"scenes": ROOM}, ActionError, "scenes is a text"),
        ({"scenes": BARE}, ActionError, r"scenes is Scene\(.*: give a list"),
        ({"scenes": 3}, ActionError, "scenes is 3: give a list"),
        ({"scenes": [ROOM], "split": "test"}, ActionError, "in bare rooms nothing is asked"),
        ({"scenes": [ROOM], "question_ids": ["a"]}, ActionError, "in bare rooms nothing is asked"),
        ({"root": 3}, ActionError, "root is 3"),
        ({"scenes": [3]}, ActionError, "scenes has 3"),
        ({"scenes": np.array(["FloorPlan9"] * 2)}, ActionError, "two rooms called 'FloorPlan9'"),
        ({"scenes": [BARE, replace(BARE, floor_z=0.1)]}, ActionError, "two rooms called 'Bare'"),
        ({"scenes": ["FloorPlan9999"]}, UnknownNameError, "FloorPlan9999"),
        ({"scenes": ["Sampled-kitchen-000001"]}, UnknownNameError, "Sampled-kitchen-000001"),
        ({"root": "nowhere", "question_ids": np.array([1, 2])}, ActionError, "question_ids has np.int64"),
        ({"root": "nowhere", "question_ids": []}, ActionError, "question_ids is empty"),
        ({"root": "nowhere", "question_ids": "FloorPlan1-COUNTING-00-c0"}, ActionError, "question_ids is a text"),
    ],
)
def test_an_environment_that_cannot_be_made_says_why(
    arguments: dict[str, Any], error: type[Exception], why: str
) -> None:
    with pytest.raises(error, match=why):
        RemqaEnv(**arguments)


@pytest.mark.parametrize(
    "wanted",
    [
        {},
        {"action": "MoveAhead"},
        {"answer": 3},
        {"answer": "y" * 301},
        {"answer": "\ud800"},
        {"answer": "yes", "action": Action("MoveAhead")},
        {"answer": "yes", "box": "abcd"},
        {"answer": "yes", "box": 0.5},
        {"answer": "yes", "box": (-0.1, 0.0, 1.0, 1.0)},
        {"answer": "yes", "box": (0.5, 0.0, 0.2, 1.0)},
        {"answer": "yes", "box": (math.nan, 0.0, 1.0, 1.0)},
        {"answer": "yes", "box": (0.0, 1.0)},
    ],
)
def test_a_command_that_no_submission_holds_is_refused(wanted: dict[str, Any]) -> None:
    with pytest.raises(ActionError, match=r"(?i)a? ?command"):
        Command(**wanted)


def test_a_live_environment_is_neither_copied_nor_pickled(env: RemqaEnv) -> None:
    env.reset(seed=0)
    for copied in (copy.deepcopy, pickle.dumps):
        with pytest.raises(TypeError, match="cannot be copied or pickled"):
            copied(env)
    assert env.step(LEFT)[-1]["success"]


def test_reset_knows_its_episodes_and_its_option(env: RemqaEnv) -> None:
    with pytest.raises(ActionError, match="call reset"):
        env.step(LEFT)
    with pytest.raises(UnknownNameError, match=ROOM):
        env.reset(options={"episode": ROOM[:-1]})
    with pytest.raises(ActionError, match="option 'episode'"):
        env.reset(options={"scene": ROOM})


@pytest.mark.parametrize("options", [{"episode": "nothing"}, {"scene": "Small1"}])
@pytest.mark.parametrize("is_cached", [False, True])
def test_after_a_reset_that_failed_no_episode_goes_on(
    small_rooms: Path, small_views: Path, is_cached: bool, options: Any
) -> None:
    env = CachedRemqaEnv(small_rooms, small_views) if is_cached else RemqaEnv(small_rooms, width=8, height=8)
    env.reset(seed=0)
    with pytest.raises((ActionError, UnknownNameError)):
        env.reset(seed=1, options=options)
    with pytest.raises(ActionError, match="call reset"):
        env.step(LEFT)
    env.reset()
    assert env.step(LEFT)[-1]["success"]
    env.close()


def test_an_episode_that_is_named_by_a_text_of_numpy_is_told_as_a_text(small_rooms: Path, small_views: Path) -> None:
    makes = (partial(RemqaEnv, small_rooms, width=8, height=8), partial(CachedRemqaEnv, small_rooms, small_views))
    for env, name in (*((make(), "Small1-q0") for make in makes), (RemqaEnv(**SMALL), ROOM)):
        info = env.reset(options={"episode": np.str_(name)})[1]
        assert info["episode_id"] == name
        assert {type(info[key]) for key in ("episode_id", "scene")} == {str}
        env.close()


@pytest.mark.parametrize("text", ["{}", "Answer {}", "Answer{}", "OpenObject @{}", "OpenObject a {}", "MoveAhead {}"])
def test_what_is_said_of_a_long_action_is_short(env: RemqaEnv, text: str) -> None:
    env.reset(seed=0)
    for filling in ("x" * 100_000, " " * 100_000):
        with pytest.raises(ActionError) as caught:
            env.step(text.format(filling))
        assert len(str(caught.value)) < 400


@pytest.mark.parametrize(
    "action", [["x"] * 100_000, {"action": "x" * 100_000}, 10**1000], ids=["list", "dictionary", "number"]
)
def test_what_is_said_of_something_long_that_is_no_action_is_short(env: RemqaEnv, action: Any) -> None:
    env.reset(seed=0)
    for wrong in (partial(env.step, action), partial(Command, action), partial(Command, None, action)):
        with pytest.raises(ActionError) as caught:
            wrong()
        assert len(str(caught.value)) < 400


def test_a_long_name_is_not_visible_in_few_words(env: RemqaEnv) -> None:
    env.reset(seed=0)
    info = env.step("OpenObject " + "y" * 100_000)[-1]
    assert info["error"].endswith("yy is not visible")
    assert info["action"].startswith("OpenObject yy")
    assert max(len(info["error"]), len(info["action"])) <= 400


@pytest.mark.parametrize("options", [{"episode": 3}, {"episode": [ROOM]}, ROOM, [ROOM], 0])
def test_options_that_are_none_are_told_with_some_that_are(env: RemqaEnv, options: Any) -> None:
    with pytest.raises(ActionError, match=f"such as .*{ROOM}"):
        env.reset(options=options)


@pytest.mark.parametrize("chosen", [[], "Small1-q0", {"Small1-q0"}, 3, ["Small1-q0"] * 2])
def test_a_choice_of_questions_that_is_none_says_why(small_rooms: Path, small_views: Path, chosen: Any) -> None:
    for make in (partial(RemqaEnv, small_rooms), partial(CachedRemqaEnv, small_rooms, small_views)):
        with pytest.raises(ActionError, match=r"question_ids (is|has) "):
            make("train", question_ids=chosen)


def test_no_other_questions_than_the_chosen_ones_are_asked(small_rooms: Path, small_views: Path) -> None:
    for make in (partial(RemqaEnv, small_rooms, width=8, height=8), partial(CachedRemqaEnv, small_rooms, small_views)):
        env = make(split="train", question_ids=np.array(["Small1-q3", "Small1-q0"]))
        assert env.episode_ids == ("Small1-q3", "Small1-q0")
        assert {type(name) for name in env.episode_ids} == {str}
        with pytest.raises(UnknownNameError, match="Small1-q1"):
            env.reset(options={"episode": "Small1-q1"})


def test_a_privileged_agent_is_marked_and_sees_instances() -> None:
    env = RemqaEnv(**SMALL, privileged=True)
    seen, info = env.reset(seed=0)
    assert info["privileged"]
    shown = np.unique(seen["instances"])
    assert 0 < shown.max() <= len(info["object_ids"])
    x, y = env.agent.grid.position(env.agent.grid.cells[0])
    assert env.step(f"Teleport {x} {y} 90.0")[-1]["success"]
    env.close()


def test_amounts_of_the_parametrised_space_are_metres_and_half_turns(env: RemqaEnv) -> None:
    env.reset(seed=0)
    agent = env.agent
    agent.place((0.0, 0.0), 90.0)

    def read(name: str, *amounts: float) -> Action | None:
        entries = {
            "action": np.int64(PARAMETRISED.index(name)),
            "point": np.full(2, 0.5, dtype=np.float32),
            "amounts": np.pad(np.array(amounts, dtype=np.float32), (0, 3 - len(amounts))),
            "box": np.zeros(4, dtype=np.float32),
            "answer": np.int64(0),
        }
        return command(entries, "parametrised", agent).action

    assert read("MoveAhead") == parse_action("MoveAhead 0.25")
    assert read("MoveAhead", 0.5) == parse_action("MoveAhead 0.5")
    assert read("RotateLeft", 0.25) == parse_action("RotateLeft 45")
    assert read("MoveBack", -1.0) == parse_action("MoveBack 0")
    assert read("LookDown", 1 / 6) == parse_action("LookDown 30")  # which float32 is not
    hand = read("MoveArm", 0.25, 0.125, 0.5)  # half a metre ahead, a quarter to the left, one metre up, facing +y
    assert hand is not None
    assert hand.numbers == pytest.approx((-0.25, 0.5, 1.0 + agent.world.scene.floor_z))


def test_the_agent_is_seen_from_outside() -> None:
    env = RemqaEnv(**SMALL, render_mode="rgb_array")
    env.reset(seed=0)
    before = env.render()
    env.step(LEFT)
    after = env.render()
    assert before is not None
    assert before.shape == (48, 64, 3)
    assert not np.array_equal(before, after)
    env.close()


@pytest.mark.slow
def test_pictures_from_outside_depend_on_no_earlier_episode() -> None:
    arguments = {**SMALL, "render_mode": "rgb_array", "max_steps": 40}
    used, fresh = RemqaEnv(**arguments), RemqaEnv(**arguments)
    for seed in range(4):
        used.reset(seed=seed)
        used.render()
    moved = used.unwrapped._needed_room().third_person._place
    used.reset(seed=9)
    fresh.reset(seed=9)
    np.testing.assert_array_equal(used.render(), fresh.render())
    assert moved != PLACES[0]  # so that there was something to forget
    for env in (used, fresh):
        env.close()


@pytest.mark.slow
def test_an_environment_that_is_dropped_gives_its_simulator_back() -> None:
    clients = set()
    for _ in range(3):
        env = RemqaEnv(**SMALL)
        env.reset(seed=0)
        clients.add(env.agent.world.client.number)
        del env
        gc.collect()
    assert len(clients) == 1


@pytest.mark.slow
def test_a_question_becomes_a_film(two_rooms: Path, tmp_path: Path) -> None:
    import cv2

    env = RemqaEnv(two_rooms, "test")
    path = tmp_path / "episode.mp4"
    frames = write_film(two_rooms, env.episode_ids[0], path)
    film = cv2.VideoCapture(str(path))
    read = 0
    while film.read()[0]:
        read += 1
    assert read == frames > 10
    with pytest.raises(UnknownNameError):
        write_film(two_rooms, "nothing", path)
