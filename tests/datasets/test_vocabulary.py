"""Words and answers as numbers."""

import json
import shutil
from pathlib import Path

import pytest

from remqa_data.datasets.vocabulary import Vocabulary
from remqa_data.errors import DatasetError, UnknownNameError
from remqa_data.storage.manifest import MANIFEST, Manifest


@pytest.fixture
def root(finished: tuple[Path, Manifest]) -> Path:
    return finished[0]


def test_the_vocabulary_is_learnt_from_the_train_split_alone(root) -> None:
    vocabulary = Vocabulary.from_dataset(root)
    assert vocabulary.words[:2] == ("<pad>", "<unk>")
    assert "next" in vocabulary.words
    assert "beneath" not in vocabulary.words  # only test questions say so
    assert vocabulary.answers == ("2", "no", "yes")
    assert vocabulary.encode("Is there a zebra?")[-1] == 1
    assert vocabulary.decode(vocabulary.encode("Is there a mug?")) == "is there a mug"


def test_without_train_questions_there_is_no_vocabulary(root, tmp_path) -> None:
    copy = Path(shutil.copytree(root, tmp_path / "copy"))
    manifest = json.loads((copy / MANIFEST).read_text())
    manifest["files"] = [file for file in manifest["files"] if (file["table"], file["split"]) != ("questions", "train")]
    (copy / MANIFEST).write_text(json.dumps(manifest))
    with pytest.raises(DatasetError, match="has no train questions to learn words from: give the vocabulary"):
        Vocabulary.from_dataset(copy)


def test_the_vocabulary_counts_frequent_words_first_and_drops_rare_ones() -> None:
    vocabulary = Vocabulary.build(["a b", "b c", "B c, b"], ["yes"], min_count=2)
    assert vocabulary.words == ("<pad>", "<unk>", "b", "c")


def test_a_batch_of_questions_is_padded_at_the_end() -> None:
    vocabulary = Vocabulary.build(["is it red"], ["no", "yes"])
    numbers, lengths = vocabulary.encode_batch(["red", "is it blue", ""])
    assert numbers.tolist() == [[4, 0, 0], [2, 3, 1], [0, 0, 0]]
    assert lengths.tolist() == [1, 3, 0]
    assert vocabulary.encode_batch([])[0].shape == (0, 0)


def test_the_vocabulary_survives_a_file(root, tmp_path) -> None:
    vocabulary = Vocabulary.from_dataset(root)
    vocabulary.save(tmp_path / "vocabulary.json")
    assert Vocabulary.load(tmp_path / "vocabulary.json") == vocabulary
    assert vocabulary.answers.index("yes") == 2


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        '{"words": ["a"], "answers": []}',
        '{"words": 3, "answers": []}',
        '{"words": ["<pad>", "<unk>"], "answers": "yes"}',
        '{"words": ["<pad>", "<unk>", "a", "a"], "answers": []}',
        '{"words": ["<pad>", "<unk>"], "answers": [1]}',
        pytest.param("[" * 200_000, id="deep"),
    ],
)
def test_a_file_that_is_no_vocabulary_is_refused(tmp_path, text) -> None:
    path = tmp_path / "vocabulary.json"
    path.write_text(text)
    with pytest.raises(DatasetError, match=r"vocabulary\.json"):
        Vocabulary.load(path)
    for none in (tmp_path, tmp_path / "none.json"):
        with pytest.raises(DatasetError, match="is not a vocabulary"):
            Vocabulary.load(none)


def test_a_vocabulary_refuses_what_is_no_word_of_it_and_one_text_for_several() -> None:
    vocabulary = Vocabulary.build(["is there a mug", "is there a fork"], ["yes"])
    numbers, _ = vocabulary.encode_batch(["is there a mug"])
    assert vocabulary.decode(numbers[0]) == "is there a mug"
    for number in (-1, len(vocabulary.words)):
        with pytest.raises(UnknownNameError, match=f"unknown word '{number}'"):
            vocabulary.decode([number])
    with pytest.raises(TypeError, match="questions is a text"):
        vocabulary.encode_batch("is there a mug")
