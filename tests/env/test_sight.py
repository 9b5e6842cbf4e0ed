"""An agent acts on what it sees, by names and points of the picture that it gets."""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from remqa_data.env import RemqaEnv
from remqa_data.env.actions import Command
from remqa_data.env.oracle import oracle_commands
from remqa_data.errors import ActionError
from remqa_data.sim.agent.actions import Action

Begun = Callable[..., tuple[RemqaEnv, Command, Command]]


@pytest.fixture
def begun(small_rooms: Path) -> Iterator[Begun]:
    """An environment in which the oracle has walked to its goal, what it would do there, and its answer."""
    made: list[RemqaEnv] = []

    def begin(**arguments: object) -> tuple[RemqaEnv, Command, Command]:
        made.append(RemqaEnv(small_rooms, "test", **arguments))
        made[-1].reset(options={"episode": made[-1].episode_ids[0]})
        *walk, manipulation, answer = commands_of(made[-1])
        for step in walk:
            made[-1].step(step)
        return made[-1], manipulation, answer

    yield begin
    for env in made:
        env.close()


def commands_of(env: RemqaEnv) -> list[Command]:
    task = env.episode.task
    assert task is not None
    return oracle_commands(task)


@pytest.mark.parametrize("privileged", [False, True])
def test_only_who_is_privileged_acts_on_what_it_does_not_see(begun: Begun, privileged: bool) -> None:
    found = {}
    for turned in (False, True):
        env, manipulation, answer = begun(hands="arm", width=32, height=32, privileged=privileged)
        for _ in range(2 * turned):
            env.step("RotateLeft")
        info = env.step(manipulation)[-1]
        found[turned] = info["success"], env.step(answer)[-1]["manipulated"]
    assert found == {
        False: (True, True),
        True: (privileged, False),
    }  # as for the evaluator, what is not seen is not done


def test_names_tell_nothing_of_what_is_not_seen(begun: Begun) -> None:
    env, manipulation, _ = begun(hands="arm")
    for _ in range(2):
        env.step("RotateLeft")
    hidden = sorted({*env.agent.world.ids} - {*env.agent.visible_objects()})
    assert manipulation.action is not None
    assert manipulation.action.target in hidden
    for name in (*hidden, f"{hidden[0]}0", "Apple"):
        for action in ("OpenObject {}", "PickupObject {}", "PutObject {}", "PushObject {}", "MoveObject {} 9 9 9"):
            said = env.step(action.format(name))[-1]
            assert (said["success"], said["error"]) == (False, f"{name} is not visible")


def test_a_refusal_names_only_what_is_seen(begun: Begun, monkeypatch: pytest.MonkeyPatch) -> None:
    env, manipulation, _ = begun(hands="arm")
    assert manipulation.action is not None
    name, told = str(manipulation.action.target), []
    x, y, z = env.agent.world.state(name).position
    for seen in ([name], []):
        monkeypatch.setattr(env.agent, "visible_objects", lambda seen=seen: seen)
        told.append(env.step(f"MoveArm {x} {y} {z}")[-1]["error"])
    assert f"{name} is blocking" in told[0]
    assert told[1] == told[0].replace(name, "something")


def test_points_and_boxes_are_of_the_picture_that_the_agent_gets(begun: Begun) -> None:
    env, manipulation, answer = begun(hands="reach", width=640, height=360, privileged=True)
    assert manipulation.action is not None
    observation, *_, info = env.step("LookUp 0")
    is_target = observation["instances"] == 1 + info["object_ids"].index(manipulation.action.target)
    rows, columns = np.nonzero(is_target)
    high, wide = is_target.shape
    middle = np.argmin(abs(columns - columns.mean()) + abs(rows - rows.mean()))
    point = (columns[middle] + 0.5) / wide, (rows[middle] + 0.5) / high
    box = columns.min() / wide, rows.min() / high, (columns.max() + 1) / wide, (rows.max() + 1) / high
    assert env.step(Command(Action(manipulation.action.name, point), box=box))[-1]["success"]
    info = env.step(answer)[-1]
    assert info["manipulated"]
    assert info["iou"] > 0.97  # both are whole pixels, of two sizes


@pytest.mark.parametrize(
    "target",
    [[0.5], (0.1, 0.2, 0.3), 5, ("a", "b"), {"x": 1}],
)
def test_a_target_is_a_name_or_a_point(target: object) -> None:
    with pytest.raises(ActionError, match="OpenObject"):
        Action("OpenObject", target)  # type: ignore[arg-type]
    assert str(Action("OpenObject", [0.5, np.float32(0.25)])) == "OpenObject @0.5,0.25"  # type: ignore[arg-type]
