"""Decay although signals saturate: a region known by hand, attacks, and what every form bars."""

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.certificates.second_opinion import agrees
from nrs_design.proof.evidence import SaturatedEllipsoid, Shows, read_evidence
from nrs_design.proof.evidence.fields import MAX_INTEGER_BITS
from nrs_design.proof.mode import Time
from nrs_design.proof.saturation import Saturation
from nrs_design.proof.switching import Reset, Switching
from tests.proof.systems import (
    bouncing,
    cut_off,
    family,
    genuine,
    kept,
    matrix,
    pushed_away,
    pushed_away_in_steps,
    saturating,
)
from tests.proof.truth import holds


def of_one_state(q, h, rate, level, logs=(8, 4)):
    rows = tuple((entry,) for entry in ((h,) if isinstance(h, int) else h))
    numbers = {"rate": Fraction(rate), "level": Fraction(level), "H": rows}
    return SaturatedEllipsoid(
        Q=((q,),), denominator_log2=logs[0], H_denominator_log2=logs[1], **numbers
    )


# For x' = x + sat(-3 x): h = -17/16, V = (19/16)^2 x^2 nearly, from |x| <= 13/16.
HELD = of_one_state(361, -17, "1/32", "13/16")


def test_a_scalar_loop_decays_from_inside_of_its_region():
    system = pushed_away()
    assert HELD.find_fault(system) is None
    assert agrees(system, HELD)
    assert holds(system, HELD)
    assert HELD.shows is Shows.REGION
    assert HELD.start_size == Fraction(13, 16)
    assert HELD.start_rate(system) == Fraction(1, 32)
    assert HELD.proved_rate(system) is None
    claim = HELD.claim(system)
    assert "a place up to 0.8125 m" in claim
    assert "alpha = 0.03125 1/s" in claim
    assert "the s at 1 N" in claim
    assert "contact" not in claim


def test_a_limit_that_is_not_short_is_rounded_up():
    """What is claimed holds at the limit and beyond it: below it, it may not."""
    system = pushed_away()
    (signal,) = system.saturation.signals
    longer = (replace(signal, limit=Fraction(10, 9)),)
    claim = HELD.claim(replace(system, saturation=replace(system.saturation, signals=longer)))
    assert "the s at 1.11112 N (rounded up)" in claim


def test_the_claim_names_what_is_not_at_rest_when_a_motion_begins():
    system = pushed_away()
    start = replace(system.saturation.start, beside="error kept")
    claim = HELD.claim(replace(system, saturation=replace(system.saturation, start=start)))
    assert "0.8125 m, the error kept being what it is then under one of the controllers" in claim


def test_the_claim_says_that_contact_may_be_lost():
    system, evidence = genuine("saturated-ellipsoid")
    assert "contact lost and made again at any time" in evidence.claim(system)
    assert "contact is kept" not in evidence.claim(system)


def test_the_known_region_is_filled():
    """It is |x| < 1: with h near -1 the certificate comes as near as wanted."""
    near = of_one_state(2**40 + 2**26, -(2**20) - 2**3, "1e-6", "0.9999", (40, 20))
    assert near.find_fault(pushed_away()) is None
    assert near.find_fault(pushed_away(2)) is None
    assert near.find_fault(pushed_away(1)) is not None


@given(
    st.integers(-80, 80),
    st.integers(1, 5000),
    st.fractions("1/20", 3, max_denominator=40),
    st.fractions("1/100", 2, max_denominator=100),
)
def test_nothing_is_shown_from_outside_of_the_known_region(h, q, level, rate):
    evidence = of_one_state(q, h, rate, level)
    if evidence.find_fault(pushed_away()) is None:
        assert level < 1
        assert holds(pushed_away(), evidence)


