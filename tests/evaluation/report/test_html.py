"""The report in a real browser: nothing is loaded, rows sort and filter, hostile texts are texts."""

from collections.abc import Iterator
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from remqa_data.evaluation.cli import app
from remqa_data.evaluation.report.html import write_tables_page
from remqa_data.evaluation.report.tables import Grid
from remqa_data.evaluation.submission.reference import reference_rows
from tests.helpers.submissions import written

HOSTILE = '<img src=x onerror="window.hacked=1"><script>window.hacked=1</script></script>"\'&{{7*7}}'


def report(data: Path, folder: Path, path: Path) -> Path:
    done = CliRunner().invoke(app, [str(path), "--data", str(data), "-o", str(folder)])
    assert done.exit_code == 0, done.output
    return folder / "report.html"


@pytest.fixture(scope="module")
def hostile(data: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("report")
    rows = [{"question_id": f"Kitchen3-q{i}", "answer": HOSTILE if i == 4 else "yes"} for i in range(10)]
    return report(data, folder, written(folder / "a.jsonl", "qa", rows, agent=HOSTILE))


@pytest.fixture
def page(hostile: Path, chromium: Any) -> Iterator[tuple[Any, list[str]]]:
    """The opened report, and what it has asked the network for or complained about."""
    opened, events = chromium.new_page(), []
    opened.on("request", lambda r: events.append(r.url) if not r.url.startswith(("file:", "data:")) else None)
    opened.on("console", lambda message: events.append(message.text))
    opened.on("pageerror", lambda error: events.append(str(error)))
    opened.on("dialog", lambda dialog: events.append(dialog.message))
    opened.goto(hostile.as_uri())
    yield opened, events
    opened.close()


def test_it_loads_without_network_or_complaints(page: tuple[Any, list[str]]) -> None:
    opened, events = page
    assert opened.locator("h2").first.text_content() == "Scores"
    assert opened.locator("svg circle").count() > 5
    images = opened.locator("figure img")
    assert images.count() > 0
    assert all(images.nth(i).evaluate("image => image.naturalWidth") > 0 for i in range(images.count()))
    assert events == []


def test_hostile_texts_show_as_texts(page: tuple[Any, list[str]]) -> None:
    opened, events = page
    assert opened.locator("p b").first.text_content() == HOSTILE
    assert opened.locator(".attempt dd", has_text="onerror").first.text_content() == HOSTILE
    assert opened.evaluate("window.hacked") is None
    assert opened.locator("script").count() == 1
    assert events == []


def test_injected_scripts_would_not_run(page: tuple[Any, list[str]]) -> None:
    opened, events = page
    opened.evaluate("document.body.insertAdjacentHTML('beforeend', '<img src=x onerror=\"window.hacked=1\">')")
    opened.wait_for_timeout(300)
    assert opened.evaluate("window.hacked") is None
    assert any("Content Security Policy" in event for event in events)


@pytest.mark.parametrize("width", [420, 1280])
def test_it_fits_the_width_of_a_phone_and_of_a_desk(page: tuple[Any, list[str]], width: int) -> None:
    opened, _ = page
    opened.set_viewport_size({"width": width, "height": 900})
    assert opened.evaluate("document.documentElement.scrollWidth") <= width
    for name in ("svg", "figure", ".scroll"):
        boxes = [one.bounding_box() for one in opened.locator(name).all()]
        assert boxes, name
        for box in boxes:
            assert box["x"] >= 0
            assert box["x"] + box["width"] <= width


def test_figures_do_not_overlap(page: tuple[Any, list[str]]) -> None:
    opened, _ = page
    for width in (420, 1280):
        opened.set_viewport_size({"width": width, "height": 900})
        boxes = [one.bounding_box() for one in opened.locator("svg, figure").all()]
        assert len(boxes) > 5
        for a, b in combinations(boxes, 2):
            apart_x = a["x"] + a["width"] <= b["x"] or b["x"] + b["width"] <= a["x"]
            assert apart_x or a["y"] + a["height"] <= b["y"] or b["y"] + b["height"] <= a["y"]


def test_texts_of_plots_are_inside_them(page: tuple[Any, list[str]]) -> None:
    opened, _ = page
    assert opened.locator("svg text").count() > 0
    for plot in opened.locator("svg").all():
        around = plot.bounding_box()
        for text in plot.locator("text").all():
            box = text.bounding_box()
            assert around["x"] <= box["x"] + 0.5
            assert box["x"] + box["width"] <= around["x"] + around["width"] + 0.5
            assert box["y"] + box["height"] <= around["y"] + around["height"] + 0.5


def test_rows_sort_and_filter(page: tuple[Any, list[str]]) -> None:
    opened, _ = page
    ids = opened.locator("#samples tbody tr td:first-child")
    stored = ids.all_text_contents()
    heading = opened.locator("#samples th").first
    heading.click()
    assert ids.all_text_contents() == sorted(stored)
    heading.click()
    assert ids.all_text_contents() == sorted(stored, reverse=True)
    opened.fill("#filter-samples", "counting 2")
    shown = opened.locator("#samples tbody tr:visible")
    assert 0 < shown.count() < len(stored)
    assert all("COUNTING" in text for text in shown.all_text_contents())
    opened.fill("#filter-failures", "q4")
    assert opened.locator(".failures .attempt:visible").count() == 1


def test_without_a_browser_the_text_is_escaped_too(hostile: Path) -> None:
    text = hostile.read_text()
    assert "<img src=x" not in text
    assert "&lt;img src=x" in text
    assert "49" not in text.split("onerror", 1)[1][:120]  # {{7*7}} is not a template
    assert "http://" not in text
    assert "https://" not in text


@pytest.mark.slow
def test_failures_and_successes_of_walks_show_view_map_and_boxes(two_rooms: Path, tmp_path: Path) -> None:
    for agent, track in (("random", "remqa"), ("random", "rec"), ("oracle", "nav")):
        predictions = tmp_path / f"{track}.jsonl"
        options = ["--data", str(two_rooms), "--track", track, "-o", str(predictions)]
        assert CliRunner().invoke(app, [agent, *options]).exit_code == 0
        text = report(two_rooms, tmp_path / track, predictions).read_text()
        failures, _, successes = text.partition("<h2>Successes</h2>")
        assert ("way from above" in failures) == (track == "remqa")
        assert ("<p>None.</p>" in failures) == (agent == "oracle")
        assert ("submitted red" in failures) == (agent == "random")
        assert (successes.count("<figcaption>way from above") == 10) == (agent == "oracle")


@pytest.mark.slow
def test_a_failed_manipulation_is_named_and_shown(two_rooms: Path, tmp_path: Path) -> None:
    rows = reference_rows("oracle", two_rooms, "remqa", "test", np.random.default_rng(0))
    ajar = next(row for row in rows if row["manipulation"].startswith("OpenObject"))
    ajar["manipulation"] += " 0.3"
    text = report(two_rooms, tmp_path / "out", written(tmp_path / "a.jsonl", "remqa", [ajar])).read_text()
    assert "12 that count as failures by S_MQA" in " ".join(text.split())
    assert text.count("<dd>manipulation</dd>") == 1
    assert text.count("<dd>nothing was submitted</dd>") == 11
    assert text.count("<figcaption>agent&#39;s view after its manipulation</figcaption>") == 1


def test_tables_alone_sort_and_their_texts_are_texts(chromium: Any, tmp_path: Path) -> None:
    grids = [Grid("Scores", ("System", "success"), ((HOSTILE, "0.9"), ("a3c", "0.25"), ("random", "0.01")))]
    write_tables_page(tmp_path / "table.html", "Agents", grids, [HOSTILE])
    opened, events = chromium.new_page(), []
    opened.on("request", lambda r: events.append(r.url) if not r.url.startswith(("file:", "data:")) else None)
    opened.on("console", lambda message: events.append(message.text))
    opened.goto((tmp_path / "table.html").as_uri())
    assert opened.locator("td").first.text_content() == HOSTILE
    assert opened.locator("p").last.text_content() == HOSTILE
    assert opened.evaluate("window.hacked") is None
    opened.locator("th", has_text="success").click()
    assert opened.locator("td:last-child").all_text_contents() == ["0.01", "0.25", "0.9"]
    assert events == []
    opened.close()
