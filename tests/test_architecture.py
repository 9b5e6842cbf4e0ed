"""The floors of docs/ARCHITECTURE.md are those of the code: every package is on one, and every import points down."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "remqa_data"
UPSTAIRS = ("generators", "evaluation", "agents", "configs", "templates")
MOST_MODULES = 16
"""In one folder, besides its `__init__`."""


def floors() -> list[list[str]]:
    """The packages of each floor, from the top."""
    block = (ROOT / "docs" / "ARCHITECTURE.md").read_text(encoding="utf-8").split("```")[1]
    return [line.split("   ")[0].split() for line in block.strip().splitlines()]


def modules() -> dict[str, Path]:
    """All modules of the package by dotted name, without `remqa_data.`."""
    found = {}
    for top in (PACKAGE, *(ROOT / folder for folder in UPSTAIRS)):
        for path in sorted(top.rglob("*.py")):
            parts = path.relative_to(PACKAGE if top == PACKAGE else ROOT).with_suffix("").parts
            if top == PACKAGE and parts[0] in UPSTAIRS:
                continue
            name = ".".join(parts).removesuffix("__init__").rstrip(".")
            found[name] = path
    return found


def package_of(module: str, all_modules: dict[str, Path]) -> str:
    """The package in which a module lies; modules at the root count as packages of their own."""
    is_package = all_modules[module].name == "__init__.py"
    return module if is_package or "." not in module else module.rpartition(".")[0]


def imported_names(path: Path, root: Path = ROOT) -> Iterator[str]:
    """The absolute names of everything that a file imports, at any depth and also lazily."""
    parts = path.relative_to(root).with_suffix("").parts[:-1]
    package = parts if parts[:1] == ("remqa_data",) else ("remqa_data", *parts)
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else ()
            start = ".".join([*base, *([node.module] if node.module else [])])
            yield from (f"{start}.{alias.name}" for alias in node.names)


def imported_modules(path: Path, all_modules: dict[str, Path]) -> Iterator[str]:
    """The modules of the package that a file imports."""
    for name in imported_names(path):
        inner = name.removeprefix("remqa_data.")
        if inner == name:
            continue
        while inner and inner not in all_modules:
            inner = inner.rpartition(".")[0]
        if inner:
            yield inner


@cache
def arrows() -> frozenset[tuple[str, str]]:
    """Pairs of packages of which the first imports the second."""
    known = modules()
    pairs = (
        (package_of(name, known), package_of(other, known))
        for name, path in known.items()
        if name  # the package itself offers names from everywhere
        for other in imported_modules(path, known)
    )
    return frozenset((upper, lower) for upper, lower in pairs if upper != lower)


def test_every_package_is_on_exactly_one_floor():
    named = [package for floor in floors() for package in floor]
    known = modules()
    packages = {package_of(name, known) for name in known if name} - {"assets.types"}
    assert sorted(named) == sorted(set(named))
    assert set(named) == packages


def test_imports_point_down_the_floors():
    level = {package: number for number, floor in enumerate(floors()) for package in floor}
    found = arrows()
    assert len(found) > 100
    assert sorted((upper, lower) for upper, lower in found if level[upper] > level[lower]) == []


def test_the_check_of_imports_sees_every_way_of_importing(tmp_path):
    path = tmp_path / "remqa_data" / "sim" / "world.py"
    path.parent.mkdir(parents=True)
    for line in (
        "import remqa_data.generators",
        "from remqa_data import generators",
        "from .. import generators",
        "def lazy():\n    from remqa_data import generators",
    ):
        path.write_text(line)
        assert list(imported_names(path, tmp_path)) == ["remqa_data.generators"], line
    path.write_text("from ..generators import cli")
    assert list(imported_names(path, tmp_path)) == ["remqa_data.generators.cli"]


def test_packages_of_one_floor_do_not_import_each_other():
    level = {package: number for number, floor in enumerate(floors()) for package in floor}
    found = arrows()
    assert [(a, b) for a, b in found if level[a] == level[b] and (b, a) in found] == []


def test_who_learns_acts_or_scores_needs_no_generator():
    makers = ("generators", "browse", "cli", "commands")
    found = [(upper, lower) for upper, lower in arrows() if lower.split(".")[0] == "generators"]
    assert len(found) > 10
    assert [upper for upper, _ in found if upper.split(".")[0] not in makers] == []


def test_no_folder_holds_more_modules_than_one_can_survey():
    folders: dict[Path, int] = {}
    for path in modules().values():
        if path.name != "__init__.py":
            folders[path.parent] = folders.get(path.parent, 0) + 1
    assert len(folders) > 30
    assert {str(folder.relative_to(ROOT)): count for folder, count in folders.items() if count > MOST_MODULES} == {}


def test_what_decides_each_truth_is_where_the_architecture_says() -> None:
    page = (ROOT / "docs" / "ARCHITECTURE.md").read_text(encoding="utf-8")
    table = page.split("Each is decided twice")[1].split("\nA question of how")[0]
    named = {word for quoted in re.findall(r"`([^`]+)`", table) for word in re.split(r"[./]", quoted)} - {"yaml"}
    code = "\n".join(path.read_text(encoding="utf-8") for path in (ROOT / "generators").rglob("*.py"))
    stems = {path.stem for path in (ROOT / "generators").rglob("*")} | {
        path.stem for path in (ROOT / "templates").iterdir()
    }
    assert len(named) > 30
    assert {word for word in named if word not in stems and not re.search(rf"\b{word}\b", code)} == set()
