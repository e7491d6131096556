"""One function under a constant force: by hand, attacks, and what the free motion bars."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from nrs_design.proof.channels import Coupling
from nrs_design.proof.contact import Contact
from nrs_design.proof.evidence import ConstantForce, Shows, read_evidence
from nrs_design.proof.mode import Mode
from nrs_design.proof.second_opinion import agrees
from nrs_design.proof.switching import Reset, Switching
from tests.proof.systems import bouncing, bouncing_in_steps, family, matrix, settling
from tests.proof.truth import holds

# V = (5 v^2 + 10 v e + 14 e^2 + 22 max(-1 - e, 0)) / 16, with v and e no less than -1 in w.
PUSHED = ConstantForce(((5, 5), (5, 14)), 4, 11)


def test_a_bouncing_mass_settles():
    system = settling()
    assert PUSHED.find_fault(system) is None
    assert agrees(system, PUSHED)
    assert holds(system, PUSHED)
    assert PUSHED.shows is Shows.CONVERGENCE
    assert not PUSHED.is_common_quadratic
    assert PUSHED.proved_rate(system) is None
    claim = PUSHED.claim(system)
    assert "for every constant Fd > 0" in claim
    assert "stiffness that does not change" in claim
    assert "the 2 modes in contact" in claim
    assert "No rate is claimed." in claim
    assert "contact is kept" not in claim
    one = replace(system, modes=system.modes[:1])
    assert "the 1 mode in contact" in PUSHED.claim(one)


def test_the_forms_are_those_of_the_derivative_of_v():
    """By hand for k = 1: in the air v' = -2 v + 1 and e' = v, from w = (v, -1)."""
    forms = dict(PUSHED.forms(settling()))
    assert forms["V does not decrease in mode m0"] == [[10, 1], [1, 10]]
    # V' = 10 v (1 - 2 v) - 10 (1 - 2 v) - 22 v = -20 v^2 + 8 v - 10, with the last entry -1.
    assert forms["V does not decrease in the free motion of mode m0"] == [[20, 4], [4, 10]]


def test_fields_are_read_again():
    fields = {"kind": "constant-force", **PUSHED.to_fields()}
    assert read_evidence(fields, settling()) == PUSHED


def changed(**parts):
    system = settling()
    return replace(system, contact=replace(system.contact, **parts))


SLIDING = Mode("slow", matrix([[-1, 0], [1, 0]]))
LEAKING = replace(settling(), modes=family([[-2, -1], [1, "-1/9"]]).modes)


@pytest.mark.parametrize(
    ("system", "fault"),
    [
        (replace(settling(), contact=None), "does not say that a constant force"),
        (changed(pushed=False), "does not say that a constant force"),
        (changed(pulls=(matrix([[0, 1]]),)), "could pull"),
        (changed(free=(SLIDING,)), "are not those of free motion"),
        (changed(free=(*settling().contact.free, SLIDING)), "are not those of free motion"),
        (
            replace(bouncing_in_steps(), contact=replace(bouncing_in_steps().contact, pushed=True)),
            "continuous time only",
        ),
        (LEAKING, "acts on its own rate"),
        (
            replace(
                settling(),
                switching=Switching(resets=(Reset("m0", "m1", matrix([[2, 0], [0, 2]])),)),
            ),
            "this kind of switching",
        ),
        (
            replace(
                settling(),
                couplings=(Coupling("c", (matrix([[1], [0]]),) * 3, (matrix([[1, 0]]),) * 3),),
            ),
            "what axes do to each other",
        ),
    ],
)
def test_another_system_is_refused(system, fault):
    assert fault in PUSHED.find_fault(system)
    assert not holds(system, PUSHED)


@pytest.mark.parametrize(
    ("evidence", "fault"),
    [
        (replace(PUSHED, slope=0), "the slope is not positive"),
        (replace(PUSHED, slope=-11), "the slope is not positive"),
        (replace(PUSHED, slope=11.0), "float"),
        (replace(PUSHED, Q=((5,),)), "not a 2 x 2 matrix"),
        (replace(PUSHED, Q=((5, 5), (4, 14))), "Q is not symmetric"),
        (replace(PUSHED, Q=((5, 5), (5, 5))), "Q is not symmetric and positive definite"),
        (replace(PUSHED, Q=((5, 0), (0, 14))), "V does not decrease in mode m0"),
        (replace(PUSHED, slope=30), "V does not decrease in the free motion of mode m0"),
        (replace(PUSHED, slope=100), "V does not decrease in the free motion of mode m0"),
    ],
)
def test_other_numbers_are_refused(evidence, fault):
    assert fault in evidence.find_fault(settling())


def test_damping_in_contact_is_refused_even_if_nothing_is_said_to_pull():
    """The mode in contact then moves the other states in another way than free motion does."""
    damped = replace(bouncing(1), contact=replace(bouncing(1).contact, pulls=(), pushed=True))
    assert "are not those of free motion" in PUSHED.find_fault(damped)


# In contact Hurwitz, s^3 + 4 s^2 + 5 s + 10; in the air v' = v + f + 10, f' = -5 f - 40.
ESCAPING = family([[1, 1, -10], [0, -5, 40], [1, 0, 0]])
IN_THE_AIR = Mode("free", matrix([[1, 1, 0], [0, -5, 0], [1, 0, 0]]))
ESCAPES = replace(ESCAPING, contact=Contact((IN_THE_AIR,), pushed=True))


def lyapunov_matrix():
    """Q that decreases in contact, from the equation ``A'Q + QA = -I``, in integers over 2^20."""
    A = np.array(ESCAPING.modes[0].A.floats())
    n = len(A)
    system = np.kron(A.T, np.eye(n)) + np.kron(np.eye(n), A.T)
    Q = np.linalg.solve(system, -np.eye(n).ravel()).reshape(n, n)
    return tuple(tuple(round(float(v) * 2**20) for v in row) for row in (Q + Q.T) / 2)


