"""The script that re-checks certificates without this package: on what ships, and on forgeries."""

import ast
import copy
import json
import subprocess
import sys
from fractions import Fraction

import pytest

from nrs_design.certificates.certificate import content_id
from nrs_design.certificates.prove import prove
from tests.support import ROOT

SCRIPT = ROOT / "docs" / "certificates" / "check_elsewhere.py"
SHIPPED = sorted((ROOT / "reports").glob("*.cert.json"))
QUADRATIC, POLYNOMIAL = "commuting", "dayawansa-martin-6"


def shipped(name):
    return json.loads((ROOT / "reports" / f"{name}.cert.json").read_text())


def run(path):
    return subprocess.run(
        [sys.executable, "-I", "-W", "error", SCRIPT, path],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )


@pytest.fixture
def judge(tmp_path):
    """Write a document with an id of its own, and return what the script says."""

    def judged(document):
        path = tmp_path / "c.json"
        path.write_text(json.dumps({**document, "id": content_id(document)}))
        return run(path)

    return judged


def test_it_is_short_and_imports_nothing_of_ours():
    text = SCRIPT.read_text()
    assert len(text.splitlines()) <= 125
    imported = {
        (item.module if isinstance(item, ast.ImportFrom) else item.names[0].name)
        for item in ast.walk(ast.parse(text))
        if isinstance(item, ast.Import | ast.ImportFrom)
    }
    assert imported <= sys.stdlib_module_names


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.name)
def test_what_ships_holds(path):
    statements = json.loads(path.read_text())["statements"]
    known = [
        item["kind"] == "no-common-quadratic"
        or (item["kind"] == "graph" and len(item["nodes"]) == 1 and "multipliers" not in item)
        for item in statements
    ]
    known = [
        checked and "stays" not in item for checked, item in zip(known, statements, strict=True)
    ]
    done = run(path)
    assert done.returncode == (0 if all(known) else 3), done.stderr
    words = ["holds" if checked else "not checked here" for checked in known]
    said = [f"{item['kind']}: {w}" for item, w in zip(statements, words, strict=True)]
    assert done.stdout.splitlines() == said


@pytest.mark.parametrize("name", [QUADRATIC, POLYNOMIAL])
def test_what_is_altered_is_noticed(tmp_path, name):
    document = shipped(name)
    for path, value in ((("modes",), document["modes"][1:]), (("verdict",), "refuted")):
        changed = {**document, path[0]: value}
        (tmp_path / "c.json").write_text(json.dumps(changed))
        done = run(tmp_path / "c.json")
        assert done.returncode == 1
        assert "altered" in done.stderr


def test_a_function_for_kept_contact_is_not_enough_where_its_loss_must_be_covered(judge):
    document = shipped(QUADRATIC)
    for required, code in ((True, 3), (False, 0)):
        contact = {"free": [], "pulls": [], "required": required}
        assert judge({**document, "contact": contact}).returncode == code


def test_a_function_for_one_axis_is_not_enough_where_others_act_on_it(judge):
    assert judge({**shipped(QUADRATIC), "couplings": []}).returncode == 3


def first(document):
    return document["statements"][0]


def flip_sign(document):
    Q = first(document)["nodes"][0]["form"]
    Q[0][0] = -Q[0][0]


def break_symmetry(document):
    first(document)["nodes"][0]["form"][0][1] += 1


def claim_more(document):
    first(document)["rate"] = str(1000 * Fraction(first(document)["rate"]))


def claim_nothing(document):
    first(document)["rate"] = "0"


def reverse_time(document):
    for row in document["modes"][0]["numerators"]:
        row[:] = [-entry for entry in row]


def name_twice(document):
    document["modes"][1]["name"] = document["modes"][0]["name"]


def turn_denominator(document):
    for mode in document["modes"]:
        mode["denominator"] = -mode["denominator"]
        mode["numerators"] = [[-entry for entry in row] for row in mode["numerators"]]


def make_oblong(document):
    document["modes"][0]["numerators"].pop()


def drop_all_modes(document):
    document["modes"] = []


def widen_mode(document):
    for row in document["modes"][0]["numerators"]:
        row.append(0)


def call_it_discrete(document):
    document["time"] = "discrete"


def refute(document):
    document["verdict"] = "refuted"


def leave_out_the_proof(document):
    document["statements"] = [s for s in document["statements"] if s["kind"].startswith("no-")]


def spoil_vanishing(document):
    first(document)["vanishing"][0][0][0] += 1


def fill_vanishing(document):
    """Definite whatever the modes do, were it not for the check that it vanishes."""
    huge = 10**40
    for N in first(document)["vanishing"]:
        for i, row in enumerate(N):
            row[i] += huge


def drop_vanishing(document):
    first(document)["vanishing"].pop()


def drop_mode(document):
    document["modes"].pop()


def change_degree(document):
    first(document)["degree"] += 1


def spoil_factor(document):
    for _, L in document["statements"][1]["factors"]:
        L[0] = [0] * len(L[0])


EVERYWHERE = (
    flip_sign,
    break_symmetry,
    claim_more,
    claim_nothing,
    reverse_time,
    name_twice,
    turn_denominator,
    make_oblong,
    widen_mode,
    drop_all_modes,
    call_it_discrete,
    refute,
    leave_out_the_proof,
)
IN_POLYNOMIALS = (
    spoil_vanishing,
    fill_vanishing,
    drop_vanishing,
    drop_mode,
    change_degree,
    spoil_factor,
)


@pytest.mark.parametrize(
    ("name", "change"),
    [
        *((name, change) for name in (QUADRATIC, POLYNOMIAL) for change in EVERYWHERE),
        *((POLYNOMIAL, change) for change in IN_POLYNOMIALS),
    ],
    ids=lambda value: getattr(value, "__name__", value),
)
def test_forgeries_do_not_hold(judge, name, change):
    document = shipped(name)
    forged = copy.deepcopy(document)
    change(forged)
    assert forged != document
    done = judge(forged)
    assert done.returncode == 1, done.stdout
    # Nor do they here.
    assert prove({**forged, "id": content_id(forged)}).fault is not None


def test_rules_of_switching_are_not_taken_for_none(judge):
    document = shipped(QUADRATIC)
    document["switching"] = {"resets": []}
    done = judge(document)
    assert done.returncode == 3
    assert "not checked here" in done.stdout


@pytest.mark.parametrize("rate", ["9/10", "1/2", "1/3"])
def test_discrete_time(judge, rate):
    """``x+ = x / 2`` with ``V = x^4``: every rho above 1/2 is proved, and no other."""
    document = shipped(POLYNOMIAL)
    statement = {
        "kind": "graph",
        "degree": 2,
        "nodes": [{"place": "modes", "form": [[1]]}],
        "denominator_log2": 0,
        "vanishing": [[[0]]],
        "rate": rate,
    }
    document |= {
        "time": "discrete",
        "states": ["x"],
        "modes": [{"name": "half", "numerators": [[1]], "denominator": 2}],
        "statements": [statement],
    }
    assert judge(document).returncode == (0 if Fraction(rate) > Fraction(1, 2) else 1)
