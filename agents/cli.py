"""The command `remqa-agent`: lets systems play a split, and shows what they score beside the paper's figures."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Protocol, Self, TypeVar

import typer

from remqa_data.command_line import Counting, announce_compiling, command_group, out_option, output
from remqa_data.errors import ConfigError
from remqa_data.files import check_beside
from remqa_data.limits import MOST_SEED
from remqa_data.processes.cores import worker_count
from remqa_data.processes.interrupts import ends_the_process

if TYPE_CHECKING:
    from remqa_data.agents.table import Scored

app = command_group("remqa-agent")

Data = Annotated[Path, typer.Option("--data", metavar="DIR", help="A dataset.")]
Folder = Annotated[Path, out_option("DIR", "Where submissions and tables are.")]
Workers = Annotated[int | None, typer.Option(min=1, help="Processes; nothing depends on it but the time.")]
Resume = Annotated[bool, typer.Option("--resume", help="Go on with an interrupted run.")]
Weights = Annotated[
    Path | None,
    typer.Option(
        "--weights", metavar="DIR", exists=True, file_okay=False, help="Weights that come before those of the package."
    ),
]
Force = Annotated[
    bool,
    typer.Option("--force", help="Use weights that may have learnt from the rooms they are tried in, too."),
]
Device = Annotated[str, typer.Option(metavar="NAME", help="Where networks compute: cpu, cuda, cuda:1, mps.")]
Seed = Annotated[
    int | None,
    typer.Option(
        min=0, max=MOST_SEED, help="Other draws, and names that end in -SEED; by default that of the configuration."
    ),
]
Seeds = Annotated[
    list[int] | None,
    typer.Option(
        "--seed",
        min=0,
        max=MOST_SEED,
        help="Other draws, and names that end in -SEED; several times for several submissions of each.",
    ),
]
Seen = Annotated[
    int | None,
    typer.Option(min=1, help="Play so many train questions about rooms that networks learn from; goes to DIR/seen."),
]
OUT = Path("out/agents")
WEIGHTS = Path("out/weights")


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
            metavar="SYSTEM...",
            help="Names such as framework or random, or YAML files like those in configs/agents/.",
        ),
    ],
    data: Data,
    split: Annotated[str | None, typer.Option(help="Which questions; by default test.")] = None,
    out: Folder = OUT,
    workers: Workers = None,
    resume: Resume = False,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace submissions that are there.")] = False,
    weights: Weights = None,
    force: Force = False,
    seeds: Seeds = None,
    seen: Seen = None,
) -> None:
    """Let systems play all questions of a split; write a submission of each, which remqa-eval replays."""
    from remqa_data.agents.config import load_system
    from remqa_data.agents.runner import Player, check_places, play_all
    from remqa_data.agents.seen import SEEN, SEEN_SPLIT, seen_questions
    from remqa_data.agents.systems import fingerprint, make_agent
    from remqa_data.storage.manifest import load_manifest

    if split is not None and seen is not None:
        raise ConfigError("--seen plays train questions: leave --split out")
    _check_one_of(overwrite=overwrite, resume=resume)
    check_beside(out, data)
    configs = _named(systems, load_system, seeds or ())
    only = None if seen is None else seen_questions(data, seen)
    split, out = (split or "test", out) if only is None else (SEEN_SPLIT, out / SEEN)
    check_places([out / f"{name}.jsonl" for name, _ in configs], overwrite=overwrite, resume=resume)
    if seen is not None and only is not None and len(only) < seen:
        output().note(f"--seen {seen}: there are {len(only)} such questions, and all of them are played")
    asked = sum(load_manifest(data).questions.get(split, {}).values()) if only is None else len(only)
    count = worker_count(workers)
    announce_compiling(count)
    players = [
        Player(
            make_agent(config, data, weights, force=force),
            out / f"{name}.jsonl",
            config.title,
            config.seed,
            fingerprint(config, weights),
        )
        for name, config in configs
    ]
    with Counting(asked * len(players), f"{', '.join(systems)} play{'s' * (len(systems) == 1)}") as on_played:
        rows = play_all(players, data, split, only=only, workers=count, resume=resume, progress=on_played)
    for player in players:
        output().say(f"{player.path}: {rows} rows")
    written = {str(player.path): rows for player in players}
    output().result(files=written)


@app.command()
def train(
    networks: Annotated[
        list[str],
        typer.Argument(metavar="NETWORK...", help="Names, or YAML files, like those of configs/agents/training/."),
    ],
    data: Data,
    more: Annotated[
        list[Path] | None, typer.Option("--more", metavar="DIR", help="Another dataset to learn from; several times.")
    ] = None,
    out: Annotated[Path, out_option("DIR", "Where weights and curves go.")] = WEIGHTS,
    views: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Cached views with features, by default DIR-views; for walkers.")
    ] = None,
    device: Device = "cpu",
    threads: Annotated[int | None, typer.Option(min=1, help="Cores; the same number gives the same weights.")] = None,
    workers: Annotated[
        int, typer.Option(min=0, help="Processes that make batches of pictures ahead: for a GPU, one for each core.")
    ] = 0,
    resume: Resume = False,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace weights and checkpoints that are there.")
    ] = False,
    seed: Seed = None,
) -> None:
    """Train networks, one after the other, on rooms that are in no val or test split; write weights, curves and scores."""
    from remqa_data.extras import require

    torch = require("torch", "agents")
    from remqa_data.agents.training.config import load_network_config
    from remqa_data.agents.training.learn import check_places, learn
    from remqa_data.agents.training.matching import Looks

    _check_one_of(overwrite=overwrite, resume=resume)
    check_beside(out, data)
    roots = [data, *(more or ())]
    _check_datasets_differ(roots)
    configs = _named(networks, load_network_config, () if seed is None else (seed,))
    names = [name for name, _ in configs]
    _check_files_differ(names, out)
    check_places(names, out, overwrite=overwrite, resume=resume)
    check_device(device)
    torch.set_num_threads(threads or worker_count(None))
    scores, looks = {}, dict[str, Looks]()
    for name, config in configs:
        with _learning(name) as (on_look, on_learn):
            about = learn(
                name,
                config,
                roots,
                out,
                views=views,
                device=device,
                workers=workers,
                resume=resume,
                looks=looks,
                on_look=on_look,
                on_learn=on_learn,
            )
        figures = ", ".join(f"{key} {value:.3g}" for key, value in about.score.items())
        figures = figures or f"{data} has no val rooms, so it is not scored"
        output().say(f"{out / name}.safetensors: {figures}")
        scores[name] = about.score
    output().result(scores=scores)


@app.command()
def predict(
    networks: Annotated[
        list[str],
        typer.Argument(
            metavar="NETWORK...",
            help="Names of weights, or their files; or names of committees, or YAML files like those of "
            "configs/agents/committees/.",
        ),
    ],
    data: Data,
    split: Annotated[
        str, typer.Option(help="Which expressions or questions; a detector is scored on its frames.")
    ] = "test",
    out: Folder = OUT,
    weights: Weights = None,
    device: Device = "cpu",
    force: Force = False,
) -> None:
    """Let networks say what they see in the stored pictures: submissions to the tracks rec and qa, a detector's precision."""
    from remqa_data.extras import require

    require("torch", "agents")
    from remqa_data.agents.predictions import predict_all

    check_beside(out, data)
    check_device(device)
    with Counting(None, "looking") as on_looked:
        written = predict_all(networks, data, split, out, weights, device=device, force=force, progress=on_looked)
    for path in written:
        output().say(str(path))
    output().result(files=[str(path) for path in written])


