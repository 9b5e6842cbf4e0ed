import os
import sys
from pathlib import Path

import numpy as np
import pytest

from remqa_data.errors import MissingExtraError
from remqa_data.generators.audit.balance import AskedQuestion, asked_questions
from remqa_data.generators.audit.blind import TOLERANCE, blind_scores
from remqa_data.storage.manifest import load_manifest
from remqa_data.tables.rows import KINDS

DATASET = "REMQA_DATASET"
"""Environment variable: folder of a full dataset."""
TYPES = ("mug", "apple", "book", "pen", "spoon", "towel", "vase", "plate")
PLACES = ("fridge", "drawer next to the sink", "safe", "box on the bed", "cabinet")


def asked(text: str, answer: str, room: int, kind: str = "EXISTENCE") -> AskedQuestion:
    split = "test" if room % 5 == 0 else "train"
    return AskedQuestion(f"{room}-{text}-{answer}", kind, text, answer, f"FloorPlan{room}", 0, split, f"{room}-{text}")


def rooms_full(answer_of) -> list[AskedQuestion]:
    """40 rooms with 20 questions each; `answer_of` is given the type, the place and random numbers."""
    rng = np.random.default_rng(0)
    made = []
    for room in range(40):
        for _ in range(20):
            type_, place = str(rng.choice(TYPES)), str(rng.choice(PLACES))
            made.append(asked(f"Is there a {type_} in the {place}?", answer_of(type_, place, rng), room))
    return made


@pytest.mark.slow
def test_questions_whose_words_tell_the_answer_are_told_apart() -> None:
    (score,) = blind_scores(rooms_full(lambda type_, place, rng: "yes" if type_ in TYPES[:4] else "no"))
    assert (score.kind, score.questions) == ("EXISTENCE", 160)
    assert score.accuracy == score.accuracy_across_rooms == 1.0
    assert score.is_excess


def test_a_word_that_is_right_more_often_than_not_is_noticed() -> None:
    def mostly(type_: str, place: str, rng: np.random.Generator) -> str:
        return "yes" if (place == "fridge") == (rng.random() < 0.9) else "no"

    (score,) = blind_scores(rooms_full(mostly))
    assert score.is_excess
    assert score.accuracy > 0.8


def test_answers_that_no_word_tells_are_guessed() -> None:
    (score,) = blind_scores(rooms_full(lambda type_, place, rng: str(rng.choice(["yes", "no"]))))
    assert abs(score.accuracy - 0.5) < 3 * score.chance_error
    assert not score.is_excess
    assert score.accuracy_across_rooms is not None
    assert abs(score.accuracy_across_rooms - 0.5) < 0.05


def test_questions_that_are_asked_with_both_answers_give_exactly_chance() -> None:
    """Any function of the words is right of exactly one of each pair."""
    pairs = [asked(f"Is there a {t} in the {p}?", a, r) for r in range(10) for t in TYPES for p in PLACES for a in "YN"]
    (score,) = blind_scores(pairs)
    assert (score.accuracy, score.chance, score.accuracy_across_rooms) == (0.5, 0.5, 0.5)
    assert not score.is_excess


def test_chance_is_the_share_of_the_most_frequent_answer_of_the_test_split() -> None:
    train = [asked(f"How many {t}s?", a, 1, "COUNTING") for t in TYPES for a in "0123"]
    test = [asked("How many mugs?", a, 5, "COUNTING") for a in "0012"]
    (score,) = blind_scores([*train, *test])
    assert (score.questions, score.chance) == (4, 0.5)
    assert score.accuracy_across_rooms is None  # two rooms cannot be cut into five parts


def test_a_kind_that_one_split_lacks_has_no_score() -> None:
    assert blind_scores([asked("Is there a mug?", answer, 1) for answer in ("yes", "no")]) == []
    assert blind_scores([asked("Is there a mug?", "yes", room) for room in (1, 5)]) == []


def test_without_scikit_learn_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "sklearn", None)
    with pytest.raises(MissingExtraError, match=r"remqa-data\[report\]"):
        blind_scores(rooms_full(lambda type_, place, rng: "yes" if rng.random() < 0.5 else "no"))


@pytest.mark.parametrize("kind", KINDS)
def test_a_full_dataset_cannot_be_answered_from_its_words(kind: str) -> None:
    if DATASET not in os.environ:
        pytest.skip(f"needs the folder of a full dataset in {DATASET} (remqa-gen --scenes 120 makes one)")
    root = Path(os.environ[DATASET])
    score = next(score for score in blind_scores(asked_questions(root, load_manifest(root))) if score.kind == kind)
    assert score.accuracy <= score.chance + TOLERANCE, score
    assert score.accuracy_across_rooms is not None
    assert score.accuracy_across_rooms <= score.chance + TOLERANCE, score
