"""One polynomial for contact and free motion: known answers, attacks, what each condition bars."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from nrs_design.proof.contact import Contact
from nrs_design.proof.evidence import CommonPolynomial, ConewisePolynomial, Shows
from nrs_design.proof.evidence.conewise_polynomial import without_last
from nrs_design.proof.lift import monomials
from nrs_design.proof.mode import Mode
from nrs_design.proof.second_opinion import agrees
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.certify import Limits, certify
from nrs_design.search.method import Method
from nrs_design.search.polynomial import search_polynomial
from tests.proof.systems import bouncing, bouncing_in_steps, family, genuine, matrix
from tests.proof.truth import holds
from tests.search.support import found
from tests.support import is_definite_by_ldl

NONE = ((0, 0), (0, 0))
# By hand, as for the quadratic: V = 4 v^2 + 4 v delta + 6 delta^2, a form of degree two.
BOUNCE = ConewisePolynomial(
    CommonPolynomial(1, ((4, 2), (2, 6)), 0, (NONE, NONE), Fraction(1, 5)), (((0,),),)
)
# Contact and flight are stable, each for itself, and bouncing grows. Found by a random search.
GROWING = [[2, -1, 2], [5, -3, 4], [1, -3, 0]], [[-1, 6], [0, -2]]


def growing() -> SwitchedSystem:
    touching, flying = GROWING
    free = [[*row, 0] for row in flying] + [touching[2]]
    return replace(family(touching), contact=Contact((Mode("f", matrix(free)),)))


def polynomial(*matrices) -> CommonPolynomial:
    """Return what the search finds for modes of kept contact, of degree 4."""
    evidence = found(search_polynomial, family(*matrices), degree=2, optimize_rate=False)
    assert isinstance(evidence, CommonPolynomial)
    return evidence


def broken(system: SwitchedSystem, candidate: ConewisePolynomial) -> set[str]:
    return {failure for failure, form in candidate.forms(system) if not is_definite_by_ldl(form)}


def test_a_bouncing_mass_is_proved():
    system, proposed = genuine("conewise-polynomial")
    for evidence in (BOUNCE, proposed):
        assert evidence.find_fault(system) is None
        assert agrees(system, evidence)
        assert holds(system, evidence)
        assert evidence.shows is Shows.STABILITY
        claim = evidence.claim(system)
        assert "contact lost and made again at any time" in claim
        assert "2 modes in contact and 1 mode of free motion" in claim
        assert "as long as contact is kept" not in claim
    assert proposed.in_contact.degree == 2
    assert "|w|^4" in proposed.claim(system)
    assert BOUNCE.proved_rate(system) == Fraction(1, 5)


@pytest.mark.parametrize(("order", "degree"), [(2, 1), (2, 3), (3, 2), (4, 2), (4, 3)])
def test_monomials_without_the_deflection_are_those_of_the_other_states(order, degree):
    basis = monomials(order, degree)
    kept = tuple(basis[k][:-1] for k in without_last(order, degree))
    assert kept == monomials(order - 1, degree)


def grows() -> bool:
    """Whether some run that bounces grows a thousandfold, by exponentials of short steps."""
    system = growing()
    contact = expm(0.02 * np.array(system.modes[0].A.floats()))
    free = expm(0.02 * np.array(system.contact.free[0].A.floats()))
    x = np.array([1.0, -1.0, 1.0])
    for _ in range(3000):
        x = (contact if x[2] > 0 else free) @ x
    return bool(np.linalg.norm([*x[:2], max(x[2], 0.0)]) > 1e3)


def test_without_the_condition_in_flight_growth_would_be_proved():
    """A function of contact alone keeps every condition but that of the free mode."""
    system, alone = growing(), polynomial(GROWING[0])
    assert grows()
    flight = (((0,) * 3,) * 3,)
    candidate = ConewisePolynomial(alone, flight)
    faults = broken(system, candidate)
    assert faults == {"V does not decrease at the claimed rate in mode f"}
    assert "in mode f" in candidate.find_fault(system)


def test_without_the_condition_in_contact_growth_would_be_proved():
    """A function of flight alone, filled up to all states, keeps all but that of the mode."""
    system, alone = growing(), polynomial(GROWING[1])
    basis, kept = monomials(3, 2), without_last(3, 2)
    Q = [[int(i == j) for j in range(len(basis))] for i in range(len(basis))]
    for a, i in enumerate(kept):
        for b, j in enumerate(kept):
            Q[i][j] = alone.Q[a][b]
    nothing = ((0,) * len(basis),) * len(basis)
    rows = tuple(map(tuple, Q))
    candidate = ConewisePolynomial(replace(alone, Q=rows, vanishing=(nothing,)), alone.vanishing)
    assert broken(system, candidate) == {"V does not decrease at the claimed rate in mode m0"}
    assert "in mode m0" in candidate.find_fault(system)


def test_without_one_function_for_both_growth_would_be_proved():
    """Contact and flight have functions of their own; none of them is one of both."""
    system = growing()
    assert polynomial(GROWING[0]).find_fault(family(GROWING[0])) is None
    assert polynomial(GROWING[1]).find_fault(family(GROWING[1])) is None
    result = certify(system, Method.CONEWISE_POLYNOMIAL, Limits(max_degree=6, optimize_rate=False))
    assert result.evidence is None


def test_a_form_in_flight_that_does_not_vanish_proves_nothing():
    """It would make any decrease positive: here that of a mass that does not slow down."""
    system = bouncing()
    sliding = replace(system, contact=Contact((Mode("free", matrix([[0, 0], [1, 0]])),)))
    candidate = replace(BOUNCE, vanishing_free=(((100,),),))
    assert broken(sliding, candidate) == set()
    assert candidate.find_fault(sliding) == "a form that must vanish does not"
    assert "in mode free" in BOUNCE.find_fault(sliding)


@pytest.mark.parametrize(
    ("changes", "fault"),
    [
        ({"vanishing_free": ()}, "one vanishing form for each mode"),
        ({"vanishing_free": (((0,),), ((0,),))}, "one vanishing form for each mode"),
        ({"vanishing_free": (NONE,)}, "1 x 1"),
        ({"in_contact": replace(BOUNCE.in_contact, vanishing=())}, "one vanishing form"),
        ({"in_contact": replace(BOUNCE.in_contact, Q=((1,),))}, "2 x 2"),
        ({"in_contact": replace(BOUNCE.in_contact, Q=((4, 2), (1, 6)))}, "not symmetric"),
        ({"in_contact": replace(BOUNCE.in_contact, rate=Fraction(0))}, "exponential decay"),
    ],
)
def test_misfits(changes, fault):
    assert fault in replace(BOUNCE, **changes).find_fault(bouncing())


def test_what_is_not_covered_is_refused():
    assert "how contact is lost" in BOUNCE.find_fault(replace(bouncing(), contact=None))
    assert "could pull" in BOUNCE.find_fault(bouncing(1))
    assert "continuous time" in BOUNCE.find_fault(bouncing_in_steps())


def test_equal_modes_repeat_their_forms():
    system, evidence = genuine("conewise-polynomial")
    again = tuple(replace(mode, name=f"{mode.name} again") for mode in system.modes)
    twice = replace(system, modes=(*system.modes, *again))
    assert evidence.spread(system, twice).find_fault(twice) is None


def test_numbers_survive_a_file():
    system, evidence = genuine("conewise-polynomial")
    assert ConewisePolynomial.from_fields(evidence.to_fields(), system) == evidence
    with pytest.raises(ValueError, match="how contact is lost"):
        ConewisePolynomial.from_fields(evidence.to_fields(), replace(system, contact=None))


@settings(deadline=None, max_examples=60)
@given(
    st.tuples(*[st.integers(-8, 0), *[st.integers(-3, 3)] * 2, st.integers(-8, 0)]),
    st.integers(-8, 1),
    st.tuples(*[st.integers(0, 20)] * 3),
    st.tuples(*[st.integers(-3, 3)] * 3),
    st.integers(-3, 3),
    st.fractions("1/10", 1),
)
def test_against_the_definition(contact, free, diagonal, others, shift, rate):
    """Degree 4 in two states; the form that vanishes is ``x1^2 x2^2 - (x1 x2)^2``."""
    a, b, c, d = (Fraction(entry, 8) for entry in contact)
    motion = Mode("f", matrix([[Fraction(free, 8), 0], [c, 0]]))
    system = replace(family([[a, b], [c, d]]), contact=Contact((motion,)))
    (p, s, u), (q, r, t) = diagonal, others
    rows = ((p, q, r), (q, s, t), (r, t, u))
    N = ((0, 0, shift), (0, -2 * shift, 0), (shift, 0, 0))
    candidate = ConewisePolynomial(CommonPolynomial(2, rows, 0, (N,), rate), (((0,),),))
    assert (candidate.find_fault(system) is None) == holds(system, candidate)
