"""Words and answers as numbers, learnt from the train split alone."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import numpy.typing as npt

from remqa_data.errors import DatasetError, UnknownNameError
from remqa_data.files import atomic_path, uri_of
from remqa_data.storage.manifest import question_splits
from remqa_data.storage.shards import read_table

PAD, UNKNOWN = "<pad>", "<unk>"
_WORD = re.compile(r"[a-z0-9]+(?:['-][a-z0-9]+)*")


def tokenize(text: str) -> list[str]:
    """Lower-case words of a question, without punctuation.

    >>> tokenize("Is there a T-shirt in the drawer?")
    ['is', 'there', 'a', 't-shirt', 'in', 'the', 'drawer']
    """
    return _WORD.findall(text.lower())


@dataclass(frozen=True)
class Vocabulary:
    """Numbers for words and answers.

    Attributes
    ----------
    words : tuple of str
        "<pad>" is 0 and "<unk>" is 1; then the words of the train questions, the most frequent first.
    answers : tuple of str
        The train answers, sorted; the classes of a classifier.
    """

    words: tuple[str, ...]
    answers: tuple[str, ...]

    @classmethod
    def build(cls, questions: Iterable[str], answers: Iterable[str], min_count: int = 1) -> Vocabulary:
        """A vocabulary of some questions and answers; words that occur less than `min_count` times are left out.

        >>> Vocabulary.build(["Is it a mug?", "Is it red?"], ["yes", "no"]).words
        ('<pad>', '<unk>', 'is', 'it', 'a', 'mug', 'red')
        """
        counts = Counter(word for question in questions for word in tokenize(question))
        words = sorted((word for word, n in counts.items() if n >= min_count), key=lambda word: (-counts[word], word))
        return cls((PAD, UNKNOWN, *words), tuple(sorted(set(answers))))

    @classmethod
    def from_dataset(cls, root: str | Path, min_count: int = 1) -> Vocabulary:
        """The vocabulary of a dataset's train questions.

        Raises
        ------
        DatasetError
            If this is not a finished dataset, or has no train split.
        """
        if "train" not in question_splits(root):
            raise DatasetError(
                f"{uri_of(root)} has no train questions to learn words from: give the vocabulary of another dataset"
            )
        train = read_table(Path(root), "questions", "train", ["question", "answer"])
        return cls.build(train["question"].to_pylist(), train["answer"].to_pylist(), min_count)

    def __len__(self) -> int:
        """How many words there are, with "<pad>" and "<unk>": the rows of an embedding."""
        return len(self.words)

    def encode(self, question: str) -> list[int]:
        """Numbers of a question's words; unknown words are 1."""
        return [self._word_ids.get(word, 1) for word in tokenize(question)]

    def decode(self, numbers: Iterable[int]) -> str:
        """The words of some numbers, without padding.

        Raises
        ------
        UnknownNameError
            If a number is no word's.
        """
        chosen = [int(number) for number in numbers if number != 0]
        for number in chosen:
            if not 0 <= number < len(self.words):
                raise UnknownNameError("word", str(number), ())
        return " ".join(self.words[number] for number in chosen)

    def encode_batch(self, questions: Sequence[str]) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
        """Several questions in one array.

        Returns
        -------
        numbers : (n, longest) int64
            Padded with 0 at the end.
        lengths : (n,) int64
            Words of each question.

        Raises
        ------
        TypeError
            If it is one question.
        """
        if isinstance(questions, str):
            raise TypeError(f"questions is a text: give a list, [{questions!r}]")
        encoded = [self.encode(question) for question in questions]
        lengths = np.array([len(numbers) for numbers in encoded], dtype=np.int64)
        padded = np.zeros((len(encoded), max(lengths, default=0)), dtype=np.int64)
        for row, numbers in zip(padded, encoded, strict=True):
            row[: len(numbers)] = numbers
        return padded, lengths

    def save(self, path: str | Path) -> None:
        """Write the vocabulary as JSON."""
        with atomic_path(path) as temporary:
            temporary.write_text(json.dumps({"words": self.words, "answers": self.answers}), encoding="utf-8")

    @classmethod
    def load(cls, path: str | Path) -> Vocabulary:
        """Read what `save` wrote.

        Raises
        ------
        DatasetError
            If the file is no vocabulary.
        """
        try:
            stored = json.loads(Path(path).read_text(encoding="utf-8"))
            words, answers = stored["words"], stored["answers"]
        except (OSError, ValueError, KeyError, TypeError, RecursionError) as error:
            raise DatasetError(f"{path} is not a vocabulary that Vocabulary.save wrote: {error!r}") from None
        for names in (words, answers):
            if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
                raise DatasetError(
                    f"{path} is not a vocabulary that Vocabulary.save wrote: it needs two lists of words"
                )
            if len({*names}) < len(names):
                raise DatasetError(f"{path} is not a vocabulary that Vocabulary.save wrote: a word is there twice")
        if words[:2] != [PAD, UNKNOWN]:
            raise DatasetError(f"{path}: the first words must be {PAD} and {UNKNOWN}")
        return cls(tuple(words), tuple(answers))

    @cached_property
    def _word_ids(self) -> dict[str, int]:
        return {word: number for number, word in enumerate(self.words)}
