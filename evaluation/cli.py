"""The command `remqa-eval`: scores of submissions, reference submissions, comparisons."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from remqa_data.command_line import (
    Counting,
    OneLineErrors,
    announce_compiling,
    command_group,
    on_stdout,
    out_option,
    output,
)
from remqa_data.errors import nearest_names
from remqa_data.evaluation.submission.tracks import TRACKS, Track
from remqa_data.limits import MOST_SEED
from remqa_data.processes.cores import worker_count
from remqa_data.processes.interrupts import ends_the_process

if TYPE_CHECKING:
    from remqa_data.evaluation.submission.reference import Agent

SCORE = "score"


class ScoreByDefault(OneLineErrors):
    """A group in which `remqa-eval FILE ...` means `remqa-eval score FILE ...`."""

    def parse_args(self, ctx: Any, args: list[str]) -> Any:
        """Put the command's name before the file's; a word that is nearly a command and no file is left to be refused."""
        if args and args[0] not in self.commands and not self._is_own(args) and not self._is_slip(args[0]):
            args = [SCORE, *args]
        return super().parse_args(ctx, args)

    def _is_own(self, args: list[str]) -> bool:
        """Whether options come first that are those of the group: alone, or before a command."""
        own = [name for parameter in self.params for name in parameter.opts]
        rest = [arg for arg in args if arg not in (*own, "-h", "--help")]
        return args[0] in (*own, "-h", "--help") and (not rest or rest[0] in self.commands)

    def _is_slip(self, word: str) -> bool:
        return bool(nearest_names(word, self.commands)) and not Path(word).exists()


app = command_group("remqa-eval", ScoreByDefault)

Data = Annotated[Path, typer.Option("--data", metavar="DIR", help="A dataset.")]
Out = Annotated[Path, out_option("FILE", "A .jsonl or .parquet file to write.")]
Split = Annotated[str, typer.Option(help="Which questions.")]
OfTrack = Annotated[Track, typer.Option(help="What to submit to.")]


def main() -> None:
    """Run the command line."""
    with ends_the_process():
        app()


@app.callback()
def _about() -> None:
    """Score predictions: remqa-eval predictions.jsonl --data DIR --split test."""


@app.command(name=SCORE)
def score(
    predictions: Annotated[Path, typer.Argument(metavar="FILE", help="A submission, .jsonl or .parquet.")],
    data: Data,
    split: Annotated[
        str | None, typer.Option(help="Refuse a file for another split; by default its own is scored.")
    ] = None,
    track: Annotated[
        Track | None, typer.Option(help="Refuse a file for another track; by default its own is scored.")
    ] = None,
    out: Annotated[Path, out_option("DIR", "Folder for results and report, in place of earlier ones.")] = Path(
        "out/eval"
    ),
    no_replay: Annotated[
        bool, typer.Option("--no-replay", help="Believe the poses and true boxes that the file claims.")
    ] = False,
    report: Annotated[bool, typer.Option(help="Write report.html too.")] = True,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes; the scores do not depend on it.")] = None,
    seed: Annotated[int, typer.Option(min=0, max=MOST_SEED, help="Of the resampling.")] = 0,
) -> None:
    """Score a submission (the word "score" may be left out)."""
    from rich.console import Console

    from remqa_data.evaluation.report.tables import markdown, print_results
    from remqa_data.evaluation.scoring.ground_truth import truth_of
    from remqa_data.evaluation.scoring.results import make_results, write_results
    from remqa_data.evaluation.scoring.scoring import score as run
    from remqa_data.evaluation.submission.reader import open_submission
    from remqa_data.extras import require
    from remqa_data.files import atomic_path, check_beside, check_folder

    if report:
        require("jinja2", "report", "or leave the report out with --no-report")
    check_beside(out, data)
    check_folder(out)
    submission = open_submission(predictions)
    header = submission.header
    submission.check(track=track, split=split)
    truth = truth_of(submission, data)
    replays = TRACKS[header.track].walks and not no_replay
    announce_compiling(worker_count(workers) if replays else 1)
    with Counting(len(truth.ids), "replaying") as on_replayed:
        scores = run(submission, truth, replay=not no_replay, workers=worker_count(workers), progress=on_replayed)
    results = make_results(submission, truth, scores, seed=seed)
    for name in ("results.md", "report.html"):
        (out / name).unlink(missing_ok=True)  # an earlier submission's, which is not to stand beside these results
    write_results(out / "results.json", results)  # first, so that nothing after it can lose what was replayed
    with atomic_path(out / "results.md") as temporary:
        temporary.write_text(markdown(results), encoding="utf-8")
    if report:
        from remqa_data.evaluation.report.html import write_report

        write_report(out / "report.html", results, submission, truth)
    say = output()
    if not (say.is_quiet or say.is_json):
        print_results(Console(), results)
    say.say(f"{out}: results.json, results.md{', report.html' * report}")
    say.result(**results.model_dump(mode="json", exclude={"samples"}))


@app.command()
def oracle(data: Data, path: Out, track: OfTrack = "remqa", split: Split = "test") -> None:
    """Write what an agent that knows everything submits."""
    _write_reference("oracle", data, path, track, split, 0)


@app.command()
def random(
    data: Data,
    path: Out,
    track: OfTrack = "remqa",
    split: Split = "test",
    seed: Annotated[int, typer.Option(min=0, max=MOST_SEED)] = 0,
) -> None:
    """Write what an agent that does anything submits."""
    _write_reference("random", data, path, track, split, seed)


@app.command()
def blind(data: Data, path: Out, track: OfTrack = "remqa", split: Split = "test") -> None:
    """Write what an agent submits that reads the question, stands still and guesses."""
    _write_reference("blind", data, path, track, split, 0)


@app.command()
def compare(
    first: Annotated[Path, typer.Argument(metavar="A.json", help="A results.json.")],
    second: Annotated[Path, typer.Argument(metavar="B.json", help="Another, for the same questions.")],
    seed: Annotated[int, typer.Option(min=0, max=MOST_SEED, help="Of the resampling.")] = 0,
) -> None:
    """Say how much better the second submission is than the first, and whether that is luck."""
    from rich.console import Console

    from remqa_data.evaluation.report.comparison import compare as run
    from remqa_data.evaluation.report.comparison import comparison_grid, comparison_notes, load_comparable
    from remqa_data.evaluation.report.tables import print_grid

    paths = [first, second]
    results = load_comparable(paths)
    compared = run(*results, seed=seed)
    say = output()
    if not (say.is_quiet or say.is_json):
        print_grid(Console(), comparison_grid(first, second, compared))
    for line in comparison_notes(paths, results, compared):
        say.say(line)
    say.result(measures=[asdict(measure) for measure in compared])


@app.command()
def rank(
    paths: Annotated[list[Path], typer.Argument(metavar="RESULTS.json...", help="Of the same questions.")],
    out: Annotated[Path | None, out_option("FILE", "Write it as Markdown too.")] = None,
) -> None:
    """Order submissions, the best first: those to the track remqa by S_MQA."""
    from rich.console import Console

    from remqa_data.evaluation.report.ranking import rank as run
    from remqa_data.evaluation.report.ranking import ranking_grid, ranking_markdown, ranking_notes
    from remqa_data.evaluation.report.tables import print_grid
    from remqa_data.files import atomic_path, check_beside
    from remqa_data.storage.manifest import dataset_around

    if out is not None and (outer := dataset_around(out)):
        check_beside(out, outer)
    ranked = run(paths)
    say = output()
    if not (say.is_quiet or say.is_json):
        print_grid(Console(), ranking_grid(ranked))
    for line in ranking_notes(ranked):
        say.say(line)
    if out is not None:
        with atomic_path(out) as temporary:
            temporary.write_text(ranking_markdown(ranked), encoding="utf-8")
    say.result(ranking=[one.as_json() for one in ranked])


@app.command()
def schema() -> None:
    """Print the JSON Schema of results.json."""
    from remqa_data.evaluation.scoring.results import schema_json

    with on_stdout():
        typer.echo(schema_json(), nl=False)


def _write_reference(agent: Agent, data: Path, path: Path, track: Track, split: str, seed: int) -> None:
    import numpy as np

    from remqa_data.evaluation.scoring.ground_truth import dataset_sha256
    from remqa_data.evaluation.submission.reader import Header, write_submission
    from remqa_data.evaluation.submission.reference import reference_rows
    from remqa_data.files import check_beside
    from remqa_data.storage.manifest import load_manifest

    check_beside(path, data)
    rows = reference_rows(agent, data, track, split, np.random.default_rng(seed))
    header = Header(track=track, split=split, dataset=dataset_sha256(load_manifest(data)), agent=agent)
    write_submission(path, header, rows)
    output().say(f"{path}: {len(rows)} rows")
    output().result(file=path, rows=len(rows))


if __name__ == "__main__":
    main()
