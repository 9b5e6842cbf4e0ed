"""The documentation's site: it builds, no link is dead, and nothing is asked of other hosts."""

import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

import pytest

from remqa_data.tables.schema import TABLES, field_docs

ROOT = Path(__file__).resolve().parents[1]
FETCHED = {"script": "src", "img": "src", "iframe": "src", "source": "src"}
STYLES = ("stylesheet", "preload", "icon", "preconnect")


class Links(HTMLParser):
    """What a page leads to, what it fetches, and the names of its places."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.to: list[str] = []
        self.fetched: list[str] = []
        self.places: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        self.places |= {given[name] for name in ("id", "name") if name in given}
        if tag == "a" and "href" in given:
            self.to.append(given["href"])
        if tag in FETCHED and given.get(FETCHED[tag]):
            self.fetched.append(given[FETCHED[tag]])
        if tag == "link" and given.get("rel") in STYLES:
            self.fetched.append(given["href"])


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("mkdocs")
    folder = tmp_path_factory.mktemp("docs") / "site"
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture(scope="module")
def pages(site: Path) -> dict[Path, Links]:
    return {path: Links(path.read_text(encoding="utf-8")) for path in sorted(site.glob("*.html"))}


@pytest.mark.slow
def test_no_link_is_dead(pages: dict[Path, Links]) -> None:
    dead, followed = [], 0
    for path, page in pages.items():
        for link in page.to:
            parts = urlsplit(link)
            if parts.scheme or path.name == "404.html":
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            target = target / "index.html" if target.is_dir() else target
            followed += 1
            places = pages[target].places if target in pages else {""}
            if not target.is_file() or (parts.fragment and unquote(parts.fragment) not in places):
                dead.append(f"{path.name}: {link}")
    assert followed > 300
    assert not dead


@pytest.mark.slow
def test_nothing_is_fetched_from_elsewhere(site: Path, pages: dict[Path, Links]) -> None:
    fetched = [link for page in pages.values() for link in page.fetched]
    assert len(fetched) > 50
    assert not [link for link in fetched if urlsplit(link).netloc]
    styles = "".join(path.read_text(encoding="utf-8") for path in site.rglob("*.css"))
    assert not re.findall(r"(?:@import|url\()\s*['\"]?(?:https?:)?//", styles)


@pytest.mark.slow
def test_every_field_of_every_table_is_told(site: Path) -> None:
    text = (site / "fields.html").read_text(encoding="utf-8")
    paths = [doc.path for spec in TABLES.values() for doc in field_docs(spec.schema)]
    assert len(paths) > 100
    assert [path for path in paths if f"<code>{path}</code>" not in text] == []


@pytest.mark.slow
def test_search_works_from_a_disk(site: Path, chromium: Any) -> None:
    page, asked = chromium.new_page(), []
    page.on("request", lambda request: asked.append(request.url))
    page.goto((site / "index.html").as_uri())
    page.get_by_role("textbox", name="Search").fill("shortest way")
    found = page.locator(".md-search-result__link")
    found.first.wait_for(timeout=30_000)
    links = [one.get_attribute("href") for one in found.all()]
    assert any("METRICS.html" in link for link in links)
    found.first.click()
    page.wait_for_load_state()
    assert page.url.split("?")[0].startswith(site.as_uri())
    assert {urlsplit(url).scheme for url in asked} <= {"file", "data", "blob"}
    page.close()
