"""Drawings, tables and refusals of the documentation."""

import re

import pytest
from making.cost import problem_of
from making.floors import drawing, floors_of, imports_between, label
from making.misprints import misprints_table
from making.offline import loaded_from_elsewhere

from nrs_design.design.impedance_optimum import impedance_cost, optimize_impedance
from nrs_design.thesis.table import printed_errors, reproduce
from tests.support import ROOT, SOFT_TISSUE

ARCHITECTURE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
TABLE = "| `top` | words |\n| `middle`, `beside` | words |\n| `ground` | words |\n"


@pytest.fixture
def house(tmp_path):
    package = tmp_path / "house"
    for floor in ("top", "ground"):
        (package / floor).mkdir(parents=True)
    (package / "top" / "a.py").write_text(
        "from house.ground.b import x\nfrom house.ground import b\nfrom house import middle\n"
    )
    (package / "middle.py").write_text("from os import path\nfrom house.middle import self\n")
    (package / "ground" / "b.py").write_text("import json\n")
    return package


def test_imports_are_counted_by_module(house):
    top, middle, ground = floors_of(TABLE)
    assert (top, middle, ground) == (("top",), ("middle", "beside"), ("ground",))
    assert imports_between(house, [top, middle, ground]) == {(top, ground): 1, (top, middle): 1}


def test_an_import_upward_is_told(house):
    assert "2 imports of modules from other floors, none of them upward" in drawing(house, TABLE)
    (house / "ground" / "b.py").write_text("def f():\n    from house.top.a import x\n")
    assert "3 imports of modules from other floors, 1 of them upward" in drawing(house, TABLE)


@pytest.mark.slow
def test_the_drawing_shows_every_floor():
    drawn = drawing(ROOT / "nrs_design", ARCHITECTURE)
    assert "none of them upward" in drawn
    names = re.findall(r'text-anchor="end">([^<]+)</text>', drawn)
    assert names == [label(floor) for floor in floors_of(ARCHITECTURE)]
    assert len(names) == 1 + 10  # The wings, and at most ten floors of the core.
    assert "<title>cli, gating, ... import pipeline: " in drawn
    assert "<!-- made: floors -->" in ARCHITECTURE


@pytest.mark.parametrize(
    "tag",
    [
        '<script src="https://cdn.example/a.js"></script>',
        '<link rel="stylesheet" href="//cdn.example/a.css">',
        '<img src="HTTP://example.org/a.png">',
        '<link rel="shortcut icon" href="https://example.org/a.ico">',
    ],
)
def test_what_a_page_would_load_from_a_network_is_found(tag):
    assert len(loaded_from_elsewhere(f"<html>{tag}</html>")) == 1


def test_links_and_local_files_are_no_loading():
    page = (
        '<a href="https://example.org">x</a><script src="js/a.js"></script><img src="a.png">'
        '<link rel="canonical" href="https://example.org">'
    )
    assert loaded_from_elsewhere(page) == []


@pytest.mark.slow
def test_the_cost_that_is_drawn_is_that_of_the_design():
    problem = problem_of(SOFT_TISSUE, "insertion")
    optimum = optimize_impedance(problem)
    assert optimum.Mt == 0.01
    # As the README shows.
    assert float(impedance_cost(problem, optimum.Mt, optimum.Bt)) == pytest.approx(0.1552, abs=1e-4)


@pytest.mark.slow
def test_every_misprint_has_a_row():
    table = misprints_table().splitlines()[2:]
    errors = printed_errors(reproduce())
    rows = [row for _, touched in errors for row in touched]
    assert len(table) == len(rows)
    assert all(f" | {row.section} | " in line for line, row in zip(table, rows, strict=True))
    # Named on the first of its rows only.
    assert [line.startswith("|  |") for line in table].count(False) == len(errors)
