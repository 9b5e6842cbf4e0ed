"""Tables as texts: in narrow terminals, and as Markdown."""

import html
import io
import re

import pytest
from markdown_it import MarkdownIt
from rich.console import Console

from remqa_data.evaluation.report.tables import Grid, markdown_lines, markdown_text, print_grid

AGENT = "a-very-long-name-of-an-agent"
RANKING = Grid(
    "split test",
    ("rank", "agent", "S_MQA", "answer accuracy", "manipulated"),
    (("1", AGENT, "0.125\n0.071–0.214", "0.250", "0.500"), ("–", "b", "not measured", "0.999", "–")),
)


@pytest.mark.parametrize("width", [80, 60, 40, 30])
def test_no_number_is_broken_in_a_narrow_terminal(width: int) -> None:
    console = Console(width=width, file=io.StringIO())
    print_grid(console, RANKING)
    text = console.file.getvalue()
    assert max(map(len, text.splitlines())) <= width
    assert {"0.125", "0.071–0.214", "0.250", "0.500", "0.999", "accuracy", "manipulated"} <= set(text.split())
    assert text.count("split test") == 1
    assert (AGENT in text) == (width == 80)


def test_columns_that_find_no_room_stand_below_with_the_names() -> None:
    console = Console(width=40, file=io.StringIO())
    print_grid(console, RANKING)
    headings = [line.split() for line in console.file.getvalue().splitlines() if line.startswith(" rank")]
    assert headings == [["rank", "agent", "S_MQA"], ["rank", "agent", "accuracy", "manipulated"]]


@pytest.mark.parametrize(
    "name",
    [
        "<b>x|`y`*z*</b>",
        "<img src=x>",
        "[text](url)",
        "![x](y)",
        "<https://a.b>",
        "&lt;",
        "a\\|b",
        "~~x~~",
        "__x__ _y_ a__b",
    ],
)
def test_a_name_in_markdown_shows_as_it_is(name: str) -> None:
    reader = MarkdownIt("commonmark").enable(["table", "strikethrough"])
    table = "\n".join(markdown_lines(Grid("scores", ("agent", "S_QA"), ((name, "0.5"),))))
    for page in (reader.render(f"Agent: {markdown_text(name)}."), reader.render(table)):
        assert set(re.findall(r"<(\w+)", page)) <= {"p", "strong", "table", "thead", "tbody", "tr", "th", "td"}
        assert name in html.unescape(re.sub("<[^>]+>", "", page))


def test_usual_names_stay_readable_in_markdown() -> None:
    assert markdown_text("cnn-lstm_v2 (S_MQA) 0.5") == "cnn-lstm_v2 (S_MQA) 0.5"
