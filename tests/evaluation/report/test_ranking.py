import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from remqa_data.errors import ResultsError
from remqa_data.evaluation.cli import app
from remqa_data.evaluation.report.comparison import compare, comparison_notes, load_comparable
from remqa_data.evaluation.report.ranking import rank, ranking_grid, ranking_markdown
from remqa_data.evaluation.scoring.ground_truth import load_ground_truth
from remqa_data.evaluation.scoring.measures import MEASURES, measures_of
from remqa_data.evaluation.scoring.results import make_results, write_results
from remqa_data.evaluation.scoring.scoring import Scores
from remqa_data.evaluation.submission.reader import open_submission
from tests.helpers.submissions import written

REPLAYED = {measure.name for measure in MEASURES if measure.takes_replay}


def results_with(data: Path, path: Path, *, replay: bool = True, **right: int) -> Path:
    """A results.json of the track remqa in which so many of the 10 questions fulfil each measure, the others none."""
    truth = load_ground_truth(data, "remqa", "test")
    names = [measure.name for measure in measures_of("remqa") if replay or measure.name not in REPLAYED]
    measures = {name: np.arange(10) < right.get(name, 0) for name in names}
    scores = Scores(np.ones(10, dtype=bool), measures, {}, replayed=replay)
    submission = open_submission(written(path.with_suffix(".jsonl"), "remqa", [], agent=path.stem))
    write_results(path, make_results(submission, truth, scores))
    return path


@pytest.fixture
def three(data: Path, tmp_path: Path) -> list[Path]:
    """Of a submission that knows answers, one that opens things, and one that was not replayed."""
    return [
        results_with(data, tmp_path / "knows.json", S_N=10, S_L=10, S_QA=10),
        results_with(data, tmp_path / "opens.json", S_N=8, S_L=7, S_QA=5, S_M=6, S_MQA=4),
        results_with(data, tmp_path / "claims.json", replay=False, S_N=10, S_L=10, S_QA=10),
    ]


def test_who_opens_things_comes_before_who_knows_all_answers(three: list[Path]) -> None:
    ranked = rank(three)
    assert [(one.rank, one.agent) for one in ranked] == [(1, "opens"), (2, "knows"), (None, "claims")]
    grid = ranking_grid(ranked)
    assert grid.headings == ("rank", "agent", "S_MQA", "S_N", "S_L", "S_QA", "S_M")
    assert [row[3:] for row in grid.rows] == [
        ("0.800", "0.700", "0.500", "0.600"),
        ("1.000", "1.000", "1.000", "0.000"),
        ("1.000", "1.000", "1.000", "–"),
    ]
    assert [row[2].split("\n")[0] for row in grid.rows] == ["0.400", "0.000", "not measured"]


def test_who_scores_alike_has_the_same_rank(data: Path, tmp_path: Path) -> None:
    right = {"a": 4, "b": 6, "c": 4, "d": 1}
    paths = [results_with(data, tmp_path / f"{name}.json", S_MQA=count) for name, count in right.items()]
    assert [(one.rank, one.agent) for one in rank(paths)] == [(1, "b"), (2, "a"), (2, "c"), (4, "d")]


