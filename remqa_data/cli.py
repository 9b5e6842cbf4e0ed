"""The command `remqa-data`: look at rooms, objects and datasets, check them, and write them for other programs."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Annotated, Literal

import typer

from remqa_data.command_line import command_group, listed, out_option, output
from remqa_data.errors import ConfigError
from remqa_data.export import Format
from remqa_data.files import beside, check_beside
from remqa_data.limits import MOST_SEED
from remqa_data.processes.interrupts import ends_the_process
from remqa_data.views import LEAST_PX, MOST_PX, SIZE_PX, views_beside

SAMPLE_QUESTIONS, SAMPLE_ROOMS = 500, 15
"""What `verify` looks into by default: five minutes of a core for the published benchmark."""
ROOM = "A floor plan such as FloorPlan1, a sampled room, or a .json that Scene.save wrote."

app = command_group("remqa-data")


def main() -> None:
    """Run the command line."""
    with ends_the_process():
        app()


@app.callback()
def _about() -> None:
    """Rooms for remote embodied manipulation question answering."""


@app.command()
def assets(
    types: Annotated[list[str] | None, typer.Argument(metavar="[TYPE]...", help="Object types; all if none.")] = None,
    sheet: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder for contact sheets, one PNG for each type.")
    ] = None,
    glb: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder for meshes, one glTF file for each variant.")
    ] = None,
    columns: Annotated[
        int | None, typer.Option(min=1, help="Variants side by side on a sheet, by default 4; the rest lie below.")
    ] = None,
) -> None:
    """Write contact sheets of object types, their variants closed and open, or their meshes."""
    from rich.progress import Progress

    from remqa_data.assets import TYPES

    if sheet is None and glb is None:
        raise typer.BadParameter("name a folder with --sheet DIR or --glb DIR")
    if sheet is None and columns is not None:
        raise ConfigError("--columns is for --sheet: meshes are files of their own")
    console = output().console()
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("assets", total=len(types or TYPES) * ((sheet is not None) + (glb is not None)))

        def on_type(name: str) -> None:
            bar.update(task, description=name, advance=1)

        sheets: list[Path] = []
        meshes: list[Path] = []
        if sheet is not None:
            from remqa_data.generators.figures.asset_sheets import write_sheets

            sheets = write_sheets(sheet, types or (), columns or 4, progress=on_type)
        if glb is not None:
            from remqa_data.generators.figures.asset_meshes import write_meshes

            meshes = write_meshes(glb, types or (), progress=on_type)
    if sheets:
        output().say(f"{len(sheets)} {'sheet' if len(sheets) == 1 else 'sheets'} in {sheet}")
    if meshes:
        output().say(f"{len(meshes)} {'mesh' if len(meshes) == 1 else 'meshes'} in {glb}")
    output().result(sheets=sheets, meshes=meshes)


@app.command()
def play(
    root: Annotated[Path, typer.Argument(metavar="DIR", help="A dataset.")],
    question_id: Annotated[str, typer.Argument(help="A question of it, such as FloorPlan1-COUNTING-00-c2.")],
    film: Annotated[Path, out_option("FILE", "The film to write: .mp4, .webm, or .webp for pages.")] = Path(
        "episode.mp4"
    ),
    submission: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Film what was submitted there; by default what the oracle does."),
    ] = None,
) -> None:
    """Film a question: what the agent sees, the agent from outside, and the map that it draws."""
    from remqa_data.env.video import write_film
    from remqa_data.evaluation.episodes import submitted_commands

    check_beside(film, root)
    commands = None if submission is None else submitted_commands(submission, root, question_id)
    frames = write_film(root, question_id, film, commands)
    output().say(f"{film}: {frames} frames")
    output().result(film=film, frames=frames)


@app.command()
def cache(
    root: Annotated[Path, typer.Argument(metavar="DIR", help="A dataset.")],
    out: Annotated[Path | None, out_option("DIR", "Folder of the cache; by default DIR-views.")] = None,
    scenes: Annotated[
        str | None, typer.Option(metavar="NAME,...", help="Rooms, such as FloorPlan1,FloorPlan201; by default all.")
    ] = None,
    split: Annotated[str | None, typer.Option(metavar="NAME", help="Only rooms of this split.")] = None,
    configurations: Annotated[
        str | None,
        typer.Option(metavar="N,...", help="Arrangements of each room, such as 0,1; by default those asked about."),
    ] = None,
    size: Annotated[
        int, typer.Option(help=f"Width and height of the frames in pixels, {LEAST_PX} to {MOST_PX}.")
    ] = SIZE_PX,
    features: Annotated[
        str | None,
        typer.Option(metavar="MODULE:FUNCTION", help="Keep what this function makes of the frames, too, as float16."),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(min=1, help="Processes, by default one for each core; the cache does not depend on it."),
    ] = None,
) -> None:
    """Draw what is seen from everywhere in a dataset's rooms, for navigation at 20,000 steps a second and more.

    Goes on with a cache that was interrupted, and adds to one that is finished. All 120 rooms with all that is asked about
    them take about 13 GB with frames of 84 px, 7 GB with 64, and hours of a core.
    """
    from remqa_data.views.build import Wanted
    from remqa_data.views.cache_command import cache_and_report

    wanted = Wanted(
        scenes=None if scenes is None else listed(scenes),
        split=split,
        configurations=None if configurations is None else _numbers(configurations),
        size_px=size,
        features=features,
    )
    folder = out or views_beside(root)
    check_beside(folder, root)
    cache_and_report(root, folder, wanted, workers)


@app.command()
def export(
    scene: Annotated[str, typer.Argument(help=ROOM)],
    file: Annotated[
        Path,
        out_option("FILE", "The file to write: .glb, .xml (MJCF, MuJoCo), .urdf, or .usd, .usda, .usdc (extra: usd)."),
    ] = Path("scene.glb"),
    data: Annotated[Path | None, typer.Option(metavar="DIR", help="A dataset whose room is meant.")] = None,
    configuration: Annotated[int, typer.Option(min=0, metavar="N", help="Which arrangement of that room.")] = 0,
    opened: Annotated[
        list[str] | None,
        typer.Option("--open", metavar="ID", help="Open this object, or all; give it as often as needed."),
    ] = None,
    form: Annotated[Format | None, typer.Option("--format", help="Whatever the file is called.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Of a sampled room.")] = 0,
) -> None:
    """Write a room for other programs: a GLB with textures and names, or MJCF, URDF and USD with joints, masses and meshes."""
    from remqa_data.export.rooms import find_scene, write_room

    if data is not None:
        check_beside(file, data)
    files = write_room(find_scene(scene, data, configuration, seed), file, form, opened or ())
    output().say(f"{file}" + (f", with {len(files) - 1} files in {files[0].parent}" if len(files) > 1 else ""))
    output().result(files=files)


@app.command()
def coco(
    root: Annotated[Path, typer.Argument(metavar="DIR", help="A dataset.")],
    out: Annotated[Path | None, out_option("DIR", "Folder to write; by default DIR-coco.")] = None,
    images: Annotated[bool, typer.Option("--images/--no-images", help="Write the pictures, too.")] = True,
) -> None:
    """Write frames as COCO JSON with masks, and referring expressions as RefCOCO's."""
    from dataclasses import asdict

    from remqa_data.export.coco import write_coco

    folder = out or beside(root, "coco")
    written = write_coco(root, folder, images)
    output().say(
        f"{folder}: {written.images:,} images, {written.annotations:,} annotations, {written.refs:,} refs "
        f"with {written.sentences:,} sentences"
    )
    output().result(folder=folder, **asdict(written))


