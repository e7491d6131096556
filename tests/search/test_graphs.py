"""Graphs that searches draw: what they decide, and where they apply."""

from dataclasses import replace
from itertools import pairwise
from math import log

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.certificates.certificate import Verdict
from nrs_design.proof.contact import Contact
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.switching import Switching
from nrs_design.search import forms, graphs
from nrs_design.search import graphs as module
from nrs_design.search.certify import Limits, certify
from nrs_design.search.family import Family
from nrs_design.search.ladder import applicable_methods
from nrs_design.search.method import Method
from nrs_design.search.polynomial import PER_CHECK, conewise_cost, family_cost, functions_cost
from nrs_design.search.work import Allowance, NotAffordableError
from tests.proof import systems
from tests.proof.graphs import shape_of
from tests.search.support import found, outcome, thesis_robot
from tests.search.test_stays import A, B, timed
from tests.tables import by_rows, entry

BOTH = ("2.15", "1.04")
slow = pytest.mark.slow


@pytest.mark.parametrize(
    ("k", "Mt", "delay"),
    [
        ("42.5", "0.01", 2),
        ("53.1", "0", 2),
        pytest.param("36.1", "0.01", 5, marks=slow),
        pytest.param("44.3", "0", 5, marks=slow),
    ],
)
def test_a_stiffness_that_moves_far_is_proved_while_contact_is_lost(k, Mt, delay):
    """Where no single function is found: the largest k that was proved in kept contact."""
    sampling = f"{{period: 2 ms, delay: {delay}}}"
    system = thesis_robot(("20", k), BOTH, Mt, sampling=sampling, contact="losable")
    assert found(module.search_together, system, optimize_rate=False) is None
    result = certify(system, limits=Limits(optimize_rate=False))
    assert result.verdict is Verdict.PROVED
    assert shape_of(result.evidence) == "conewise-mode-quadratic"
    forms = [form for place, form in result.evidence.nodes if place == "modes"]
    # Both ends of an enclosed number share theirs.
    assert (len(forms), len(set(forms))) == (8, 4)


@pytest.mark.parametrize(
    ("search", "system"),
    [
        (module.search_conewise_modes, systems.bouncing_in_steps()),
        (module.search_periodic_quadratic, systems.bouncing_in_turns(0, rounded=True)),
        (module.search_periodic_quadratic, systems.bouncing_in_turns(1, rounded=True)),
    ],
)
def test_the_rate_is_raised(search, system):
    rates = [found(search, system, optimize_rate=wanted).rate for wanted in (True, False)]
    assert rates[0] < rates[1] < 1


def test_where_they_apply():
    turns, steps = {Method.PERIODIC_QUADRATIC}, {Method.CONEWISE_MODE_QUADRATIC}
    flows = {Method.CONEWISE_POLYNOMIAL}
    assert applicable_methods(systems.bouncing_in_turns()) == turns | {Method.PERIOD}
    assert outcome(module.search_periodic_quadratic, systems.bouncing_in_steps())[0] is None
    for system, methods in (
        (systems.bouncing_in_steps(), steps),
        (systems.bouncing(), flows),
        (systems.bouncing(1), set()),
        (systems.dayawansa_martin(5), set()),
    ):
        assert applicable_methods(system) & (turns | steps | flows) == methods


def test_five_samples_of_delay_are_not_found():
    """One mode is unstable by itself."""
    system = thesis_robot(("41.5", "44.2"), BOTH, "0.01", sampling="{period: 2 ms, delay: 5}")
    with pytest.raises(np.linalg.LinAlgError, match="not stable"):
        outcome(module.search_conewise_modes, system, optimize_rate=False)


def test_the_rate_of_one_state_is_nearly_the_best():
    """2 (3/4)^4 = 0.6328 in five steps: 0.91256 a step."""
    evidence = found(module.search_periodic_quadratic, systems.doubled_in_turns(5))
    assert shape_of(evidence) == "periodic-quadratic"
    best = (2 * 0.75**4) ** (1 / 5)
    assert best < evidence.rate < best + 0.005


def test_what_grows_is_not_found():
    evidence, words = outcome(module.search_periodic_quadratic, systems.doubled_in_turns(3))
    assert evidence is None
    assert "no solution" in words


def test_too_many_conditions_leave_roundings_out(monkeypatch):
    system = systems.bouncing_in_turns(rounded=True)
    assert found(module.search_periodic_quadratic, system).covers_rounding
    monkeypatch.setattr(graphs, "MOST_ROUNDED", 1)
    assert not found(module.search_periodic_quadratic, system).covers_rounding


