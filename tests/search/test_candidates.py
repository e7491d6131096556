"""What searches yield, what the exact check takes of it, and what they say."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.proof.switching import Stay, Switching
from nrs_design.search.acceptance import NO_MARGIN, OUT_OF_RANGE
from nrs_design.search.drawing import Solution
from nrs_design.search.family import Family, floats_in_silence
from nrs_design.search.forms import FormsProgram
from nrs_design.search.gradient import search_by_gradient
from nrs_design.search.graphs import decide_one_state, search_by_lmi, search_polynomial
from nrs_design.search.obstruction import search_obstruction
from nrs_design.search.period import search_period
from nrs_design.search.unstable_mode import examine_every_mode, examine_suspicious_modes
from nrs_design.search.unstable_value import search_mixture
from nrs_design.search.work import Allowance, NotAffordableError
from tests.search.support import outcome
from tests.support import dayawansa_martin, family, holds

GOOD = dayawansa_martin(5)
ROTATION = [[0, 1], [-1, 0]]


def test_suspicious_modes_are_examined_exactly():
    singular = [["-0.36", "-0.48"], ["-0.48", "-0.64"]]
    evidence, words = outcome(examine_suspicious_modes, family([[-1, 0], [0, -1]], singular))
    assert evidence.steps[0][0] == "m1"
    assert words == "mode m1 is not stable"
    assert outcome(examine_suspicious_modes, GOOD) == (None, "none")


def test_a_suspicious_mode_can_be_innocent():
    barely = family([["-1e-12", 1], [-1, "-1e-12"]])
    evidence, words = outcome(examine_suspicious_modes, barely)
    assert evidence is None
    assert words == "1 modes tested exactly, all stable"


def test_every_mode_is_examined():
    assert outcome(examine_every_mode, GOOD) == (None, "2 modes tested exactly, all stable")
    assert outcome(examine_every_mode, family(ROTATION))[0].steps[0][0] == "m0"


def test_modes_that_must_be_left_are_not_called_stable():
    """The report takes the words "all stable" at the end for a statement about every mode."""
    rules = Switching(stays=(("m0", Stay(longest=Fraction(1))),))
    system = replace(family([[1]], [[-1]]), switching=rules)
    evidence, words = outcome(examine_every_mode, system)
    assert evidence is None
    assert words.startswith("1 modes tested exactly, all stable; 1 not tested")


def test_states_of_any_size_are_balanced():
    stretched = family(*([[-1, x], [y, -1]] for x, y in ((1000, 0), (500, "1/9999"))))
    for system in (GOOD, stretched):
        evidence, words = outcome(search_by_lmi, system)
        assert words == "found with the largest decay rate"
        assert holds(system, evidence)
    evidence, words = outcome(search_by_lmi, dayawansa_martin(6))
    assert (evidence, words) == (None, NO_MARGIN)


@pytest.mark.parametrize(
    ("search", "words"),
    [
        (search_obstruction, "the dual has no strict solution"),
        (search_period, "no periodic signal tried makes solutions grow"),
        (search_mixture, "every combination tried is stable"),
    ],
)
def test_nothing_is_found_against_a_stable_family(search, words):
    assert outcome(search, GOOD) == (None, words)


def test_polynomials_beyond_patience_are_not_tried():
    many = family(*[[[-int(i == j) for j in range(8)] for i in range(8)]] * 9)
    family_ = Family.of(many, Allowance(60.0))
    with pytest.raises(NotAffordableError, match="not tried: a program in 330 monomials"):
        next(search_polynomial(family_, degree=4))


def test_candidates_that_no_rounding_saves(monkeypatch):
    """What is proposed without looking at the modes is refused, and the exact check says why."""
    lie = Solution([np.diag([1.0, 100.0])], np.zeros(0), [np.zeros((1, 1))] * 2)
    monkeypatch.setattr(FormsProgram, "solve", lambda *_: lie)
    monkeypatch.setattr(FormsProgram, "own_rate", lambda *_: 0.5)
    evidence, words = outcome(search_by_lmi, GOOD)
    assert evidence is None
    assert words.startswith("a candidate was found, but V does not decrease")


def test_one_state_is_decided_without_floating_point():
    evidence, words = outcome(decide_one_state, family([[Fraction(-1, 10**400)]], [[-1]]))
    assert words == "found"
    assert 0 < evidence.rate < Fraction(1, 10**400)


def test_beyond_floating_point():
    beyond = family([[-(10**400), 0], [0, -1]])
    for search in (search_by_lmi, search_by_gradient):
        assert outcome(search, beyond) == (None, OUT_OF_RANGE)
    assert outcome(examine_suspicious_modes, beyond)[0] is None


def test_warnings_are_silent_only_inside():
    with floats_in_silence():
        assert np.isinf(np.float64(1e308) * 10)
    with pytest.warns(RuntimeWarning):
        np.float64(1e308) * np.float64(10)
