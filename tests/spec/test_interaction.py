from fractions import Fraction

import pytest
from pydantic import ValidationError

from nrs_design.spec import ImpedanceControllerSpec
from nrs_design.spec.controllers import contact_names, touched_in
from nrs_design.spec.describe import describe
from nrs_design.spec.environment import KelvinBoltzmannSpec, MaxwellSpec

from .samples import (
    FORCE,
    IMPEDANCE,
    interaction,
    place_of,
    refusal,
    spoiled,
)


def test_reads_quantities_and_defaults() -> None:
    spec = interaction(IMPEDANCE)
    assert spec.name == "sample"
    assert spec.title == ""
    assert spec.motion_loop.damping_ratio == Fraction(707, 1000)
    assert spec.motion_loop.derivative_gain is None
    assert spec.limits.torque.exact == Fraction(3, 10)
    assert spec.design.significant_digits == 4
    assert spec.coordinates == "deflection"
    insertion = spec.controllers["insertion"]
    assert isinstance(insertion, ImpedanceControllerSpec)
    assert insertion.contacts == ("soft",)
    assert insertion.desired_impedance is None
    assert insertion.desired_impedance_ratio is None
    assert insertion.weights.displayed == insertion.weights.sensitivity == Fraction(1, 2)


def test_offset_of_force_controllers() -> None:
    """Thesis 6.41: by default there is none, and all force controllers have the same."""
    assert interaction(FORCE).offset == "none"
    gain = "    proportional_gain: 0.02 rad/(N*m)\n"
    measured = spoiled(FORCE, gain, gain + "    offset: measured\n")
    assert interaction(measured).offset == "measured"
    other = f"  gentle:\n    type: force\n    environment: soft\n{gain}"
    error = refusal(spoiled(measured, "switching:", other + "switching:"))
    assert "'gentle' has offset none, 'force' has measured" in error.message
    error = refusal(spoiled(FORCE, gain, gain + "    offset: position\n"))
    assert "offset" in str(error)


AT_ONCE = spoiled(
    IMPEDANCE, "environment: soft\n", "environment: soft\n    contacts: [[soft, hand]]\n"
)


def test_contacts_touched_at_once() -> None:
    spec = interaction(AT_ONCE)
    insertion = spec.controllers["insertion"]
    assert insertion.contacts == (("soft", "hand"),)
    assert contact_names(insertion.contacts) == ("soft+hand",)
    assert touched_in(insertion.contacts) == ("soft", "hand")
    assert spec.touched == {"soft", "hand"}


def test_environments_may_be_missing_without_contact() -> None:
    head, _, rest = FORCE.partition("environments:\n")
    tail = "controllers:\n  free: {type: position}\nswitching: arbitrary\n"
    assert interaction(head + tail).environments == {}
    error = refusal(head + "controllers:" + rest.partition("controllers:")[2])
    assert "there is no environment 'soft'" in error.message


def test_is_frozen() -> None:
    spec = interaction(IMPEDANCE)
    with pytest.raises(ValidationError, match="frozen"):
        spec.__setattr__("name", "other")


def test_at_least_one_controller() -> None:
    head = IMPEDANCE.partition("controllers:")[0]
    error = refusal(head + "controllers: {}\nswitching: arbitrary\n")
    assert "controllers: must not be empty" in error.message


def test_reports_the_first_fault_and_counts_the_others() -> None:
    text = spoiled(IMPEDANCE, "0.0351 s", "0.0351 m")
    text = spoiled(text, "8 deg/s", "8 m")
    text = spoiled(text, "747.1461 N/m", "nan N/m")
    error = refusal(text)
    assert "actuator.time_constant" in error.message
    assert [(f.line, f.column) for f in error.faults] == [
        place_of(text, "0.0351 m"),
        place_of(text, "8 m"),
        place_of(text, "nan N/m"),
    ]
    assert str(error).endswith("; 2 more faults in this file")
    one = refusal(spoiled(spoiled(IMPEDANCE, "0.0351 s", "0.0351 m"), "8 deg/s", "8 m"))
    assert str(one).endswith("; 1 more fault in this file")