@app.command()
def attend(
    expressions: Annotated[list[str], typer.Argument(metavar="EXPRESSION...", help="Ids of referring expressions.")],
    data: Data,
    out: Annotated[Path, out_option("FILE", "The picture, .png.")] = Path("out/attention.png"),
    network: Annotated[str, typer.Option(help="A language attention network.")] = "language_attention",
    weights: Weights = None,
    force: Force = False,
) -> None:
    """Draw which words a language attention network looks at, and which object it means."""
    from remqa_data.extras import require

    require("torch", "agents")
    from remqa_data.agents.figures.attention import write_attention_picture

    check_beside(out, data)
    write_attention_picture(data, expressions, out, network, weights, force=force)
    output().say(f"{out}: {len(expressions)} expressions")
    output().result(files=[str(out)])


@app.command()
def curves(
    networks: Annotated[
        list[str] | None, typer.Argument(metavar="[NETWORK...]", help="Names; by default all that were trained there.")
    ] = None,
    weights: Annotated[
        Path, typer.Option("--weights", metavar="DIR", help="Where training has put weights.")
    ] = WEIGHTS,
    out: Annotated[Path, out_option("FILE", "The picture, .png.")] = Path("out/curves.png"),
) -> None:
    """Draw how networks became better while they learnt, all seeds of each."""
    from remqa_data.agents.figures.curves import write_curves_picture

    count = write_curves_picture(weights, out, networks or ())
    output().say(f"{out}: {count} trainings")
    output().result(files=[str(out)])


