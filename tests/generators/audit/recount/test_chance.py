import numpy as np
import pandas as pd
import pytest

from remqa_data.generators.audit.recount.chance import CUES, cue_scores


def views(rng: np.random.Generator, **tells: float) -> pd.DataFrame:
    """800 questions about 40 rooms; each cue that is named is larger by so much where the answer is yes."""
    is_yes = np.arange(800) % 2 == 0
    cues = {cue: rng.normal(size=800) + tells.get(cue, 0.0) * is_yes for cue in CUES if cue != "is_revealed"}
    rooms = [f"FloorPlan{number % 40}" for number in range(800)]
    answers = np.where(is_yes, "yes", "no")
    return pd.DataFrame({"kind": "EXISTENCE", "scene": rooms, "answer": answers, **cues})


@pytest.mark.slow
def test_a_cue_that_goes_with_the_answer_tells_it() -> None:
    scores = cue_scores(views(np.random.default_rng(0), end_bytes=2.0))
    telling = {score.cue for score in scores if score.accuracy > score.luck}
    assert telling == {"end_bytes"}


@pytest.mark.slow
def test_cues_that_are_luck_stay_at_chance() -> None:
    found = [cue_scores(views(np.random.default_rng(seed))) for seed in range(4)]
    assert sum(map(len, found)) == 28
    lucky = [score for scores in found for score in scores if score.accuracy > score.luck]
    assert len(lucky) <= 4  # of 28, at 2.5 in 100 and a little more
    assert all(score.chance == 0.5 for scores in found for score in scores)


def test_too_few_rooms_say_nothing() -> None:
    assert cue_scores(views(np.random.default_rng(0)).query("scene in ['FloorPlan0', 'FloorPlan1']")) == []
