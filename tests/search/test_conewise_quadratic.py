"""Search for functions for contact and free motion: known answers for the robot of the thesis.

The rates were found by an independent program, and proved in exact arithmetic there; so they are
what a good search reaches at least, to two percent.
"""

from dataclasses import replace
from math import log

import pytest

from nrs_design.certificates.certificate import Verdict
from nrs_design.proof.contact import Contact
from nrs_design.proof.mode import Mode
from nrs_design.search.certify import Limits, certify
from nrs_design.search.graphs import search_together
from tests.proof.graphs import shape_of
from tests.proof.systems import bouncing, bouncing_in_steps, matrix
from tests.search.support import found, outcome, thesis_robot

SOFT, STIFF = ("41.5", "44.2"), ("43", "62")
BOTH, INSERTION = ("2.15", "1.04"), ("2.15",)
slow = pytest.mark.slow


@pytest.mark.parametrize("system", [bouncing(), bouncing(1), bouncing_in_steps()])
@pytest.mark.parametrize("optimize_rate", [False, True])
def test_a_bouncing_mass(system, optimize_rate):
    assert (
        shape_of(found(search_together, system, optimize_rate=optimize_rate))
        == "conewise-quadratic"
    )


def test_free_motion_that_does_not_slow_down_is_not_found():
    free = Mode("free", matrix([[0, 0], [1, 0]]))
    system = bouncing()
    sliding = replace(system, assumptions=(), contact=Contact((free,)))
    evidence, why = outcome(search_together, sliding)
    assert evidence is None
    assert why


@pytest.mark.parametrize(
    ("k", "Bt", "Mt", "rate"),
    [
        (SOFT, BOTH, "0.01", 3.92),
        (SOFT, INSERTION, "0.01", 14.1),
        (SOFT, ("1.04",), "0.01", 4.92),
        (SOFT, BOTH, "0", 7.61),
    ],
)
def test_rates_in_continuous_time(k, Bt, Mt, rate):
    system = thesis_robot(k, Bt, Mt)
    evidence = found(search_together, system)
    assert shape_of(evidence) == "conewise-quadratic"
    assert float(evidence.rate) > 0.98 * rate


def test_stiffer_tissue_has_no_quadratic_function():
    assert found(search_together, thesis_robot(STIFF, BOTH, "0.01"), optimize_rate=False) is None


SAMPLED = [
    (SOFT, BOTH, "0.01", "0", "0", 2.35),
    (SOFT, BOTH, "0.01", "1", "0", 1.3),
    (SOFT, BOTH, "0.01", "2", "0", 0.5),
    pytest.param(SOFT, BOTH, "0.01", "[0, 1]", "0", 1.29, marks=slow),
    pytest.param(SOFT, BOTH, "0.01", "[0, 1]", "0.02", 0.94, marks=slow),
    pytest.param(SOFT, INSERTION, "0.01", "[0, 2]", "0.05", 9.46, marks=slow),
    pytest.param(STIFF, INSERTION, "0.01", "[0, 2]", "0.05", 4.0, marks=slow),
    pytest.param(STIFF, ("2.15", "1.8"), "0.01", "[0, 2]", "0", None, marks=slow),
    pytest.param(STIFF, ("2.15", "1.5"), "0", "[0, 2]", "0", None, marks=slow),
]
# The least damping of withdrawal that is proved beside insertion, for a delay and a tolerance.
LEAST = [
    ("0.01", "0.95", "[0, 1]", "0"),
    ("0.01", "1.045", "[0, 2]", "0.02"),
    ("0.01", "1.225", "[0, 5]", "0"),
    ("0.005", "0.97", "[0, 2]", "0.02"),
    ("0", "0.74", "[0, 1]", "0"),
    ("0", "0.83", "[0, 2]", "0.02"),
    ("0", "1.02", "[0, 5]", "0"),
]


@slow
@pytest.mark.parametrize(("Mt", "Bt", "delay", "tolerance"), LEAST)
def test_the_least_damping_of_withdrawal(Mt, Bt, delay, tolerance):
    sampling = f"{{period: 2 ms, delay: {delay}}}"
    system = thesis_robot(SOFT, ("2.15", Bt), Mt, tolerance, sampling=sampling)
    evidence = found(search_together, system, optimize_rate=False)
    assert shape_of(evidence) == "conewise-quadratic"
    assert evidence.covers_rounding


@slow
def test_the_least_damping_that_takes_one_function_for_each_mode():
    system = thesis_robot(SOFT, ("2.15", "0.94"), "0.005", sampling="{period: 2 ms, delay: [0, 2]}")
    assert found(search_together, system, optimize_rate=False) is None
    result = certify(system, limits=Limits(optimize_rate=False))
    assert shape_of(result.evidence) == "conewise-mode-quadratic"


@pytest.mark.parametrize(("k", "Bt", "Mt", "delay", "tolerance", "rate"), SAMPLED)
def test_rates_of_the_sampled_loop(k, Bt, Mt, delay, tolerance, rate):
    sampling = f"{{period: 2 ms, delay: {delay}}}"
    system = thesis_robot(k, Bt, Mt, tolerance, sampling=sampling)
    evidence = found(search_together, system, optimize_rate=rate is not None)
    assert shape_of(evidence) == "conewise-quadratic"
    assert rate is None or -log(float(evidence.rate)) / 0.002 > 0.98 * rate


@slow
def test_too_much_at_once_is_not_found():
    """Both controllers with up to two samples of delay and a tolerance of 2 %."""
    system = thesis_robot(SOFT, BOTH, "0.01", "0.02", sampling="{period: 2 ms, delay: [0, 2]}")
    assert found(search_together, system, optimize_rate=False) is None


def test_five_samples_of_delay_are_refuted():
    system = thesis_robot(SOFT, BOTH, "0.01", sampling="{period: 2 ms, delay: 5}")
    result = certify(system, limits=Limits(optimize_rate=False))
    assert result.verdict is Verdict.REFUTED
    assert result.evidence.names_unstable_mode
    assert result.evidence.steps[0][0].startswith("c1/")
