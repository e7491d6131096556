"""The code of the package, read once for all tests that ask how it is built."""

import ast
from functools import cache
from pathlib import Path

from tests.support import ROOT

PACKAGE = ROOT / "nrs_design"


def module_name(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


FILES = {module_name(path): path for path in sorted(PACKAGE.rglob("*.py"))}


@cache
def nodes_of(path: Path) -> tuple[ast.AST, ...]:
    """All that a file says, read once for all questions."""
    return tuple(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))


@cache
def names_in(path: Path) -> frozenset[str]:
    """Names that the code of a file uses or imports."""
    used = {node.id for node in nodes_of(path) if isinstance(node, ast.Name)}
    return frozenset(used) | {
        alias.name
        for node in nodes_of(path)
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
