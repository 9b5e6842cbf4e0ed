"""Truths of a dataset as a whole: no answer is more frequent than another, and the same words are answered differently."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from remqa_data.generators.audit.failures import Failure
from remqa_data.language.question_rules import question_rules
from remqa_data.storage.manifest import Manifest
from remqa_data.storage.shards import read_table
from remqa_data.tables.rows import KINDS


@dataclass(frozen=True)
class AskedQuestion:
    """The words of a question and of its answer, without pictures."""

    question_id: str
    kind: str
    question: str
    answer: str
    scene: str
    configuration: int
    split: str
    group: str


def asked_questions(root: Path, manifest: Manifest) -> list[AskedQuestion]:
    """All questions of a dataset, in its order."""
    columns = list(AskedQuestion.__dataclass_fields__)
    tables = [read_table(root, "questions", split, columns) for split in manifest.splits("questions")]
    return [AskedQuestion(**row) for table in tables for row in table.to_pylist()]


def balance_failures(questions: Sequence[AskedQuestion], manifest: Manifest) -> Iterator[Failure]:
    """What a dataset's questions do not keep, taken together."""
    yield from _numbers(questions, manifest)
    for split in dict.fromkeys(question.split for question in questions):
        for kind in KINDS:
            answers = Counter(q.answer for q in questions if (q.split, q.kind) == (split, kind))
            yield from _shares(f"{split} {kind}", answers, question_rules().answers(kind))
    groups: dict[str, list[AskedQuestion]] = defaultdict(list)
    for question in questions:
        groups[question.group].append(question)
    for group in groups.values():
        yield from _group(group)


def _numbers(questions: Sequence[AskedQuestion], manifest: Manifest) -> Iterator[Failure]:
    for name, count in Counter(question.question_id for question in questions).items():
        if count > 1:
            yield Failure(name, "consistent", f"{count} questions have this id")
    found = Counter((question.split, question.kind) for question in questions)
    told = {(split, kind): n for split, kinds in manifest.questions.items() for kind, n in kinds.items() if n}
    for split, kind in sorted(found.keys() | told.keys(), key=str):
        there, said = found.get((split, kind), 0), told.get((split, kind), 0)
        if there != said:
            yield Failure(f"{split} {kind}", "consistent", f"there are {there} questions; the manifest says {said}")


def _shares(where: str, answers: Counter[str], legal: tuple[str, ...]) -> Iterator[Failure]:
    unknown = sorted(answers.keys() - set(legal), key=str)
    if unknown:
        yield Failure(where, "unbiased", f"{unknown[0]!r} is no answer; answers are {', '.join(legal)}")
    counts = [answers[answer] for answer in legal]
    if max(counts) - min(counts) > 1:
        shares = ", ".join(f"{answer}: {answers[answer]}" for answer in legal)
        yield Failure(where, "unbiased", f"some answers are more frequent than others ({shares})")


def _group(group: Sequence[AskedQuestion]) -> Iterator[Failure]:
    first = group[0]
    if len({(q.question, q.kind, q.scene) for q in group}) > 1:
        yield Failure(first.question_id, "unbiased", f"the questions of {first.group} are not the same")
    if len({q.configuration for q in group}) < len(group):
        yield Failure(first.question_id, "unbiased", f"{first.group} asks twice in one configuration")
    if len({q.answer for q in group}) == 1:
        yield Failure(first.group, "unbiased", f"all questions of {first.group} are answered {first.answer}")
