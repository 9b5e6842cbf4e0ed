"""Many walks over cached views in one process, in one array."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium import spaces
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.env.arguments import check_counts, check_flags, check_render_mode
from remqa_data.env.cached.environment import begin, observation_space
from remqa_data.env.cached.tasks import CachedTasks
from remqa_data.env.cached.walk import ACTIONS, Walk, action_number
from remqa_data.env.environment import type_numbers
from remqa_data.env.record import reward_of
from remqa_data.errors import ActionError, one_line

Batch = tuple[dict[str, Any], npt.NDArray[np.float64], npt.NDArray[np.bool_], npt.NDArray[np.bool_], dict[str, Any]]


class CachedRemqaVectorEnv(VectorEnv[dict[str, Any], Any, npt.NDArray[Any]]):
    """Several `CachedRemqaEnv`, which share one cache; as Gymnasium's SyncVectorEnv, but several times faster.

    An environment whose episode has ended begins the next one in the next step. In `info` there are "success" (of those that
    did an action), "privileged", what an episode's beginning and end say, and no words for actions and refusals.

    Parameters
    ----------
    num_envs : int
        How many.
    root, views, split, question_ids, max_steps, features, vocabulary, render_mode
        See `CachedRemqaEnv`.
    max_episode_steps : int, optional
        What `gymnasium.make_vec` calls `max_steps`: an episode is truncated after the fewer of both; -1 for no other limit.
    """

    metadata: dict[str, Any] = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}  # noqa: RUF012

    def __init__(
        self,
        num_envs: int,
        root: str | os.PathLike[str],
        views: str | os.PathLike[str],
        split: str = "train",
        *,
        question_ids: Sequence[str] | None = None,
        max_steps: int = 250,
        features: bool = False,
        vocabulary: Vocabulary | None = None,
        render_mode: str | None = None,
        max_episode_steps: int | None = None,
    ) -> None:
        check_render_mode(render_mode)
        check_counts(num_envs=num_envs, max_steps=max_steps)
        if max_episode_steps not in (None, -1):
            check_counts(max_episode_steps=max_episode_steps)
            max_steps = min(max_steps, max_episode_steps)
        check_flags(features=features)
        self.num_envs, self.autoreset_mode, self.render_mode = num_envs, AutoresetMode.NEXT_STEP, render_mode
        self.tasks = CachedTasks(root, views, split, question_ids, vocabulary)
        self.walks = [Walk(self.tasks, max_steps) for _ in range(num_envs)]
        self._has_features, self._has_begun = features, False
        self._draws = [seeding.np_random() for _ in range(num_envs)]
        self.single_action_space = spaces.Discrete(len(ACTIONS))
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.single_observation_space = observation_space(self.tasks, features)
        self.observation_space = batch_space(self.single_observation_space, num_envs)

    @property
    def episode_ids(self) -> tuple[str, ...]:
        """What `reset` can choose from: ids of questions."""
        return self.tasks.ids

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Any], dict[str, Any]]:
        """Begin an episode in each; environment i draws from `seed + i`, or from seed i of a sequence.

        `options={"reset_mask": mask}`, (num_envs,) bool, begins them only there.
        """
        wanted = dict(options or {})
        mask = self._mask(wanted.pop("reset_mask", None))
        for number, one in enumerate(self._seeds(seed)):
            if one is not None and mask[number]:
                self._draws[number] = seeding.np_random(one)
        info: dict[str, Any] = {}
        self._has_begun = False  # until all have
        for number in np.flatnonzero(mask).tolist():
            info = self._begin(number, info, wanted)
        self._tell()
        self._has_begun = True
        return self._observe(), info

    def step(self, actions: npt.ArrayLike) -> Batch:
        """Do one action in each.

        Raises
        ------
        ActionError
            If one is no action, or no episodes have begun.
        """
        if not self._has_begun:
            raise ActionError("there are no episodes going on: call reset")
        numbers = [action_number(action) for action in np.atleast_1d(np.asarray(actions)).tolist()]
        if len(numbers) != self.num_envs:
            raise ActionError(f"there are {len(numbers)} actions for {self.num_envs} environments")
        rewards = np.zeros(self.num_envs)
        terminated, truncated, success = (np.zeros(self.num_envs, dtype=np.bool_) for _ in range(3))
        info: dict[str, Any] = {}
        acted = np.ones(self.num_envs, dtype=np.bool_)
        for i, (walk, number) in enumerate(zip(self.walks, numbers, strict=True)):
            if walk.is_over:
                info, acted[i] = self._begin(i, info), False
                continue
            success[i] = not walk.act(number)
            terminated[i], truncated[i] = walk.ended(number)
            if walk.is_over:
                measures = walk.measures(number)
                rewards[i] = reward_of(measures, bool(terminated[i]))
                info = self._add_info(info, measures, i)
        if not acted.all():
            self._tell()
        everywhere, nowhere = np.ones(self.num_envs, dtype=np.bool_), np.zeros(self.num_envs, dtype=np.bool_)
        info |= {"privileged": nowhere, "_privileged": everywhere}
        if acted.any():
            info |= {"success": success, "_success": acted}
        return self._observe(), rewards, terminated, truncated, info

    @property
    def np_random_seed(self) -> tuple[int, ...]:  # type: ignore[override]
        """What each draws from, as SyncVectorEnv tells it."""
        return tuple(seed for _, seed in self._draws)

    @property  # type: ignore[misc]
    def np_random(self) -> tuple[np.random.Generator, ...]:  # type: ignore[override]
        """What each draws with."""
        return tuple(generator for generator, _ in self._draws)

    def close_extras(self, **kwargs: Any) -> None:
        """There are no steps any more."""
        self._has_begun = False

    def _begin(self, number: int, info: dict[str, Any], options: dict[str, Any] | None = None) -> dict[str, Any]:
        said = begin(self.walks[number], self.tasks, self._draws[number][0], options)
        return self._add_info(info, said, number)

    def _seeds(self, given: Any) -> list[int | None]:
        """What each is to draw from; None to go on."""
        seeds = given.tolist() if isinstance(given, np.ndarray) else given
        if isinstance(seeds, int | np.integer):
            return [int(seeds) + i for i in range(self.num_envs)]
        if seeds is None:
            return [None] * self.num_envs
        if not (isinstance(seeds, Sequence) and all(isinstance(one, int | np.integer | None) for one in seeds)):
            raise ActionError(f"seed is {one_line(repr(given)):.80}: give a whole number, or one for each environment")
        if len(seeds) != self.num_envs:
            raise ActionError(f"there are {len(seeds)} seeds for {self.num_envs} environments")
        return [None if one is None else int(one) for one in seeds]

    def _mask(self, given: Any) -> npt.NDArray[np.bool_]:
        """Which begin an episode."""
        if given is None:
            return np.ones(self.num_envs, dtype=np.bool_)
        mask = np.asarray(given)
        if mask.shape != (self.num_envs,) or mask.dtype != np.bool_ or not mask.any():
            raise ActionError(f"reset_mask is {given!r:.80}: give {self.num_envs} of True and False, at least one True")
        if not (self._has_begun or mask.all()):
            raise ActionError("reset_mask: there are no episodes going on yet; reset all of them first")
        return mask

    def _tell(self) -> None:
        """Note what is told of the episodes, which stays the same until one begins."""
        tasks = [walk.task for walk in self.walks]
        self._told = {
            "question": tuple(self.tasks.question(task) for task in tasks),
            "question_tokens": np.stack([self.tasks.tokens(task) for task in tasks]),
            "target": np.array([type_numbers()[task.target_type] for task in tasks]),
        }

    def _observe(self) -> dict[str, Any]:
        size, walks = self.tasks.views.size_px, self.walks
        rgb = np.empty((self.num_envs, size, size, 3), dtype=np.uint8)
        for walk, onto in zip(walks, rgb, strict=True):
            walk.room.draw(walk.state, onto)
        told = {key: np.copy(value) if isinstance(value, np.ndarray) else value for key, value in self._told.items()}
        observation = {"rgb": rgb, "pose": np.array([walk.room.poses[walk.state] for walk in walks]), **told}
        if self._has_features:
            observation["features"] = np.array([walk.room.features[walk.state] for walk in walks])  # type: ignore[index]
        return observation
