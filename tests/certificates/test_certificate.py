import json
from dataclasses import replace
from fractions import Fraction

import pytest

from nrs_design.certificates.certificate import (
    SCHEMA,
    CommonQuadraticStatus,
    Verdict,
    common_quadratic_of,
    content_id,
    deciding,
    dump,
    to_document,
    verdict_of,
)
from nrs_design.pipeline.runs import run_certification
from nrs_design.proof.evidence import BlockTriangular, GrowingSequence, NoCommonQuadratic
from nrs_design.proof.evidence.growing_sequence import staying
from nrs_design.proof.switching import Reset, Switching
from nrs_design.spec import read_spec
from tests.proof.graphs import common_quadratic, mode_quadratic
from tests.support import COMMUTING, PRINT_ERROR, ROOT, family, matrix
from tests.tables import rows

Q = ((1, 0), (0, 1))
EXAMPLES = ROOT / "specs" / "examples"
OBSTRUCTION = "no-common-quadratic"
POLYNOMIAL = ["graph", OBSTRUCTION]
PROOF = common_quadratic(Q, 0, Fraction(1, 2))
IMPOSSIBLE = NoCommonQuadratic((("m0", ((1,), (0,))),))
UNSTABLE = staying("m0")
PERIOD = GrowingSequence((("m0", Fraction(1)), ("m1", Fraction(1))), 3)
PER_MODE = mode_quadratic((("m0", Q), ("m1", Q)), 0, Fraction(1, 2))
NAMED = {
    "proof": PROOF,
    "impossible": IMPOSSIBLE,
    "unstable": UNSTABLE,
    "period": PERIOD,
    "per mode": PER_MODE,
}


def statement(said):
    """Return a named statement, or one of a system of two blocks."""
    if isinstance(said, str):
        return NAMED[said]
    return BlockTriangular(((0,), (1,)), tuple((block, NAMED[name]) for block, name in said))


@pytest.mark.parametrize(
    ("statements", "verdict", "status"), rows(__file__, "test_what_statements_say_together")
)
def test_what_statements_say_together(statements, verdict, status):
    system = family([[-1, 0], [0, -1]], [[-2, 0], [0, -2]])
    statements = tuple(map(statement, statements))
    assert verdict_of(system, statements) is Verdict(verdict)
    assert common_quadratic_of(system, statements) is CommonQuadraticStatus(status)
    decisive = deciding(system, statements)
    assert (decisive is None) == (verdict == "inconclusive")
    assert decisive is None or decisive in statements


def test_growth_through_resets_says_nothing_about_quadratic_functions():
    """Both modes may share a function that only the resets raise."""
    doubling = Reset("m0", "m1", matrix([[2, 0], [0, 2]]))
    system = family([[-1, 0], [0, -1]], [[-2, 0], [0, -2]])
    system = replace(system, switching=Switching(resets=(doubling,)))
    assert common_quadratic_of(system, (PERIOD,)) is CommonQuadraticStatus.UNKNOWN
    assert common_quadratic_of(system, (UNSTABLE,)) is CommonQuadraticStatus.IMPOSSIBLE


@pytest.mark.parametrize(
    ("path", "verdict", "kinds"),
    [
        (COMMUTING, "proved", ["graph"]),
        (PRINT_ERROR, "refuted", ["growing-sequence"]),
        (EXAMPLES / "dayawansa-martin-6.nrs.yaml", "proved", POLYNOMIAL),
        (EXAMPLES / "geromel-colaneri.nrs.yaml", "proved", ["graph", OBSTRUCTION]),
    ],
)
def test_file_and_id(path, verdict, kinds):
    certificate = run_certification(read_spec(path)).certificate
    document = json.loads(dump(certificate))
    assert document["schema"] == SCHEMA == "nrs-design/certificate/9"
    assert [item["kind"] for item in document["statements"]] == kinds
    assert certificate.evidence is certificate.statements[0]
    assert document["verdict"] == certificate.verdict == verdict
    assert document["id"] == certificate.id == content_id(document)
    assert {k: v for k, v in document.items() if k != "id"} == to_document(certificate)
    assert dump(certificate).isascii()
    assert "e+" not in dump(certificate)
    assert not any(isinstance(value, float) for value in json.loads(dump(certificate)).values())


def test_id_ignores_order_and_itself_only():
    document = {"a": 1, "b": [2, 3]}
    assert content_id({"b": [2, 3], "a": 1, "id": "x"}) == content_id(document)
    for other in (
        {"a": 1},
        {"a": 1, "b": [3, 2]},
        {"a": "1", "b": [2, 3]},
        {"a": True, "b": [2, 3]},
    ):
        assert content_id(other) != content_id(document)


def test_certification_is_reproducible():
    first, second = (dump(run_certification(read_spec(COMMUTING)).certificate) for _ in range(2))
    assert first == second
