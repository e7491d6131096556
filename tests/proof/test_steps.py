"""Steps with rounded arithmetic: known answers, attacks, and what each condition bars."""

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.proof.evidence import CommonQuadratic, ConewiseQuadratic, InvariantEllipsoid
from nrs_design.proof.evidence.abstract import NOT_ROUNDED, ROUNDED
from nrs_design.proof.second_opinion import agrees
from nrs_design.proof.system import Channel, Output, Rounding, SwitchedSystem, Time
from tests.proof.systems import Entry, bouncing_in_steps, family, matrix
from tests.proof.truth import holds

ONE = Fraction(1)


def rounded(A: Entry, share: Entry, column: Entry = 1) -> SwitchedSystem:
    """One state, ``x+ = A x + C r`` with ``|r| <= share |x|``."""
    rounding = Rounding("a x", (matrix([[column]]),), (matrix([[share]]),))
    return replace(family([[A]], time=Time.DISCRETE), roundings=(rounding,))


def test_the_exact_rate_of_one_state():
    """x+ = x/2 + r with |r| <= |x|/4 grows by 3/4 at worst, and no multiplier shows less."""
    system = rounded("1/2", "1/4")
    proof = CommonQuadratic(((1,),), 0, Fraction("0.7501"), (3,))
    assert proof.find_fault(system) is None
    assert agrees(system, proof)
    assert holds(system, proof)
    assert proof.claim(system).endswith(ROUNDED)
    for tau in range(20):
        fast = CommonQuadratic(((8,),), 3, Fraction("0.7499"), (tau,))
        assert "does not decrease" in fast.find_fault(system)


def test_without_its_roundings_a_growing_law_would_pass():
    """x+ = 3/4 x + r with |r| <= |x|/2 may grow by 5/4 a step."""
    system = rounded("3/4", "1/2")
    exact = CommonQuadratic(((1,),), 0, Fraction("0.8"))
    assert exact.find_fault(system) is None
    assert exact.claim(system).endswith(NOT_ROUNDED)
    for tau in range(1, 40):
        for rate in ("0.8", "0.999"):
            covered = CommonQuadratic(((8,),), 3, Fraction(rate), (tau,))
            assert "does not decrease" in covered.find_fault(system)


BOUNCE = ConewiseQuadratic(((3059, 1375), (1375, 3495)), 8, Fraction("0.999"), (2598,), (60_000,))


def bouncing_and_rounded(share: Entry, *, deflects: bool = False) -> SwitchedSystem:
    """A mass on a spring that pushes only; the force, in the air the velocity, is rounded."""
    system = bouncing_in_steps()
    columns = (matrix([[0], [1]] if deflects else [[1], [0]]),) * 3
    rows = (matrix([[0, share]]), matrix([[0, share]]), matrix([[share, 0]]))
    return replace(system, roundings=(Rounding("F", columns, rows),))


def test_a_bouncing_mass_that_rounds():
    for deflects in (False, True):
        system = bouncing_and_rounded("1/1000", deflects=deflects)
        assert BOUNCE.find_fault(system) is None
        assert agrees(system, BOUNCE)
        assert holds(system, BOUNCE)
        coarse = bouncing_and_rounded("1/4", deflects=deflects)
        assert BOUNCE.find_fault(coarse) is not None


@pytest.mark.parametrize(
    ("where", "Q"),
    [
        # Each of these errors acts in one motion only, and throws the state far.
        ("in mode m0", 0),
        ("in free motion, mode free", 1),
    ],
)
def test_an_error_in_any_motion_counts(where, Q):
    system = bouncing_and_rounded("1/1000")
    item = system.roundings[0]
    rows = list(item.rows)
    rows[2 * Q] = matrix([[4, 0]])
    wild = replace(system, roundings=(replace(item, rows=tuple(rows)),))
    assert BOUNCE.find_fault(wild).endswith(where)
    for tau in (0, 1, 100, 10_000, 10**6):
        assert replace(BOUNCE, roundings=(tau,)).find_fault(wild) is not None


