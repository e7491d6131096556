"""The list of dear tests, and in which session each runs."""

import ast

from tests.costs import known_costs
from tests.support import ROOT


def test_every_dear_test_is_there():
    """Of parameters only the function is looked up."""
    wanted = {name.partition("[")[0] for name in known_costs()}
    there = set()
    for file in {name.partition("::")[0] for name in wanted}:
        path = ROOT / file
        if not path.is_file():
            continue
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            there.add(f"{file}::{getattr(node, 'name', '')}")
            for inner in getattr(node, "body", []) if isinstance(node, ast.ClassDef) else []:
                there.add(f"{file}::{node.name}::{getattr(inner, 'name', '')}")
    assert not wanted - there
