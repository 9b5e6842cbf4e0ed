import re
from pathlib import Path

import pytest

from remqa_data.agents.config import load_system, systems
from remqa_data.errors import ConfigError

ROOT = Path(__file__).parents[2]
TEXT = """\
title: mine
seed: 0
most_steps: 10
navigator: {kind: random}
localizer: null
manipulator: null
answerer: null
"""


def test_the_systems_that_come_with_the_package_are_read_and_say_what_they_are() -> None:
    assert {"a3c", "framework", "framework_memory", "random", "savn", "scene_priors", "semantic_map"} <= set(systems())
    assert len({load_system(name).title for name in systems()}) == len(systems())
    assert load_system("semantic_map").navigator.kind == "semantic_map"
    titles = [load_system(name).title for name in ("random", "semantic_map")]
    assert "majority answer" in titles[0]
    assert "true labels" in titles[1]
    assert "majority answer" in titles[1]  # nobody takes it for the paper's whole method


def test_the_systems_that_come_with_the_package_are_described_and_play() -> None:
    page = (ROOT / "docs" / "AGENTS.md").read_text(encoding="utf-8")
    table = page.split("## The systems\n")[1].split("\n\n**")[0]
    cells = re.findall(r"^\| (`.*?) \|", table, re.MULTILINE)
    assert sorted(name for cell in cells for name in re.findall(r"`(\w+)`", cell)) == sorted(systems())
    (played,) = re.findall(r"^SYSTEMS := (.*)$", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    assert sorted(played.split()) == sorted(systems())


def test_a_file_is_read_like_a_preset(tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(TEXT)
    system = load_system(path)
    assert (system.title, system.localizer) == ("mine", None)
    path.write_text(TEXT + "# a remark\n")
    assert load_system(path).sha256 == system.sha256
    path.write_text(TEXT.replace("most_steps: 10", "most_steps: 11"))
    assert load_system(path).sha256 != system.sha256


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ("kind: random", "kind: clever", "navigator: Input tag 'clever' found using 'kind' does not match"),
        ("most_steps: 10", "most_steps: 501", "most_steps: Input should be less than or equal to 500"),
        ("title: mine", "title: ''", "title: String should have at least 1 character"),
        ("answerer: null", "answers: null", "answers: there is no such key; did you mean 'answerer'"),
        ("10\nnavigator: {kind: random}", "0\nnavigator: {kind: frontier}", "who explores does a step at least"),
        (TEXT, "- a list", "expected keys such as 'seed', found list"),
        (TEXT, "a: &x 1\nb: *x", "anchors and aliases"),
    ],
)
def test_what_is_wrong_is_said_with_file_and_key(tmp_path: Path, before: str, after: str, said: str) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(TEXT.replace(before, after))
    with pytest.raises(ConfigError) as error:
        load_system(path)
    assert str(error.value).startswith(f"{path}: ")
    assert said in str(error.value)


def test_a_name_that_is_nearly_a_system_is_told() -> None:
    with pytest.raises(ConfigError, match="did you mean 'random'"):
        load_system("randon")
