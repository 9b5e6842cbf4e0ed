"""The pages of a hostile dataset as files and at a server, and a browser."""

import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from remqa_data.browse.dataset import BrowsedDataset
from remqa_data.browse.site import Site
from tests.helpers.hostile_dataset import Tab, write_hostile
from tests.helpers.real_datasets import made_once


@pytest.fixture(scope="session")
def hostile(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """See `write_hostile`. Not to be changed."""
    return made_once(tmp_path_factory, "hostile", write_hostile)


@pytest.fixture(scope="session")
def site(hostile: Path) -> Site:
    """Its pages as they are served."""
    return Site(BrowsedDataset(hostile))


@pytest.fixture(scope="session")
def exported(hostile: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Its pages as files."""
    from remqa_data.browse.export import write_site

    out = tmp_path_factory.mktemp("exported") / "site"
    write_site(Site(BrowsedDataset(hostile), is_static=True), out)
    return out


@pytest.fixture(scope="session")
def served(site: Site) -> Iterator[str]:
    """The address under which a real server shows them."""
    uvicorn = pytest.importorskip("uvicorn")
    pytest.importorskip("starlette")
    from remqa_data.browse.server import make_app

    server = uvicorn.Server(uvicorn.Config(make_app(site), port=0, log_level="error"))
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    deadline = time.monotonic() + 60
    while not server.started:
        assert time.monotonic() < deadline, "the server does not start"
        time.sleep(0.02)
    yield f"http://127.0.0.1:{server.servers[0].sockets[0].getsockname()[1]}/"
    server.should_exit = True
    thread.join(30)


@pytest.fixture
def tab(chromium: Any) -> Iterator[Tab]:
    """A new page."""
    context = chromium.new_context(viewport={"width": 1280, "height": 900})
    page, events = context.new_page(), []
    near = ("file:", "blob:", "http://127.0.0.1:")
    page.on("request", lambda request: events.append(request.url) if not request.url.startswith(near) else None)
    page.on("console", lambda message: events.append(message.text))
    page.on("pageerror", lambda error: events.append(str(error)))
    page.on("dialog", lambda dialog: events.append(dialog.message))
    yield Tab(page, events)
    context.close()
