"""The script that re-checks certificates without this package: on what ships, and on forgeries."""

import ast
import copy
import json
import runpy
import subprocess
import sys
from fractions import Fraction

import pytest

from nrs_design.certificates.certificate import content_id
from nrs_design.certificates.prove import prove
from tests.certificates.attacks import (
    ATTACKS,
    BOTH,
    DEAR_ATTACKS,
    PAGE_ALONE,
    POLYNOMIAL,
    QUADRATIC,
    SHIPPED,
    found,
    named,
    shipped,
)
from tests.support import ROOT
from tests.tables import rows

SCRIPT = ROOT / "docs" / "certificates" / "check_elsewhere.py"


def run(path):
    return subprocess.run(
        [sys.executable, "-I", "-W", "error", SCRIPT, path],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )


@pytest.fixture
def judge(tmp_path, monkeypatch):
    """Write a document with an id of its own, and return the exit code of the script, run here."""

    def judged(document):
        path = tmp_path / "c.json"
        path.write_text(json.dumps({**document, "id": content_id(document)}))
        return decide(path, monkeypatch)

    return judged


def decide(path, monkeypatch):
    monkeypatch.setattr(sys, "argv", [str(SCRIPT), str(path)])
    # It says what is wrong in one line.
    monkeypatch.setattr(sys, "tracebacklimit", 1000, raising=False)
    try:
        runpy.run_path(str(SCRIPT))
    except SystemExit as done:
        return done.code if isinstance(done.code, int) else 1
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
        return 1
    raise AssertionError("it did not say how it ended")


def test_it_is_short_and_imports_nothing_of_ours():
    text = SCRIPT.read_text()
    assert len(text.splitlines()) <= 275
    imported = {
        (item.module if isinstance(item, ast.ImportFrom) else item.names[0].name)
        for item in ast.walk(ast.parse(text))
        if isinstance(item, ast.Import | ast.ImportFrom)
    }
    assert imported <= sys.stdlib_module_names


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.name)
def test_what_ships_holds(path, monkeypatch, capsys):
    """Every statement of every certificate but of what could pull, whatever its kind and shape."""
    document = json.loads(path.read_text())
    known = "pulls" not in document.get("contact", {})
    assert decide(path, monkeypatch) == (0 if known else 3)
    said = "holds" if known else "not checked here (this kind, turns, pulls or axes)"
    kinds = [item["kind"] for item in document["statements"]]
    assert capsys.readouterr().out.splitlines() == [f"{kind}: {said}" for kind in kinds]


def test_it_runs_as_typed():
    done = run(ROOT / "reports" / f"{POLYNOMIAL}.cert.json")
    assert done.returncode == 0
    assert done.stdout.splitlines() == ["graph: holds", "no-common-quadratic: holds"]
    assert done.stderr == ""


@pytest.mark.parametrize("name", [QUADRATIC, POLYNOMIAL])
def test_what_is_altered_is_noticed(tmp_path, name):
    document = shipped(name)
    for key, value in (("modes", document["modes"][1:]), ("verdict", "refuted")):
        (tmp_path / "c.json").write_text(json.dumps({**document, key: value}))
        done = run(tmp_path / "c.json")
        assert done.returncode == 1
        assert "altered" in done.stderr


@pytest.mark.parametrize(("name", "change"), [*ATTACKS, *DEAR_ATTACKS], ids=named)
def test_forgeries_do_not_hold(judge, name, change):
    document = shipped(name)
    forged = copy.deepcopy(document)
    change(forged)
    assert forged != document
    # Polynomials in steps, and what is left after any time, are left to others.
    done = named(change)
    left = done == "follow_nobody" or (name, done) == (POLYNOMIAL, "call_it_discrete")
    assert judge(forged) == (3 if left else 1)
    # Nor do they here.
    assert prove({**forged, "id": content_id(forged)}).fault is not None