def test_names_may_equal_keys() -> None:
    text = IMPEDANCE.replace("insertion:", "environment:").replace("soft", "model")
    assert set(interaction(text).controllers) == {"environment"}
    error = refusal(spoiled(text, "    Mt: 0.01 kg*m^2\n", "    Mm: 0.01 kg*m^2\n"))
    assert "`controllers.environment.Mt` is missing" in error.message


def test_entries_are_limited() -> None:
    many = "".join(f"  e{i}: {{model: elastic, stiffness: 1 N*m/rad}}\n" for i in range(65))
    error = refusal(spoiled(IMPEDANCE, "  soft:\n", many + "  soft:\n"))
    assert "environments: more than 64 entries are not read" in error.message


BOLTZMANN = (
    "model: kelvin-boltzmann\n    parallel_stiffness: 4 N/m\n    series_stiffness: 17 N/m\n"
    "    damping: {nominal: 400 N*s/m, range: [300 N*s/m, 500 N*s/m]}"
)
MAXWELL = "model: maxwell\n    stiffness: 700 N/m\n    damping: 40 N*s/m"
SOFT = "model: elastic\n    stiffness: 747.1461 N/m"


def test_kelvin_boltzmann() -> None:
    nose = interaction(spoiled(IMPEDANCE, SOFT, BOLTZMANN)).environments["soft"]
    assert isinstance(nose, KelvinBoltzmannSpec)
    turned = nose.at_pivot()
    assert list(turned) == ["parallel_stiffness", "series_stiffness", "damping"]
    assert turned["series_stiffness"].nominal.text == "0.9792 N*m/rad"
    assert turned["damping"].nominal.unit == "N*m*s/rad"
    assert [q.exact for q in turned["damping"].range] == [
        300 * Fraction("0.0576"),
        500 * Fraction("0.0576"),
    ]
    assert not nose.fixed


def test_maxwell_alone() -> None:
    gel = interaction(spoiled(IMPEDANCE, SOFT, MAXWELL)).environments["soft"]
    assert isinstance(gel, MaxwellSpec)
    assert gel.at_pivot()["damping"].nominal.exact == 40 * Fraction("0.0576")


def test_force_control_of_a_kelvin_voigt_spring_is_allowed() -> None:
    text = spoiled(FORCE, "model: elastic", "model: kelvin-voigt\n    damping: 0 N*s/m")
    assert interaction(text).environments["soft"].is_spring


FREE = ("  insertion:", "  free: {type: position}\n  insertion:")
IDLE = ("switching:", "idle_states: {decay: 20 1/s}\nswitching:")


def test_idle_states() -> None:
    mixed = IMPEDANCE.replace(*FREE, 1).replace(*IDLE, 1)
    spec = interaction(mixed)
    assert spec.idle_states is not None
    assert spec.idle_states.decay.exact == 20
    assert not spec.idle_states.reset
    both = interaction(mixed.replace("20 1/s}", "1/2 1/s, reset: true}"))
    assert both.idle_states is not None
    assert both.idle_states.reset


VOLTS = spoiled(IMPEDANCE, "gain: 4.8417e-4 rad/s/rpm", "command: V\n  gain: 145.2 rad/s/mV")


def test_a_motor_that_takes_volts():
    spec = interaction(VOLTS)
    assert (spec.actuator.command, spec.actuator.gain.nominal.si) == ("V", 145200.0)
    rows = {row.name: row for row in describe(spec)}
    assert rows["actuator.gain"][1:] == ("145.2 rad/s/mV", "145200", "rad/s/V")
    assert rows["actuator.command"].written == "V"
    assert interaction(IMPEDANCE).actuator.command == "rpm"
