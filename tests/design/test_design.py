"""Gains of whole specs, rounded to what ships."""

from fractions import Fraction

import pytest

from nrs_design.controllers.float32 import is_float32, round_float32
from nrs_design.design.analysis import design_controllers, root_locus_design
from nrs_design.design.laws.impedance import desired_impedance
from nrs_design.errors import DesignError
from nrs_design.spec import load_spec, parse_spec
from nrs_design.spec.build_plant import build_plant
from tests.support import FORCE_LIMIT, SOFT_TISSUE


def design(text):
    spec = parse_spec(text)
    return design_controllers(spec, build_plant(spec))


def test_motion_gains_follow_the_root_locus_if_none_are_given():
    text = SOFT_TISSUE.read_text()
    text = text.replace("  derivative_gain: 2060 rpm*s/rad\n", "").replace(
        "  zero: 56.9706 1/s\n", ""
    )
    spec, motion = parse_spec(text), design(text).motion
    wanted = root_locus_design(spec)
    # Three significant digits, as the spec asks for.
    assert float(motion.Kd) == pytest.approx(wanted.derivative_gain, rel=5e-3)
    assert motion.Kd == 2070
    assert float(motion.zero) == pytest.approx(57.0, rel=1e-6)


def test_motion_gains_that_vanish_in_single_precision():
    text = FORCE_LIMIT.read_text().replace("derivative_gain: 2060", "derivative_gain: 1e-29")
    text = text.replace("zero: 56.9706", "zero: 1e-29")
    with pytest.raises(DesignError, match="zero in single precision") as caught:
        design(text)
    assert caught.value.at == ("motion_loop",)


@pytest.mark.parametrize("digits", [1, 4, 7])
def test_all_gains_are_single_precision(digits):
    text = SOFT_TISSUE.read_text().replace("significant_digits: 3", f"significant_digits: {digits}")
    found = design(text)
    numbers = [found.motion.Kp, found.motion.Kd]
    numbers += [gain for c in found.controllers for gain in (c.law.Mt, c.law.Bt)]
    assert all(map(is_float32, numbers))


def test_rounding_never_leaves_the_bounds():
    text = SOFT_TISSUE.read_text().replace("max: 20 N*m*s/rad", "max: 0.994 N*m*s/rad")
    found = design(text.replace("significant_digits: 3", "significant_digits: 1"))
    for controller in found.controllers:
        assert controller.law.Bt <= round_float32(Fraction("0.994"))


def test_force_gain_as_given_and_from_a_damping_ratio():
    text = FORCE_LIMIT.read_text()
    assert design(text).controllers[1].law.Kp == round_float32(Fraction("0.02"))
    asked = text.replace("proportional_gain: 0.02 rad/(N*m)", "damping_ratio: 0.741")
    assert float(design(asked).controllers[1].law.Kp) == pytest.approx(0.02, rel=0.02)


def test_desired_impedance():
    """Thesis 6.2: 0.3 N m over 8 deg/s is 2.1486 N m s/rad."""
    spec = load_spec(SOFT_TISSUE)
    insertion, withdrawal = (spec.controllers[name] for name in ("insertion", "withdrawal"))
    assert desired_impedance(spec, insertion) == pytest.approx(2.14859, rel=1e-5)
    assert desired_impedance(spec, withdrawal) == pytest.approx(2.14859 / 2, rel=1e-5)
    given = SOFT_TISSUE.read_text().replace(
        "desired_impedance_ratio: 0.5", "desired_impedance: 3.5 N*m*s/rad"
    )
    spec = parse_spec(given)
    assert desired_impedance(spec, spec.controllers["withdrawal"]) == 3.5
