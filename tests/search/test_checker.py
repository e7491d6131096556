"""A check is made once for each piece of evidence, and never for what only looks like it."""

from dataclasses import replace
from fractions import Fraction

import pytest
from nrs_design.search.checker import Checker

from nrs_design.errors import InternalError
from nrs_design.proof.evidence import CommonQuadratic
from nrs_design.search import certify as certify_module
from nrs_design.search.certify import Limits, Method, certify
from tests.proof.systems import family

SYSTEM = family([[-1, 1], [-1, -2]], [[-2, 1], [-1, -1]])
GOOD = CommonQuadratic(((1, 0), (0, 1)), 0, Fraction(1, 2))
WRONG = replace(GOOD, rate=Fraction(2))


def test_what_holds_is_checked_once(monkeypatch):
    calls = []
    find_unfit = CommonQuadratic.find_unfit
    monkeypatch.setattr(
        CommonQuadratic, "find_unfit", lambda self, s: calls.append(s) or find_unfit(self, s)
    )
    checker = Checker(SYSTEM)
    assert [checker.find_fault(GOOD), checker.find_fault(GOOD)] == [None, None]
    assert calls == [SYSTEM]
    # Equal evidence is another piece, and another system has another checker.
    assert checker.find_fault(replace(GOOD)) is None
    assert len(calls) == 2


def test_what_fails_never_passes():
    checker = Checker(SYSTEM)
    assert checker.find_fault(GOOD) is None
    assert checker.find_fault(WRONG)
    assert checker.find_fault(WRONG)
    assert Checker(family([[1, 0], [0, 1]])).find_fault(GOOD)


@pytest.mark.parametrize("lie", [WRONG, replace(GOOD, Q=((1, 0), (0, -1)))])
def test_a_rung_that_does_not_check_is_found_out(monkeypatch, lie):
    monkeypatch.setattr(
        certify_module, "search_by_lmi", lambda found, *, optimize_rate: (lie, "trust me")
    )
    with pytest.raises(InternalError, match="does not hold"):
        certify(SYSTEM, Method.LMI, Limits(optimize_rate=False))


def test_neither_does_a_rung_for_merged_modes(monkeypatch):
    monkeypatch.setattr(
        certify_module, "search_by_lmi", lambda found, *, optimize_rate: (WRONG, "trust me")
    )
    twice = family([[-1, 0], [0, -2]], [[-1, 0], [0, -2]], [[-2, 1], [1, -1]])
    with pytest.raises(InternalError, match="does not hold"):
        certify(twice, Method.LMI, Limits(optimize_rate=False))
