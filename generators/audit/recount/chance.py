"""Whether answers can be guessed from what has nothing to do with the thing asked for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from remqa_data.extras import require

CUES = ("is_revealed", "revealed", "revealed_px", "start_bytes", "end_bytes", "end_depth_bytes", "scene_objects")
"""How many things come to light, whether any does, in how many pixels, sizes of files, how much there is in the room."""
FOLDS = 5
LEAST_LEAF = 12
LEAVES = 6
SURE = 1.96
"""Standard errors; who guesses is within them 95 times of 100."""


@dataclass(frozen=True)
class CueScore:
    """How often one cue gives the right answer to questions of one kind; shares from 0 to 1.

    Attributes
    ----------
    kind, cue : str
    accuracy : float
        Each question is answered by a small decision tree that has seen no question about its room.
    chance : float
        Share of the most frequent answer.
    error : float
        Standard error of the accuracy of who guesses.
    """

    kind: str
    cue: str
    accuracy: float
    chance: float
    error: float

    @property
    def luck(self) -> float:
        """The accuracy that guessing does not exceed in 97.5 of 100 tries."""
        return self.chance + SURE * self.error


def cue_scores(views: pd.DataFrame) -> list[CueScore]:
    """The scores of all cues, for each kind of which there are questions about enough rooms.

    Parameters
    ----------
    views : pandas.DataFrame
        Of `measured_views`.

    Raises
    ------
    MissingExtraError
        If scikit-learn is not installed.
    """
    views = views.assign(is_revealed=(views["revealed"] > 0).astype(float))
    scores = []
    for kind, rows in views.groupby("kind"):
        if rows["scene"].nunique() < FOLDS or rows["answer"].nunique() < 2:
            continue
        chance = float(rows["answer"].value_counts(normalize=True).max())
        error = float(np.sqrt(chance * (1 - chance) / len(rows)))
        scores += [CueScore(str(kind), cue, _accuracy(rows, cue), chance, error) for cue in CUES]
    return scores


def _accuracy(rows: pd.DataFrame, cue: str) -> float:
    tree = require("sklearn.tree", "report").DecisionTreeClassifier(
        max_leaf_nodes=LEAVES, min_samples_leaf=LEAST_LEAF, random_state=0
    )
    selection = require("sklearn.model_selection", "report")
    guesses = selection.cross_val_predict(
        tree, rows[[cue]].to_numpy(), rows["answer"], groups=rows["scene"], cv=selection.GroupKFold(FOLDS)
    )
    return float(np.mean(guesses == rows["answer"]))