@app.command()
def rerun(
    root: Annotated[Path, typer.Argument(metavar="DIR", help="A dataset.")],
    scene: Annotated[str, typer.Argument(help="A room of it, such as FloorPlan1.")],
    recording: Annotated[Path, out_option("FILE", "Recording to write.")] = Path("walk.rrd"),
    configuration: Annotated[int, typer.Option(help="Which arrangement of the room's things.")] = 0,
) -> None:
    """Write the walk through a room as a recording for the viewer Rerun (extra: rerun)."""
    from remqa_data.export.rerun_walk import write_walk

    check_beside(recording, root)
    frames = write_walk(root, scene, recording, configuration)
    output().say(f"{recording}: {frames} frames; look at it with `rerun {recording}`")
    output().result(recording=recording, frames=frames)


@app.command()
def browse(
    root: Annotated[Path, typer.Argument(metavar="DIR", help="A dataset.")],
    submission: Annotated[
        list[Path] | None,
        typer.Option(metavar="FILE", help="Show what an agent answered, too: .jsonl or .parquet; can be repeated."),
    ] = None,
    audit: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Show this audit, too, which `recount --csv FILE` has written.")
    ] = None,
    export: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Write the pages into this new folder, and serve nothing.")
    ] = None,
    limit: Annotated[
        int | None, typer.Option(min=1, metavar="N", help="Export only so many questions, spread evenly.")
    ] = None,
    port: Annotated[int | None, typer.Option(min=0, max=65535, help="0 for any that is free; by default 8017.")] = None,
    host: Annotated[
        str | None,
        typer.Option(help="What to listen on; by default 127.0.0.1: only this machine can open the pages."),
    ] = None,
) -> None:
    """Look about in a dataset with a browser: questions, pictures, maps, graphs, walks and statistics."""
    from remqa_data.browse.command import browse_dataset

    if export is not None and not (host is None and port is None):
        raise ConfigError("--host and --port are for pages that are served: leave them out, or --export")
    address = (host or "127.0.0.1", 8017 if port is None else port)
    browse_dataset(root, submission or (), audit, export, limit, address)


