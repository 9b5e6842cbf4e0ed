"""The pages written as files, which work from disk and on any server of files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from remqa_data.browse.site import Site
from remqa_data.files import atomic_path, check_empty


def write_site(site: Site, out: Path, progress: Callable[[int], None] | None = None) -> int:
    """Write every page and picture; index.html is written last, so a folder that has it is whole.

    Parameters
    ----------
    site : Site
        Made with `is_static`.
    out : Path
        The folder; made if missing.
    progress : callable, optional
        Called with 1 after each file.

    Returns
    -------
    int
        Number of files.

    Raises
    ------
    OutputError
        If the folder holds anything.
    """
    check_empty(out, "--export")
    count = 0
    for address in site.addresses():
        found = site.get(address)
        assert found is not None, address
        path = out / address
        path.parent.mkdir(parents=True, exist_ok=True)
        with atomic_path(path) as temporary:
            temporary.write_bytes(found.body)
        count += 1
        if progress is not None:
            progress(1)
    return count
