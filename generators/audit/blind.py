"""How well questions can be answered without looking: a bag of words learnt from the train split, tried on the test split.

A dataset in which words give the answer away teaches an agent to guess. The classifier is to stay at chance.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from remqa_data.extras import require
from remqa_data.generators.audit.balance import AskedQuestion
from remqa_data.tables.rows import KINDS

TOLERANCE = 0.03
"""A classifier that is right so much more often than chance knows something."""
FOLDS = 5


@dataclass(frozen=True)
class BlindScore:
    """What a bag of words gets right of the questions of one kind; shares from 0 to 1.

    Attributes
    ----------
    kind : str
        EXISTENCE, COUNTING or SPATIAL.
    questions : int
        Of this kind in the test split.
    chance : float
        Share of the most frequent answer of the test split: who always gives it is right as often.
    accuracy : float
        On the test split, learnt from the train split.
    chance_error : float
        Standard error of the accuracy of who guesses, which tells how much of a difference is luck.
    accuracy_across_rooms : float or None
        On all questions of both splits, each answered by a classifier that has seen no question about its room
        (5 parts); several times more questions, and so several times less luck. None with fewer than 5 rooms.
    """

    kind: str
    questions: int
    chance: float
    accuracy: float
    chance_error: float
    accuracy_across_rooms: float | None

    @property
    def is_excess(self) -> bool:
        """Whether the test split is answered better than by chance and `TOLERANCE`."""
        return self.accuracy > self.chance + TOLERANCE


def blind_scores(questions: Sequence[AskedQuestion]) -> list[BlindScore]:
    """The scores of all kinds of which both splits have questions.

    Raises
    ------
    MissingExtraError
        If scikit-learn is not installed.

    Notes
    -----
    Logistic regression on word counts, with scikit-learn's defaults: L2 penalty, C = 1.
    """
    scores = []
    for kind in KINDS:
        of_kind = [question for question in questions if question.kind == kind]
        train = [question for question in of_kind if question.split == "train"]
        test = [question for question in of_kind if question.split == "test"]
        if not test or len({question.answer for question in train}) < 2:
            continue
        chance = max(Counter(question.answer for question in test).values()) / len(test)
        scores.append(
            BlindScore(
                kind=kind,
                questions=len(test),
                chance=chance,
                accuracy=float(_is_right(train, test).mean()),
                chance_error=float(np.sqrt(chance * (1 - chance) / len(test))),
                accuracy_across_rooms=_across_rooms(of_kind),
            )
        )
    return scores


def _across_rooms(questions: Sequence[AskedQuestion]) -> float | None:
    if len({question.scene for question in questions}) < FOLDS:
        return None
    return float(np.concatenate([_is_right(train, test) for train, test in _folds(questions)]).mean())


def _folds(questions: Sequence[AskedQuestion]) -> Iterator[tuple[list[AskedQuestion], list[AskedQuestion]]]:
    rooms = list(dict.fromkeys(question.scene for question in questions))
    for fold in range(FOLDS):
        held_out = set(rooms[fold::FOLDS])
        train = [question for question in questions if question.scene not in held_out]
        yield train, [question for question in questions if question.scene in held_out]


def _is_right(train: Sequence[AskedQuestion], test: Sequence[AskedQuestion]) -> npt.NDArray[np.bool_]:
    """(test,) whether a classifier that learns from some questions answers each of some others."""
    words = require("sklearn.feature_extraction.text", "report").CountVectorizer()
    classifier = require("sklearn.linear_model", "report").LogisticRegression(max_iter=1000)
    classifier.fit(words.fit_transform([question.question for question in train]), [q.answer for q in train])
    guesses = classifier.predict(words.transform([question.question for question in test]))
    return np.asarray(guesses == np.array([question.answer for question in test]))
