"""What `remqa-data browse` does."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from remqa_data.browse.answers import read_answers
from remqa_data.browse.dataset import BrowsedDataset
from remqa_data.browse.export import write_site
from remqa_data.browse.server import serve
from remqa_data.browse.site import Site
from remqa_data.browse.statistics import read_audit
from remqa_data.command_line import Counting, output
from remqa_data.errors import ConfigError
from remqa_data.extras import require
from remqa_data.files import check_beside

PACKAGES = ("jinja2", "starlette", "uvicorn")


def browse_dataset(
    root: Path,
    submissions: Sequence[Path],
    audit: Path | None,
    export: Path | None,
    limit: int | None,
    address: tuple[str, int],
) -> None:
    """Serve a dataset's pages at a host and port until stopped, or write them into a folder.

    Raises
    ------
    RemqaError
        If there is no such dataset, a file is not what it should be, or nothing can be served or written there.
    """
    for package in PACKAGES if export is None else PACKAGES[:1]:
        require(package, "browse")
    if limit is not None and export is None:
        raise ConfigError("--limit is for --export: the pages that are served show every question")
    if export is not None:
        check_beside(export, root)
    dataset = BrowsedDataset(root)
    agents = read_answers(submissions, root)
    figures = () if audit is None else read_audit(audit)
    _ = dataset.rows, dataset.walk_places  # read now: no page waits for them, and what is there twice is told first
    site = Site(dataset, agents, figures, is_static=export is not None, limit=limit)
    if export is not None:
        with Counting(sum(1 for _ in site.addresses()), "writing") as on_file:
            files = write_site(site, export, on_file)
        output().say(f"{export / 'index.html'}: {len(site.scope.rows)} questions in {files} files")
        output().result(site=export, questions=len(site.scope.rows), files=files)
        return

    def ready(url: str) -> None:
        output().say(f"{url} shows {root}; Ctrl-C ends it")
        output().result(url=url)

    serve(site, *address, ready)
