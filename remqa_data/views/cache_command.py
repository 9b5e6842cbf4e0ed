"""What `remqa-data cache` says while it draws, and at the end."""

from __future__ import annotations

from pathlib import Path

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from remqa_data.command_line import announce_compiling, output
from remqa_data.processes.cores import worker_count
from remqa_data.processes.executors import LocalExecutor
from remqa_data.views.build import Wanted, cache_views
from remqa_data.views.manifest import CachedRoom


def cache_and_report(root: Path, out: Path, wanted: Wanted, workers: int | None) -> None:
    """Cache the views of a dataset with a progress bar; see `build.cache_views` for errors."""
    count = worker_count(workers)
    announce_compiling(count)
    console = output().console()
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("rooms"),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("drawing", total=None)

        def on_room(done: int, total: int, room: CachedRoom) -> None:
            bar.update(task, completed=done, total=total, description=room.scene)
            if not console.is_terminal:
                output().note(f"{done}/{total} {room.scene}: {room.frames} frames")

        manifest = cache_views(root, out, wanted, LocalExecutor(count), on_room)
    frames = sum(room.frames for room in manifest.rooms)
    output().say(f"{out}: {len(manifest.rooms)} rooms, {frames:,} frames, {manifest.bytes / 1e9:.2f} GB")
    output().result(cache=out, rooms=len(manifest.rooms), frames=frames, bytes=manifest.bytes)
