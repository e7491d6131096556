"""A safety layer as operations: idle it changes no bit, and what it lets pass keeps its limits."""

from dataclasses import astuple
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.controllers.float32 import float32_not_above, to_float32
from nrs_design.controllers.replica import step
from nrs_design.controllers.safety import SafetyLimits
from nrs_design.errors import DesignError
from nrs_design.spec.quantity import Quantity
from nrs_design.spec.safety import SafetySpec
from tests.simulation.safe import LIMITS, PERIOD, governed, law_of

LAW, BARE = law_of(), law_of(layer=False)
SPEED, TORQUE, ENERGY, REFILL = map(float, astuple(LIMITS))


def sampled(law, **given):
    """Compute one step of the stiff admittance from its inputs and states."""
    states = {"reference": 0.0, "velocity": 0.0, "error_before": 0.0, "spent": 0.0}
    inputs = {"angle": 0.0, "torque": 0.0, "velocity_command": 0.0}
    known = {v.name for v in law.values}
    every = inputs | states | given
    each = {name: np.array([every[name]], np.float32) for name in known}
    done = step(law, np.array([1], np.uint32), each)
    assert done.valid.all()
    found = {**done.outputs, **{f"next {k}": v for k, v in done.states.items()}}
    return {name: value[0] for name, value in found.items()}


def moved(**given):
    """Return by how much the reference moves from zero, and what is booked."""
    found = sampled(LAW, **given)
    return float(found["next reference"]), float(found["next spent"]), float(found["withheld"])


@given(
    angle=st.floats(-3, 3, width=32),
    reference=st.floats(-3, 3, width=32),
    torque=st.floats(-TORQUE, TORQUE, width=32).filter(lambda f: abs(f) <= TORQUE),
    velocity=st.floats(-0.125, 0.125, width=32),
    spent=st.floats(0, ENERGY / 2, width=32),
)
def test_within_its_limits_no_bit_differs(angle, reference, torque, velocity, spent):
    given = {"angle": angle, "reference": reference, "torque": torque, "velocity": velocity}
    with_layer, bare = sampled(LAW, **given, spent=spent), sampled(BARE, **given)
    assert with_layer["withheld"] == 0
    for name, value in bare.items():
        assert with_layer[name].view(np.uint32) == value.view(np.uint32), name


@pytest.mark.parametrize("sign", [-1, 1])
def test_the_speed_of_the_reference_is_limited(sign):
    way, _, withheld = moved(velocity=-sign * 2.0)
    assert sign * way == np.float32(float(to_float32(PERIOD))) * np.float32(SPEED)
    assert sign * withheld == pytest.approx(float(PERIOD) * (2 - SPEED), rel=1e-6)


@pytest.mark.parametrize("sign", [-1, 1])
def test_beyond_the_limit_of_the_torque_the_reference_only_retreats(sign):
    just = np.nextafter(np.float32(TORQUE), np.float32(1))
    for torque in (TORQUE, just, 5.0):
        inward, _, withheld = moved(torque=sign * torque, velocity=-sign * 0.1)
        retreat, _, _ = moved(torque=sign * torque, velocity=sign * 0.1)
        assert (inward == 0) == (torque > TORQUE) == (withheld != 0)
        assert sign * retreat < 0


def test_the_smallest_step_beyond_the_limit_is_seen():
    """A product that vanishes would have no sign."""
    just = np.nextafter(np.float32(TORQUE), np.float32(1))
    tiny = np.finfo(np.float32).smallest_subnormal * 1024
    assert moved(torque=float(just), velocity=-float(tiny))[0] == 0


def test_a_step_that_would_spend_too_much_is_not_made_and_is_not_booked():
    left = 1e-6
    way, spent, _ = moved(torque=0.2, velocity=-0.1, spent=ENERGY - left)
    assert way == 0
    assert spent == pytest.approx(ENERGY - left - REFILL, rel=1e-6)
    # What it costs: 0.2 N m times 0.2 mrad.
    way, spent, withheld = moved(torque=0.2, velocity=-0.1, spent=ENERGY - 1e-4)
    assert (way > 0, withheld) == (True, 0)
    assert spent == pytest.approx(ENERGY - 1e-4 + 0.2 * way - REFILL, rel=1e-6)
    # A step out gives back.
    _, spent, _ = moved(torque=0.2, velocity=0.1, spent=ENERGY)
    assert spent == pytest.approx(ENERGY - 0.2 * 0.0002 - REFILL, rel=1e-6)
    assert moved(torque=0.2, velocity=0.1)[1] == 0


@given(
    start=st.floats(0, ENERGY, width=32).filter(lambda x: x <= ENERGY),
    steps=st.lists(st.tuples(st.floats(-1, 1, width=32), st.floats(-4, 4, width=32)), max_size=30),
)
def test_over_any_samples_no_more_is_spent_than_is_said(start, steps):
    """In rational numbers, from any account; refusals are not booked."""
    lost = 2 * Fraction(1, 2**22) * (LIMITS.energy + LIMITS.refill) + Fraction(1, 2**100)
    tick, account, total = np.float32(float(to_float32(PERIOD))), start, Fraction(0)
    for n, (torque, velocity) in enumerate(steps, 1):
        found = sampled(LAW, torque=torque, velocity=velocity, spent=account)
        asked = tick * (np.float32(0) - np.float32(velocity))
        way = Fraction(float(asked)) - Fraction(float(found["withheld"]))
        # The difference of both is the step but for its own rounding.
        way = Fraction(float(np.float32(float(way))))
        total += Fraction(float(np.float32(torque))) * way
        account = float(found["next spent"])
        assert 0 <= account <= ENERGY
        room = LIMITS.energy - Fraction(start) + n * (LIMITS.refill + lost)
        assert total <= room + n * Fraction(1, 2**24) * abs(Fraction(float(asked)))


def spec(**changed):
    texts = {
        "speed": "10 deg/s",
        "torque": "0.3 N*m",
        "energy": "5 mJ",
        "stiffness": ("30 N*m/rad", "60 N*m/rad"),
    }
    return SafetySpec.model_validate(texts | changed)


def test_numbers_that_ship_are_not_above_those_of_the_spec():
    limits = SafetyLimits.of(spec(power="1 mW"), PERIOD)
    assert limits.torque == float32_not_above(Fraction(3, 10)) < Fraction(3, 10)
    assert limits.energy == float32_not_above(Fraction(5, 1000)) <= Fraction(5, 1000)
    assert limits.refill == float32_not_above(Fraction(2, 10**6)) <= Fraction(2, 10**6)
    assert float(limits.speed) <= np.pi / 18
    assert SafetyLimits.of(spec(), PERIOD).refill == 0
    assert isinstance(spec().energy, Quantity)


def test_a_torque_whose_excess_would_have_no_sign_is_refused():
    with pytest.raises(DesignError, match="too small for single precision"):
        SafetyLimits.of(spec(torque="9e-7 N*m"), PERIOD)
    assert SafetyLimits.of(spec(torque="1e-6 N*m"), PERIOD)


def test_without_a_refill_there_is_no_number_for_it():
    limits = SafetyLimits(LIMITS.speed, LIMITS.torque, LIMITS.energy, Fraction(0))
    assert "less_refill" in LAW.coefficient
    assert "less_refill" not in law_of(limits=limits).coefficient
    assert governed().find_odd() is None
