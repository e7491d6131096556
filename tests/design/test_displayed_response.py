"""What is felt and how well the tool follows: by hand, python-control, and random parameters."""

from fractions import Fraction
from math import sqrt

import numpy as np
import pytest

from nrs_design.controllers.laws import Admittance
from nrs_design.controllers.sensor import LowPass
from nrs_design.design.affine_family import Quotient, polynomial
from nrs_design.design.displayed_response import (
    largest_impedance,
    largest_over,
    largest_tracking_error,
)
from nrs_design.errors import InternalError
from nrs_design.loop.cut_loop import ContinuousAxis
from nrs_design.loop.parameter_box import Joint
from nrs_design.models.actuator import ActuatorRanges
from nrs_design.models.motion_loop import MotionLoop, realize
from nrs_design.thesis import thesis
from tests.design.motion_loops import LAG, PD, PLACE, interval

ONE = Fraction(1)
BAND = Fraction(0), Fraction(12)


def plain(loop=LAG, low_pass=None):
    return ContinuousAxis((PLACE,), realize(loop), None, low_pass)


def test_by_hand():
    """G = 1/(s + 1): Z = (Mt s + Bt)(s + 1), and 1 - G = s/(s + 1)."""
    law = Admittance(Fraction(2), Fraction(8))
    felt = largest_impedance(plain(), law, {}, (Fraction(0), ONE))
    assert felt.below**2 <= 2 * 68 <= felt.above**2
    assert felt.square == 1
    error = largest_tracking_error(plain(), law, {}, (Fraction(0), ONE))
    assert error.below**2 <= Fraction(1, 2) <= error.above**2
    assert error.above < Fraction("0.7072")


def test_slow_motions_feel_the_damping_and_follow_the_command():
    """Z tends to Bt as omega tends to 0, and the tracking error to 0."""
    law = Admittance(Fraction(2), Fraction(8))
    slow = Fraction(0), Fraction(1, 10**4)
    felt = largest_impedance(plain(), law, {}, slow)
    assert 8 <= felt.above < Fraction("8.0000001")
    assert largest_tracking_error(plain(), law, {}, slow).above < Fraction("0.000101")


def test_a_spring_is_felt_without_bound_at_rest():
    law = Admittance(ONE, Fraction(8), Fraction(5))
    felt = largest_impedance(plain(), law, {}, (Fraction(0), ONE), limit=Fraction(50))
    assert felt.above is None
    assert felt.below > 50
    held = largest_impedance(plain(), law, {}, (ONE, ONE + ONE))
    # At 1 rad/s, |s + 8 + 5/s| |s + 1| = |8 - 4j| sqrt 2; at 2 rad/s, |8 - j/2| sqrt 5.
    assert held.below**2 <= Fraction("64.25") * 5 <= held.above**2


def test_an_unstable_loop_is_not_judged():
    unstable = plain(MotionLoop((ONE,), (ONE, -ONE)))
    assert largest_impedance(unstable, Admittance(ONE, ONE), {}, BAND) is None
    assert largest_tracking_error(unstable, Admittance(ONE, ONE), {}, BAND) is None
    # Stable at 10 N m/rad and in the air, and not at 1000 N m/rad.
    law, loop = Admittance(ONE, Fraction(4)), plain(thesis.CLOSED_LOOP)
    for stiffest, judged in ((10, True), (1000, False)):
        box = {"k": interval(1, stiffest)}
        found = largest_tracking_error(loop, law, box, BAND, in_contact=True)
        assert (found is not None) == judged


def test_a_response_that_is_not_affine_is_a_defect():
    """A cube is odd about the middle of its range: there it is the mean of its ends."""

    def cubed(values):
        return Quotient(polynomial(values["k"] ** 3), polynomial(ONE), polynomial(ONE, ONE))

    with pytest.raises(InternalError, match="not affine"):
        largest_over(cubed, {"k": interval(-1, 1)}, BAND, None)


def test_what_does_not_come_to_rest_in_contact_is_not_judged():
    """G = s/(s + 1)^2 lets go of a spring at rest: a pole at zero, which is none of the air's."""
    loop = plain(MotionLoop((ONE, Fraction(0)), (ONE, ONE + ONE, ONE)))
    law, box = Admittance(ONE, ONE), {"k": interval(1, 2)}
    assert largest_tracking_error(loop, law, box, (ONE, ONE + ONE), in_contact=True) is None
    assert largest_tracking_error(loop, law, {}, (ONE, ONE + ONE)) is not None


def responses(omega, values, J, pole):
    """Return Z and ``1 - V/Vcmd`` by the equations of the loop: motor, PD, law, contact."""
    s = 1j * omega
    Km, tau, Mt, Bt, Kt = (values[name] for name in ("Km", "tau", "Mt", "Bt", "Kt"))
    law = s / (Mt * s**2 + Bt * s + Kt) * (pole / (s + pole) if pole else 1)
    pull = float(PD.Kp) / s + float(PD.Kd)
    torque = tau / float(J) if J else 0.0
    closed = tau * s + 1 + Km * pull
    admittance = (Km * pull * law + torque) / closed
    free = Km * pull / closed
    touched = free / (1 + admittance * (values["k"] / s + values["b"]))
    return 1 / admittance, 1 - free, 1 - touched


@pytest.mark.parametrize("J", [None, "0.3"])
@pytest.mark.parametrize("pole", [None, 150])
@pytest.mark.parametrize("spring", ["0", "0.8"])
def test_over_ranges_at_random_parameters(J, pole, spring):
    """No draw is above the bound, and at the witness the response is what is said."""
    motor = {"Km": interval("4.7e-4", "5e-4"), "tau": interval("0.033", "0.037")}
    gains = {"Mt": interval("0.008", "0.02"), "Bt": interval("1.5", "2.6")}
    contact = {"k": interval(3, 20), "b": interval(0, 1)}
    low_pass = None if pole is None else LowPass(1, Fraction(pole))
    joint = Joint(PD, ActuatorRanges(*motor.values(), "rpm"), None if J is None else Fraction(J))
    axis = ContinuousAxis((PLACE,), realize(thesis.CLOSED_LOOP), joint, low_pass)
    law = Admittance(Fraction("0.01"), Fraction("2.15"), Fraction(spring))
    band, box = (Fraction(1, 2), Fraction(12)), motor | gains
    found = [
        largest_impedance(axis, law, box, band),
        largest_tracking_error(axis, law, box, band),
        largest_tracking_error(axis, law, {**gains, **contact}, band, in_contact=True),
    ]
    fixed = {"Km": 4.8417e-4, "tau": 0.0351, "Mt": 0.01, "Bt": 2.15, "Kt": float(spring)}
    fixed |= {"k": 0.0, "b": 0.0}
    draw, omega = np.random.default_rng(1), np.linspace(0.5, 12, 100)
    boxes = (box, motor, {**gains, **contact})
    for i, (one, ranges) in enumerate(zip(found, boxes, strict=True)):
        assert one.above <= one.below * Fraction("1.01")
        for _ in range(25):
            drawn = {n: draw.uniform(float(r.low), float(r.high)) for n, r in ranges.items()}
            response = np.abs(responses(omega, fixed | drawn, J, pole)[i])
            assert response.max() <= float(one.above) * (1 + 1e-9)
        at = {name: float(v) for name, v in one.at.items()}
        there = responses(np.array([sqrt(one.square)]), fixed | at, J, pole)[i]
        assert abs(there[0]) == pytest.approx(float(one.below), rel=1e-9)