def test_limits_that_are_wider_are_covered():
    system = pushed_away()
    (signal,) = system.saturation.signals
    for limit in (1, 2, 1000):
        wider = (replace(signal, limit=Fraction(limit)),)
        what = replace(system.saturation, signals=wider)
        assert HELD.find_fault(replace(system, saturation=what)) is None
    narrow = replace(system.saturation, signals=(replace(signal, limit=Fraction(1, 2)),))
    assert "beyond its limit" in HELD.find_fault(replace(system, saturation=narrow))


def test_a_denominator_may_be_as_long_as_is_read():
    system, half = changed(limit=Fraction(4)), ((1 << MAX_INTEGER_BITS - 1,),)
    long = replace(HELD, Q=half, denominator_log2=MAX_INTEGER_BITS)
    assert long.find_fault(system) is None
    longer = replace(HELD, Q=half, denominator_log2=MAX_INTEGER_BITS + 1)
    assert "the denominator of Q" in longer.find_fault(system)


def test_a_row_is_held_against_the_square_of_its_limit():
    """In whole numbers: h = -2 in V = 20 x^2 reaches sqrt(1/5), h = -5 in V = 5 x^2 sqrt(5)."""
    near = of_one_state(20, -2, "1/2", "1/5", (0, 0))
    assert near.find_fault(changed(limit=Fraction(1, 2))) is None
    assert "beyond its limit" in near.find_fault(changed(limit=Fraction(2, 5)))
    far = of_one_state(5, -5, "1/2", "1/5", (0, 0))
    assert "beyond its limit" in far.find_fault(changed(limit=Fraction(2)))
    assert far.find_fault(changed(limit=Fraction(5, 2))) is None


@pytest.mark.parametrize(
    ("evidence", "fault"),
    [
        # What each condition bars: without it, decay from |x| > 1 or of an unstable loop.
        (replace(HELD, Q=((64,),), level=Fraction(19, 10)), "the row of s is beyond its limit"),
        (replace(HELD, H=((-15,),)), "does not decrease at the claimed rate in mode m0"),
        (replace(HELD, level=Fraction(2)), "does not hold the stated place"),
        (replace(HELD, H=((0,),), Q=((64,),)), "does not decrease"),
        (replace(HELD, rate=Fraction(1, 16)), "does not decrease"),
        # On the edge, every form is singular and shows nothing.
        (replace(HELD, H=((-16,),)), "does not decrease"),
        (replace(HELD, H=((-19,),)), "beyond its limit"),
        (replace(HELD, level=Fraction(16, 19)), "does not hold the stated place"),
        (replace(HELD, Q=((-361,),)), "Q is not symmetric and positive definite"),
        (replace(HELD, rate=Fraction(0)), "is not positive"),
        (replace(HELD, level=Fraction(0)), "is not positive"),
        (replace(HELD, level=Fraction(-1, 2)), "is not positive"),
        (replace(HELD, Q=((361, 0), (0, 1))), "Q is not a 1 x 1 matrix"),
        (replace(HELD, H=()), "H has not 1 rows of 1 entries"),
        (replace(HELD, H=((-17,), (-17,))), "H has not 1 rows"),
        (replace(HELD, H=((-17, 0),)), "H has not 1 rows"),
        (replace(HELD, H=((-17.0,),)), "float"),
        (replace(HELD, denominator_log2=10**400), "the denominator of"),
        (replace(HELD, H_denominator_log2=10**400), "the denominator of"),
        (replace(HELD, H_denominator_log2=-1), "the denominator of"),
    ],
)
def test_other_numbers_are_refused(evidence, fault):
    assert fault in evidence.find_fault(pushed_away())


def test_a_loop_that_is_unstable_within_its_limits_is_refused():
    """The row alone would decay: x' = x - sat(x/2) does not, from anywhere."""
    assert "does not decrease" in HELD.find_fault(pushed_away("1/2"))
    assert not holds(pushed_away("1/2"), HELD)


def changed(**parts):
    system = pushed_away()
    (signal,) = system.saturation.signals
    return replace(
        system, saturation=replace(system.saturation, signals=(replace(signal, **parts),))
    )


