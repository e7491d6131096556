"""Drawings, tables and refusals of the documentation."""

import re

import pytest
from making.cost import problem_of
from making.dissertation import misprints_table, reproduced_table, rows
from making.floors import drawing, floors_of, imports_between, label
from making.growth import growth_table
from making.offline import loaded_from_elsewhere

from nrs_design.design.impedance_optimum import impedance_cost, optimize_impedance
from nrs_design.thesis.table import counts_line, printed_errors
from tests import tables
from tests.support import ROOT, SOFT_TISSUE
from tests.tables import table

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


@pytest.mark.slow
def test_the_cost_that_is_drawn_is_that_of_the_design():
    problem = problem_of(SOFT_TISSUE, "insertion")
    optimum = optimize_impedance(problem)
    assert optimum.Mt == 0.01
    # As `optimize` prints.
    assert float(impedance_cost(problem, optimum.Mt, optimum.Bt)) == pytest.approx(0.1552, abs=1e-4)


@pytest.mark.slow
def test_every_number_of_the_dissertation_has_a_row():
    counts, _, _, _, *listed = reproduced_table().splitlines()
    assert counts == counts_line(rows())
    verdicts = [row.verdict for row in rows()]
    compared = {"reproduced", "fitted", "derived"}
    assert len(listed) == sum(verdict in compared for verdict in verdicts)
    assert any(line.endswith("| 2.14859 | N m s/rad | reproduced |") for line in listed)
    misprints = misprints_table().splitlines()[2:]
    errors = printed_errors(rows())
    touched = [row for _, of_one in errors for row in of_one]
    assert len(misprints) == len(touched)
    assert all(f" | {row.section} | " in x for x, row in zip(misprints, touched, strict=True))
    # Named on the first of its rows only.
    assert [line.startswith("|  |") for line in misprints].count(False) == len(errors)


def test_every_published_growth_has_a_row():
    path = ROOT / "tests/literature/growth_per_step.yaml"
    _, _, *rows = growth_table(path).splitlines()
    assert len(rows) == len(table(path))
    assert "| G96 long |  | 13 |" in rows
    assert "| L17 long | 1.68418528 | 41 |" in rows


@pytest.mark.parametrize(
    ("tags", "count"), tables.rows(__file__, "test_what_a_page_would_load_from_a_network_is_found")
)
def test_what_a_page_would_load_from_a_network_is_found(tags, count):
    assert len(loaded_from_elsewhere(f"<html>{tags}</html>")) == count