def test_roundings_that_leave_no_room_are_left_out():
    sampling = "{period: 2 ms, outer_period: 4 ms, delay: 0}"
    system = thesis_robot(("41.5", "44.2"), BOTH, "0.01", sampling=sampling)
    assert certify(system).evidence.covers_rounding


def test_numbers_beyond_floating_point():
    assert certify(systems.doubled_in_turns(4, 10**400)).verdict is Verdict.INCONCLUSIVE


def test_a_stable_mode_of_one_stay_need_not_decrease_on_the_way():
    """The period shrinks to 0.934; in the form of a, the flow of a rises for a while."""
    a, b = (np.array(rows, float) for rows in (A, B))
    radius = np.abs(np.linalg.eigvals(expm(b * 1.1) @ expm(a * 1.7))).max()
    assert radius == pytest.approx(0.934, abs=1e-3)
    found = certify(timed(("0", "0")), limits=Limits(optimize_rate=False))
    assert found.verdict == "proved"
    assert found.evidence.stays.leaving == ("a", "b")


@pytest.mark.parametrize(
    "system",
    [
        systems.geromel_colaneri("2.752"),
        systems.ando_shih("0.99"),
        systems.rectangular(),
        systems.slow_switching_in_steps(),
    ],
)
def test_what_is_found_passes_the_exact_check(system):
    assert found(module.search_modes, system).find_fault(system) is None


@pytest.mark.parametrize(
    "system", [systems.geromel_colaneri("2.74"), systems.shears(), systems.ando_shih("1.001")]
)
def test_nothing_is_found_where_there_is_nothing(system):
    assert found(module.search_modes, system) is None


def test_no_ends_of_constant_parameters():
    system = systems.shears(Switching(transitions=(), fixed_ends=(("m0", "m1"),)))
    assert found(module.search_modes, system) is None


def test_a_solver_that_is_content_with_every_rate_raises_none(monkeypatch):
    """It gives the functions for no decay at every rate: what is proved is what these show."""
    true, kept = forms.FormsProgram.solve_for, []

    def content(*arguments, **options):
        kept.append(kept[0] if kept else true(*arguments, **options))
        return kept[0]

    system = systems.geromel_colaneri("2.76")
    honest = found(module.search_modes, system)
    monkeypatch.setattr(forms.FormsProgram, "solve_for", content)
    claimed = [c.evidence.rate for c in module.search_modes(Family.of(system))]
    assert max(claimed) > 100 * honest.rate
    evidence = found(module.search_modes, system)
    assert 0 < evidence.rate <= honest.rate


def test_fast_ones_are_proposed_first():
    rates = [c.evidence.rate for c in module.search_modes(Family.of(systems.ando_shih("0.99")))]
    assert len(set(rates)) > 1
    assert rates == sorted(rates)


def test_exact_checks_are_part_of_the_work_that_is_predicted():
    """12 modes that may follow each other in any order: 156 forms, each checked twice."""
    modes = [[[f"{k}/100", "1/2"], [0, "1/3"]] for k in range(12)]
    system = systems.family(*modes, time=Time.DISCRETE)
    solution, _ = functions_cost(system, 1)
    allowance = Allowance(solution.work + 0.01)
    with pytest.raises(NotAffordableError, match="with the exact check of what it finds"):
        next(module.search_modes(Family.of(system, allowance)))
    checks = 2 * 156 * 4 * PER_CHECK
    enough = Allowance(2 * solution.work + checks + 60.0)
    assert next(module.search_modes(Family.of(system, enough))).evidence


SOFT, STIFF = ("41.5", "44.2"), ("43", "62")
INSERTION = ("2.15",)


@pytest.mark.parametrize(
    "system", [systems.bouncing(), systems.bouncing(1), systems.bouncing_in_steps()]
)
@pytest.mark.parametrize("optimize_rate", [False, True])
def test_a_bouncing_mass(system, optimize_rate):
    assert (
        shape_of(found(module.search_together, system, optimize_rate=optimize_rate))
        == "conewise-quadratic"
    )


def test_free_motion_that_does_not_slow_down_is_not_found():
    free = Mode("free", systems.matrix([[0, 0], [1, 0]]))
    system = systems.bouncing()
    sliding = replace(system, assumptions=(), contact=Contact((free,)))
    evidence, why = outcome(module.search_together, sliding)
    assert evidence is None
    assert why


