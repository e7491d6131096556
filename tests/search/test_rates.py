"""How programs are asked for rates: a program here knows the largest feasible one."""

from dataclasses import dataclass, field, replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.proof.mode import Time
from nrs_design.search import rates as module
from nrs_design.search.acceptance import NO_MARGIN
from nrs_design.search.family import Family
from nrs_design.search.forms import FormsProgram
from nrs_design.search.graphs import draw_balanced
from nrs_design.search.work import Allowance, Cost, NotAffordableError
from tests.proof.systems import dayawansa_martin
from tests.proof.systems import family as system_of
from tests.tables import by_rows

PAIR = Family.of(dayawansa_martin(5))
# How exactly a position is found where it is not told otherwise.
FINE = 2.0**-14


def shown_up_to(threshold, further=0.0):
    """Tell of positions up to a threshold that they are feasible, and show a share of the rest."""
    return lambda s: None if s > threshold else s + further * (threshold - s)


def largest_position(allowance=None):
    """The largest position at which the pair has a common quadratic function."""
    program = FormsProgram(draw_balanced(PAIR))

    def shown(position):
        rate = module.rate_at(position, 1.0, Time.CONTINUOUS)
        found = program.solve(rate, allowance or Allowance())
        return None if found is None else position

    return module.bisect_position(shown, 0.0, FINE)


def test_positions_run_from_stability_to_the_limit():
    assert [module.rate_at(s, 4.0, Time.CONTINUOUS) for s in (0.0, 0.5, 1.0)] == [0.0, 2.0, 4.0]
    contractions = [module.rate_at(s, 0.2, Time.DISCRETE) for s in (0.0, 0.5, 1.0)]
    assert contractions == pytest.approx([1.0, 0.6, 0.2])


def test_position_of_dayawansa_martin():
    """The pair shifted by alpha is a scaled pair; the threshold falls where it must."""
    position = largest_position()
    assert position == pytest.approx(0.1056, abs=2e-4)


@pytest.mark.parametrize("further", [0.0, 0.3])
@pytest.mark.parametrize("threshold", [0.999, 0.5, 0.3, 1e-6, 2 * module.SMALLEST])
def test_position_is_bracketed_relative_to_itself(threshold, further):
    position = module.bisect_position(shown_up_to(threshold, further))
    assert threshold * (1 - 2 * module.RESOLUTION) <= position <= threshold


@pytest.mark.parametrize("threshold", [0.0, module.SMALLEST / 4])
def test_nothing_feasible_ends(threshold):
    assert module.bisect_position(shown_up_to(threshold)) == 0.0


def test_a_position_is_bracketed_to_a_difference():
    tried = []
    shown = shown_up_to(0.3)
    position = module.bisect_position(lambda s: tried.append(s) or shown(s), 0.0, 2.0**-8)
    assert 0.3 - 2.0**-8 <= position <= 0.3
    # And once above what it has found.
    assert len(tried) == 8 + 1


def test_a_solver_that_fails_below_the_largest_does_not_end_the_search():
    shown = shown_up_to(0.3)
    position = module.bisect_position(lambda s: None if s == 0.28125 else shown(s))
    assert 0.3 * (1 - 2 * module.RESOLUTION) <= position <= 0.3


@dataclass
class Known:
    """A program with solutions up to a rate, which show a share of what is left to it."""

    best: float
    further: float = 0.0
    is_flow: bool = True
    work: float = 0.0
    asked: list = field(default_factory=list)

    def solve(self, rate, allowance):
        allowance.take(Cost(self.work), "a step")
        self.asked.append(rate)
        return rate + self.further * (self.best - rate) if self.is_below(rate) else None

    def is_below(self, rate):
        return rate <= self.best if self.is_flow else rate >= self.best

    def own_rate(self, solution):
        return solution

    def roundings(self, solution, claim, digits, *, errors=False):
        yield solution, claim, errors


def proposed(program, time=Time.CONTINUOUS, rates=None, coverings=(False,), **options):
    limit = 2.0 if time is Time.CONTINUOUS else 0.5
    family = replace(Family.of(system_of([[-1]] if limit > 1 else [["1/2"]], time=time)), **options)
    return module.propose(program, family, limit, rates or module.Rates(), coverings)


@pytest.mark.parametrize("time", list(Time))
def test_solutions_come_fastest_first(time):
    """Every claim is a short rate on the safe side of what a solution shows."""
    best = module.rate_at(0.8, 2.0 if time is Time.CONTINUOUS else 0.5, time)
    found = [
        c.evidence
        for c in proposed(
            Known(best, is_flow=time is Time.CONTINUOUS), time, module.Rates(always=True)
        )
    ]
    claims = list(dict.fromkeys(claim for _, claim, _ in found))
    assert claims == sorted(claims, reverse=time is Time.CONTINUOUS)
    assert claims == [module.round_rate(claim, time) for claim in claims]
    assert len(claims) == len(module.BACK_OFFS)
    assert float(claims[0]) == pytest.approx(best, rel=1e-3)
    sign = 1 if time is Time.CONTINUOUS else -1
    assert all(sign * (solution - float(claim)) >= 0 for solution, claim, _ in found)


