import io
import json
import sys
from pathlib import Path

import pytest
from rich.console import Console
from typer.testing import CliRunner

from remqa_data.errors import ResultsError
from remqa_data.evaluation.cli import app
from remqa_data.evaluation.report.comparison import compare, load_comparable
from remqa_data.evaluation.report.tables import in_words, print_results, rounded
from remqa_data.evaluation.scoring.ground_truth import dataset_sha256, load_ground_truth
from remqa_data.evaluation.scoring.results import load_results, schema_json, write_results
from remqa_data.evaluation.submission.reader import Header, write_submission
from remqa_data.storage.manifest import load_manifest
from tests.helpers.submissions import results_of, written

SCHEMA_PATH = Path(__file__).parents[3] / "evaluation" / "scoring" / "results.schema.json"


def answers(data: Path, path: Path, answer: str, agent: str = "a") -> Path:
    rows = [{"question_id": f"Kitchen3-q{i}", "answer": answer} for i in range(10)]
    return written(path, "qa", rows, agent=agent)


def test_the_published_schema_is_the_one_of_the_code_and_holds(data: Path, tmp_path: Path) -> None:
    jsonschema = pytest.importorskip("jsonschema")
    assert SCHEMA_PATH.read_text() == schema_json() == CliRunner().invoke(app, ["schema"]).output
    results = results_of(data, answers(data, tmp_path / "a.jsonl", "yes"))
    write_results(tmp_path / "results.json", results)
    text = (tmp_path / "results.json").read_text()
    jsonschema.validate(json.loads(text), json.loads(schema_json()))
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(json.loads(text) | {"replayed": "maybe"}, json.loads(schema_json()))
    assert load_results(tmp_path / "results.json") == results


def test_the_same_submission_gives_the_same_bytes_whatever_the_row_order(data: Path, tmp_path: Path) -> None:
    texts = []
    for name, order in (("a", 1), ("b", -1)):
        rows = [{"question_id": f"Kitchen3-q{i}", "answer": "yes"} for i in range(10)][::order]
        results = results_of(data, written(tmp_path / f"{name}.jsonl", "qa", rows))
        texts.append(results.model_copy(update={"submission": None}).model_dump_json())
    assert texts[0] == texts[1]


def claims(data: Path, path: Path) -> Path:
    """A submission to the track remqa as it is without a replay, in which all questions were answered with yes."""
    asked = load_ground_truth(data, "remqa", "test")
    rows = [
        {
            "question_id": name,
            "poses": [pose],
            "target_box": [10, 10, 50, 50],
            "box": [10, 10, 50, 50],
            "manipulation": "OpenObject Fridge|1",
            "answer": "yes",
        }
        for name, pose in zip(asked.ids.to_pylist(), asked.initial_poses.tolist(), strict=True)
    ]
    return written(path, "remqa", rows)


def test_what_only_a_replay_knows_is_null_without_one(data: Path, tmp_path: Path) -> None:
    jsonschema = pytest.importorskip("jsonschema")
    out = tmp_path / "out"
    options = ["--data", str(data), "-o", str(out), "--no-replay"]
    done = CliRunner().invoke(app, [str(claims(data, tmp_path / "a.jsonl")), *options])
    assert done.exit_code == 0, done.output
    told = json.loads((out / "results.json").read_text())
    jsonschema.validate(told, json.loads(schema_json()))
    unmeasured = {"S_M", "S_MQA", "manipulated"}
    for metric in told["metrics"]:
        is_null = [metric[name] is None for name in ("value", "low", "high")]
        assert is_null == [True] * 3 if metric["name"] in unmeasured else not is_null[0]
    assert {metric["name"] for metric in told["metrics"]} >= unmeasured | {"S_N", "S_L", "S_QA"}
    assert all(told["samples"][name] == [None] * 10 for name in unmeasured)
    assert all(None not in told["samples"][name] for name in ("S_N", "S_L", "S_QA"))
    results = load_results(out / "results.json")
    assert results.main_measure == "S_QA"
    table = (out / "results.md").read_text()
    assert table.count("not measured") == 3 * (
        len({m["group"] for m in told["metrics"] if m["breakdown"] == "kind"}) + 1
    )
    report = (out / "report.html").read_text()
    assert "count as failures by S_QA" in report
    assert "<dd>manipulation</dd>" not in report  # nobody knows whether that is what went wrong