@app.command()
def table(data: Data, out: Folder = OUT, workers: Workers = None, weights: Weights = None) -> None:
    """Replay the submissions in a folder and show them beside the paper's figures; writes tables, a page, leaderboard.json."""
    from rich.console import Console

    from remqa_data.agents.costs import costs_grid, known_costs, pace_grid
    from remqa_data.agents.leaderboard import leaderboard
    from remqa_data.agents.picture_tables import qa_grid, rec_grid, score_pictures
    from remqa_data.agents.ranking import orders, orders_grid
    from remqa_data.agents.seen import SEEN, seen_grid
    from remqa_data.agents.table import (
        as_json,
        failures_grid,
        found_submissions,
        navigation_grid,
        remqa_grid,
        score_systems,
        seeds_grid,
        submissions_in,
        write_tables,
    )
    from remqa_data.evaluation.report.tables import print_grid
    from remqa_data.files import atomic_path

    check_beside(out, data)
    count = worker_count(workers)
    submissions = submissions_in(out)  # before anything is compiled
    announce_compiling(count)
    seen: list[Scored] = []
    with Counting(None, "replaying") as on_replayed:
        scored = score_systems(out, data, count, on_replayed)
        if in_seen_rooms := found_submissions(out / SEEN):
            submissions += in_seen_rooms
            seen = score_systems(out / SEEN, data, count, on_replayed, partial=True)
    pictures = {track: score_pictures(out, data, track) for track in ("rec", "qa")}
    grids = [
        navigation_grid(scored),
        seeds_grid(scored),
        remqa_grid(scored),
        failures_grid(scored),
        seen_grid(scored, seen) if seen else None,
        *(grid_of(pictures[track]) for track, grid_of in (("rec", rec_grid), ("qa", qa_grid)) if pictures[track]),
    ]
    if found := orders(scored, pictures["rec"]):
        grids.append(orders_grid(found))
    if find_spec("safetensors"):
        grids.append(costs_grid(known_costs(weights)))
    grids.append(pace_grid(submissions))
    shown = [grid for grid in grids if grid is not None]
    write_tables(out, scored, shown)
    with atomic_path(out / "leaderboard.json") as temporary:
        temporary.write_text(json.dumps(leaderboard(scored), indent=1) + "\n", encoding="utf-8")
    say = output()
    if not (say.is_quiet or say.is_json):
        for grid in shown:
            print_grid(Console(), grid)
    say.say(f"{out}: table.md, table.json, {'table.html, ' * bool(find_spec('jinja2'))}leaderboard.json")
    say.result(**as_json(scored))


class _Config(Protocol):
    def seeded(self, seed: int) -> Self: ...


C = TypeVar("C", bound=_Config)


def _named(names: Sequence[str], load: Callable[[str], C], seeds: Sequence[int]) -> list[tuple[str, C]]:
    """Configurations with the stems of their names; where there are seeds, with the draws and the name of each of them."""
    from remqa_data.agents.training.config import seeded_name

    configs = [(Path(name).stem, load(name)) for name in names]
    if not seeds:
        return configs
    return [(seeded_name(name, seed), config.seeded(seed)) for seed in seeds for name, config in configs]


def _check_one_of(*, overwrite: bool, resume: bool) -> None:
    """Refuse to both go on with what is there and replace it."""
    if overwrite and resume:
        raise ConfigError("--resume goes on with what is there, and --overwrite replaces it: give one of them")


def _check_files_differ(names: Sequence[str], folder: Path) -> None:
    """Refuse to train two networks into one file."""
    for name, count in Counter(names).items():
        if count > 1:
            raise ConfigError(
                f"{count} networks would write {folder / name}.safetensors: train them to folders of their own"
            )


def _check_datasets_differ(roots: Sequence[Path]) -> None:
    """Refuse to learn from a dataset twice."""
    for root, count in Counter(root.resolve() for root in roots).items():
        if count > 1:
            raise ConfigError(f"{root} is named {count} times with --data and --more: name each dataset once")


@contextmanager
def _learning(name: str) -> Iterator[tuple[Callable[[int], None], Callable[[int], Callable[[int], None]]]]:
    """Shows how a network looks and then learns: what is told of looking, and what begins to count samples."""
    with Counting(None, f"{name} looks") as on_look, ExitStack() as bars:
        yield on_look, lambda samples: bars.enter_context(Counting(samples, f"{name} learns"))


def check_device(name: str) -> None:
    """Refuse a device that is not there.

    Raises
    ------
    ConfigError
        In one line.
    """
    import torch

    from remqa_data.errors import one_line

    try:
        torch.zeros(1, device=name).item()
    except (RuntimeError, AssertionError, ValueError) as error:  # NotImplementedError is a RuntimeError
        raise ConfigError(f"--device {name}: {one_line(error)[:200]}") from None


if __name__ == "__main__":
    main()
