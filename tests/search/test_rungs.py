"""Rungs return only what has passed the exact check, whatever the searches below them say."""

from dataclasses import replace

import numpy as np
import pytest
from nrs_design.search.checker import Checker

from nrs_design.errors import DesignError
from nrs_design.proof.evidence import UnstablePeriod
from nrs_design.proof.system import Switching
from nrs_design.search import mode_quadratic, obstruction, polynomial, rungs
from nrs_design.search.allowance import Allowance, NotAffordableError
from nrs_design.search.certify import Limits, Method, Verdict, certify
from nrs_design.search.family import Family
from nrs_design.search.gradient import GradientResult
from tests.proof.systems import branicky, dayawansa_martin, family, shears

LIES = [np.nan, np.inf, 0.0, 1.0, -1.0, 1e300]


def lying(shape, value):
    def lie(*_, **__):
        return np.full(shape, value)

    return lie


@pytest.mark.parametrize("value", LIES)
def test_a_lying_semidefinite_solver_never_decides(monkeypatch, value):
    def lie(rows, offset, sizes, equalities=0, time_limit=0.0):
        return np.full(rows.shape[1], value)

    for module in (polynomial, obstruction, mode_quadratic):
        monkeypatch.setattr(module, "maximize_margin", lie)
    for system in (dayawansa_martin(6), dayawansa_martin(5)):
        for method in (Method.POLYNOMIAL, Method.OBSTRUCTION):
            limits = Limits(max_degree=4, optimize_rate=False)
            assert certify(system, method, limits).verdict is Verdict.INCONCLUSIVE


@pytest.mark.parametrize("value", LIES)
def test_a_lying_quadratic_search_never_decides(monkeypatch, value):
    monkeypatch.setattr(rungs, "find_common_quadratic", lying((2, 2), value))
    monkeypatch.setattr(
        rungs, "iterate_gradient", lambda *_, **__: GradientResult(np.full((2, 2), value), 0)
    )
    for method in (Method.LMI, Method.GRADIENT):
        found = certify(dayawansa_martin(12), method, Limits(optimize_rate=False))
        assert found.verdict is Verdict.INCONCLUSIVE


def test_a_function_that_is_not_symmetric_never_decides(monkeypatch):
    skew = np.array([[1.0, 5.0], [-5.0, 1.0]])
    monkeypatch.setattr(rungs, "find_common_quadratic", lambda *_, **__: skew)
    found = certify(dayawansa_martin(12), Method.LMI, Limits(optimize_rate=False))
    assert found.verdict is Verdict.INCONCLUSIVE


def test_modes_on_the_border_are_tested_exactly():
    found, words = rungs.examine_suspicious_modes(Family.of(family([[0, 1], [-1, 0]])))
    assert found is not None
    assert "m0" in words
    nothing, _ = rungs.examine_every_mode(Family.of(shears()))
    assert nothing is None


def test_what_does_not_pass_the_whole_check_is_no_evidence():
    """Which of two modes of one name is meant, a certificate could not say."""
    system = family([[0, 1], [-1, 0]], [[-1, 0], [0, -1]])
    twins = replace(system, modes=tuple(replace(mode, name="twin") for mode in system.modes))
    found, words = rungs.examine_every_mode(Family.of(twins))
    assert found is None
    assert words == "mode twin is not stable, but two modes of the system have the same name"
    assert certify(twins, limits=Limits(max_degree=4)).verdict is Verdict.INCONCLUSIVE


def test_every_rung_says_how_it_ended():
    family_ = Family.of(branicky())
    for rung in (rungs.prove_obstruction, rungs.search_mixture, rungs.search_period):
        evidence, words = rung(family_)
        assert words
        assert evidence is None or evidence.find_fault(family_.system) is None
    assert isinstance(rungs.search_period(family_)[0], UnstablePeriod)


def test_a_lift_beyond_patience_is_not_tried():
    n = 12
    system = family([[-(i == j) + (i == j + 1) for j in range(n)] for i in range(n)])
    family_ = Family.checked_by(Checker(system), Allowance(60.0))
    with pytest.raises(NotAffordableError, match="not tried"):
        rungs.search_polynomial(family_, degree=4)


@pytest.mark.parametrize("method", list(Method))
def test_no_method_proves_a_constant_parameter_by_its_ends(method):
    # Halfway between the two, the shears have the eigenvalue 4.
    system = shears(Switching(transitions=(), fixed_ends=(("m0", "m1"),)))
    try:
        found = certify(system, method, Limits(max_degree=4))
    except DesignError:
        return
    assert found.verdict is not Verdict.PROVED


@pytest.mark.parametrize("exponent", [12, 100, 200, 300])
def test_enormous_entries_end_in_words(exponent):
    big = 10**exponent
    modes = [[-big, 0], [1, -1]], [[-1, 1], [0, -big]]
    for switching in (Switching(), Switching(dwell_time=branicky().switching.dwell_time + 1)):
        assert certify(family(*modes, switching=switching), limits=Limits(max_degree=4)).attempts