@pytest.mark.parametrize(
    ("key", "value"),
    [("clock", {"length": 2, "first": ["a"]}), ("contact", {"free": [], "pulls": []})],
)
def test_turns_and_pulls_are_not_taken_for_none(judge, key, value):
    document = shipped(QUADRATIC)
    if key == "contact":
        document = shipped("soft-tissue")
        value = {**document["contact"], "pulls": [{"numerators": [[0, 0, 0, 1]], "denominator": 1}]}
    assert judge({**document, key: value}) == 3


def test_another_kind_is_not_checked(judge):
    document = shipped(QUADRATIC)
    document["statements"][0]["kind"] = "growing-sequence"
    assert judge(document) == 3


def test_axes_that_act_on_each_other_are_not_checked(judge):
    assert judge({**shipped(QUADRATIC), "couplings": []}) == 3


@pytest.mark.parametrize("rate", ["9/10", "1/2", "1/3"])
def test_discrete_time(judge, rate):
    """``x+ = x / 2`` with ``V = x^2``: every rho above 1/2 is proved, and no other."""
    document = shipped(QUADRATIC)
    statement = {"kind": "graph", "nodes": [{"place": "modes", "form": [[1]]}], "rate": rate}
    document |= {
        "time": "discrete",
        "states": ["x"],
        "modes": [{"name": "half", "numerators": [[1]], "denominator": 2}],
        "statements": [{**statement, "denominator_log2": 0}],
    }
    assert judge(document) == (0 if Fraction(rate) > Fraction(1, 2) else 1)


@pytest.mark.parametrize(
    ("time", "A", "rate", "code"), rows(__file__, "test_a_constant_parameter_by_hand")
)
def test_a_constant_parameter_by_hand(judge, time, A, rate, code):
    """One state, P = 3 and 5, F = 1, G = 4: definite for rho^2 > 2/5, or alpha < 1/20."""
    modes = [{"name": k, "numerators": [[a]], "denominator": 4} for k, a in zip("ab", A, strict=1)]
    statement = {"kind": "constants-quadratic", "denominator_log2": 0, "rate": rate}
    statement |= {"functions": [[[3]], [[5]]], "multipliers": [[[[1]], [[4]]]]}
    document = {**shipped(QUADRATIC), "time": time, "states": ["x"], "modes": modes}
    document |= {"switching": {"fixed_ends": [["a", "b"]]}, "statements": [statement]}
    assert judge(document) == code


@pytest.mark.parametrize(("dwell", "code"), [("2761/1000", 0), ("68/25", 1)])
def test_dwell_times(judge, dwell, code):
    """Geromel and Colaneri (2006): no forms below 2.75084 s, and those of 2.76 s do for longer."""
    document = shipped("geromel-colaneri")
    document["switching"]["dwell_time"] = dwell
    assert judge(document) == code


def test_numbers_that_are_no_integers_are_refused(judge):
    """A product of them would be rounded, and to the wrong side."""
    document = shipped(QUADRATIC)
    document["statements"] = document["statements"][:1]
    node = document["statements"][0]["nodes"][0]
    assert judge(document) == 0
    node["form"] = [[float(entry) for entry in row] for row in node["form"]]
    assert judge(document) == 1


def test_nothing_said_is_nothing_shown(judge):
    assert judge({**shipped(QUADRATIC), "statements": [], "verdict": "inconclusive"}) == 1


@pytest.mark.slow
@pytest.mark.parametrize("example", BOTH)
def test_shapes_that_do_not_ship(judge, example):
    document = found(example)
    assert judge(document) == 0
    statement = document["statements"][0]
    if statement["kind"] == "graph":
        statement["nodes"][-1]["form"][0][0] *= -1
    else:
        statement["factors"].pop()
    assert judge(document) == 1


@pytest.mark.parametrize("example", [PAGE_ALONE[0], PAGE_ALONE[-1]])
def test_shapes_that_are_not_checked(judge, example):
    assert judge(found(example)) == 3
