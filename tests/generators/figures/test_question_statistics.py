import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

from remqa_data.cli import app
from remqa_data.errors import DatasetError
from remqa_data.generators.audit.recount.wording import asked
from remqa_data.generators.figures.question_statistics import question_statistics
from remqa_data.storage.shards import read_rows
from remqa_data.tables.rows import QuestionRow


def test_every_number_is_that_of_the_rows(finished) -> None:
    root, manifest = finished
    table = question_statistics(root)
    assert len(table) > 0
    assert set(table.index) == {(s, k) for s, kinds in manifest.questions.items() for k in kinds if kinds[k]}
    for split, kind in table.index:
        rows = [row for row in read_rows(root, QuestionRow, split) if row.kind == kind]
        told = table.loc[(split, kind)]
        assert told["questions"] == len(rows) == manifest.questions[split][kind]
        assert told["words"] == round(sum(len(row.question.split()) for row in rows) / len(rows), 1)
        assert told["path_m"] == pytest.approx(np.median([row.path_length_m for row in rows]), abs=0.005)
        answers = [row.answer for row in rows]
        assert {answer: told[answer] for answer in set(answers)} == {a: answers.count(a) for a in set(answers)}


def test_the_papers_figures_stand_beside(finished) -> None:
    table = question_statistics(finished[0])
    assert table.loc[("train", "EXISTENCE"), ["published", "published_words"]].tolist() == [1653, 9.5]  # table I


def test_the_command_prints_the_table_and_writes_it(finished, tmp_path) -> None:
    result = CliRunner().invoke(app, ["stats", str(finished[0]), "--csv", str(tmp_path / "stats.csv")])
    assert result.exit_code == 0, result.output
    written = pd.read_csv(tmp_path / "stats.csv", index_col=["split", "kind"])
    assert written["questions"].tolist() == question_statistics(finished[0])["questions"].tolist()
    assert "published_words" in result.output


def test_a_folder_without_a_dataset_is_refused(tmp_path) -> None:
    with pytest.raises(DatasetError):
        question_statistics(tmp_path)


def test_a_dataset_without_questions_is_told_so(dataset: Path) -> None:
    path = dataset / "manifest.json"
    manifest = json.loads(path.read_text())
    manifest["files"] = [file for file in manifest["files"] if file["table"] != "questions"]
    path.write_text(json.dumps(manifest))
    for read in (question_statistics, asked):
        with pytest.raises(DatasetError, match="has no questions"):
            read(dataset)
