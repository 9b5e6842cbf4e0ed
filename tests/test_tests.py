"""No test passes by looping over nothing or by returning early: outside such loops each one asserts something."""

import ast
from collections.abc import Sequence
from pathlib import Path

FILES = sorted(Path(__file__).parent.rglob("test_*.py"))
NEVER_EMPTY = ("range", "enumerate", "zip", "sorted", "reversed", "np.linspace", "permutations", "product")


def test_every_test_asserts_something_whatever_it_loops_over() -> None:
    assert len(FILES) > 100
    idle = []
    for path in FILES:
        tree = ast.parse(path.read_text(encoding="utf-8"))
        helpers = {node.name for node in tree.body if isinstance(node, ast.FunctionDef) and asserts(node.body, set())}
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef) and node.name.startswith("test_") and not asserts(node.body, helpers):
                idle.append(f"{path.name}:{node.lineno}: {node.name}")
    assert not idle, "assert that there is something to loop over:\n" + "\n".join(idle)


def asserts(body: Sequence[ast.stmt], helpers: set[str]) -> bool:
    """Whether statements assert something whenever they are reached; a return before that is an idle way through."""
    for node in body:
        if is_certain(node, helpers):
            return True
        if returns_idly(node, helpers):
            return False
    return False


def returns_idly(node: ast.stmt, helpers: set[str]) -> bool:
    """Whether a statement may leave the test with nothing asserted."""
    if isinstance(node, ast.Return):
        return True
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return False
    for block in ("body", "orelse", "finalbody", "handlers"):
        for inner in getattr(node, block, []):
            if isinstance(inner, ast.stmt) and is_certain(inner, helpers):
                break
            if returns_idly(inner, helpers):
                return True
    return False


def is_certain(node: ast.stmt, helpers: set[str]) -> bool:
    match node:
        case ast.Assert():
            return True
        case ast.With():
            opened = [ast.unparse(item.context_expr) for item in node.items]
            return any(text.startswith(("pytest.raises", "pytest.warns")) for text in opened) or asserts(
                node.body, helpers
            )
        case ast.For():
            return is_never_empty(node.iter) and asserts(node.body, helpers)
        case ast.If():
            return asserts(node.body, helpers) and asserts(node.orelse, helpers)
        case ast.Try():
            return asserts([*node.body, *node.orelse, *node.finalbody], helpers)
        case ast.Expr(value=ast.Call(func=function)) | ast.Assign(value=ast.Call(func=function)):
            name = ast.unparse(function).rpartition(".")[2]
            return name in helpers or name.startswith(("assert_", "check_"))
    return False


def is_never_empty(node: ast.expr) -> bool:
    """What is written out, a constant of the module, an argument of the test, or made of such."""
    match node:
        case ast.Tuple() | ast.List() | ast.Set() | ast.Dict():
            return True
        case ast.Name(id=name):
            return name.isupper() or name in ("levels",)
        case ast.Attribute(value=inner) | ast.BinOp(left=inner) | ast.Starred(value=inner):
            return is_never_empty(inner)
        case ast.Constant():
            return True
        case ast.Call(func=ast.Attribute(value=inner, attr="items" | "values" | "keys")):
            return is_never_empty(inner)
        case ast.Call(args=args):
            return ast.unparse(node.func) in NEVER_EMPTY and any(map(is_never_empty, args))
    return False