def test_tracks_without_manipulation_say_nothing_of_it(data: Path, tmp_path: Path) -> None:
    results = results_of(data, answers(data, tmp_path / "a.jsonl", "yes"))
    assert not {"S_M", "S_MQA", "manipulated"} & {*results.measures, *results.samples}


def test_score_writes_results_and_markdown(data: Path, tmp_path: Path) -> None:
    path = answers(data, tmp_path / "a.jsonl", "yes", agent="a | b | c |")
    out = tmp_path / "out"
    done = CliRunner().invoke(app, [str(path), "--data", str(data), "--split", "test", "-o", str(out), "--no-report"])
    assert done.exit_code == 0, done.output
    assert {file.name for file in out.iterdir()} == {"results.json", "results.md"}
    lines = (out / "results.md").read_text().splitlines()
    assert lines[2].startswith("| Kind | questions |")
    assert all(line.count("|") == lines[2].count("|") for line in lines[2:8])
    assert len(lines) == 10  # an agent's name makes no lines of its own


def test_results_are_not_written_into_the_dataset(data: Path, tmp_path: Path) -> None:
    path = answers(data, tmp_path / "a.jsonl", "yes")
    for out in (data, data / "results"):
        done = CliRunner().invoke(app, [str(path), "--data", str(data), "--split", "test", "-o", str(out)])
        assert done.exit_code == 2
        assert "which holds nothing else; give another place" in done.output
    assert not (data / "results.json").exists()
    assert not (data / "results").exists()


@pytest.mark.slow
def test_a_dataset_is_named_by_its_first_digits(data: Path, tmp_path: Path) -> None:
    sha256 = dataset_sha256(load_manifest(data))
    for told, code in ((sha256, 0), (sha256[:16], 0), (sha256[:15], 2), (sha256[:16] + "x", 2)):
        path = tmp_path / "a.jsonl"
        write_submission(path, Header(track="qa", split="test", dataset=told), [])
        done = CliRunner().invoke(app, [str(path), "--data", str(data), "-o", str(tmp_path / "out"), "--no-report"])
        assert done.exit_code == code, done.output


def test_tables_for_the_terminal_are_whole_in_80_columns(data: Path, tmp_path: Path) -> None:
    written(tmp_path / "qa.jsonl", "qa", [])
    written(tmp_path / "rec.jsonl", "rec", [])
    claims(data, tmp_path / "remqa.jsonl")
    for name in ("qa", "rec", "remqa"):
        results = results_of(data, tmp_path / f"{name}.jsonl", replay=name != "remqa")
        console = Console(width=80, file=io.StringIO())
        print_results(console, results)
        text = console.file.getvalue()
        assert "…" not in text
        assert all(in_words(measure) in text for measure in results.measures)


def test_1_000_is_said_of_1_alone() -> None:
    assert [rounded(share) for share in (1, 0.9999, 0.9991, 0.9984, 0.25, 0)] == [
        "1.000",
        "0.999",
        "0.999",
        "0.998",
        "0.250",
        "0.000",
    ]


