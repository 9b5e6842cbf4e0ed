"""What `remqa-data verify` shows: progress, each failure with the truth that it breaks, and how far guessing gets."""

from __future__ import annotations

from pathlib import Path

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from remqa_data.command_line import announce_compiling, output
from remqa_data.errors import MissingExtraError
from remqa_data.generators.audit.balance import asked_questions
from remqa_data.generators.audit.blind import TOLERANCE, BlindScore, blind_scores
from remqa_data.generators.audit.verify import Verification, verify
from remqa_data.processes.cores import worker_count
from remqa_data.storage.manifest import load_manifest


def verify_and_report(root: Path, sample: int | None, rooms: int | None, seed: int, workers: int) -> bool:
    """Check a dataset and print what was found; see `verify.verify` for parameters and errors.

    Returns
    -------
    Whether everything holds. That guessing from words is better than chance is shown but is no failure: it is a
    statistic, in which there is luck, and not a truth of any one question.
    """
    workers = worker_count(workers)
    announce_compiling(workers)
    console = output().console()
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("checking rooms", total=None)
        result = verify(
            root, sample, seed, workers, lambda done, total: bar.update(task, completed=done, total=total), rooms=rooms
        )
    for failure in result.failures:
        output().say(f"{failure.where}: {failure.truth}: {failure.reason}")
    manifest = load_manifest(root)
    if result.failures and result.notes:
        # Other versions draw and encode other bytes, which is no fault of the dataset.
        output().say(f"{', '.join(result.notes)}: install these versions before you trust what is said of pictures")
    _tell_coverage(result)
    output().say(f"{len(result.checked) - len(result.failed)} of {len(result.checked)} questions hold")
    try:
        scores = [] if result.failures else blind_scores(asked_questions(root, manifest))
    except MissingExtraError as error:
        output().say(f"whether words give answers away was not checked: {error}")
        scores = []
    else:
        _tell_scores(scores)
    output().result(
        holds=not result.failures,
        questions=len(result.checked),
        failures=[failure._asdict() for failure in result.failures],
        coverage={what: {"checked": done, "rows": total} for what, (done, total) in result.coverage.items()},
        notes=list(result.notes),
        words_alone=[vars(score) for score in scores],
    )
    return not result.failures


def _tell_coverage(result: Verification) -> None:
    """What was checked, and how much there is of it."""
    covered = {what: f"{done:,} of {total:,}" for what, (done, total) in result.coverage.items()}
    output().say(f"checked in full: {', '.join(result.in_full)}")
    output().say(f"made again from the configuration: {covered['rooms']} rooms; {covered['scenes']} scenes")
    output().say(f"drawn and compared: {covered['frames']} frames; phrases read: {covered['expressions']} expressions")
    output().say(f"replayed: {covered['questions']} questions")
    if any(done < total for done, total in result.coverage.values()):
        why = "the dataset as a whole does not hold" if not result.checked else "use --all to check everything"
        output().say(f"not everything was checked: {why}")


def _tell_scores(scores: list[BlindScore]) -> None:
    if not scores:
        return
    table = Table(title="A bag of words learnt from train questions, in percent of test questions")
    for heading in ("kind", "questions", "chance", "accuracy", "luck", "across rooms"):
        table.add_column(heading, justify="left" if heading == "kind" else "right")
    for score in scores:
        across = "-" if score.accuracy_across_rooms is None else f"{100 * score.accuracy_across_rooms:.1f}"
        figures = (f"{100 * share:.1f}" for share in (score.chance, score.accuracy))
        table.add_row(score.kind, str(score.questions), *figures, f"± {100 * score.chance_error:.1f}", across)
    output().show(table)
    for score in scores:
        if score.is_excess:
            more = 100 * (score.accuracy - score.chance)
            output().say(
                f"{score.kind}: words alone are right {more:.1f} points more often than chance; aim: {100 * TOLERANCE:.0f}"
            )
