"""Robot specs: what they hold, and what is refused."""

import pytest

from nrs_design.robot.models import build_robot
from nrs_design.spec import RobotSpec, parse_spec
from nrs_design.spec.describe import describe, si_unit
from nrs_design.spec.templates import TEMPLATES

from .samples import place_of, refusal, spoiled

TEXT = TEMPLATES["robot"]
ROD = "crank: {mass: 73.3 g, center_of_mass: [75.6 mm, 0 mm, 0 mm], inertia: slender-rod}"
TENSOR = (
    "crank: {mass: 73.3 g, center_of_mass: [75.6 mm, 1 mm, -2 mm], inertia: tensor, "
    "tensor: {xx: 10 g*mm^2, yy: 111324.375 g*mm^2, zz: 111324.375 g*mm^2, xy: -3 g*mm^2}}"
)


def robot_spec(text: str = TEXT) -> RobotSpec:
    spec = parse_spec(text)
    assert isinstance(spec, RobotSpec)
    return spec


def test_tensor_instead_of_rod() -> None:
    robot = build_robot(robot_spec(spoiled(TEXT, ROD, TENSOR)))
    crank = robot.legs[0].crank
    assert crank.center_of_mass == pytest.approx([0.0756, 0.001, -0.002])
    assert crank.inertia[1, 1] == pytest.approx(0.0733 * 0.135**2 / 12)
    assert crank.inertia[0, 1] == crank.inertia[1, 0] == pytest.approx(-3e-9)
    assert crank.inertia[0, 2] == pytest.approx(0, abs=1e-18)


@pytest.mark.parametrize(
    ("old", "new", "said", "at"),
    [
        ("azimuth: -45 deg", "azimuth: -45", "has no unit", "-45\n"),
        ("azimuth: -45 deg", "azimuth: 45 deg", "parallel", None),
        ("azimuth: -45 deg", "azimuth: 225 deg", "parallel", None),
        ("mass: 73.3 g,", "mass: -73.3 g,", "zero or positive", "-73.3 g"),
        ("mass: 73.3 g,", "mass: 73.3 mm,", "not a mass", "73.3 mm"),
        ("mass: 73.3 g,", "mass: 0.7 N,", "that is a weight", "0.7 N"),
        ("[36.7 mm, 0 mm, 10 mm]", "[36.7 mm, 0 mm]", "center_of_mass", None),
        ("[36.7 mm, 0 mm, 10 mm]", "[36.7 mm, 0 mm, 10 g]", "not a length", "10 g"),
        (ROD, ROD.replace("slender-rod", "tensor"), "go together", None),
        (ROD, TENSOR.replace("inertia: tensor", "inertia: slender-rod"), "go together", None),
        (ROD, TENSOR.replace("xx: 10 g", "xx: 999999 g"), "no body has that", None),
        ("capstan_ratio: 5", "capstan_ratio: 0", "positive", None),
        ("encoder_counts: 8192", "encoder_counts: 8192.5", "integer", "8192.5"),
        ("encoder_counts: 8192", "encoder_counts: 1", "integer", None),
        ("coulomb_friction: 276.575 rpm", "coulomb_friction: 29 rad/s", "never converted", "29 "),
        ("4.8417e-4 rad/s/rpm", "0.145 rad/s/V", "the motor takes rpm", "0.145"),
        ("2060 rpm*s/rad", "6.9 V*s/rad", "the motor takes rpm", "6.9 V"),
        (
            "coulomb_friction: 276.575 rpm",
            "coulomb_friction: 0.9 V",
            "the motor takes rpm",
            "0.9 V",
        ),
        ("{min: 150 mm, max: 250 mm}", "{min: 250 mm, max: 150 mm}", "below min", None),
        ("base_tilt: 0 deg", "base_tilt: 0 rad/s", "angular velocity", "0 rad/s"),
        ("  left:\n    # Rec", "  lift:\n    # Rec", "unknown key `legs.lift`", "lift"),
        ("gravity: 9.81 m/s^2", "gravity: 9.81 m/s", "not an acceleration", "9.81 m/s\n"),
    ],
)
def test_what_is_wrong_is_refused_with_its_place(
    old: str, new: str, said: str, at: str | None
) -> None:
    text = spoiled(TEXT, old, new)
    error = refusal(text)
    assert said in f"{error.message} ({error.remedy})"
    if at is not None:
        assert (error.line, error.column) == place_of(text, new[new.index(at.strip()) :].strip())


@pytest.mark.parametrize("sign", ["0", "2", "-0.5", "yes"])
def test_elbow_sign(sign: str) -> None:
    text = TEXT.replace("elbow_sign: -1", f"elbow_sign: {sign}", 1)
    assert "elbow_sign" in refusal(text).message


def test_balance_and_control_may_be_left_out() -> None:
    text = TEXT[: TEXT.index("# Thesis 4.2 and 4.3")]
    spec = robot_spec(text)
    assert (spec.control, spec.balance) == (None, None)


def test_description_lists_every_quantity() -> None:
    rows = {row.name: row for row in describe(robot_spec())}
    assert rows["legs.left.azimuth"].value == "-0.785398"
    assert rows["legs.right.arm.center_of_mass[0]"][1:] == ("75.4 mm", "0.0754", "m")
    assert rows["gravity"].unit == "m/s^2"
    assert rows["drive.speed_torque_gradient"].unit == "s^2*rpm/kg/m^2"
    assert rows["control.motion_loop.damping_ratio"].written == "0.707"
    assert "name" not in rows


def test_units_of_a_dimension() -> None:
    assert si_unit((0,) * 8) == "1"
    assert si_unit((0, 0, -1, 0, 0, 0, 0, 0)) == "1/s"
    assert si_unit((1, 2, -2, -1, 0, 0, 0, 0)) == "kg*m^2/s^2/rad"
