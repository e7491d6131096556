"""One page for each kind of evidence, and nobody else asks which kind it is."""

from __future__ import annotations

import ast
import re

import pytest

from nrs_design.proof import evidence as proof
from nrs_design.reporting.document import Illustration
from nrs_design.reporting.evidence import offers, page_of
from tests.package import FILES, PACKAGE, nodes_of
from tests.proof.systems import SYSTEMS, genuine

NAMES = frozenset(proof.KINDS.values())
TEXTS = frozenset(proof.KINDS)
# What says the most, or takes long to prove, is left to the slow tests.
LONG = frozenset(
    (
        "conewise-mode-quadratic",
        "conewise-polynomial",
        "invariant-ellipsoid",
        "mode-quadratic",
        "offset-ellipsoid",
        "periodic-quadratic",
        "saturated-ellipsoid",
    )
)


def test_every_kind_has_a_row_in_the_table_of_what_it_offers():
    assert set(offers.OFFERS) == TEXTS


def test_outside_proof_and_search_only_the_table_names_a_kind():
    files = {path.relative_to(PACKAGE): path.read_text("utf-8") for path in PACKAGE.rglob("*.py")}
    for path, text in files.items():
        # Theorems for a proof assistant state the kinds again.
        if path.parts[0] in ("proof", "search") or "proof_assistant" in path.parts:
            continue
        assert not NAMES & set(re.findall(r"\w+", text)), path
        quoted = TEXTS & set(re.findall(r'"([\w-]+)"', text))
        assert not quoted or path.as_posix() == "reporting/evidence/offers.py", path


# Pages of growth differ by what shows it.
GROWING = ("mode", "average", "period", "contact", "value")
SHORT = sorted(TEXTS - LONG - {"growing-sequence", "graph"})


@pytest.mark.parametrize(
    "example",
    [
        *SHORT,
        "common-quadratic",
        "common-polynomial",
        pytest.param("mode-polynomial", marks=pytest.mark.slow),
        *(f"growing-sequence, {shape}" for shape in GROWING),
        *(pytest.param(kind, marks=pytest.mark.slow) for kind in sorted(LONG)),
    ],
)
def test_every_page_speaks_in_sentences_and_draws_a_run(example):
    example = next(name for name in SYSTEMS if name == example or name.split(",")[0] == example)
    page = page_of(*genuine(example))
    assert page.name
    assert not page.name.endswith(".")
    sentences = (*page.meaning(), *page.between_corners(), *page.limits())
    assert page.meaning()
    assert all(text.endswith(".") for text in sentences)
    assert all(section.blocks for section in page.sections())
    assert any(isinstance(block, Illustration) for block in page.run().blocks)


def aliases(files):
    """Names of kinds, and of all that is assigned from them: unions and tuples of kinds."""
    assigned = [
        node
        for nodes in files
        for node in nodes
        if isinstance(node, ast.Assign | ast.AnnAssign)
        and isinstance(node.value, ast.Tuple | ast.BinOp)
    ]
    known, before = set(NAMES), 0
    while len(known) > before:
        before = len(known)
        for node in assigned:
            if mentions(node.value, known):
                targets = node.targets if isinstance(node, ast.Assign) else [node.target]
                known |= {t.id for t in targets if isinstance(t, ast.Name)}
    return known


def mentions(node, known):
    names = (getattr(part, "id", getattr(part, "attr", None)) for part in ast.walk(node))
    return any(name in known for name in names)


def questions(nodes, known):
    """Yield the lines that ask of what kind some evidence is, other than by a look into a table."""
    for node in nodes:
        match node:
            case ast.Call(func=ast.Name("isinstance" | "issubclass"), args=[_, kind]):
                asks = mentions(kind, known)
            case ast.MatchClass(cls=kind):
                asks = mentions(kind, known)
            case ast.Compare(ops=[ast.Is() | ast.IsNot() | ast.Eq() | ast.NotEq()]):
                sides = [node.left, *node.comparators]
                typed = any(isinstance(s, ast.Call) and mentions(s.func, {"type"}) for s in sides)
                told = any(isinstance(s, ast.Attribute) and s.attr == "kind" for s in sides)
                asks = (typed and any(mentions(side, known) for side in sides)) or (
                    told and any(isinstance(s, ast.Constant) and s.value in TEXTS for s in sides)
                )
            case _:
                asks = False
        if asks:
            yield node.lineno


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("isinstance(e, FormsOnGraph)", 1),
        ("isinstance(e, evidence.FormsOnGraph)", 1),
        ("isinstance(e, FormsOnGraph | BlockTriangular)", 1),
        ("RULED = (FormsOnGraph, BlockTriangular)\nisinstance(e, RULED)", 1),
        ("Ruled = FormsOnGraph | BlockTriangular\nMORE = (Ruled, int)\nisinstance(e, MORE)", 1),
        ("type(e) is GrowingSequence", 1),
        ("e.kind == 'block-triangular'", 1),
        ("match e:\n  case GrowingSequence(steps=name): pass", 1),
        ("type(e) in PARTS", 0),
        ("KINDS[type(e)]", 0),
        ("isinstance(e, AbstractEvidence)", 0),
        ("kind.kind == fields['kind']", 0),
        ("block.kind == 'table'", 0),
    ],
)
def test_questions_about_kinds_are_recognized(text, count):
    nodes = tuple(ast.walk(ast.parse(text)))
    assert len(list(questions(nodes, aliases([nodes])))) == count


def test_no_code_asks_for_the_kind_of_evidence():
    known = aliases(map(nodes_of, FILES.values()))
    asked = [
        f"{name}:{line}"
        for name, path in FILES.items()
        for line in questions(nodes_of(path), known)
    ]
    assert asked == []


def test_the_modes_of_a_sampled_loop_are_not_said_to_be_the_corners_of_its_ranges():
    """Of the four corners of a motor's exponentials, one is left out, and one is another."""
    system, evidence = genuine("periodic-quadratic, rounding")
    (said,) = page_of(system, evidence).between_corners()
    assert "corners of what encloses the declared parameter ranges" in said
