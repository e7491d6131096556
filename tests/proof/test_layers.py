"""The proof is the ground floor: it stands on the standard library, and on flint in one file."""

import ast
import subprocess
import sys
from pathlib import Path

import nrs_design.proof
from tests.test_structure import imports

ROOT = Path(nrs_design.proof.__file__).parent
DOCS = Path(__file__).parents[2] / "docs" / "certificates"
FILES = sorted(path.relative_to(ROOT).as_posix() for path in ROOT.rglob("*.py"))


def test_imports():
    foreign = {
        (item.source, item.target)
        for item in imports()
        if item.source.startswith("nrs_design.proof")
        and item.target.split(".")[0] not in sys.stdlib_module_names
        and not item.target.startswith("nrs_design.proof.")
    }
    # Inside functions only, as is seen below: nobody pays for it who needs no enclosure.
    assert foreign == {("nrs_design.proof.enclosure", "flint")}


def test_the_whole_proof_loads_nothing_else():
    script = (
        "import sys, importlib\n"
        f"for name in {FILES!r}:\n"
        "    parts = name.removesuffix('.py').split('/')\n"
        "    importlib.import_module('.'.join(['nrs_design.proof', *parts]))\n"
        "print(*sorted({name.split('.')[0] for name in sys.modules}))\n"
        "print(*sorted(name for name in sys.modules if name.startswith('nrs_design.')))\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert not done.stderr
    top, ours = (line.split() for line in done.stdout.splitlines())
    assert not {"numpy", "scipy", "flint", "pydantic", "typer"} & set(top)
    assert all(name.startswith("nrs_design.proof") for name in ours)


def test_an_audit_takes_a_day():
    """The page leads to every file, and they are few lines of code."""
    page = (DOCS / "audit.md").read_text(encoding="utf-8")
    assert [name for name in FILES if f"`{name.removesuffix('.py')}`" not in page] == [
        "__init__.py"
    ]
    assert sum(code_lines((ROOT / name).read_text(encoding="utf-8")) for name in FILES) <= 3700


def code_lines(text):
    """Count lines that are neither blank, nor a comment, nor part of a docstring."""
    told = {
        line
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        for line in range(node.lineno, node.end_lineno + 1)
    }
    lines = ((number, line.strip()) for number, line in enumerate(text.splitlines(), 1))
    return sum(bool(line) and line[0] != "#" and number not in told for number, line in lines)
