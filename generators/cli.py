"""The command `remqa-gen`: rooms, walks and questions, written as Parquet."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Annotated, Any

import typer

from remqa_data.command_line import OneLineErrors, announce_compiling, command_group, out_option, output
from remqa_data.errors import ConfigError
from remqa_data.processes.interrupts import ends_the_process
from remqa_data.published import MEAN_WORDS

if TYPE_CHECKING:
    from remqa_data.generators.config import Config


class Resumable(OneLineErrors):
    """A command that goes on after it was stopped, and takes options only."""

    when_stopped = "stopped; the rooms that are finished are kept, go on with --resume"

    def collect_usage_pieces(self, ctx: Any) -> list[str]:
        """What its usage shows, which is no command."""
        return [str(self.options_metavar)]

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """Say that there are no commands."""
        ctx.fail(f"unexpected argument {args[0]!r}; give options only, such as --config tiny")


app = command_group("remqa-gen", Resumable, no_args_is_help=False)


def main() -> None:
    """Run the command line."""
    with ends_the_process():
        app()


@app.callback(invoke_without_command=True)
def generate(
    scenes: Annotated[
        int | None, typer.Option(help="How many rooms; by default as many as the configuration says.")
    ] = None,
    out: Annotated[
        str, out_option("DIR", "Folder of the dataset, or a place such as s3://bucket/prefix.")
    ] = "out/remqa",
    config: Annotated[
        str, typer.Option(metavar="NAME", help="A preset, paper or tiny, or a YAML file like those in configs/.")
    ] = "paper",
    seed: Annotated[int | None, typer.Option(min=0, help="Seed of the whole dataset.")] = None,
    workers: Annotated[
        int | None,
        typer.Option(min=1, help="Processes here, by default one for each core; the dataset does not depend on it."),
    ] = None,
    executor: Annotated[
        str, typer.Option(metavar="NAME", help="Where rooms are made: local, in processes here, or ray, on a cluster.")
    ] = "local",
    ray_address: Annotated[
        str | None,
        typer.Option(
            metavar="ADDR", help="Of the Ray cluster, such as auto or ray://head:10001; by default this machine."
        ),
    ] = None,
    layouts: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="Where rooms come from: ithor, the 120 of AI2-THOR, or sampled, any number."),
    ] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace what is in the folder.")] = False,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with an interrupted run.")] = False,
) -> None:
    """Generate a dataset of rooms, walks and questions, every sample checked in the simulator."""
    from remqa_data.generators.config import load_config
    from remqa_data.generators.pipeline import check_place
    from remqa_data.generators.pipeline import generate as run
    from remqa_data.processes.executors import LocalExecutor, make_executor

    if overwrite and resume:
        raise ConfigError("--resume goes on with what is in the folder, and --overwrite removes it: give one of them")
    settings = load_config(config)
    if layouts is not None:
        settings = settings.with_layouts(layouts)
    if seed is not None:
        settings = settings.with_seed(seed)
    if scenes is not None:
        settings = settings.with_scenes(scenes)
    check_place(out, overwrite=overwrite, resume=resume)
    makes = make_executor(executor, workers, ray_address)
    announce_compiling(makes.workers if isinstance(makes, LocalExecutor) else 1)
    started = time.monotonic()
    with _Progress(len(settings.scene_names)) as on_scene:
        manifest = run(out, settings, makes, on_scene, overwrite=overwrite)
    seconds = time.monotonic() - started
    _summary(out, settings, manifest.questions, seconds)
    rows = {table: manifest.rows(table) for table in ("scenes", "frames", "expressions", "questions")}
    output().result(
        dataset=out, rooms=len(settings.scene_names), seconds=seconds, rows=rows, questions=manifest.questions
    )


class _Progress:
    """Calls back with each finished room: a bar on a terminal, else a line for each room."""

    def __init__(self, total: int) -> None:
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

        self.total, self.questions, self.frames = total, 0, 0
        self.reports: dict[str, Mapping[str, Any]] = {}
        self.console = output().console()
        columns = (
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("rooms"),
            TimeRemainingColumn(),
        )
        self.bar = Progress(*columns, console=self.console, disable=not self.console.is_terminal)
        self.task = self.bar.add_task("generating", total=total)

    def __enter__(self) -> Callable[[str, Mapping[str, Any]], None]:
        self.bar.start()
        return self.on_scene

    def __exit__(self, *error: object) -> None:
        self.bar.stop()

    def on_scene(self, scene: str, report: Mapping[str, Any]) -> None:
        before = self.reports.get(scene, {"questions": 0, "frames": 0})  # a room that is made again counts once
        self.reports[scene] = report
        self.questions += report["questions"] - before["questions"]
        self.frames += report["frames"] - before["frames"]
        done, counts = len(self.reports), f"{self.questions} questions, {self.frames} frames"
        self.bar.update(self.task, completed=done, description=counts)
        if not self.console.is_terminal:
            output().note(f"{done}/{self.total} {scene}: {counts} so far")


def _summary(out: str, settings: Config, questions: Mapping[str, Mapping[str, int]], seconds: float) -> None:
    from rich.table import Table
    from rich.text import Text

    from remqa_data.storage.shards import read_table

    table = Table(title=Text(f"{out}: {len(settings.scene_names)} rooms in {seconds:.0f} s"))  # Text: no markup
    for heading in ("split", "kind", "questions", "asked for", "mean words", "published words"):
        table.add_column(heading, justify="left" if heading in ("split", "kind") else "right")
    for split, kinds in questions.items():
        rows = read_table(out, "questions", split, ["kind", "question"]).to_pylist()
        for kind, count in kinds.items():
            words = [len(row["question"].split()) for row in rows if row["kind"] == kind]
            mean = f"{sum(words) / len(words):.2f}" if words else "-"
            asked = settings.totals[split][kind]  # type: ignore[index]
            table.add_row(split, kind, str(count), str(asked), mean, f"{MEAN_WORDS[kind]:.1f}")
    output().show(table)


if __name__ == "__main__":
    main()
