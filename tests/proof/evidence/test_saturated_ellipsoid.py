"""Decay although signals saturate: regions known by hand, and what every form bars.

The rows of test_saturated_ellipsoid.yaml are most of it.
"""

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.certificates.second_opinion import agrees
from nrs_design.proof.evidence import SaturatedEllipsoid, Shows, read_evidence
from nrs_design.proof.evidence.fields import MAX_INTEGER_BITS
from nrs_design.proof.saturation import Saturation
from tests.proof import systems
from tests.proof.truth import holds


def of_one_state(q, h, rate, level, logs=(8, 4)):
    rows = tuple((entry,) for entry in ((h,) if isinstance(h, int) else h))
    numbers = {"rate": Fraction(rate), "level": Fraction(level), "H": rows}
    return SaturatedEllipsoid(
        Q=((q,),), denominator_log2=logs[0], H_denominator_log2=logs[1], **numbers
    )


# For x' = x + sat(-3 x): h = -17/16, V = (19/16)^2 x^2 nearly, from |x| <= 13/16.
HELD = of_one_state(361, -17, "1/32", "13/16")


# For x+ = 3/2 x + sat(-x): h = -9/16, V = (5/8)^2 x^2 nearly, from |x| <= 3/2.
STEPS = of_one_state(25, -9, "31/32", "3/2", (6, 4))


@pytest.mark.parametrize(
    ("system", "evidence", "rate"),
    # A thirty-second of it is lost in a second, or in every tenth of a second.
    [(systems.pushed_away(), HELD, "1/32"), (systems.pushed_away_in_steps(), STEPS, "10/32")],
)
def test_a_scalar_loop_decays_from_inside_of_its_region(system, evidence, rate):
    assert agrees(system, evidence)
    assert evidence.shows is Shows.REGION
    assert evidence.start_size == evidence.level
    assert evidence.start_rate(system) == Fraction(rate)
    assert evidence.proved_rate(system) is None
    assert "contact" not in evidence.claim(system)
    fields = {"kind": evidence.kind, **evidence.to_fields()}
    assert read_evidence(fields, system) == evidence
    with pytest.raises(ValueError, match="does not say what saturates"):
        read_evidence(fields, systems.family([[-1]]))


def test_a_step_of_unknown_length_has_no_rate_in_seconds():
    system = replace(systems.pushed_away_in_steps(), sample_time=None)
    assert STEPS.start_rate(system) == Fraction(1, 32)
    assert "A step takes" not in STEPS.claim(system)


@given(
    st.integers(-80, 80),
    st.integers(1, 5000),
    st.fractions("1/20", 3, max_denominator=40),
    st.fractions("1/100", 2, max_denominator=100),
)
def test_nothing_is_shown_from_outside_of_the_known_region(h, q, level, rate):
    evidence = of_one_state(q, h, rate, level)
    if evidence.find_fault(systems.pushed_away()) is None:
        assert level < 1
        assert holds(systems.pushed_away(), evidence)


@given(
    st.integers(-30, 0),
    st.integers(1, 100),
    st.fractions(Fraction(1, 2), Fraction(2), max_denominator=32),
    st.fractions(Fraction(1, 2), Fraction(3), max_denominator=32),
)
def test_no_region_in_steps_is_larger_than_that_of_the_motions(h, q, rate, level):
    """It is |x| < 2, by hand."""
    system = systems.pushed_away_in_steps()
    evidence = of_one_state(q, h, rate, level, (6, 4))
    if evidence.find_fault(system) is None:
        assert level < 2
        assert rate < 1
        assert holds(system, evidence)


def test_a_denominator_may_be_as_long_as_is_read():
    system = systems.pushed_away()
    (signal,) = system.saturation.signals
    wide = (replace(signal, limit=Fraction(4)),)
    system = replace(system, saturation=replace(system.saturation, signals=wide))
    long = replace(HELD, Q=((1 << MAX_INTEGER_BITS - 1,),), denominator_log2=MAX_INTEGER_BITS)
    systems.expect(system, long, None)
    longer = replace(long, denominator_log2=MAX_INTEGER_BITS + 1)
    systems.expect(system, longer, "the denominator of Q")
    systems.expect(system, replace(HELD, denominator_log2=10**400), "the denominator of")
    systems.expect(system, replace(HELD, H_denominator_log2=10**400), "the denominator of")


def test_kept_contact_has_no_conditions_of_flight():
    system, evidence = systems.genuine("saturated-ellipsoid")
    assert "contact is kept" not in evidence.claim(system)
    systems.expect(systems.kept(system), evidence, None)


def test_every_choice_of_arguments_and_rows_is_needed():
    """Two signals, one in the other: x' = x + s1 + s2, s1 = sat(-x) and s2 = sat(s1 - x)."""
    signals = systems.cut_off("s1", 2, [[1]], [[-1]]), systems.cut_off("s2", 1, [[1]], [[-1, 1]])
    what = Saturation(signals, systems.pushed_away().saturation.start)
    system = replace(systems.pushed_away(), modes=systems.family([[-2]]).modes, saturation=what)
    # The last vertex alone bars this: from x = 3 it flies away, and h2 = -1/4 is no pull.
    weak = of_one_state(16, (-16, -4), "1/64", "7/2", (8, 5))
    assert "does not decrease" in weak.find_fault(system)
    assert not holds(system, weak)


def test_rounding_is_asked_for():
    system, evidence = systems.genuine("saturated-ellipsoid, in steps")
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
    system, evidence = systems.genuine("saturated-ellipsoid, in steps")
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