@pytest.mark.parametrize("slope", [1, 2**10, 2**20, 2**24])
def test_without_the_free_motion_something_false_would_be_proved(slope):
    """It stays in the air for ever, from ``v = -3``, though Q decreases in contact."""
    evidence = ConstantForce(lyapunov_matrix(), 20, slope)
    *before, last = evidence.forms(ESCAPES)
    assert len(before) == 2
    assert all(np.linalg.eigvalsh(np.array(form, dtype=float))[0] > 0 for _, form in before)
    assert last[0] == "V does not decrease in the free motion of mode m0"
    assert evidence.find_fault(ESCAPES) == last[0]
    assert not holds(ESCAPES, evidence)
    # States v, f, delta and d = 1.
    flow = expm(np.array([[1, 1, 0, 10], [0, -5, 0, -40], [1, 0, 0, 0], [0, 0, 0, 0]]) * 0.01)
    x = np.array([-3.0, -8.0, -1.0, 1.0])
    for _ in range(1000):
        x = flow @ x
        assert x[2] < 0
    assert x[2] < -1e4


@given(
    numbers=st.tuples(*[st.integers(-6, 20)] * 3),
    slope=st.integers(-2, 24),
    k=st.tuples(*[st.integers(1, 4)] * 2),
    damping=st.integers(0, 4),
)
@settings(max_examples=300, deadline=None)
def test_the_check_agrees_with_the_conditions_as_they_are_derived(numbers, slope, k, damping):
    a, b, c = numbers
    system = replace(
        family(*([[-damping, -stiffness], [1, 0]] for stiffness in k)),
        contact=Contact((Mode("free", matrix([[-damping, 0], [1, 0]])),), pushed=True),
    )
    evidence = ConstantForce(((a, b), (b, c)), 0, slope)
    assert (evidence.find_fault(system) is None) == holds(system, evidence)


@given(
    start=st.tuples(st.floats(-20, 20), st.floats(-20, 10)),
    seed=st.integers(0, 2**32 - 1),
)
@settings(max_examples=8, deadline=None)
def test_v_never_rises_along_random_runs(start, seed):
    """With any signal among the modes, and averages of them; in units of d."""
    random, step = np.random.default_rng(seed), 1e-3
    Q, s = np.array(PUSHED.Q) / 16, PUSHED.slope / 16
    v, e = start

    def V(v, e):
        w = np.array([v, max(e, -1.0)])
        return w @ Q @ w + 2 * s * max(-1.0 - e, 0.0)

    values = [V(v, e)]
    for i in range(15_000):
        if i % 300 == 0:
            k = random.choice([1.0, 2.0, random.uniform(1, 2)])
        # Heun's method: the field is continuous.
        dv, de = -2 * v - k * max(e, -1.0), v
        nv, ne = v + step * dv, e + step * de
        v, e = (
            v + step * (dv - 2 * nv - k * max(ne, -1.0)) / 2,
            e + step * (de + nv) / 2,
        )
        values.append(V(v, e))
    assert (np.diff(values) <= 1e-13 * values[0]).all()
    assert values[-1] < 1e-3 * values[0] or values[-1] < 1e-9


def test_a_fraction_of_the_denominator_is_all_that_a_scale_changes():
    scaled = ConstantForce(((10, 10), (10, 28)), 5, 22)
    assert scaled.find_fault(settling()) is None
    assert Fraction(scaled.slope, 2**5) == Fraction(PUSHED.slope, 2**4)
