import dataclasses
import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.errors import SpecError
from nrs_design.spec import Quantity, kinds
from nrs_design.spec.quantity import QuantityKind, is_less, parse_quantity

from .samples import message_of


def test_keeps_what_was_written() -> None:
    quantity = parse_quantity("4.8417e-4 rad/s/rpm", kinds.ACTUATOR_GAIN)
    assert quantity.text == "4.8417e-4 rad/s/rpm"
    assert quantity.unit == "rad/s/rpm"
    assert quantity.value == quantity.exact == Fraction(48417, 10**8)
    assert quantity.is_exact
    with pytest.raises(dataclasses.FrozenInstanceError):
        quantity.__setattr__("unit", "m")


def test_exact_is_refused_where_pi_enters() -> None:
    quantity = parse_quantity("8 deg/s", kinds.ANGULAR_VELOCITY)
    assert not quantity.is_exact
    assert quantity.si == pytest.approx(8 * math.pi / 180, rel=1e-15)
    with pytest.raises(ValueError, match="pi"):
        _ = quantity.exact


@pytest.mark.parametrize(
    ("text", "kind", "said"),
    [
        # Units with pi are refused in what enters a proof.
        ("43 N*m/deg", kinds.STIFFNESS, "write it in N*m/rad, such as '2463.72 N*m/rad'"),
        ("4 deg/s/rpm", kinds.ACTUATOR_GAIN, "such as '0.0698132 rad/s/rpm'"),
        ("57 Hz/rad", kinds.ZERO, "such as '358.142 1/s'"),
        ("2 N*m*s/deg", kinds.IMPEDANCE, "N*m*s/rad"),
        ("2 deg/(N*m)", kinds.FORCE_GAIN, "rad/(N*m)"),
        ("1 rad/Hz", kinds.DWELL_TIME, "write it in s"),
        ("1 rad/Hz", kinds.DURATION, "write it in s"),
        ("43 N*m", kinds.STIFFNESS, "write '43 N*m/rad'"),
        ("43 N*m/rad", kinds.TORQUE, "write '43 N*m'"),
        ("2 1/s", kinds.BANDWIDTH, "write '2 Hz' or '2 rad/s'"),
        ("2 rpm", kinds.BANDWIDTH, "never converted"),
        ("8 rpm", kinds.ANGULAR_VELOCITY, "never converted"),
        ("8 1/s", kinds.ANGULAR_VELOCITY, "write '8 rad/s'"),
        ("57 rad/s", kinds.ZERO, "write '57 1/s'"),
        ("4e-4 rad/s", kinds.ACTUATOR_GAIN, "write '4e-4 rad/s/rpm' or '4e-4 rad/s/V' or"),
        ("4e-4", kinds.ACTUATOR_GAIN, "or '4e-4 rad/s/counts', whichever the motor takes"),
        ("2060 rpm", kinds.DERIVATIVE_GAIN, "write '2060 rpm*s/rad'"),
        ("20 V", kinds.DERIVATIVE_GAIN, "velocity: write '20 V*s/rad'"),
        ("20 mV/rad", kinds.DERIVATIVE_GAIN, "proportional gain: write '0.02 V*s/rad'"),
        ("43 N*mm", kinds.STIFFNESS, "write '0.043 N*m/rad'"),
        (
            "24",
            kinds.COMMAND,
            "write '24 rpm' or '24 V' or '24 A' or '24 counts' or '24 N*m', whichever",
        ),
        ("24 rad/s", kinds.COMMAND, "or '24 V' or '24 A' or '24 counts', whichever"),
        (
            "24 N",
            kinds.COMMAND,
            "write '24 rpm' or '24 V' or '24 A' or '24 counts' or '24 N*m', whichever",
        ),
        ("2 N*s/m", kinds.IMPEDANCE, "square of its lever arm"),
        ("1 kg", kinds.INERTIA, "square of its lever arm"),
        ("0.3 m", kinds.TORQUE, "write it in N*m, such as '0.3 N*m'"),
        ("0.3", kinds.TORQUE, "write '0.3 N*m'"),
        ("0.3N*m", kinds.TORQUE, "write '0.3 N*m'"),
        ("0.3 Nm", kinds.TORQUE, "did you mean N*m?"),
        ("−0.3 N*m", kinds.TORQUE, "use the ASCII hyphen"),
        ("1e31 N*m", kinds.TORQUE, "SI values between"),
        ("1e-99 N*m", kinds.TORQUE, "SI values between"),
        ("nan N*m", kinds.TORQUE, "write an integer"),
        ("0.3 " + "N*" * 50, kinds.TORQUE, "such as '0.3 N*m'"),
    ],
)
def test_says_what_to_write(text: str, kind: QuantityKind, said: str) -> None:
    with pytest.raises(SpecError) as caught:
        parse_quantity(text, kind)
    assert said in (caught.value.remedy or "")


