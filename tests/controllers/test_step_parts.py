"""The parts of the steps of one axis: what a filter, limits and inertia add to a list."""

from fractions import Fraction

import pytest
from nrs_design.controllers.sampled import SampledMotion
from nrs_design.controllers.step_parts import (
    BEYOND,
    StepFrame,
    StepLimits,
    admitted,
    error_before,
    felt,
    filtered,
    lags,
    motion,
)

from nrs_design.controllers.sensor import LowPass

MOTION = SampledMotion(Fraction(1000), Fraction(2000))


def frame(order):
    low_pass = LowPass(order, Fraction(200)).sampled(Fraction(1, 500)) if order else None
    return StepFrame(MOTION, low_pass)


@pytest.mark.parametrize("order", [0, 1, 2])
def test_lags_of_a_filter(order):
    """Each takes what the one before makes of this sample, and is remembered."""
    made = frame(order)
    assert (made.order, made.force) == (order, felt(order))
    operations = list(filtered(order))
    assert len(operations) == 3 * order
    taken = [operation.right for operation in operations if operation.left == "q"]
    assert taken == [felt(i) for i in range(order)]
    states = [value.name for value in lags(order)]
    assert list(made.memory) == ["error_before", *states]
    assert [c.name for c in made.coefficients][2:] == (["p", "q"] if order else [])
    assert felt(0) == "torque"


def test_the_command_saturates_where_there_is_a_limit():
    for limits, last in (
        (StepLimits(), "command"),
        (StepLimits(command=Fraction(4000)), "limited_command"),
    ):
        assert [*motion(limits)][-1].name == last
        assert limits.output == {"command": last}
        assert [c.values for c in limits.coefficients] == [(Fraction(4000),)] * (last != "command")


def test_limits_are_those_of_the_values():
    limits = StepLimits(angle=Fraction(1, 2))
    found = {value.name: value.limit for value in (*limits.measured, *limits.commanded)}
    assert found == {
        "angle": Fraction(1, 2),
        "torque": BEYOND,
        "position": Fraction(1, 2),
        "wanted_torque": BEYOND,
    }
    assert error_before(limits.angle).limit == Fraction(1, 2)


@pytest.mark.parametrize("inert", [True, False])
def test_an_admittance_moves_the_reference_by_the_wanted_less_its_velocity(inert):
    """With inertia its velocity is that of before the sample."""
    operations = {operation.name: operation for operation in admitted("torque", inert=inert)}
    assert operations["relative"].right == "velocity"
    assert ("velocity" in operations) != inert
    assert ("next_velocity" in operations) == inert
    assert operations["wanted"].kind == "saturate"
