from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.errors import AssemblyError
from nrs_design.models.actuator import Actuator
from nrs_design.models.motion_loop import JointMotionLoop, MotionLoop, close_motion_loop, realize

F = Fraction
ACTUATOR = Actuator(Fraction("4.8417e-4"), Fraction("0.0351"))


def test_unit_gain_at_rest():
    loop = close_motion_loop(ACTUATOR, Fraction(3), Fraction(7))
    assert loop.numerator[-1] == loop.denominator[-1]
    assert loop.denominator[1] - loop.numerator[0] == 1


class TestRealization:
    def test_transfer_function_comes_back(self):
        loop = MotionLoop((F(3), F(5)), (F(2), F(7), F(11), F(13)))
        motion = realize(loop)
        for s in (F(0), F(1), F(-1, 3), F(10)):
            n = motion.order
            x = [s**i for i in range(n)]  # (s - A) x = (den/leading) B in this canonical form
            residue = s * x[-1] - sum(a * b for a, b in zip(motion.A[-1], x, strict=True))
            gain = sum(c * b for c, b in zip(motion.C, x, strict=True)) / residue
            assert gain == (3 * s + 5) / (2 * s**3 + 7 * s**2 + 11 * s + 13)
            assert [s * x[i] - x[i + 1] for i in range(n - 1)] == [0] * (n - 1)

    @pytest.mark.parametrize(
        ("numerator", "denominator"),
        [((1, 1), (1, 1)), ((1, 1, 1), (1, 1)), ((1,), (1,)), ((1,), (0, 1))],
    )
    def test_not_strictly_proper(self, numerator, denominator):
        with pytest.raises(AssemblyError, match="strictly proper"):
            realize(MotionLoop(tuple(map(F, numerator)), tuple(map(F, denominator))))


class TestJointMotion:
    @pytest.mark.slow
    @given(*[st.fractions("1/50", 50, max_denominator=50)] * 4, st.fractions(-9, 9))
    def test_it_has_the_transfer_function_of_the_closed_loop(self, Kp, Kd, Km, tau, s):
        loop = close_motion_loop(Actuator(Km, tau), Kp, Kd)
        motion = JointMotionLoop(Kp, Kd, Km, tau, None)
        # At e = n, omega = m, u = 1: s e = e' and s omega = omega'.
        (a, b, c), (d, e, f) = motion.rates([F(0), F(0), F(1)])
        determinant = (s - a) * (s - e) - b * d
        numerator = d * c + (s - a) * f
        top, bottom = (
            sum(entry * s**k for k, entry in enumerate(reversed(row)))
            for row in (loop.numerator, loop.denominator)
        )
        assert numerator * bottom == top * determinant

    def test_a_load_slows_the_motor(self):
        motion = JointMotionLoop(F(3), F(5), F(2), F(1, 2), F(4))
        force, command = [F(0), F(0), F(7)], [F(0), F(0), F(0)]
        free, loaded = (motion.rates(command, load)[1] for load in (None, force))
        assert [b - a for a, b in zip(free, loaded, strict=True)] == [0, 0, F(-7, 4)]
        unloaded = JointMotionLoop(F(3), F(5), F(2), F(1, 2), None)
        assert unloaded.rates(command, force) == unloaded.rates(command)
