"""The Gymnasium environment `remqa_data/Remqa-v0`: an agent in a room, with a question to answer.

Importing this module registers it:

>>> import gymnasium, remqa_data.env
>>> "remqa_data/Remqa-v0" in gymnasium.registry
True

docs/ENVIRONMENT.md tells the whole story.
"""

from __future__ import annotations

import string
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, get_args

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium import spaces

from remqa_data.catalog import catalog
from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.env.actions import ActionMode, Shares, action_space, command
from remqa_data.env.arguments import check_counts, check_flags, check_render_mode, check_vocabulary
from remqa_data.env.episodes import DatasetEpisodes, Episode, Episodes, SceneEpisodes
from remqa_data.env.loaded_scene import LoadedRoom
from remqa_data.env.question import QuestionText
from remqa_data.env.record import EpisodeRecord, reward_of
from remqa_data.errors import ActionError
from remqa_data.limits import MAX_TEXT, MOST_IMAGE_PX
from remqa_data.scene import Scene
from remqa_data.sim.agent.actions import (
    DONE,
    MANIPULATION,
    NAVIGATION,
    TELEPORT,
    Action,
    amounts_of,
    nothing_at,
    perform,
)
from remqa_data.sim.agent.agent import Agent, Hands
from remqa_data.sim.agent.pictures import BYTES_PER_PIXEL
from remqa_data.sim.agent.results import ActionResult

ENV_ID = "remqa_data/Remqa-v0"

MAX_QUESTION_CHARACTERS, MAX_QUESTION_WORDS = 200, 40
CHARACTERS = " " + string.printable.replace(" ", "")
"""Of questions."""
MOST_OF_ACTION = MAX_TEXT + 100
"""Characters of an action in `info`: those that submissions hold are shorter."""
ROOM_M, DEPTH_M = 100.0, 100.0
"""Bounds of the spaces: no room is so large."""


