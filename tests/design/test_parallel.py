"""Where parallel control is stable: Routh by hand, exact ends, and dead time against Pade."""

from fractions import Fraction

import numpy as np
import pytest
from control import pade
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.controllers.laws import ParallelForce
from nrs_design.design.parallel import border, is_stable, unstable_stiffness
from nrs_design.design.transfer import TransferFunction
from nrs_design.models.contact.elastic import Elastic
from nrs_design.models.motion_loop import MotionLoop, realize
from nrs_design.switched.modes import position_mode

# G of the thesis, 6.13: (28.416 s + 1618.8)/(s^2 + 56.89 s + 1618.8).
THESIS = MotionLoop(
    (Fraction("28.416"), Fraction("1618.8")), (Fraction(1), Fraction("56.89"), Fraction("1618.8"))
)
tenths = st.integers(0, 500).map(lambda n: Fraction(n, 10))
positive = st.integers(1, 500).map(lambda n: Fraction(n, 10))


def polynomial(loop, Kp, Ki, k):
    lead, a1, a0 = map(float, loop.denominator)
    b1, b0 = map(float, loop.numerator)
    p, i = float(k * Kp), float(k * Ki)
    return [lead, a1 + p * b1, a0 + p * b0 + i * b1, i * b0]


def test_the_mode_has_the_polynomial_of_the_map():
    """``s D + k (Kp s + Ki) N`` at the thesis's stiffness and gain, and Ki = 0.2."""
    law = ParallelForce(Fraction("0.02"), Fraction("0.2"))
    k = Fraction("43.0356")
    rows = position_mode(realize(THESIS), law, Elastic(k))
    A = np.array([[float(v) for v in row] for row in rows])
    assert np.poly(A) == pytest.approx(polynomial(THESIS, law.Kp, law.Ki, k), rel=1e-9)


def test_integral_alone_by_hand():
    """``k Ki (b0 - a1 b1) < a1 a0``: with the G of the thesis, 41 900 N m/rad at Ki = 1."""
    low, high = unstable_stiffness(THESIS, Fraction(0), Fraction(1))
    assert high is None
    assert low == Fraction("56.89") * Fraction("1618.8") / (
        Fraction("1618.8") - Fraction("56.89") * Fraction("28.416")
    )
    assert float(low) == pytest.approx(41_900, rel=2e-2)


def test_the_gain_of_the_thesis_bears_every_stiffness():
    assert unstable_stiffness(THESIS, Fraction("0.02"), Fraction("0.2")) is None
    assert unstable_stiffness(THESIS, Fraction("2e-5"), Fraction(1)) is None
    assert unstable_stiffness(THESIS, Fraction("1e-9"), Fraction(1)) is not None


@given(tenths, tenths, *[positive] * 3, tenths)
def test_routh_against_roots(p, i, a1, a0, b0, b1):
    loop = MotionLoop((b1, b0), (Fraction(1), a1, a0))
    roots = np.roots(polynomial(loop, p, i, 1))
    if abs(roots.real.max()) > 1e-6:
        assert is_stable(loop, p, i) == (roots.real.max() < 0)


@given(tenths, positive, *[positive] * 3, tenths)
def test_no_stiffness_outside_the_interval_is_unstable(Kp, Ki, a1, a0, b0, b1):
    loop = MotionLoop((b1, b0), (Fraction(1), a1, a0))
    found = unstable_stiffness(loop, Kp, Ki)
    ends = () if found is None else tuple(end for end in found if end is not None)
    tried = [Fraction(2) ** n for n in range(-20, 21)]
    for k in (*tried, *(end * f for end in ends for f in (Fraction(99, 100), Fraction(101, 100)))):
        low, high = found or (None, None)
        inside = low is not None and low <= k and (high is None or k <= high)
        stable = is_stable(loop, k * Kp, k * Ki)
        assert stable or inside
        if inside and (high is None or high > low * Fraction(21, 20)):
            near = any(abs(k - end) <= abs(end) / 50 for end in ends)
            assert near or not stable


def test_another_motion_loop():
    third = MotionLoop((Fraction(1),), (Fraction(1),) * 4)
    assert is_stable(third, Fraction(1), Fraction(1)) is None
    with pytest.raises(ValueError, match="second order"):
        unstable_stiffness(third, Fraction(1), Fraction(1))


def rightmost(p, i, delay):
    """Largest real part of the poles, the dead time by Pade of order 8."""
    D, N = [1.0, 56.89, 1618.8], [28.416, 1618.8]
    above, below = pade(delay, 8)
    closed = np.polyadd(
        np.polymul(np.polymul([1.0, 0.0], D), below), np.polymul(np.polymul([p, i], N), above)
    )
    return np.roots(closed).real.max()


@pytest.mark.parametrize("delay", [0.002, 0.005, 0.01])
def test_dead_time_against_pade(delay):
    motion = TransferFunction((28.416, 1618.8), (1.0, 56.89, 1618.8))
    frequencies = np.linspace(5, 0.95 * np.pi / delay, 400)
    p, i = border(motion, delay, frequencies)
    on = (p > 0.1) & (i > 10)
    assert on.sum() > 20
    for x, y in zip(p[on][::20], i[on][::20], strict=True):
        assert rightmost(x, 0.97 * y, delay) < rightmost(x, 1.03 * y, delay)
        assert rightmost(x, 0.97 * y, delay) < 0 < rightmost(x, 1.03 * y, delay)
