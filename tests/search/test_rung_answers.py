"""What the rungs find and what they say."""

from dataclasses import replace
from fractions import Fraction
from functools import partial

import numpy as np
import pytest
from nrs_design.search.checker import Checker
from nrs_design.search.rungs import (
    examine_every_mode,
    examine_suspicious_modes,
    prove_obstruction,
    search_by_gradient,
    search_by_lmi,
    search_mixture,
    search_mode_quadratic,
    search_parameter_quadratic,
    search_period,
    search_polynomial,
    search_preconditioned,
    search_raw,
)

from nrs_design.proof.system import Stay, Switching
from nrs_design.search import rungs
from nrs_design.search.allowance import Allowance, NotAffordableError
from nrs_design.search.family import Family, floats_in_silence
from tests.support import dayawansa_martin, family, holds

GOOD = dayawansa_martin(5)
ROTATION = [[0, 1], [-1, 0]]


def test_suspicious_modes_are_examined_exactly():
    singular = [["-0.36", "-0.48"], ["-0.48", "-0.64"]]
    evidence, outcome = examine_suspicious_modes(Family.of(family([[-1, 0], [0, -1]], singular)))
    assert evidence.mode == "m1"
    assert outcome == "mode m1 is not stable"
    assert examine_suspicious_modes(Family.of(GOOD)) == (None, "none")


def test_a_suspicious_mode_can_be_innocent():
    barely = family([["-1e-12", 1], [-1, "-1e-12"]])
    evidence, outcome = examine_suspicious_modes(Family.of(barely))
    assert evidence is None
    assert outcome == "1 modes tested exactly, all stable"


def test_every_mode_is_examined():
    assert examine_every_mode(Family.of(GOOD)) == (None, "2 modes tested exactly, all stable")
    assert examine_every_mode(Family.of(family(ROTATION)))[0].mode == "m0"


def test_modes_that_must_be_left_are_not_called_stable():
    """The report takes the words "all stable" at the end for a statement about every mode."""
    rules = Switching(stays=(("m0", Stay(longest=Fraction(1))),))
    system = replace(family([[1]], [[-1]]), switching=rules)
    evidence, outcome = examine_every_mode(Family.of(system))
    assert evidence is None
    assert outcome.startswith("1 modes tested exactly, all stable; 1 not tested")


@pytest.mark.parametrize("optimize_rate", [True, False])
def test_lmi_finds_evidence(optimize_rate):
    evidence, outcome = search_by_lmi(Family.of(GOOD), optimize_rate=optimize_rate)
    assert outcome.startswith("found")
    assert holds(GOOD, evidence)


def test_optimizing_gives_the_faster_rate():
    plain, best = (search_by_lmi(Family.of(GOOD), optimize_rate=o)[0].rate for o in (False, True))
    assert best >= plain


def test_gradient_finds_evidence():
    evidence, outcome = search_by_gradient(Family.of(GOOD))
    assert "updates" in outcome
    assert holds(GOOD, evidence)


@pytest.mark.parametrize("search", [search_raw, search_preconditioned])
def test_other_coordinates_find_evidence_too(search):
    stretched = family(*([[-1, x], [y, -1]] for x, y in ((1000, 0), (500, "1/9999"))))
    for system in (GOOD, stretched):
        evidence, outcome = search(Family.of(system))
        assert outcome == "found"
        assert holds(system, evidence)
    evidence, outcome = search(Family.of(dayawansa_martin(6)))
    assert (evidence, outcome) == (None, "the solver found no candidate with positive margins")


FIXED_ENDS = Switching(fixed_ends=(("m0", "m1"),))
SHEARS = family([[-1, 10], [0, -1]], [[-1, 0], [10, -1]])


@pytest.mark.parametrize(
    ("search", "system", "kind"),
    [
        (prove_obstruction, dayawansa_martin(6), "no-common-quadratic"),
        (partial(search_polynomial, degree=2), dayawansa_martin(6), "common-polynomial"),
        (search_period, dayawansa_martin(12), "unstable-period"),
        (search_mixture, SHEARS, "unstable-mixture"),
        (
            search_parameter_quadratic,
            replace(dayawansa_martin(12), switching=FIXED_ENDS),
            "parameter-quadratic",
        ),
        (
            search_mode_quadratic,
            replace(dayawansa_martin(12), switching=Switching(dwell_time=Fraction(10))),
            "mode-quadratic",
        ),
    ],
)
def test_every_other_rung_finds_its_kind(search, system, kind):
    evidence, _ = search(Family.of(system))
    assert evidence.kind == kind
    assert evidence.find_fault(system) is None
    assert holds(system, evidence)


@pytest.mark.parametrize(
    ("search", "words"),
    [
        (prove_obstruction, "the dual has no strict solution"),
        (search_period, "no periodic signal tried makes solutions grow"),
        (search_mixture, "every combination tried is stable"),
    ],
)
def test_nothing_is_found_against_a_stable_family(search, words):
    assert search(Family.of(GOOD)) == (None, words)


def test_polynomials_beyond_patience_are_not_tried():
    many = family(*[[[-int(i == j) for j in range(8)] for i in range(8)]] * 9)
    family_ = Family.checked_by(Checker(many), Allowance(60.0))
    with pytest.raises(NotAffordableError, match="not tried: a program in 330 monomials"):
        search_polynomial(family_, degree=4)


def test_candidate_that_no_rounding_saves(monkeypatch):
    monkeypatch.setattr(rungs, "round_to_evidence", lambda *arguments: None)
    evidence, outcome = search_by_lmi(Family.of(GOOD), optimize_rate=True)
    assert evidence is None
    assert "no rounding" in outcome


def test_beyond_floating_point():
    with floats_in_silence():
        family_ = Family.of(family([[-(10**400), 0], [0, -1]]))
        assert search_by_lmi(family_, optimize_rate=True) == (None, rungs.OUT_OF_RANGE)
        assert search_by_gradient(family_) == (None, rungs.OUT_OF_RANGE)
        assert search_raw(family_) == (None, rungs.OUT_OF_RANGE)
        assert search_preconditioned(family_) == (None, rungs.OUT_OF_RANGE)
        assert examine_suspicious_modes(family_)[0] is None


def test_warnings_are_silent_only_inside():
    with floats_in_silence():
        assert np.isinf(np.float64(1e308) * 10)
    with pytest.warns(RuntimeWarning):
        np.float64(1e308) * np.float64(10)