class RemqaEnv(gymnasium.Env[dict[str, Any], Any]):
    """An agent that sees, walks, reaches, opens, moves, picks up, and answers.

    Parameters
    ----------
    root : path, optional
        Folder of a finished dataset, whose questions are the episodes.
    split : str
        Of the dataset.
    question_ids : sequence of str, optional
        Only these questions, which `reset` then draws from in this order.
    scenes : sequence of str or Scene, optional
        Instead of a dataset: bare rooms, by the name of a floor plan, in which nothing is asked.
    action_mode : {"discrete", "parametrised"}
        What the action space is; see `remqa_data.env.actions`.
    hands : {"arm", "reach", "near"}
        What it takes to act on a thing; see `remqa_data.sim.agent.agent.Hands`.
    width, height : int
        Of the images, pixels.
    max_steps : int
        An episode is truncated after so many steps.
    privileged : bool
        Whether the agent gets what no agent should: instance images, Teleport, and to act on what it does not see.
        `info["privileged"]` marks the run.
    vocabulary : Vocabulary, optional
        For the question's tokens; by default that of the dataset's train split.
    views_kept : int
        So many pictures of a room that nothing has been done to are remembered, 1.7 MB each of 300 x 300: agents come by the
        same places again. Nothing else depends on it.
    render_mode : {"rgb_array"}, optional
        `render` gives the view of a camera behind the agent, with its arm.

    Notes
    -----
    `reset(options={"episode": id})` chooses an episode of `episode_ids`; otherwise it is drawn. The reward is 1 at the
    end of an episode in which the agent navigated to the target and answered rightly, else 0.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012
        "render_modes": ["rgb_array"],
        "render_fps": 5,
    }

    def __init__(
        self,
        root: str | Path | None = None,
        split: str = "train",
        *,
        question_ids: Sequence[str] | None = None,
        scenes: Sequence[str | Scene] | None = None,
        action_mode: ActionMode = "discrete",
        hands: Hands = "arm",
        width: int = 300,
        height: int = 300,
        max_steps: int = 250,
        privileged: bool = False,
        vocabulary: Vocabulary | None = None,
        views_kept: int = 0,
        render_mode: str | None = None,
    ) -> None:
        if (root is None) == (scenes is None):
            raise ActionError("give either the root of a dataset or scenes: one of them, not both")
        if scenes is not None and (question_ids is not None or split != "train"):
            raise ActionError("in bare rooms nothing is asked: give split and question_ids with the root of a dataset")
        check_render_mode(render_mode, *self.metadata["render_modes"])
        if hands not in get_args(Hands):
            raise ActionError(f"hands {hands!r:.80} is none of {', '.join(get_args(Hands))}")
        check_counts(width=width, height=height, max_steps=max_steps)
        check_counts(0, views_kept=views_kept)
        check_flags(privileged=privileged)
        check_vocabulary(vocabulary)
        if max(width, height) > MOST_IMAGE_PX:
            raise ActionError(f"a view of {width} x {height} pixels: give at most {MOST_IMAGE_PX} x {MOST_IMAGE_PX}")
        self.episodes: Episodes
        self.split = None if root is None else split
        if root is not None:
            self.episodes = DatasetEpisodes(root, split, question_ids)
            self.vocabulary = vocabulary or Vocabulary.from_dataset(root)
        else:
            self.episodes = SceneEpisodes(() if scenes is None else scenes)
            self.vocabulary = vocabulary or Vocabulary.build((), ())
        self.action_mode: ActionMode = action_mode
        self.hands: Hands = hands
        self.width, self.height, self.max_steps = width, height, max_steps
        self.privileged, self.views_kept, self.render_mode = privileged, views_kept, render_mode
        self.action_space = action_space(action_mode)
        self.observation_space = _observation_space(width, height, self.vocabulary, privileged)
        self._room: LoadedRoom | None = None
        self._is_over = True

    @property
    def episode_ids(self) -> tuple[str, ...]:
        """What `reset` can choose from: ids of questions, or names of scenes."""
        return self.episodes.ids

    @property
    def agent(self) -> Agent:
        """The agent; the policy that is trained should not look here."""
        return self._needed_room().agent

    @property
    def episode(self) -> Episode:
        """The episode that is played."""
        return self._needed_room().episode

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Begin an episode; `options={"episode": id}` chooses which. If this fails, there is none.

        Raises
        ------
        ActionError
            For an option that there is not.
        UnknownNameError
            If there is no such episode.
        """
        self._is_over = True  # until there is all that an episode takes
        super().reset(seed=seed)
        name = wanted_episode(self.episode_ids, self.np_random, options)
        episode = self.episodes.episode(name)
        if self._room is None or self._room.episode.name != episode.name:
            self.close()
            kept = self.views_kept * self.width * self.height * BYTES_PER_PIXEL
            self._room = LoadedRoom(episode, self.hands, kept)
        self._room.begin(episode, self.np_random)
        self.record = EpisodeRecord(positions=[(self.agent.x, self.agent.y)])
        self.steps, self._is_over = 0, False
        task = episode.task
        text = task.question if task else ""
        self._question = shown_question(text), question_tokens(self.vocabulary, text)
        info = {"scene": episode.name, "episode_id": name, "privileged": self.privileged}
        return self._observe(info), info

    def step(self, action: Any) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        """Do one action, given as `remqa_data.env.actions.command` reads it.

        `info["success"]` and `info["error"]` say what came of it. At the end `info` also holds the measures.

        Raises
        ------
        ActionError
            If it is no action, or the episode has not begun or is over.
        UnknownNameError
            If a privileged agent names an object that is not in the room. To another one that is as any that it does not see.
        """
        if self._is_over:
            raise ActionError("there is no episode going on: call reset")
        wanted = command(action, self.action_mode, self.agent)
        result = ActionResult(True) if wanted.action is None else self._act(wanted.action, wanted.box)
        self.steps += 1
        terminated = wanted.action is None or wanted.action.name == DONE
        truncated = not terminated and self.steps >= self.max_steps
        info: dict[str, Any] = {
            "action": f"{wanted!s:.{MOST_OF_ACTION}}",
            "success": result.success,
            "error": result.error,
            "privileged": self.privileged,
        }
        reward = 0.0
        if terminated or truncated:
            self._is_over = True
            task = self.episode.task
            if task is not None:
                info["answer"] = wanted.answer
                self.record.look(self.agent, task, self._in_frame(wanted.box))
                info |= self.record.measures(task, wanted.answer)
                reward = reward_of(info, terminated)
        return self._observe(info), reward, terminated, truncated, info

    def render(self) -> npt.NDArray[np.uint8] | None:
        """The agent from behind, (height, width, 3) RGB, or None without a render mode."""
        return None if self.render_mode is None else self._needed_room().third_person.render(self.width, self.height)

    def close(self) -> None:
        """Give the simulator's memory back."""
        if self._room is not None:
            self._room.world.close()
            self._room = None
        self._is_over = True

    def _act(self, action: Action, box: Shares | None) -> ActionResult:
        if action.name == TELEPORT and not self.privileged:
            raise ActionError(f"{TELEPORT} is only for privileged agents")
        if action.name in MANIPULATION:
            return self._manipulate(action, box)
        result = perform(self.agent, action)
        if action.name in NAVIGATION:
            self.record.walked(action, self.agent)
        return result if self.privileged else result.without_name()

    def _manipulate(self, action: Action, box: Shares | None) -> ActionResult:
        """Act on a thing. Names, be they right or wrong, tell who is not privileged nothing of what it does not see."""
        target, agent, task = action.target, self.agent, self.episode.task
        amounts_of(action)  # is it an action at all? What is not there is asked next
        if isinstance(target, tuple):
            target = agent.object_at(*target, agent.camera(self.width, self.height))
            if target is None:
                return nothing_at(action)
            action = Action(action.name, target, action.numbers)
        elif target is not None and not self.privileged and target not in agent.visible_objects():
            return ActionResult(False, f"{target:.{MAX_TEXT}} is not visible")
        if task is not None and target is not None:
            self.record.look(agent, task, self._in_frame(box))
        result = perform(agent, action)
        if result.success and target is not None:
            self.record.manipulated(action, target, agent)
        return result if result.success or self.privileged else self._without_names(result, target)

    def _without_names(self, refusal: ActionResult, target: str | None) -> ActionResult:
        """A refusal that names nothing but the target, what the agent holds and what it sees."""
        words = refusal.error.split(" ")
        named = {word.rstrip(":,") for word in words} & {*self.agent.world.ids} - {target, self.agent.held}
        if not named:  # so nothing is drawn
            return refusal
        unseen = named.difference(self.agent.visible_objects())
        told = (word.replace(name, "something") if (name := word.rstrip(":,")) in unseen else word for word in words)
        return ActionResult(False, " ".join(told))

    def _in_frame(self, box: Shares | None) -> Shares | None:
        """A box of the agent's picture in the square one that is scored, which is as high, and may be narrower or wider."""
        if box is None or self.width == self.height:
            return box
        left, top, right, bottom = box
        left, right = (min(max(0.5 + (x - 0.5) * self.width / self.height, 0.0), 1.0) for x in (left, right))
        return left, top, right, bottom

    def _observe(self, info: dict[str, Any]) -> dict[str, Any]:
        agent = self.agent
        seen = self._needed_room().look(self.width, self.height)
        pose = [agent.x, agent.y, agent.yaw_deg, agent.horizon_deg, float(agent.is_standing)]
        held = 0 if agent.held is None else type_numbers()[agent.world.type_of(agent.held)]
        observation: dict[str, Any] = {
            "rgb": seen.rgb,
            "depth": seen.depth,
            "pose": np.array(pose, dtype=np.float32),
            "held": np.int64(held),
            "question": self._question[0],
            "question_tokens": self._question[1].copy(),
        }
        if self.privileged:
            observation["instances"] = seen.objects + 1
            info["object_ids"] = agent.world.ids
        return observation

    def _needed_room(self) -> LoadedRoom:
        if self._room is None:
            raise ActionError("there is no episode going on: call reset")
        return self._room


