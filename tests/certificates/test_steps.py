import numpy as np
import pytest

from nrs_design.certificates import steps
from nrs_design.certificates.steps import (
    Family,
    examine_every_mode,
    examine_suspicious_modes,
    floats_in_silence,
    search_by_gradient,
    search_by_lmi,
)
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


def test_candidate_that_no_rounding_saves(monkeypatch):
    monkeypatch.setattr(steps, "round_to_evidence", lambda *arguments: None)
    evidence, outcome = search_by_lmi(Family.of(GOOD), optimize_rate=True)
    assert evidence is None
    assert "no rounding" in outcome


def test_beyond_floating_point():
    with floats_in_silence():
        family_ = Family.of(family([[-(10**400), 0], [0, -1]]))
        assert search_by_lmi(family_, optimize_rate=True) == (None, steps.OUT_OF_RANGE)
        assert search_by_gradient(family_) == (None, steps.OUT_OF_RANGE)
        assert examine_suspicious_modes(family_)[0] is None


def test_warnings_are_silent_only_inside():
    with floats_in_silence():
        assert np.isinf(np.float64(1e308) * 10)
    with pytest.warns(RuntimeWarning):
        np.float64(1e308) * np.float64(10)
