import math
from types import SimpleNamespace

import pandas as pd
import pytest
from typer.testing import CliRunner

from remqa_data.cli import app
from remqa_data.generators.audit.recount import wording
from remqa_data.generators.audit.recount.report import _phrases, _sight, recount
from remqa_data.generators.audit.recount.wording import _has_landmark, expressions_in_frames

FRIDGE = (("filter_type", "Fridge"),)


def test_a_landmark_is_what_the_phrase_of_the_place_leans_on() -> None:
    cabinet = (("filter_type", "Cabinet"), ("relate", "next to", FRIDGE))
    assert not _has_landmark((("filter_type", "Mug"), ("relate", "in", FRIDGE), ("exist",)))
    assert _has_landmark((("filter_type", "Mug"), ("relate", "in", cabinet), ("exist",)))
    for where, expected in ((FRIDGE, False), (cabinet, True)):  # the partner is no landmark
        partner = (("filter_type", "Egg"), ("relate", "in", where))
        assert _has_landmark((("filter_type", "Mug"), ("relate", "behind", partner), ("exist",))) is expected


def test_an_expression_without_a_landmark_says_nothing_about_landmarks(dataset) -> None:
    found = expressions_in_frames(dataset)
    assert 0 < found["anchor_id"].isna().sum() < len(found)
    assert (found["shows_anchor"].isna() == found["anchor_id"].isna()).all()


def test_a_dataset_may_have_no_expressions(dataset, monkeypatch) -> None:
    manifest = wording.load_manifest(dataset)
    monkeypatch.setattr(
        wording,
        "load_manifest",
        lambda root: SimpleNamespace(splits=lambda table: () if table == "expressions" else manifest.splits(table)),
    )
    found = expressions_in_frames(dataset)
    assert found.empty
    questions = pd.DataFrame({"has_landmark": [True], "called_so": [2], "expression": ["the mug"], "same_type": [1]})
    measured = {figure.what: figure.measured for figure in _phrases(questions, found)}
    assert math.isnan(measured["expressions whose target has no rival in the frame"])  # `recount` leaves it out


def test_every_start_view_should_show_its_landmark() -> None:
    names = ["evidence_px", "evidence_de", "target_px", "front_deg", "start_m"]
    views = pd.DataFrame(dict.fromkeys(names, 50.0), index=range(100)).assign(landmark_seen=[True] * 99 + [False])
    (figure,) = [one for one in _sight(views) if "landmark" in one.what]
    assert (figure.asked, figure.measured, figure.holds) == (">= 1", 0.99, False)


@pytest.mark.slow
def test_every_figure_of_a_dataset_has_an_aim(one_room) -> None:
    table = recount(one_room)
    assert list(table.columns) == ["what", "asked", "measured", "holds"]
    assert table["what"].is_unique
    assert table["measured"].notna().all()
    figures = table.set_index("what")
    assert figures.loc["end views that show another number than the answer", "measured"] == 0
    assert figures.loc["questions of the room with most", "measured"] == 12
    assert figures.loc["expressions whose frame shows the landmark", "measured"] == 1


@pytest.mark.slow
def test_the_command_prints_the_table_and_writes_it(one_room, tmp_path) -> None:
    done = CliRunner().invoke(app, ["recount", str(one_room), "--csv", str(tmp_path / "figures.csv")])
    assert done.exit_code == 0, done.output
    assert "about 5 rooms or more" in done.output
    assert "pixels of evidence, median" in done.output
    assert (tmp_path / "figures.csv").read_text().startswith("what,asked,measured,holds\n")