@pytest.mark.parametrize(
    ("system", "fault"),
    [
        (replace(pushed_away(), saturation=None), "does not say what saturates"),
        # In steps this loop doubles its state.
        (replace(pushed_away(), time=Time.DISCRETE), "does not decrease"),
        (changed(limit=Fraction(0)), "the limit of s is not positive"),
    ],
)
def test_another_system_is_refused(system, fault):
    assert fault in HELD.find_fault(system)


def test_contact_is_asked_for_what_it_does():
    system, evidence = genuine("saturated-ellipsoid")
    pulling = replace(system, contact=replace(system.contact, pulls=(matrix([[0, 1]]),)))
    assert "could pull" in evidence.find_fault(pulling)
    first, *others = system.saturation.signals
    feeling = replace(first, rows=(*first.rows[:-1], matrix([[-1, 1]])))
    what = replace(system.saturation, signals=(feeling, *others))
    fault = "s1 depends on the deflection in free motion"
    assert fault in evidence.find_fault(replace(system, saturation=what))
    reset = Switching(resets=(Reset("m0", "m1", matrix([[2, 0], [0, 2]])),))
    assert "kind of switching" in evidence.find_fault(replace(system, switching=reset))
    assert evidence.find_fault(bouncing()) == "the system does not say what saturates"


def test_free_motion_has_conditions_of_its_own():
    """What decays in contact flies away where the pull is cut off earlier in the air."""
    system, evidence = genuine("saturated-ellipsoid")
    flying = replace(system.contact.free[0], A=matrix([[1, 0], [1, 0]]))
    lost = replace(system, contact=replace(system.contact, free=(flying,)))
    # In the air nothing pulls: v' = v, where its linear form is what it is in contact.
    off = [
        replace(s, rows=(*s.rows[:-1], matrix([[0] * (2 + i)])))
        for i, s in enumerate(system.saturation.signals)
    ]
    lost = replace(lost, saturation=replace(system.saturation, signals=tuple(off)))
    assert "in free motion, mode free" in evidence.find_fault(lost)
    assert evidence.find_fault(kept(system)) is None
    assert not holds(lost, evidence)


def test_every_choice_of_arguments_and_rows_is_needed():
    """Two signals, one in the other: x' = x + s1 + s2, s1 = sat(-x) and s2 = sat(s1 - x)."""
    signals = cut_off("s1", 2, [[1]], [[-1]]), cut_off("s2", 1, [[1]], [[-1, 1]])
    what = Saturation(signals, pushed_away().saturation.start)
    system = replace(pushed_away(), modes=family([[-2]]).modes, saturation=what)
    # The last vertex alone bars this: from x = 3 it flies away, and h2 = -1/4 is no pull.
    weak = of_one_state(16, (-16, -4), "1/64", "7/2", (8, 5))
    assert "does not decrease" in weak.find_fault(system)
    assert not holds(system, weak)


# For x+ = 3/2 x + sat(-x): h = -9/16, V = (5/8)^2 x^2 nearly, from |x| <= 3/2.
STEPS = of_one_state(25, -9, "31/32", "3/2", (6, 4))


def test_a_loop_in_steps_decays_from_inside_of_its_region():
    system = pushed_away_in_steps()
    assert STEPS.find_fault(system) is None
    assert agrees(system, STEPS)
    assert holds(system, STEPS)
    # A thirty-second of it is lost in every tenth of a second.
    assert STEPS.start_rate(system) == Fraction(10, 32)
    assert STEPS.start_rate(replace(system, sample_time=None)) == Fraction(1, 32)
    claim = STEPS.claim(system)
    assert "|w(m)| <= rho^m |w(0)| after m steps with rho = 0.96875" in claim
    assert "alpha = 0.3125 1/s" in claim
    assert "A step takes" not in STEPS.claim(replace(system, sample_time=None))


