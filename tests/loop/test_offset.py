"""The offset X_i of thesis 6.41, as a memory that the modes and resets stand for."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm

from nrs_design.controllers.laws import PositionControl, ProportionalForce
from nrs_design.errors import AssemblyError
from nrs_design.loop.modes import lead, position_mode, replace_last
from nrs_design.models.contact import Elastic
from nrs_design.models.motion_loop import MotionLoop, realize
from nrs_design.proof.matrix import RationalMatrix
from tests.loop.support import LOOP, MOTION, assembled, polynomial
from tests.support import FORCE_LIMIT, ROBOT, words_of

F = Fraction
OFFSET = ROBOT / "force-limit-offset.nrs.yaml"
SECOND = """  gentle:
    type: force
    environment: soft
    proportional_gain: 0.01 rad/(N*m)
    offset: measured
"""


def system(old="offset: measured", new="offset: measured"):
    return assembled(OFFSET, (old, new))


def test_lead_of_the_thesis_loop():
    """Ap of thesis 6.12: the lead is (a1 - c2) w1 + w2, as the PD has it."""
    assert lead(MOTION) == [F("56.89") - F("28.416"), 1]


@given(
    numerator=st.lists(st.fractions(-5, 5, max_denominator=20), min_size=0, max_size=2),
    denominator=st.lists(st.fractions("1/10", 9, max_denominator=20), min_size=3, max_size=3),
)
def test_lead_is_command_less_position(numerator, denominator):
    """With w = Ap xi + Bp u at any xi and u."""
    motion = realize(MotionLoop((*numerator, denominator[-1]), (F(1), *denominator)))
    xi, u = [F(3), F(-2), F(5)], F(7)
    w = [sum(a * x for a, x in zip(row, xi, strict=True)) for row in motion.A]
    w[-1] += u
    theta = sum(c * x for c, x in zip(motion.C, xi, strict=True))
    assert sum(y * x for y, x in zip(lead(motion), w, strict=True)) == u - theta


def test_modes_keep_their_poles():
    force, soft = ProportionalForce(F("0.02")), Elastic(F("43.0356"))
    for rows in (position_mode(MOTION, PositionControl()), position_mode(MOTION, force, soft)):
        assert polynomial(replace_last(rows, lead(MOTION))) == polynomial(rows)


def test_a_loop_that_does_not_rest_at_its_command_is_refused():
    motion = realize(MotionLoop((F(1), F(2)), (F(1), F(3), F(4))))
    with pytest.raises(AssemblyError, match=r"G\(0\) is not 1"):
        lead(motion)


def test_without_offset_nothing_changes():
    expected = assembled(FORCE_LIMIT)
    found = system(new="offset: none")
    assert found.states == expected.states == ("xp1", "xp2")
    assert (found.modes, found.switching) == (expected.modes, expected.switching)
    assert words_of(found) == words_of(expected)


def test_reference_leaves_the_state_and_measured_sets_the_lead_to_zero():
    assert system(new="offset: reference").switching.resets == ()
    measured = system()
    assert measured.states == ("dxp1", "lead [rad]")
    pairs = {(reset.source, reset.target) for reset in measured.switching.resets}
    corners = ("force/soft/k-min", "force/soft/k-max")
    assert pairs == {(a, b) for c in corners for a, b in (("position", c), (c, "position"))}
    assert {reset.map for reset in measured.switching.resets} == {
        RationalMatrix.from_rows([[F(1), F(0)], [F(0), F(0)]])
    }


@given(seed=st.integers(0, 2**32 - 1), offset=st.sampled_from(["reference", "measured"]))
def test_run_with_the_memory_itself(seed, offset):
    """[xi, u] with X_i held and taken anew, Fd the force at the switch: what is eliminated."""
    rng = np.random.default_rng(seed)
    stiffness = 43.0
    A, C = np.array(MOTION.A, float), np.array(MOTION.C, float)
    B = np.array([0.0, 1.0])
    rows = {
        "position": position_mode(MOTION, PositionControl()),
        "force": position_mode(MOTION, ProportionalForce(F("0.02")), Elastic(F(43))),
    }
    modes = {name: np.array(replace_last(A, lead(MOTION)), float) for name, A in rows.items()}
    y = np.array(lead(MOTION), float)

    def coordinates(xi, u):
        w = A @ xi + B * u
        return np.array([w[0], y @ w])

    xi, u, mode = rng.normal(size=2) / 1000, 0.01, "position"
    x = coordinates(xi, u)
    for _ in range(6):
        time = rng.uniform(0.001, 0.05)
        # u' = -Kp k theta' in force mode, and u is constant in position mode.
        full = np.zeros((3, 3))
        full[:2, :2], full[:2, 2] = A, B
        if mode == "force":
            full[2] = -0.02 * stiffness * C @ np.column_stack([A, B])
        *xi, u = expm(full * time) @ [*xi, u]
        x = expm(modes[mode] * time) @ x
        assert x == pytest.approx(coordinates(np.array(xi), u), rel=1e-6, abs=1e-9)
        mode = "force" if mode == "position" else "position"
        xi = np.array(xi)
        if offset == "measured":
            # X_i = theta, and Fd = F, so that the correction starts from zero.
            u, x = C @ xi, x * [1, 0]


def test_two_force_controllers_reset_between_them_too():
    found = system("design:\n", SECOND + "design:\n")
    pairs = {(r.source.split("/")[0], r.target.split("/")[0]) for r in found.switching.resets}
    names = ("position", "force", "gentle")
    assert pairs == {(a, b) for a in names for b in names if a != b}


def test_stated_loop_with_another_static_gain_is_refused():
    stated = "  transfer_function: {numerator: [28.416, 1600], denominator: [1, 56.89, 1618.80]}\n"
    assert LOOP.numerator[1] == LOOP.denominator[2]
    with pytest.raises(AssemblyError, match=r"G\(0\) is not 1"):
        system(old="limits:\n", new=stated + "limits:\n")
