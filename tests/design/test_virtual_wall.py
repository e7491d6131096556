"""A virtual wall: borders beside those that are published, and the loop that is proved."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.controllers.laws import LAWS
from nrs_design.controllers.step_law import StepFrame
from nrs_design.design.laws.torque_impedance import Wall, passivity_margin
from nrs_design.loop.command_timing import CommandTiming
from nrs_design.models.drive import Takes, torque_drive
from nrs_design.models.interval import Interval
from tests.literature.test_colgate_schenkel import is_passive
from tests.loop.frames import Frame

F = Fraction


def proved_radius(wall, K, B, late):
    """The spectral radius of the mode in the air that a certificate is about."""
    T = F(str(wall.period))
    law = LAWS["torque-impedance"](F(K), F(B)).discretize(T, "exact")
    timing = CommandTiming(T, late, late)
    drive = torque_drive(
        Interval.point(F(str(wall.inertia))), Interval.point(F(str(wall.friction)))
    )
    frame = Frame(timing, drive, StepFrame(F(0), F(0), takes=Takes.TORQUE), (law,), 0)
    n = len(frame.states)
    rows = frame.rows(law, 0, {})[:n]
    A = np.array([[float(v) for v in row[:n]] for row in rows])
    return abs(np.linalg.eigvals(A)).max()


@given(
    st.integers(1, 3000),
    st.integers(0, 8),
    st.sampled_from([F(0), F(1, 2000), F(1, 1000), F(7, 2000)]),
)
def test_the_wall_in_the_air_is_the_mode_that_is_proved(K, B, late):
    wall = Wall(0.2, 0.5, 0.001, float(late))
    assert wall.growth(K, B) == pytest.approx(proved_radius(wall, K, B, late), rel=1e-6, abs=1e-6)


# Of joint, period and delay: inertia, friction, T, t, and the damping of the wall.
@pytest.mark.parametrize(
    ("inertia", "friction", "T", "late", "damping"),
    [
        (0.1, 0.5, 0.001, 0.0, 0.2),
        (1.0, 0.1, 0.001, 0.001, 0.0),
        (0.4, 0.2, 0.0005, 0.002, 0.3),
        (2.0, 1.0, 0.002, 0.003, 1.0),
    ],
)
def test_the_border_is_about_that_of_gil_and_others(inertia, friction, T, late, damping):
    """K below (b + B)/(T/2 + t), for small B; the closer, the slower the joint is."""
    wall = Wall(inertia, friction, T, late)
    exact, estimate = wall.border(damping), wall.estimate(damping)
    assert exact == pytest.approx(estimate, rel=0.03)
    slow = Wall(1000 * inertia, friction, T, late)
    assert slow.border(damping) == pytest.approx(estimate, rel=1e-4)
    for share, stable in ((0.999, True), (1.001, False)):
        assert (wall.growth(share * exact, damping) < 1) is stable


def test_without_damping_anywhere_nothing_is_stable():
    assert Wall(1.0, 0.0, 0.001, 0.001).border(0.0) == 0.0


@given(st.integers(0, 2000), st.integers(-8, 8), st.sampled_from([F(1, 1000), F(1, 200)]))
def test_passivity_is_the_condition_at_all_frequencies(K, B, T):
    """Colgate and Schenkel 1997, equation 13, decided by the first root of a polynomial."""
    limit = F(K) * T / 2 + abs(F(B))
    for b in (limit * F(9, 10), limit * F(11, 10)):
        if K and b != limit:
            assert (passivity_margin(b, F(K), F(B), T) > 0) == is_passive(b, F(K), F(B), T)