def test_what_a_solution_shows_is_claimed_without_another():
    program = Known(1.6, 0.5)
    solution, claim, _ = next(proposed(program)).evidence
    asked = len(program.asked)
    assert solution >= claim > max(rate for rate in program.asked if rate <= 1.6) - 1e-3
    assert asked < 15


def test_errors_are_covered_first_and_any_rate_last():
    found = [c.evidence for c in proposed(Known(1.6), coverings=(True, False))]
    covered = [errors for *_, errors in found]
    assert covered == sorted(covered, reverse=True)
    any_rate = [c.evidence for c in proposed(Known(1.6, 0.5), optimize_rate=False)]
    assert {solution for solution, *_ in any_rate} == {0.8}


def test_no_solution_is_no_margin():
    with pytest.raises(StopIteration) as end:
        next(proposed(Known(-1.0)))
    assert end.value.value == NO_MARGIN


@pytest.mark.parametrize("always", [False, True])
def test_the_search_for_the_best_rate_takes_half_of_the_work(always):
    allowance = Allowance(10.0)
    found = proposed(Known(2.0, work=1.0), rates=module.Rates(always=always), allowance=allowance)
    assert next(found).evidence[1] < 2
    assert allowance.left == pytest.approx(5.0)
    if always:
        with pytest.raises(NotAffordableError):
            list(found)
    else:
        assert list(found)


def test_a_bisection_without_work_keeps_what_it_has():
    assert largest_position(Allowance(0.0)) == 0.0
    # Enough for some of the steps of the bisection only.
    allowance = Allowance(0.03)
    some = largest_position(allowance)
    assert 0.0 < some < largest_position()

    tried = []

    def shown(position):
        tried.append(position)
        if len(tried) > 2:
            raise NotAffordableError("no time")
        return position if position < 0.6 else None

    assert module.bisect_position(shown) == 0.5


CONTINUOUS, DISCRETE = Time.CONTINUOUS, Time.DISCRETE


@pytest.mark.parametrize(("time", "limit"), [(CONTINUOUS, 3.7), (DISCRETE, 0.3)])
def test_claims_are_below_the_position_the_fastest_first(time, limit):
    proposed = list(module.claims(0.8, limit, time))
    assert len(proposed) == len(module.BACK_OFFS)
    assert proposed == sorted(proposed, reverse=time is CONTINUOUS)
    for back_off, claim in zip(module.BACK_OFFS, proposed, strict=True):
        rate = module.rate_at(0.8 * back_off, limit, time)
        assert claim == module.round_rate(rate, time)
        assert float(claim) == pytest.approx(rate, rel=1e-4)


def test_few_claims_and_few_digits_where_checks_take_long():
    assert [float(c) for c in module.claims(1.0, 1.0, CONTINUOUS, 0.9, few=True)] == pytest.approx(
        [0.9, 0.5, 0.1], rel=1e-4
    )
    assert module.digits(10)[:2] == (10, 12)
    assert module.digits() == module.BITS


@by_rows("position", "limit", "time", time=Time)
def test_what_is_no_decay_is_not_claimed(position, limit, time):
    assert list(module.claims(position, limit, time)) == []


@pytest.mark.parametrize("exponents", [(0, 3), (5, -5), (-40, 17)])
def test_scaling_is_undone_exactly(exponents):
    Q, bits = np.array([[0.75, -0.5], [-0.5, 3.0]]), 4
    rows, denominator_log2 = module.unscale(Q, np.array(exponents), bits)
    for i, row in enumerate(rows):
        for j, entry in enumerate(row):
            wanted = Fraction(Q[i, j]) / Fraction(2) ** (exponents[i] + exponents[j])
            assert Fraction(entry) / Fraction(2) ** denominator_log2 == wanted


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e308])
def test_a_form_beyond_floating_point_is_refused(value):
    with pytest.raises(OverflowError), np.errstate(all="ignore"):
        module.round_form(np.array([[value]]), np.array([0]), 20)


@given(st.floats(1e-300, 1e300))
def test_rates_in_continuous_time_only_get_slower(rate):
    rounded = module.round_rate(rate, Time.CONTINUOUS)
    assert 0 < rounded <= Fraction(rate)
    assert rounded >= Fraction(rate) * (1 - Fraction(1, 2 ** (module.RATE_BITS - 1)))
    assert rounded.denominator & (rounded.denominator - 1) == 0


@given(st.floats(0, 1, exclude_max=True))
def test_rates_in_discrete_time_only_get_slower(rate):
    assert Fraction(rate) <= module.round_rate(rate, Time.DISCRETE) < 1


@given(st.integers(20, 1900))
def test_rates_beyond_floating_point(digits):
    tiny = Fraction(1, 10**digits)
    rounded = module.round_rate(tiny, Time.CONTINUOUS)
    assert tiny * (1 - Fraction(1, 2 ** (module.RATE_BITS - 1))) <= rounded <= tiny
    assert module.round_rate(1 - tiny, Time.DISCRETE) == 1 - rounded
