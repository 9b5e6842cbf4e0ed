"""Several environments side by side, in this process and in others."""

from functools import partial
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

from remqa_data.env import ENV_ID, RemqaEnv
from remqa_data.env.actions import DISCRETE
from remqa_data.errors import UnknownNameError
from remqa_data.storage.shards import read_table

SMALL = {"scenes": ["FloorPlan406"], "width": 64, "height": 48}
AHEAD, LEFT = DISCRETE.index("MoveAhead"), DISCRETE.index("RotateLeft")


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*ERROR")
def test_what_goes_wrong_in_a_process_of_its_own_is_told_as_in_this_one(small_rooms: Path) -> None:
    envs = gymnasium.make_vec(ENV_ID, num_envs=1, vectorization_mode="async", root=small_rooms, width=8, height=8)
    with pytest.raises(UnknownNameError, match="unknown question 'Small1-q'; did you mean") as caught:
        envs.reset(options={"episode": "Small1-q"})
    assert caught.value.kind == "question"
    envs.close(terminate=True)


@pytest.mark.slow
def test_two_environments_in_processes_of_their_own_are_like_one() -> None:
    envs = gymnasium.make_vec(ENV_ID, num_envs=2, vectorization_mode="async", **SMALL)
    seen, _ = envs.reset(seed=5)
    alone = RemqaEnv(**SMALL)
    first, _ = alone.reset(seed=5)
    assert np.array_equal(seen["rgb"][0], first["rgb"])
    assert seen["question"] == ("", "")
    seen, *_ = envs.step(np.array([LEFT, AHEAD]))
    assert np.array_equal(seen["depth"][0], alone.step(LEFT)[0]["depth"])
    envs.close()
    alone.close()


@pytest.mark.slow
@pytest.mark.parametrize(
    "vector",
    [
        gymnasium.vector.SyncVectorEnv,
        gymnasium.vector.AsyncVectorEnv,
        partial(gymnasium.vector.AsyncVectorEnv, copy=False),
        partial(gymnasium.vector.AsyncVectorEnv, shared_memory=False),
        partial(gymnasium.vector.AsyncVectorEnv, context="spawn"),
    ],
)
def test_vector_environments_ask_the_questions_that_are_played(two_rooms: Path, vector: Any) -> None:
    table = read_table(two_rooms, "questions", "train", ["question_id", "question"])
    asked = dict(zip(*(table[name].to_pylist() for name in table.column_names), strict=True))
    assert len(set(asked.values())) > 1
    envs = vector([partial(RemqaEnv, two_rooms, "train", width=8, height=8, max_steps=1)] * 2)
    heard = set()
    for seed in range(3):
        seen, info = envs.reset(seed=seed)
        assert seen["question"] == tuple(asked[name] for name in info["episode_id"])
        heard |= set(seen["question"])
        before = seen
        seen, *_ = envs.step(np.array([LEFT, LEFT]))
        assert seen["question"] == tuple(asked[name] for name in info["episode_id"])
        seen, *_, info = envs.step(np.array([LEFT, LEFT]))  # which begins the next episode
        assert seen["question"] == tuple(asked[name] for name in info["episode_id"])
        heard |= set(seen["question"])
    assert len(heard) > 1
    assert isinstance(before["question"], tuple) or not envs.copy
    envs.close()