@given(
    st.integers(-30, 0),
    st.integers(1, 100),
    st.fractions(Fraction(1, 2), Fraction(2), max_denominator=32),
    st.fractions(Fraction(1, 2), Fraction(3), max_denominator=32),
)
def test_no_region_in_steps_is_larger_than_that_of_the_motions(h, q, rate, level):
    """It is |x| < 2, by hand."""
    system = pushed_away_in_steps()
    evidence = of_one_state(q, h, rate, level, (6, 4))
    if evidence.find_fault(system) is None:
        assert level < 2
        assert rate < 1
        assert holds(system, evidence)


@pytest.mark.parametrize(
    ("evidence", "fault"),
    [
        (replace(STEPS, H=((-8,),)), "does not decrease"),
        (replace(STEPS, H=((-11,),)), "beyond its limit"),
        (replace(STEPS, H=((-9,), (-9,))), "H has not 1 rows"),
        (replace(STEPS, rate=Fraction(7, 8)), "does not decrease"),
        (replace(STEPS, rate=Fraction(1)), "not one of exponential decay"),
        (replace(STEPS, level=Fraction(8, 5)), "does not hold the stated place"),
        (replace(STEPS, multipliers=(1,)), "one multiplier for each condition"),
        (replace(STEPS, roundings=(1,)), "one multiplier for each rounding"),
    ],
)
def test_other_numbers_in_steps_are_refused(evidence, fault):
    assert fault in evidence.find_fault(pushed_away_in_steps())


def test_multipliers_are_of_steps():
    for part in ("multipliers", "roundings"):
        fault = replace(HELD, **{part: (1,)}).find_fault(pushed_away())
        assert "there is not one multiplier for each" in fault


def test_rounding_is_asked_for():
    system, evidence = genuine("saturated-ellipsoid, in steps")
    assert evidence.covers_rounding
    assert "single-precision arithmetic rounds in the law is included" in evidence.claim(system)
    negative = replace(evidence, roundings=tuple(-tau - 1 for tau in evidence.roundings))
    assert "a multiplier is negative" in negative.find_fault(system)
    (signal,) = system.saturation.signals
    silent = replace(system.saturation, signals=(replace(signal, errors=()),))
    fault = "does not say what the arithmetic rounds"
    assert fault in evidence.find_fault(replace(system, saturation=silent))
    # Without its roundings it is about exact arithmetic, and need not know of them.
    plain, exact = replace(evidence, roundings=()), replace(signal, errors=())
    known = replace(system, saturation=replace(system.saturation, signals=(exact,)))
    assert plain.find_fault(known) is None
    assert holds(known, plain)
    assert "without rounding" in plain.claim(known)


def test_rows_may_differ_from_mode_to_mode():
    """Each is held against its limit, and counts in its own mode."""
    system, evidence = genuine("saturated-ellipsoid, in steps")
    each = replace(evidence, H=evidence.H * 3)
    assert each.find_fault(system) is None
    assert holds(system, each)
    far = tuple(21 * entry // 20 for entry in evidence.H[0])
    for k in range(3):
        rows = [*evidence.H * 3]
        rows[k] = far
        assert "the row of s is beyond" in replace(each, H=tuple(rows)).find_fault(system)
        rows[k] = tuple(0 for _ in far)
        other = replace(each, H=tuple(rows))
        assert "does not decrease" in other.find_fault(system)
        assert not holds(system, other)
    ragged = replace(each, H=(*each.H[:2], each.H[2][:1]))
    assert "H has not 1 rows of 2 entries" in ragged.find_fault(system)


def test_fields_are_read_again():
    fields = {"kind": "saturated-ellipsoid", **HELD.to_fields()}
    assert read_evidence(fields, pushed_away()) == HELD
    with pytest.raises(ValueError, match="does not say what saturates"):
        read_evidence(fields, family([[-1]]))


def test_what_saturates_is_a_part_of_the_system():
    system = saturating()
    assert replace(system, saturation=None) != system
