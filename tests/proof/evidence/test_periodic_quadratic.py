"""A function for each step of a round: known answers, attacks, what each condition bars."""

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.proof.contact import Contact
from nrs_design.proof.contradiction import find_contradiction
from nrs_design.proof.evidence import ConewiseQuadratic, PeriodicQuadratic, Shows
from nrs_design.proof.evidence.abstract import NOT_ROUNDED, ROUNDED
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.second_opinion import agrees
from nrs_design.proof.switching import Clock
from nrs_design.proof.system import SwitchedSystem
from tests.proof.evidence.test_conewise_quadratic import ESCAPES, LAGGING, growth, losable
from tests.proof.systems import (
    bouncing_in_steps,
    bouncing_in_turns,
    doubled_in_turns,
    family,
    genuine,
    matrix,
    pushed,
)
from tests.proof.truth import holds
from tests.support import is_definite_by_ldl

# x doubles, then loses a quarter three times: 2 (3/4)^3 = 0.84375, so 0.9584 a step.
ROUNDS = Fraction("0.84375")


def numbers(*values: int) -> tuple[tuple[tuple[int]], ...]:
    return tuple(((value,),) for value in values)


FOUR = PeriodicQuadratic(numbers(64, 15, 25, 42), 0, Fraction("0.977"))


def test_known_answer_of_one_state():
    """V before the doubling is to V after it as 4 to rho^2, and then as 9/16 to rho^2."""
    system = doubled_in_turns(4)
    assert FOUR.find_fault(system) is None
    assert agrees(system, FOUR)
    assert holds(system, FOUR)
    assert FOUR.shows is Shows.STABILITY
    assert FOUR.keeps_bound_in_mixtures
    assert FOUR.proved_rate(system) == FOUR.rate
    claim = FOUR.claim(system)
    assert "In rounds of 4 steps, every solution of x+ = A x and" in claim
    assert "w is the state" in claim
    assert "deflection" not in claim


def test_the_best_rate_of_one_state():
    system, rate = doubled_in_turns(4), Fraction("0.95845")
    assert Fraction("0.9584") ** 4 < ROUNDS < rate**4
    values = [10**9]
    for kept in (Fraction(1, 4), Fraction(16, 9), Fraction(16, 9)):
        values.append(int(values[-1] * kept * rate**2) - 1)
    tight = PeriodicQuadratic(numbers(*values), 0, rate)
    assert tight.find_fault(system) is None
    assert "does not decrease" in replace(tight, rate=Fraction("0.9584")).find_fault(system)