@app.command()
def preview(
    scene: Annotated[str, typer.Argument(help=ROOM)],
    picture: Annotated[Path, out_option("FILE", "The picture to write, a PNG.")] = Path("preview.png"),
    size: Annotated[int, typer.Option(min=32, max=2048, help="Width and height of each view in pixels.")] = 300,
    light: Annotated[Literal["baked", "direct"], typer.Option(help="How the room is lit.")] = "baked",
    seed: Annotated[int, typer.Option(min=0, help="Of a sampled room.")] = 0,
) -> None:
    """Draw a room: a map with walls, objects and reachable cells, and eight views."""
    from remqa_data.generators.figures.preview import write_preview

    write_preview(scene, picture, size_px=size, light=light, seed=seed)
    output().say(str(picture))
    output().result(picture=picture)


@app.command()
def show(
    root: Annotated[Path, typer.Argument(metavar="DIR", help="A dataset.")],
    question_id: Annotated[str, typer.Argument(help="A question of it, such as FloorPlan1-COUNTING-00-c2.")],
    picture: Annotated[Path, out_option("FILE", "The picture to write, a PNG.")] = Path("sample.png"),
) -> None:
    """Draw a question: the views before and after the manipulation, and the way there on a map."""
    from remqa_data.generators.figures.sample_picture import write_sample_picture

    check_beside(picture, root)
    write_sample_picture(root, question_id, picture)
    output().say(str(picture))
    output().result(picture=picture)


@app.command()
def stats(
    root: Annotated[Path, typer.Argument(metavar="DIR", help="A dataset.")],
    csv: Annotated[Path | None, typer.Option(metavar="FILE", help="Write the table there, too.")] = None,
) -> None:
    """Count and measure the questions by split and kind, beside what the paper has published."""
    from remqa_data.files import atomic_path
    from remqa_data.generators.figures.question_statistics import question_statistics

    if csv is not None:
        check_beside(csv, root)
    table = question_statistics(root)
    if csv is not None:
        with atomic_path(csv) as temporary:
            table.to_csv(temporary)
    output().say(table.to_string())
    output().say("words: means; path_m and path_steps, of the way that is stored: medians")
    output().result(questions=json.loads(table.reset_index().to_json(orient="records")))


@app.command()
def recount(
    root: Annotated[Path, typer.Argument(metavar="DIR", help="A dataset.")],
    csv: Annotated[Path | None, typer.Option(metavar="FILE", help="Write the table there, too.")] = None,
) -> None:
    """Count and measure a dataset in its files and pictures, beside what version 1.0 of the full dataset aims at."""
    from remqa_data.files import atomic_path
    from remqa_data.generators.audit.recount.chance import FOLDS
    from remqa_data.generators.audit.recount.report import recount

    if csv is not None:
        check_beside(csv, root)
    table = recount(root)
    if csv is not None:
        with atomic_path(csv) as temporary:
            table.to_csv(temporary, index=False)
    output().say(table.round(3).to_string(index=False))
    if not table["what"].str.contains(": right by ").any():
        output().say(
            f"What gives answers away can be measured where questions of a kind are about {FOLDS} rooms or more."
        )
    output().result(figures=json.loads(table.to_json(orient="records")))


@app.command()
def verify(
    root: Annotated[Path, typer.Argument(metavar="DIR", help="A dataset.")],
    everything: Annotated[bool, typer.Option("--all", help="Check every row of every table.")] = False,
    sample: Annotated[
        int | None,
        typer.Option(min=1, help=f"Replay so many questions, drawn at random; by default {SAMPLE_QUESTIONS}."),
    ] = None,
    rooms: Annotated[
        int | None,
        typer.Option(
            min=0,
            help=f"Make so many rooms again, drawn at random, and compare all their rows; by default {SAMPLE_ROOMS}.",
        ),
    ] = None,
    seed: Annotated[int | None, typer.Option(min=0, max=MOST_SEED, help="Of the draws; by default 0.")] = None,
    workers: Annotated[int, typer.Option(min=1, help="Processes; what is found does not depend on it.")] = 1,
) -> None:
    """Check a dataset from its files: what it says of itself, answers, actions, pictures and words, all worked out anew."""
    from remqa_data.generators.audit.verify_command import verify_and_report

    draws = {"--sample": sample, "--rooms": rooms, "--seed": seed}
    if everything and (given := [option for option, value in draws.items() if value is not None]):
        raise ConfigError(f"--all checks everything, and draws nothing: leave {' and '.join(given)} out")
    questions = None if everything else SAMPLE_QUESTIONS if sample is None else sample
    whole_rooms = None if everything else SAMPLE_ROOMS if rooms is None else rooms
    if not verify_and_report(root, questions, whole_rooms, seed or 0, workers):
        raise typer.Exit(1)


def _numbers(text: str) -> tuple[int, ...]:
    if not all(re.fullmatch(r"\d{1,9}", item, re.ASCII) for item in listed(text)):
        raise ConfigError(f"--configurations {text!r:.80}: give numbers, such as 0,1")
    return tuple(map(int, listed(text)))


if __name__ == "__main__":
    main()
