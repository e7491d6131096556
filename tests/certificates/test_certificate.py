import json
from decimal import Decimal
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.certificates.certificate import (
    CommonQuadratic,
    UnstableMode,
    claim,
    content_id,
    dump,
    rate_text,
    to_document,
)
from nrs_design.pipeline import run_certification
from nrs_design.spec import read_spec
from nrs_design.switched.system import Time
from tests.support import COMMUTING, PRINT_ERROR, family

Q = ((1, 0), (0, 1))


@given(st.fractions(min_value=Fraction(1, 10**12), max_value=10**12))
def test_rates_are_rounded_to_the_safe_side(rate):
    slower, larger = rate_text(rate, Time.CONTINUOUS), rate_text(rate, Time.DISCRETE)
    assert Fraction(Decimal(slower)) <= rate <= Fraction(Decimal(larger))
    assert Fraction(Decimal(slower)) >= rate * (1 - Fraction(1, 10**5))
    assert Fraction(Decimal(larger)) <= rate * (1 + Fraction(1, 10**5))


@pytest.mark.parametrize(
    "rate", [Fraction(10) ** 4000, Fraction(1, 10**4000), Fraction(2, 3) ** 9000]
)
def test_rates_of_any_size_have_a_text(rate):
    assert len(rate_text(rate, Time.CONTINUOUS)) < 20


def test_claims_in_words():
    system = family([[-1, 0], [0, -1]], [[-2, 0], [0, -2]])
    evidence = CommonQuadratic(Q, 0, Fraction(2, 3))
    assert claim(system, evidence) == (
        "Every solution of x' = A x, switching arbitrarily among the 2 modes, satisfies "
        "|x(t)| <= exp(-alpha t) |x(0)| with alpha = 0.666666 1/s, in the norm "
        "|x| = sqrt(x' Q x)."
    )
    discrete = family([[0, 0], [0, 0]], time=Time.DISCRETE)
    assert "its one mode" in claim(discrete, evidence)
    assert "rho^t |x(0)| with rho = 0.666667," in claim(discrete, evidence)
    assert "not Hurwitz (eigenvalue 0 +- 1j)" in claim(system, UnstableMode("m0", "0 +- 1j"))
    assert "not Schur" in claim(discrete, UnstableMode("m0", "1"))


@pytest.mark.parametrize(("path", "verdict"), [(COMMUTING, "proved"), (PRINT_ERROR, "refuted")])
def test_file_and_id(path, verdict):
    certificate = run_certification(read_spec(path)).certificate
    document = json.loads(dump(certificate))
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
