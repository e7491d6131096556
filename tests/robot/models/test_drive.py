import pytest

from nrs_design.errors import DesignError
from nrs_design.robot.models.drive import build_drive
from nrs_design.spec import parse_spec
from nrs_design.spec.templates import TEMPLATES


def test_ratios_of_the_thesis(drive):
    # Thesis 4.2: 181:1 and 5:1.
    assert drive.encoder_ratio == 5


def test_free_motor_answers_as_identified(drive):
    # Thesis 4.9: speed of the encoder over command is 4.8417e-4/(0.0351 s + 1).
    speed = drive.encoder_ratio * drive.torque_per_command / drive.damping
    assert speed == pytest.approx(4.8417e-4, rel=1e-12)
    assert drive.inertia / drive.damping == pytest.approx(0.0351, rel=1e-4)


def test_friction_at_the_joint(drive):
    # 276.575 rpm over 2.7044e5 rpm/(N m), behind 905:1.
    assert drive.friction == pytest.approx(276.575 / 2.7044e5 * 905, rel=1e-12)


def changed(old, new):
    text = TEMPLATES["robot"]
    assert old in text
    return parse_spec(text.replace(old, new)).drive


def test_gradient_of_the_print_is_accepted():
    # 2.7261e5 follows from the printed R; it is 0.8 % off.
    printed = changed("gradient: 2.7044e5", "gradient: 2.7261e5")
    assert build_drive(printed).torque_per_command == pytest.approx(905 / 2.7261e5)


def test_numbers_that_contradict_each_other():
    with pytest.raises(DesignError, match=r"contradict each other.*0\.0474 s.*0\.0351 s"):
        build_drive(changed("rotor_inertia: 14.81e-7", "rotor_inertia: 20e-7"))
