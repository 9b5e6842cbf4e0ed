"""What machine code depends on: its folder is named after all of it."""

import ast
from pathlib import Path

import pytest

import remqa_data
from remqa_data.compiled import SOURCES

PACKAGE = Path(remqa_data.__file__).parent


def depended_on(path: Path) -> set[str]:
    """The module, if it compiles functions, and all of ours whose names its compiled functions use."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    module_of = {
        alias.asname or alias.name: source_of(str(node.module), alias.name)
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and str(node.module).startswith("remqa_data.")
        for alias in node.names
    }
    compiled = [
        node
        for node in tree.body
        if isinstance(node, ast.FunctionDef) and "exact" in [ast.unparse(name) for name in node.decorator_list]
    ]
    used = {node.id for function in compiled for node in ast.walk(function) if isinstance(node, ast.Name)}
    own = {path.relative_to(PACKAGE).with_suffix("").as_posix()} if compiled else set()
    return own | {module_of[name] for name in used & set(module_of)} - {"geometry/types"}  # names of numpy's types


def source_of(module: str, name: str) -> str:
    path = module.removeprefix("remqa_data.").replace(".", "/")
    return f"{path}/{name}" if (PACKAGE / path / f"{name}.py").is_file() else path


@pytest.mark.slow
def test_machine_code_is_renewed_when_any_module_changes_that_it_comes_from() -> None:
    expected = {"compiled"}.union(*(depended_on(path) for path in PACKAGE.rglob("*.py")))
    assert len(expected) > 8
    assert set(SOURCES) == expected
    assert all((PACKAGE / f"{module}.py").is_file() for module in SOURCES)