def test_the_command_prints_the_order_and_writes_markdown(three: list[Path], tmp_path: Path) -> None:
    done = CliRunner().invoke(app, ["rank", *map(str, three), "-o", str(tmp_path / "ranking.md")])
    assert done.exit_code == 0, done.output
    lines = done.output.splitlines()
    assert "…" not in done.output
    table = lines[: next(place for place, line in enumerate(lines) if line.startswith("Ranked by S_MQA"))]
    assert len(table) > 5
    assert max(map(len, table)) <= 80
    assert [line.split()[1] for line in table if line.split()[:1] in (["1"], ["2"], ["–"])] == [
        "opens",
        "knows",
        "claims",
    ]
    assert "claims.json was not replayed and has no rank" in done.output.replace("\n", " ")
    assert (tmp_path / "ranking.md").read_text() == ranking_markdown(rank(three))


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"metrics": []}, "cannot be compared: a column of samples, or a measure"),
        ({"column": "yes"}, "a sample of S_N is no number"),
        ({"column": 1.5}, "the mean of its samples"),
        ({"value": 0.9}, "S_N of all is 0.9, and the mean of its samples"),
        ({"value": float("nan")}, "S_N of all is nan"),
        ({"value": None}, "S_N of all is None, with 10 samples"),
    ],
)
def test_results_that_somebody_has_edited_are_one_line(
    three: list[Path], tmp_path: Path, change: dict, words: str
) -> None:
    for path in three[:2]:
        edited = json.loads(path.read_text())
        if "metrics" in change:
            edited["metrics"] = []
        elif "value" in change:
            edited["metrics"][0]["value"] = change["value"]
        else:
            edited["samples"][edited["metrics"][0]["name"]][0] = change["column"]
        (tmp_path / path.name).write_text(json.dumps(edited))
    paths = [tmp_path / path.name for path in three[:2]]
    with pytest.raises(ResultsError, match=words):
        rank(paths)
    with pytest.raises(ResultsError, match=words):
        load_comparable(paths)


def test_a_file_that_is_named_twice_is_refused(three: list[Path]) -> None:
    with pytest.raises(ResultsError, match="is named 2 times"):
        rank([three[0], three[1], three[0]])


def test_only_results_of_the_same_questions_are_ordered(three: list[Path], tmp_path: Path) -> None:
    other = json.loads(three[0].read_text())
    other["dataset"]["seed"] += 1
    (tmp_path / "other.json").write_text(json.dumps(other))
    with pytest.raises(ResultsError, match=r"other\.json cannot be compared: they are not of the same dataset"):
        rank([*three, tmp_path / "other.json"])


def test_a_comparison_says_who_is_ranked_first_and_who_has_no_rank(three: list[Path]) -> None:
    knows, opens, claims = three
    assert "Ranked by S_MQA: B before A." in noted(knows, opens)
    assert not REPLAYED & {one.name for one in compare(*load_comparable([claims, opens]))}
    assert "Ranked by S_MQA, which only a replay measures: no rank for A." in noted(claims, opens)
    assert "Ranked by S_MQA, which only a replay measures: no rank for A and B." in noted(claims, claims)
    assert noted(claims, claims)[-1].startswith("-: resampling tells nothing")


def noted(*paths: Path) -> list[str]:
    results = load_comparable(paths)
    return comparison_notes(paths, results, compare(*results))


def test_what_was_not_replayed_has_no_rank_in_any_track(data: Path, tmp_path: Path) -> None:
    paths = []
    for agent, replayed in (("walks", True), ("claims", False)):
        path = written(tmp_path / f"{agent}.jsonl", "nav", [], agent=agent)
        truth = load_ground_truth(data, "nav", "test")
        measures = {measure.name: np.full(10, agent == "claims") for measure in measures_of("nav")}
        scores = Scores(np.ones(10, dtype=bool), measures, {}, replayed=replayed)
        paths.append(tmp_path / f"{agent}.json")
        write_results(paths[-1], make_results(open_submission(path), truth, scores))
    assert [(one.rank, one.agent) for one in rank(paths)] == [(1, "walks"), (None, "claims")]
    done = CliRunner().invoke(app, ["rank", *map(str, paths), "--json"])
    entries = json.loads(done.output)["ranking"]
    assert [(entry["rank"], entry["measure"], entry["value"]) for entry in entries] == [
        (1, "success@50", 0.0),
        (None, "success@50", 1.0),
    ]
    assert [entry["replayed"] for entry in entries] == [True, False]


def test_a_file_by_another_name_is_the_same_file(three: list[Path], tmp_path: Path) -> None:
    again = three[0].parent / "." / ".." / three[0].parent.name / three[0].name
    with pytest.raises(ResultsError, match="named 2 times"):
        rank([three[0], again])


def test_no_order_is_written_into_a_dataset(three: list[Path], data: Path) -> None:
    done = CliRunner().invoke(app, ["rank", *map(str, three), "-o", str(data / "ranking.md")])
    assert done.exit_code == 2
    assert "which holds nothing else" in done.output.replace("\n", " ")
    assert not (data / "ranking.md").exists()
