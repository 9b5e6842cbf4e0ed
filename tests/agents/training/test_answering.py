from pathlib import Path
from typing import Any

import numpy as np
import pytest

from remqa_data.agents.networks.detection.detector import Detector
from remqa_data.agents.training import answering
from remqa_data.agents.training.answering import AnsweringTask, AskedViews, Others
from remqa_data.agents.training.pictures import detector_types

ROWS = [
    {"room_type": "kitchen", "answer_type": name, "kind": kind, "question": question, "answer": answer}
    for name, kind, question, answer in (
        ("Mug", "EXISTENCE", "Is there a mug in the fridge?", "no"),
        ("Egg", "COUNTING", "How many eggs are there in the fridge?", "2"),
        ("Apple", "SPATIAL", "Is there an apple inside the fridge?", "yes"),
    )
]
OTHERS = Others.of_rows(ROWS)


def test_only_what_rooms_of_that_type_are_asked_about_and_numbers_that_occur() -> None:
    assert Others({"kitchen": ("Mug", "Egg", "Apple")}, frozenset(("yes", "no", "2"))) == OTHERS


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("row", ROWS)
def test_another_question_is_grammatical_and_has_the_answer_that_is_there(row: dict[str, str], seed: int) -> None:
    there = ["Egg", "Egg", "Mug"]
    question, answer, wanted = OTHERS.ask(row, there, np.random.default_rng(seed))
    words = {"Mug": ("a mug", "mugs"), "Egg": ("an egg", "eggs"), "Apple": ("an apple", "apples")}[wanted]
    if row["kind"] == "COUNTING" or question.startswith("How many"):
        assert question == f"How many {words[1]} are there {'inside' if row['kind'] == 'SPATIAL' else 'in'} the fridge?"
        assert answer == str(there.count(wanted))
    else:
        assert f" {words[0]} " in question
        assert answer == ("yes" if wanted in there else "no")


def test_answers_are_asked_for_equally_often_and_never_more_than_can_be_answered() -> None:
    others = Others(OTHERS.by_room_type, frozenset(("yes", "no", "0", "1", "2")))

    def shares(row: dict[str, str], there: list[str]) -> dict[str, float]:
        draws = [others.ask(row, there, np.random.default_rng(seed))[1] for seed in range(800)]
        return {answer: draws.count(answer) / len(draws) for answer in set(draws)}

    assert shares(ROWS[0], ["Egg", "Mug"]) == pytest.approx({"yes": 1 / 2, "no": 1 / 2}, abs=0.05)
    assert shares(ROWS[0], ["Egg", "Mug", "Mug"]) == pytest.approx({"0": 0.2, "1": 0.2, "2": 0.6}, abs=0.05)
    assert set(shares(ROWS[1], ["Egg", "Egg", "Mug", "Mug", "Mug"])) == {"0", "2"}  # nobody is asked for three


def test_where_no_two_alike_came_to_light_a_count_stays_what_it_was() -> None:
    row = ROWS[1]
    others = Others(OTHERS.by_room_type, frozenset(("yes", "no", "0", "1", "2")))
    assert others.ask(row, ["Egg", "Mug"], np.random.default_rng(0)) == (row["question"], row["answer"], "Egg")


def test_where_nothing_else_can_be_asked_the_question_stays() -> None:
    row = ROWS[1]
    others = Others({"kitchen": ("Egg",)}, frozenset(("yes", "no", "2")))
    assert others.ask(row, ["Egg"], np.random.default_rng(0)) == (row["question"], row["answer"], "Egg")


@pytest.mark.slow
def test_it_learns_from_as_many_questions_as_it_is_told(two_rooms: Path) -> None:
    detector = Detector(len(detector_types()))
    tasks = [AnsweringTask([two_rooms], ("end",), True, detector, questions=n) for n in (3, 5, 1000, None)]
    assert [len(task) for task in tasks] == [3, 5, 8, 8]
    rng = np.random.default_rng
    asked = [asked.question for asked in tasks[1].batch(np.arange(5), [rng(k) for k in range(5)])]
    assert len(set(asked)) > 1
    assert set(tasks[0].vocabulary.words) < set(tasks[3].vocabulary.words)


@pytest.mark.slow
def test_where_a_view_is_mirrored_so_are_the_words(two_rooms: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    views, seen = AskedViews(two_rooms, "train"), []
    real = answering.cut

    def cut(*which: Any, mirrored: bool = False, **how: Any) -> np.ndarray:
        seen.append(mirrored)
        return real(*which, mirrored=mirrored, **how)

    monkeypatch.setattr(answering, "cut", cut)
    monkeypatch.setattr(answering, "mirrored_words", lambda question: f"mirrored: {question}")
    for seed in range(6):
        asked = views.view(seed % len(views), np.random.default_rng(seed))
        assert len(set(seen)) == 1
        assert asked.question.startswith("mirrored: ") == seen[0]
        seen.clear()
    assert not views.view(0).question.startswith("mirrored: ")