def wanted_episode(ids: Sequence[str], rng: np.random.Generator, options: Mapping[str, Any] | None) -> str:
    """The episode that the options of `reset` name, or one that is drawn from some.

    Raises
    ------
    ActionError
        For an option that there is not, or an episode that is no name.
    """
    if options is not None and not isinstance(options, Mapping):
        raise ActionError(f"options is {options!r:.80}: give a dict, such as {{'episode': {ids[0]!r}}}")
    wanted = dict(options or {})
    name = wanted.pop("episode", None)
    if wanted:
        raise ActionError(f"reset takes the option 'episode', not {', '.join(map(repr, wanted)):.80}")
    if name is not None and not isinstance(name, str):
        raise ActionError(f"episode is {name!r:.80}: give the name of one, such as {ids[0]!r}")
    return ids[int(rng.integers(len(ids)))] if name is None else str(name)  # NumPy has texts of its own


@cache
def type_numbers() -> Mapping[str, int]:
    """The numbers that observations have for object types, from 1."""
    return {name: number for number, name in enumerate(catalog(), start=1)}


def shown_question(text: str) -> str:
    """A question as it is observed, cut to MAX_QUESTION_CHARACTERS."""
    return text[:MAX_QUESTION_CHARACTERS]


def question_tokens(vocabulary: Vocabulary, text: str) -> npt.NDArray[np.int64]:
    """(MAX_QUESTION_WORDS,) the first words of a question as numbers, padded with 0."""
    tokens = np.array(vocabulary.encode(text)[:MAX_QUESTION_WORDS], dtype=np.int64)
    return np.pad(tokens, (0, MAX_QUESTION_WORDS - len(tokens)))