def test_comparing_needs_the_same_questions(data: Path, tmp_path: Path) -> None:
    for name, answer in (("yes", "yes"), ("no", "no")):
        write_results(tmp_path / name, results_of(data, answers(data, tmp_path / f"{name}.jsonl", answer)))
    (one,) = compare(*load_comparable([tmp_path / "yes", tmp_path / "no"]))
    assert (one.first, one.second, one.difference.value) == pytest.approx((0.4, 0.3, -0.1))
    shown = CliRunner().invoke(app, ["compare", str(tmp_path / "yes"), str(tmp_path / "no")])
    assert shown.exit_code == 0
    assert "-0.100" in shown.output
    other = json.loads((tmp_path / "no").read_text())
    other["dataset"]["sha256"] = "0" * 64
    (tmp_path / "other").write_text(json.dumps(other))
    with pytest.raises(ResultsError, match="dataset"):
        load_comparable([tmp_path / "yes", tmp_path / "other"])


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", "\x00", '{"format": "remqa-results", "version": 9}'])
def test_what_is_no_results_file_is_one_line(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.json").write_text(text)
    done = CliRunner().invoke(app, ["compare", str(tmp_path / "a.json"), str(tmp_path / "b.json")])
    assert done.exit_code == 2
    assert len(done.stderr.splitlines()) == 1
    assert "a.json" in done.stderr


def test_a_missing_extra_is_told_before_anything_is_scored(data, tmp_path, monkeypatch) -> None:
    path = written(tmp_path / "a.jsonl", "qa", [{"question_id": "Kitchen3-q0", "answer": "yes"}])
    monkeypatch.setitem(sys.modules, "jinja2", None)
    monkeypatch.setattr("remqa_data.evaluation.scoring.scoring.score", lambda *_, **__: pytest.fail("it was scored"))
    done = CliRunner().invoke(app, [str(path), "--data", str(data), "-o", str(tmp_path / "out")])
    assert done.exit_code == 2
    said = "jinja2 is not installed; run: pip install 'remqa-data[report]', or in a clone: pip install '.[report]'"
    assert f"{said}, or leave the report out with" in done.stderr


def test_results_are_there_even_if_the_report_fails(data, tmp_path, monkeypatch) -> None:
    path = written(tmp_path / "a.jsonl", "qa", [{"question_id": "Kitchen3-q0", "answer": "yes"}])

    def fail(*_: object) -> None:
        raise OSError("no space left")

    monkeypatch.setattr("remqa_data.evaluation.report.html.write_report", fail)
    done = CliRunner().invoke(app, [str(path), "--data", str(data), "-o", str(tmp_path / "out")])
    assert done.exit_code == 2
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"results.json", "results.md"}


def test_the_seed_of_the_resampling_keeps_nothing_from_being_compared(data: Path, tmp_path: Path) -> None:
    path = answers(data, tmp_path / "a.jsonl", "yes")
    for seed in ("0", "1"):
        out = str(tmp_path / seed)
        done = CliRunner().invoke(app, [str(path), "--data", str(data), "-o", out, "--no-report", "--seed", seed])
        assert done.exit_code == 0, done.output
    done = CliRunner().invoke(app, ["compare", *(str(tmp_path / seed / "results.json") for seed in ("0", "1"))])
    assert done.exit_code == 0, done.output


def test_a_report_of_another_submission_does_not_stay(data: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "report.html").write_text("of an earlier one")
    path = answers(data, tmp_path / "a.jsonl", "yes")
    done = CliRunner().invoke(app, [str(path), "--data", str(data), "-o", str(out), "--no-report"])
    assert done.exit_code == 0, done.output
    assert {file.name for file in out.iterdir()} == {"results.json", "results.md"}


def test_where_nothing_can_be_written_is_told_before_anything_is_scored(
    data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("remqa_data.evaluation.scoring.scoring.score", lambda *given, **named: pytest.fail("scored"))
    path, taken = answers(data, tmp_path / "a.jsonl", "yes"), tmp_path / "file"
    taken.write_text("")
    for out in (taken, taken / "below"):
        done = CliRunner().invoke(app, [str(path), "--data", str(data), "-o", str(out), "--no-report"])
        assert done.exit_code == 2
        assert "nothing can be written there" in done.output.replace("\n", " ")
