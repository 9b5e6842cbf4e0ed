import pickle
from pathlib import Path

import pytest

from remqa_data.datasets.random_access import SplitReader
from remqa_data.errors import DatasetError
from remqa_data.storage.manifest import Manifest
from remqa_data.storage.shards import ShardWriter
from tests.helpers.dataset_rows import question_row, scene_row


def test_rows_come_in_the_order_asked_for_across_row_groups_and_shards(finished: tuple[Path, Manifest]) -> None:
    reader = SplitReader(finished[0], "questions", "train")
    assert len(reader.paths) == 2
    asked = [17, 0, 5, 5, len(reader) - 1]
    rows = reader.rows(asked, ["question_id", "answer"])
    every = reader.columns(["question_id", "answer"]).to_pylist()
    assert rows == [every[row] for row in asked]
    assert rows[1]["answer"] == question_row("Kitchen1", "train", 0).answer
    assert reader.rows([], ["answer"]) == []


def test_a_relative_folder_is_found_by_another_process_wherever_that_is(
    finished: tuple[Path, Manifest], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(finished[0].parent)
    reader = SplitReader(Path(finished[0].name), "questions", "train")
    monkeypatch.chdir(tmp_path)
    assert pickle.loads(pickle.dumps(reader)).rows([3], ["answer"]) == reader.rows([3], ["answer"])


def test_a_name_may_lead_into_a_struct(finished: tuple[Path, Manifest]) -> None:
    reader = SplitReader(finished[0], "scenes", "test")
    (row,) = reader.rows([1], ["configuration", "semantic_map.labels"])
    assert row == {
        "configuration": 1,
        "semantic_map": {"labels": list(scene_row("Kitchen3", "test").semantic_map.labels)},
    }


def test_another_process_does_not_mix_in_rows_of_a_file_that_has_been_replaced(dataset: Path) -> None:
    """As workers of a loader did that were started while the dataset was made again."""
    reader = SplitReader(dataset, "questions", "train")
    sent = pickle.dumps(reader)
    assert pickle.loads(sent).rows([3], ["answer"]) == reader.rows([3], ["answer"])
    rows = [question_row("Kitchen3", "train", number) for number in range(len(reader) // 2)]
    with ShardWriter(reader.paths[1], "questions") as writer:
        writer.write_rows(rows)
    for ask in (lambda it: it.rows([3], ["answer"]), lambda it: it.images(3, ["start_rgb"])) * 2:
        with pytest.raises(
            DatasetError, match=r"-00001-of-00002\.parquet: it was replaced after the dataset was opened"
        ):
            ask(pickle.loads(sent))
    again = pickle.loads(sent)
    for _ in range(2):  # it is not believed the second time either
        with pytest.raises(DatasetError, match="it was replaced"):
            again.rows([3], ["answer"])
    assert reader.rows([3], ["answer"])  # who has opened the files goes on with them
