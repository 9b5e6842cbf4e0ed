"""The command `remqa-agent`: lets systems play a split, and shows what they score beside the paper's figures."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from remqa_data.command_line import Counting, OneLineErrors, announce_compiling, output
from remqa_data.processes.cores import worker_count
from remqa_data.processes.interrupts import ends_the_process

app = typer.Typer(
    name="remqa-agent",
    cls=OneLineErrors,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

Data = Annotated[Path, typer.Option("--data", metavar="DIR", help="A dataset.")]
Folder = Annotated[Path, typer.Option("-o", "--out", metavar="DIR", help="Where submissions and tables are.")]
Workers = Annotated[int | None, typer.Option(min=1, help="Processes; nothing depends on it but the time.")]
OUT = Path("out/agents")


def main() -> None:
    """Run the command line."""
    with ends_the_process():
        app()


@app.callback()
def _about() -> None:
    """Agents that come with the benchmark: remqa-agent run semantic_map --data DIR."""


@app.command()
def run(
    systems: Annotated[
        list[str],
        typer.Argument(
            metavar="SYSTEM...", help="Names, semantic_map or random, or YAML files like those in configs/agents/."
        ),
    ],
    data: Data,
    split: Annotated[str, typer.Option(help="Which questions.")] = "test",
    out: Folder = OUT,
    workers: Workers = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with an interrupted run.")] = False,
) -> None:
    """Let systems play all questions of a split; write a submission of each, which remqa-eval replays."""
    from remqa_data.agents.config import load_system
    from remqa_data.agents.runner import play_split
    from remqa_data.agents.systems import make_agent
    from remqa_data.storage.manifest import load_manifest

    configs = [(Path(name).stem, load_system(name)) for name in systems]
    asked = sum(load_manifest(data).questions.get(split, {}).values())
    count = worker_count(workers)
    announce_compiling(count)
    written = {}
    for name, config in configs:
        path = out / f"{name}.jsonl"
        with Counting(asked, f"{name} plays") as on_played:
            rows = play_split(
                make_agent(config, data),
                data,
                split,
                path,
                title=config.title,
                seed=config.seed,
                fingerprint=config.sha256,
                workers=count,
                resume=resume,
                progress=on_played,
            )
        output().say(f"{path}: {rows} rows")
        written[str(path)] = rows
    output().result(files=written)


@app.command()
def table(data: Data, out: Folder = OUT, workers: Workers = None) -> None:
    """Replay the submissions in a folder and show them beside the paper's figures; writes table.md and table.json."""
    from rich.console import Console

    from remqa_data.agents.table import (
        as_json,
        navigation_grid,
        remqa_grid,
        score_systems,
        submissions_in,
        write_tables,
    )
    from remqa_data.evaluation.report.tables import print_grid

    count = worker_count(workers)
    submissions_in(out)  # before anything is compiled
    announce_compiling(count)
    with Counting(None, "replaying") as on_replayed:
        scored = score_systems(out, data, count, on_replayed)
    write_tables(out, scored)
    say = output()
    if not (say.is_quiet or say.is_json):
        for grid in (navigation_grid(scored), remqa_grid(scored)):
            print_grid(Console(), grid)
    say.say(f"{out}: table.md, table.json")
    say.result(**as_json(scored))


if __name__ == "__main__":
    main()
