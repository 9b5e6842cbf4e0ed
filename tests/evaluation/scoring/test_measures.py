from pathlib import Path

import pytest

from remqa_data.evaluation.scoring.measures import MEASURES, measures_of
from remqa_data.evaluation.submission.tracks import TRACKS, Track

METRICS = (Path(__file__).parents[3] / "docs" / "METRICS.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("track", TRACKS)
def test_a_track_shows_and_plots_measures_of_its_own(track: Track) -> None:
    names = [measure.name for measure in measures_of(track)]
    assert set(TRACKS[track].main_measures) <= set(names)
    assert any(track in measure.plotted for measure in measures_of(track))


def test_measures_are_named_once_and_plotted_only_where_they_count() -> None:
    assert len({measure.name for measure in MEASURES}) == len(MEASURES) > 10
    assert all(set(measure.plotted) <= set(measure.tracks) for measure in MEASURES)


@pytest.mark.parametrize("name", sorted({measure.name.partition("@")[0] for measure in MEASURES}))
def test_every_measure_is_defined_in_the_documentation(name: str) -> None:
    assert f"**{name}" in METRICS