@pytest.mark.parametrize("step", range(4))
def test_every_step_has_a_condition(step):
    """A function that is too small lets the one before it fall, and not rise to the next."""
    functions = list(FOUR.functions)
    functions[step] = ((functions[step][0][0] // 2,),)
    fault = replace(FOUR, functions=tuple(functions)).find_fault(doubled_in_turns(4))
    mode = "m0" if step == 0 else "m1"
    assert fault == f"V does not decrease at the claimed rate in mode {mode}, at step {step}"


def test_a_round_that_grows_is_not_proved():
    """2 (3/4)^2 is above one: without the step from the last function to the first, all holds."""
    system = doubled_in_turns(3)
    candidate = PeriodicQuadratic(numbers(64, 15, 26), 0, Fraction("0.99"))
    broken = [where for where, form in candidate.forms(system) if not is_definite_by_ldl(form)]
    assert len(broken) == 1
    assert broken[0].endswith("in mode m1, at step 2")
    assert candidate.find_fault(system) == broken[0]


@pytest.mark.parametrize("example", ["", ", pulling", ", rounding", ", kept"])
def test_what_the_search_finds_is_true(example):
    system, evidence = genuine(f"periodic-quadratic{example}")
    assert evidence.find_fault(system) is None
    assert agrees(system, evidence)
    assert holds(system, evidence)
    claim = evidence.claim(system)
    lost = system.contact is not None
    assert ("with contact lost and made again at any time," in claim) is lost
    assert ("where w holds the states other than the deflection" in claim) is lost
    assert (ROUNDED in claim) == evidence.covers_rounding == bool(system.roundings)


def test_what_is_not_rounded_is_said():
    system, evidence = genuine("periodic-quadratic, rounding")
    exact = replace(evidence, roundings=())
    assert exact.find_fault(system) is None
    assert NOT_ROUNDED in exact.claim(system)
    item = system.roundings[0]
    wild = tuple(replace(row, denominator=1, numerators=((4, 0),)) for row in item.rows)
    for where in range(5):
        rows = (*item.rows[:where], wild[where], *item.rows[where + 1 :])
        other = replace(system, roundings=(replace(item, rows=rows),))
        assert exact.find_fault(other) is None
        assert evidence.find_fault(other) is not None


def in_turns(system: SwitchedSystem) -> SwitchedSystem:
    """Return the same motions at every step, under names of their own at the first of two."""
    first = tuple(replace(mode, name=f"{mode.name}, first") for mode in system.modes)
    free = tuple(replace(mode, name=f"{mode.name}, first") for mode in system.contact.free)
    names = tuple(mode.name for mode in (*first, *free))
    return replace(
        system,
        modes=(*first, *system.modes),
        contact=replace(system.contact, free=(*free, *system.contact.free)),
        clock=Clock(2, names),
    )


def test_equal_steps_have_the_conditions_of_one_function():
    for system, Q, multipliers in (
        (bouncing_in_steps(), ((40, 20), (20, 60)), (16,)),
        (bouncing_in_steps(1), ((40, 20), (20, 60)), (16, 3, 5, 7)),
    ):
        multipliers = multipliers[:1] + multipliers[1:] * len(system.contact.pulls)
        one = ConewiseQuadratic(Q, 0, Fraction(99, 100), multipliers)
        twice = PeriodicQuadratic((Q, Q), 0, Fraction(99, 100), (multipliers,) * 2)
        forms = [form for _, form in one.forms(system)]
        every = [form for _, form in twice.forms(in_turns(system))]
        assert every == [forms[0], forms[0], *forms[1:], *forms[1:]]


@pytest.mark.parametrize("where", ESCAPES)
def test_each_condition_bars_a_family_that_grows(where):
    """The families of one function for all steps, with the same motions at both of a round."""
    contact, free, Q = ESCAPES[where]
    single = losable(contact, free, Time.DISCRETE)
    system = in_turns(single)
    scaled = tuple(tuple(64 * entry for entry in row) for row in Q)
    faults = set()
    for multiplier in (0, 16, 32, 64, 128, 256, 512):
        candidate = PeriodicQuadratic(
            (scaled, scaled), 0, Fraction(98, 100), ((multiplier,), (multiplier,))
        )
        broken = {
            failure.partition("rate ")[2]
            for failure, form in candidate.forms(system)
            if not is_definite_by_ldl(form)
        }
        assert {f"{where}, first, at step 0", f"{where}, at step 1"} <= broken
        assert candidate.find_fault(system) is not None
        faults.add(frozenset(broken))
    assert frozenset({f"{where}, first, at step 0", f"{where}, at step 1"}) in faults
    assert max(growth(single, Q, start) for start in range(40)) > 1000


@pytest.mark.parametrize("where", LAGGING)
def test_each_condition_of_what_lags_is_one_of_every_step(where):
    system, Q, multipliers = LAGGING[where]
    candidate = PeriodicQuadratic((Q, Q), 0, Fraction(98, 100), (multipliers,) * 2)
    broken = {
        failure.partition("rate ")[2]
        for failure, form in candidate.forms(in_turns(system))
        if not is_definite_by_ldl(form)
    }
    assert broken == {f"{where}, first, at step 0", f"{where}, at step 1"}


TURNS = PeriodicQuadratic(
    (((40, 20), (20, 60)), ((40, 20), (20, 60))), 0, Fraction(99, 100), ((16,), (16,))
)


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        ({"functions": TURNS.functions[:1]}, "one function for each step"),
        ({"functions": (*TURNS.functions, TURNS.functions[0])}, "one function for each step"),
        ({"functions": (((1,),), TURNS.functions[1])}, "not a 2 x 2"),
        ({"functions": (((40, 20), (19, 60)), TURNS.functions[1])}, "step 0 is not symmetric"),
        ({"functions": (TURNS.functions[0], ((-40, 0), (0, 60)))}, "step 1 is not symmetric"),
        ({"rate": Fraction(0)}, "exponential decay"),
        ({"rate": Fraction(1)}, "exponential decay"),
        ({"multipliers": ()}, "one multiplier for each condition"),
        ({"multipliers": ((16,),)}, "one multiplier for each condition"),
        ({"multipliers": ((16,), ())}, "one multiplier for each condition"),
        ({"multipliers": ((16,), (16, 16))}, "one multiplier for each condition"),
        ({"multipliers": ((16,), (-1,))}, "negative"),
        ({"roundings": ((1,),)}, "for each step of a round"),
        ({"roundings": ((1,), ())}, "for each step of a round"),
        ({"roundings": ((), ())}, "for each step of a round"),
        ({"roundings": ((1,), (-1,))}, "negative"),
        ({"roundings": ((1,), (1, 1))}, "one multiplier for each rounding"),
    ],
)
def test_misfits(changes, fault):
    assert fault in replace(TURNS, **changes).find_fault(bouncing_in_turns(rounded=True))