def pose_space() -> spaces.Box:
    """Of poses: x, y in metres, yaw_deg, horizon_deg, 1 if the agent stands."""
    low = np.array([-ROOM_M, -ROOM_M, 0.0, -90.0, 0.0], dtype=np.float32)
    high = np.array([ROOM_M, ROOM_M, 360.0, 90.0, 1.0], dtype=np.float32)
    return spaces.Box(low, high, dtype=np.float32)


def question_space() -> spaces.Text:
    """Of questions."""
    return QuestionText(MAX_QUESTION_CHARACTERS, min_length=0, charset=CHARACTERS)


def tokens_space(vocabulary: Vocabulary) -> spaces.Box:
    """Of `question_tokens`."""
    return spaces.Box(0, max(len(vocabulary.words) - 1, 1), (MAX_QUESTION_WORDS,), np.int64)


def _observation_space(width: int, height: int, vocabulary: Vocabulary, privileged: bool) -> spaces.Dict:
    entries: dict[str, spaces.Space[Any]] = {
        "rgb": spaces.Box(0, 255, (height, width, 3), np.uint8),
        "depth": spaces.Box(0.0, DEPTH_M, (height, width), np.float32),
        "pose": pose_space(),
        "held": spaces.Discrete(len(type_numbers()) + 1),
        "question": question_space(),
        "question_tokens": tokens_space(vocabulary),
    }
    if privileged:
        entries["instances"] = spaces.Box(0, np.iinfo(np.int32).max, (height, width), np.int32)
    return spaces.Dict(entries)


def register() -> None:
    """Make `gymnasium.make("remqa_data/Remqa-v0", ...)` work; importing this module does it."""
    if ENV_ID not in gymnasium.registry:
        gymnasium.register(ENV_ID, entry_point="remqa_data.env:RemqaEnv")


register()