def test_a_disturbance_is_rounded_too():
    """z+ = z/2 + d + r, |r| <= |d|/2: from rest up to 3; no set below shows it."""
    system = replace(
        family([["1/2"]], time=Time.DISCRETE),
        channels=(Channel("d", "", ONE, (matrix([[1]]),)),),
        outputs=(Output("z", "", (matrix([[1]]),)),),
        roundings=(Rounding("d", (matrix([[1]]),), (matrix([[0, "1/2"]]),)),),
    )
    scale = 2**20

    def candidate(reach: Fraction, tau: Fraction) -> InvariantEllipsoid:
        Q, half = int(scale / reach**2), (Fraction(1, 2),)
        return InvariantEllipsoid(
            ("d",), "z", ((Q,),), 20, half, Fraction(4), (), (int(scale * tau),)
        )

    # At the border, tau = 2/9 of the part of r in the worst push.
    found = [
        t
        for t in range(1, 200)
        if candidate(Fraction("3.01"), Fraction(t, 200)).find_fault(system) is None
    ]
    assert found
    assert agrees(system, candidate(Fraction("3.01"), Fraction(found[0], 200)))
    for t in range(1, 200):
        assert candidate(Fraction("2.99"), Fraction(t, 200)).find_fault(system) is not None


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        ({"roundings": (1, 1)}, "one multiplier for each rounding"),
        ({"roundings": (-1,)}, "multiplier of a rounding is negative"),
    ],
)
def test_misfits(changes, fault):
    system = bouncing_and_rounded("1/1000")
    assert fault in replace(BOUNCE, **changes).find_fault(system)
    proof = CommonQuadratic(((1,),), 0, Fraction("0.8"))
    assert fault in replace(proof, **changes).find_fault(rounded("1/2", "1/4"))


def changed(**changes: object) -> SwitchedSystem:
    system = bouncing_and_rounded("1/1000")
    return replace(system, roundings=(replace(system.roundings[0], **changes),))


@pytest.mark.parametrize(
    ("system", "fault"),
    [
        (changed(columns=(matrix([[1], [0]]),) * 2), "one column and row for every mode"),
        (changed(columns=(matrix([[1]]),) * 3), "the size of the state"),
        (changed(rows=(matrix([[1, 1, 1]]),) * 3), "the size of the state"),
        (changed(rows=(matrix([[1, 1]]),) * 3), "depends on the deflection in free motion"),
        (
            replace(changed(), roundings=changed().roundings * 2),
            "two roundings have one name",
        ),
        (replace(family([[-1]]), roundings=rounded(0, 0).roundings), "there are no steps"),
    ],
)
def test_roundings_that_make_no_sense(system, fault):
    assert fault in system.find_contradiction()


@settings(deadline=None)
@given(
    st.lists(st.integers(-8, 8), min_size=4, max_size=4),
    st.lists(st.integers(-4, 4), min_size=6, max_size=6),
    st.lists(st.integers(-6, 6), min_size=3, max_size=3),
    st.integers(0, 6),
    st.integers(0, 40),
)
def test_against_the_definition(contact, errors, Q, multiplier, tau):
    """The definition in fractions, decided by another elimination."""
    a, b, c, d = (Fraction(entry, 8) for entry in contact)
    p, q, r, s, t, u = (Fraction(entry, 16) for entry in errors)
    system = bouncing_in_steps()
    flight = [mode.A for mode in system.contact.free]
    columns = (matrix([[p], [q]]),) * 2
    item = Rounding("F", columns, (matrix([[r, s]]), matrix([[t + u, 0]])))
    system = replace(
        family([[a, b], [c, d]], time=Time.DISCRETE),
        contact=replace(system.contact, free=system.contact.free[: len(flight)]),
        roundings=(item,),
    )
    x, y, z = Q
    candidate = ConewiseQuadratic(((x, y), (y, z)), 2, Fraction("0.95"), (multiplier,), (tau,))
    assert (candidate.find_fault(system) is None) == holds(system, candidate)