def test_what_disturbs_is_not_taken_for_a_rounding():
    """Rows of roundings go over the state and what disturbs it, which decay says nothing of."""
    system = bouncing_in_turns(rounded=True)
    (item,) = system.roundings
    wide = tuple(matrix([[*row.fractions()[0], 7]]) for row in item.rows)
    disturbed = pushed(replace(system, roundings=(replace(item, rows=wide),)))
    assert find_contradiction(disturbed) is None
    evidence = replace(TURNS, roundings=((1,), (1,)))
    assert [*evidence.forms(disturbed)] == [*evidence.forms(system)]
    # A rounding that grows with the state is still held against.
    large = tuple(matrix([[100, *row.fractions()[0][1:], 7]]) for row in item.rows)
    worse = pushed(replace(system, roundings=(replace(item, rows=large),)))
    assert evidence.find_fault(worse) is not None


def test_a_multiplier_may_be_zero():
    system = bouncing_in_turns(rounded=True)
    none = replace(TURNS, multipliers=((0,), (0,)), roundings=((0,), (0,)))
    assert none.find_misfit(system) is None


def test_no_multipliers_where_contact_is_kept():
    kept = replace(bouncing_in_turns(), contact=None, clock=Clock(2, ("push 1", "push 2")))
    assert "one multiplier for each condition" in TURNS.find_misfit(kept)
    assert replace(TURNS, multipliers=()).find_misfit(kept) is None


def test_without_turns_it_shows_nothing():
    assert "do not take turns" in TURNS.find_fault(bouncing_in_steps())
    with pytest.raises(ValueError, match="do not take turns"):
        PeriodicQuadratic.from_fields(TURNS.to_fields(), bouncing_in_steps())


def test_fields_are_read_back():
    system = bouncing_in_turns(rounded=True)
    for evidence in (TURNS, replace(TURNS, roundings=((1,), (2,)))):
        assert PeriodicQuadratic.from_fields(evidence.to_fields(), system) == evidence
    fields = TURNS.to_fields()
    fields["functions"][1]["denominator_log2"] = 1
    with pytest.raises(ValueError, match="share one denominator"):
        PeriodicQuadratic.from_fields(fields, system)


@settings(deadline=None, max_examples=60)
@given(
    st.lists(st.integers(-6, 6), min_size=12, max_size=12),
    st.lists(st.integers(-6, 6), min_size=6, max_size=6),
    st.lists(st.integers(0, 6), min_size=8, max_size=8),
    st.booleans(),
    st.fractions("1/2", "11/10"),
)
def test_against_the_definition(maps, Q, multipliers, pulled, rate):
    a, b, c, d, e, f, g, h, i, j, k, m = (Fraction(entry, 8) for entry in maps)
    free = (
        Mode("f0", matrix([[i, 0], [j, 1]])),
        Mode("f1", matrix([[k, 0], [m, 1]])),
    )
    pulls = (matrix([[1, "2/3"]]),) if pulled else ()
    system = replace(
        family([[a, b], [c, d]], [[e, f], [g, h]], time=Time.DISCRETE),
        contact=Contact(free, pulls),
        clock=Clock(2, ("m0", "f0")),
    )
    p, q, r, s, t, u = Q
    per_step = tuple(multipliers[:4] if pulled else multipliers[:1])
    other = tuple(multipliers[4:] if pulled else multipliers[4:5])
    functions = (((p, q), (q, r)), ((s, t), (t, u)))
    candidate = PeriodicQuadratic(functions, 0, rate, (per_step, other))
    assert (candidate.find_fault(system) is None) == holds(system, candidate)
