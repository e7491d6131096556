"""The search for one function for all axes: what it finds, what it refuses to begin."""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.errors import DesignError
from nrs_design.search.candidates import NO_MARGIN
from nrs_design.search.certify import Limits, certify
from nrs_design.search.coupled_axes import search_coupled_axes
from nrs_design.search.family import Family
from nrs_design.search.method import Method
from nrs_design.work import Allowance, NotAffordableError
from tests.proof.graphs import shape_of
from tests.proof.systems import bouncing, family, leaning
from tests.search.support import found, outcome


def rate(system):
    evidence = found(search_coupled_axes, system)
    assert shape_of(evidence) == "coupled-axes"
    return float(evidence.rate)


@pytest.mark.slow
def test_two_equal_axes_that_are_pushed_by_their_acceleration():
    """``x' = A x + b w``, ``|w| <= c |a x|``: an H-infinity norm, which Q attains for one mode.

    ``v' = -2 v + w`` alone with ``|w| <= 2 c |v|`` decays at ``2 - 2 c``, and delta at 1.
    """
    system = family([[-2, 0], [0, -1]])
    for c in ("0", "1/4", "2/5"):
        expected = min(1, 2 - 2 * float(Fraction(c)))
        assert rate(leaning(system, c)) == pytest.approx(expected, rel=5e-3)


@pytest.mark.slow
def test_more_coupling_takes_of_the_rate():
    rates = [rate(leaning(bouncing(), share)) for share in ("0", "1/8", "1/4")]
    assert rates[0] > rates[1] > rates[2] > 0


def test_what_cannot_be_is_not_found():
    evidence, words = outcome(search_coupled_axes, leaning(bouncing(), 2))
    assert (evidence, words) == (None, NO_MARGIN)


@pytest.mark.slow
@pytest.mark.parametrize("damping", [0, 1])
def test_any_rate_is_that_of_the_function(damping):
    system = leaning(bouncing(damping), "1/8")
    evidence = found(search_coupled_axes, system, optimize_rate=False)
    best = rate(system)
    assert 0 < float(evidence.rate) <= best * 1.01


@pytest.mark.slow
def test_numbers_of_any_size():
    """Speeds in units of a millionth: columns and rows differ by the square."""
    system = leaning(family([[-2, -(10**6)], ["1/1000000", 0]]), "1/8")
    plain = leaning(family([[-2, -1], [1, 0]]), "1/8")
    assert rate(system) == pytest.approx(rate(plain), rel=1e-2)


def test_what_does_not_fit_is_not_begun():
    allowance = Allowance(1.0)
    with pytest.raises(NotAffordableError, match="loading CVXPY would take"):
        next(search_coupled_axes(Family.of(leaning(bouncing(), "1/8"), allowance)))


def test_a_solver_that_gives_up_has_found_nothing(monkeypatch):
    import cvxpy

    def fail(*arguments, **options):
        raise cvxpy.SolverError("stalled")

    monkeypatch.setattr(cvxpy.Problem, "solve", fail)
    assert outcome(search_coupled_axes, leaning(bouncing(), "1/8")) == (None, NO_MARGIN)


def test_modes_beyond_floating_point_have_no_candidate():
    huge = leaning(family([[-(10**400), 0], [0, -1]]), "1/8")
    evidence, words = outcome(search_coupled_axes, huge)
    assert evidence is None
    assert "beyond the range" in words


def test_only_rungs_that_know_of_other_axes_are_tried():
    result = certify(leaning(bouncing(), 2), limits=Limits(optimize_rate=False))
    tried = {attempt.step for attempt in result.attempts}
    assert "coupled axes" in tried
    assert not any("conewise" in step or "lmi" in step for step in tried)


@pytest.mark.slow
def test_it_can_be_asked_for_where_axes_act_on_each_other():
    system = leaning(bouncing(), "1/8")
    assert shape_of(certify(system, Method.COUPLED_AXES).evidence) == "coupled-axes"
    for other, method in ((bouncing(), Method.COUPLED_AXES), (system, Method.LMI)):
        with pytest.raises(DesignError, match="does not apply"):
            certify(other, method)


def test_equal_modes_and_blocks_are_left_as_they_are():
    """What other axes add may differ between equal modes; here the modes are diagonal, too."""
    system = leaning(family([[-2, 0], [0, -1]], [[-2, 0], [0, -1]]), "1/4")
    result = certify(system)
    assert shape_of(result.evidence) == "coupled-axes"
    assert len(result.system.modes) == 2
    assert np.isfinite(float(result.evidence.rate))