def test_the_error_names_the_expected_units() -> None:
    with pytest.raises(SpecError, match=r"expected N\*m/rad or N/m"):
        parse_quantity("3 s", kinds.STIFFNESS)


ALL_KINDS = [kind for kind in vars(kinds).values() if isinstance(kind, QuantityKind)]


numbers = st.fractions(min_value=Fraction(1, 10**6), max_value=10**6, max_denominator=10**6)


@given(numbers, numbers, st.sampled_from(["deg/s", "rad/s", "mrad/min", "Hz"]))
def test_conversion_is_linear(a: Fraction, b: Fraction, unit: str) -> None:
    x, y, total = (Quantity(f"{v} {unit}", v, unit) for v in (a, b, a + b))
    assert x.rational_part + y.rational_part == total.rational_part
    assert total.si == pytest.approx(x.si + y.si, rel=1e-14)


@given(numbers, numbers)
def test_order_does_not_depend_on_units(a: Fraction, b: Fraction) -> None:
    newton = Quantity(f"{a} N/m", a, "N/m")
    millimeter = Quantity(f"{b / 1000} N/mm", b / 1000, "N/mm")
    assert is_less(newton, millimeter) == (a < b)


def test_order_across_powers_of_pi() -> None:
    assert is_less(Quantity("1 deg", Fraction(1), "deg"), Quantity("1 rad", Fraction(1), "rad"))
    assert not is_less(
        Quantity("180 deg", Fraction(180), "deg"), Quantity("3.14 rad", Fraction(314, 100), "rad")
    )


@given(st.text(max_size=60), st.sampled_from(ALL_KINDS))
def test_garbage_is_a_quantity_or_refused(text: str, kind: QuantityKind) -> None:
    assert message_of(lambda: parse_quantity(text, kind)).isprintable()


@pytest.mark.parametrize(
    ("text", "kind", "meant", "never"),
    [
        ("8 degs", kinds.ANGULAR_VELOCITY, "did you mean deg/s?", "mean deg?"),
        ("8 deg/sec", kinds.ANGULAR_VELOCITY, "did you mean deg/s?", "mean s?"),
        (
            "8 degs",
            kinds.BANDWIDTH,
            "a bandwidth is written in rad/s or Hz, such as '2 Hz'",
            "mean",
        ),
        ("0.3 Nm", kinds.TORQUE, "did you mean N*m?", "rad"),
        ("3 Nm/rad", kinds.STIFFNESS, "did you mean N*m/rad?", "known"),
        ("0.02 rad/Nm", kinds.FORCE_GAIN, "did you mean rad/(N*m)?", "mean rad/N*m"),
        ("8 furlongs", kinds.LEVER_ARM, "a length is written in m, such as '0.24 m'", "mean"),
        ("24 mmm", kinds.LEVER_ARM, "did you mean mm?", "known"),
        ("24 volts", kinds.COMMAND, "a command of the motor is written in", "such as"),
        ("8 °/s", kinds.ANGULAR_VELOCITY, "write deg for degrees", "mean"),
    ],
)
def test_a_unit_that_is_no_unit_is_told_by_what_is_measured(text, kind, meant, never) -> None:
    with pytest.raises(SpecError) as caught:
        parse_quantity(text, kind)
    assert meant in caught.value.remedy
    assert never not in caught.value.remedy