@by_rows("k", "Bt", "Mt", "rate")
def test_rates_in_continuous_time(k, Bt, Mt, rate):
    system = thesis_robot(k, Bt, Mt)
    evidence = found(module.search_together, system)
    assert shape_of(evidence) == "conewise-quadratic"
    assert float(evidence.rate) > 0.98 * rate


def test_stiffer_tissue_has_no_quadratic_function():
    assert (
        found(module.search_together, thesis_robot(STIFF, BOTH, "0.01"), optimize_rate=False)
        is None
    )


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
LEAST = entry(__file__, "least")


@slow
@pytest.mark.parametrize(("Mt", "Bt", "delay", "tolerance"), LEAST)
def test_the_least_damping_of_withdrawal(Mt, Bt, delay, tolerance):
    sampling = f"{{period: 2 ms, delay: {delay}}}"
    system = thesis_robot(SOFT, ("2.15", Bt), Mt, tolerance, sampling=sampling)
    evidence = found(module.search_together, system, optimize_rate=False)
    assert shape_of(evidence) == "conewise-quadratic"
    assert evidence.covers_rounding


@slow
def test_the_least_damping_that_takes_one_function_for_each_mode():
    system = thesis_robot(SOFT, ("2.15", "0.94"), "0.005", sampling="{period: 2 ms, delay: [0, 2]}")
    assert found(module.search_together, system, optimize_rate=False) is None
    result = certify(system, limits=Limits(optimize_rate=False))
    assert shape_of(result.evidence) == "conewise-mode-quadratic"


@pytest.mark.parametrize(("k", "Bt", "Mt", "delay", "tolerance", "rate"), SAMPLED)
def test_rates_of_the_sampled_loop(k, Bt, Mt, delay, tolerance, rate):
    sampling = f"{{period: 2 ms, delay: {delay}}}"
    system = thesis_robot(k, Bt, Mt, tolerance, sampling=sampling)
    evidence = found(module.search_together, system, optimize_rate=rate is not None)
    assert shape_of(evidence) == "conewise-quadratic"
    assert rate is None or -log(float(evidence.rate)) / 0.002 > 0.98 * rate


@slow
def test_too_much_at_once_is_not_found():
    """Both controllers with up to two samples of delay and a tolerance of 2 %."""
    system = thesis_robot(SOFT, BOTH, "0.01", "0.02", sampling="{period: 2 ms, delay: [0, 2]}")
    assert found(module.search_together, system, optimize_rate=False) is None


def test_five_samples_of_delay_are_refuted():
    system = thesis_robot(SOFT, BOTH, "0.01", sampling="{period: 2 ms, delay: 5}")
    result = certify(system, limits=Limits(optimize_rate=False))
    assert result.verdict is Verdict.REFUTED
    assert result.evidence.names_unstable_mode
    assert result.evidence.steps[0][0].startswith("c1/")


STIFF_LOOP = thesis_robot(("43", "62"), BOTH, "0.01")


@pytest.mark.slow
@by_rows("k", "Mt", "degree", "rate")
def test_rates_while_contact_is_lost(k, Mt, degree, rate):
    """Where no quadratic function is found; neither is one of a lower degree."""
    system = thesis_robot(k, BOTH, Mt)
    evidence = found(module.search_conewise_polynomial, system, degree=degree // 2)
    assert shape_of(evidence) == "conewise-polynomial"
    assert float(evidence.rate) > 0.98 * rate
    if degree > 4:
        lower = found(module.search_conewise_polynomial, system, degree=2, optimize_rate=False)
        assert lower is None


@pytest.mark.slow
def test_it_is_tried_before_contact_is_taken_for_granted():
    result = certify(STIFF_LOOP)
    assert result.verdict is Verdict.PROVED
    assert result.method == "conewise polynomial of degree 4"
    assert "contact lost and made again" in result.statements[0].claim(STIFF_LOOP)


def test_where_it_applies():
    for system in (systems.bouncing_in_steps(), systems.bouncing(1), systems.dayawansa_martin(6)):
        assert Method.CONEWISE_POLYNOMIAL not in applicable_methods(system)
    assert Method.CONEWISE_POLYNOMIAL in applicable_methods(systems.bouncing())


def test_predictions_grow_with_degree_and_exceed_those_without_flight():
    costs = [conewise_cost(STIFF_LOOP, d)[0] for d in range(2, 6)]
    assert all(a.work < b.work and a.memory < b.memory for a, b in pairwise(costs))
    assert costs[0].work > family_cost(STIFF_LOOP, 2)[0].work
