"""The sampled loop: against a step-by-step simulation, known answers, and what is not modelled."""

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from nrs_design.controllers.sampled import (
    ROUNDINGS,
)
from nrs_design.errors import AssemblyError
from nrs_design.models.actuator import ActuatorRanges
from nrs_design.pipeline import run_design
from nrs_design.proof.system import SwitchedSystem, Time
from nrs_design.spec import read_spec
from nrs_design.spec.interval import Interval
from nrs_design.switched.assemble import assemble
from nrs_design.switched.sampled_loop import motor_box
from tests.support import FORCE_LIMIT, SOFT_TISSUE

TEXT = SOFT_TISSUE.read_text(encoding="utf-8")
TOLERANCE = (
    (
        "gain: 4.8417e-4 rad/s/rpm",
        "gain: {nominal: 4.8417e-4 rad/s/rpm, "
        "range: [4.744866e-4 rad/s/rpm, 4.938534e-4 rad/s/rpm]}",
    ),
    (
        "time_constant: 0.0351 s",
        "time_constant: {nominal: 0.0351 s, range: [0.034398 s, 0.035802 s]}",
    ),
)


def system_of(
    path: Path, sampling: str, *changes: tuple[str, str], text: str = TEXT
) -> SwitchedSystem:
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = path / "sampled.nrs.yaml"
    path.write_text(f"{text}\nsampling: {sampling}\n", encoding="utf-8")
    designed = run_design(read_spec(path))
    assert designed is not None
    return assemble(designed.spec, designed.plant, designed.design, "deflection")


def test_modes_and_states_of_the_thesis_robot(tmp_path):
    system = system_of(tmp_path, "{period: 2 ms, delay: [0, 1]}")
    assert system.time is Time.DISCRETE
    assert system.sample_time == Fraction(1, 500)
    assert system.states == (
        "e [rad]",
        "omega [rad/s]",
        "e before [rad]",
        "vm [rad/s]",
        "F 1 before [N*m]",
        "delta [rad]",
    )
    # Two controllers, two delays, two ends of k, two bounds on exp(-T/tau).
    assert len(system.modes) == 16
    assert len(system.contact.free) == 8
    assert system.find_contradiction() is None
    assert [item.name for item in system.roundings] == [*ROUNDINGS]
    texts = " ".join(system.assumptions)
    assert "0 to 1 sample old" in texts
    assert "D (e - e before) 3" in texts
    assert "without jitter" in texts
    assert "Kd/T = 1030000" in texts


def test_a_tolerance_of_the_motor_gives_its_corners(tmp_path):
    system = system_of(tmp_path, "{period: 2 ms, delay: [0, 1]}", *TOLERANCE)
    assert len(system.modes) == 64
    assert "may change at every sample" in " ".join(system.assumptions)


def test_without_inertia_there_is_no_velocity(tmp_path):
    system = system_of(
        tmp_path,
        "{period: 2 ms, delay: 0}",
        ("min: 0.01 kg*m^2, max: 1 kg*m^2", "min: 0 kg*m^2, max: 0 kg*m^2"),
    )
    assert system.order == 4


PERIOD = Fraction(1, 500)
TAU, KM = Fraction("0.0351"), Fraction("4.8417e-4")


def test_bounds_of_the_motor_hold_what_lies_between():
    """E and s at any time constant of the range lie within their axes."""
    tau = Interval(TAU, TAU * Fraction(9, 10), TAU * Fraction(11, 10))
    box = motor_box(ActuatorRanges(Interval.point(KM), tau), PERIOD).ranges
    Km, E, s = (box[symbol] for symbol in ("Km", "E", "s"))
    assert Km == Interval.point(KM)
    for share in np.linspace(0, 1, 50):
        value = float(tau.low + Fraction(float(share)) * (tau.high - tau.low))
        exponential = np.exp(-0.002 / value)
        assert float(E.low) <= exponential * (1 + 1e-12)
        assert exponential <= float(E.high) * (1 + 1e-12)
        assert float(s.low) <= value * (1 - exponential) * (1 + 1e-12)
        assert value * (1 - exponential) <= float(s.high) * (1 + 1e-12)


BT = "Bt: {min: 0.1 N*m*s/rad, max: 20 N*m*s/rad"
RANGED_SOFT = "{nominal: 747.1461 N/m, range: [720.56 N/m, 768.17 N/m]}"


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ([(f"{BT}}}", f"{BT}, range: [1 N*m*s/rad, 3 N*m*s/rad]}}")], "have ranges"),
        ([("model: elastic", "model: maxwell\n    damping: 20 N*s/m")], "remembers"),
        (
            [
                (RANGED_SOFT, "747.1461 N/m"),
                ("switching: arbitrary", "switching: {dwell_time: 1 s}"),
            ],
            "have dwell times",
        ),
    ],
)
def test_what_the_sampled_loop_does_not_model_is_refused(tmp_path, changes, said):
    with pytest.raises(AssemblyError, match=said) as caught:
        system_of(tmp_path, "{period: 2 ms, delay: 0}", *changes)
    assert "sampling" in caught.value.remedy
    assert caught.value.at


def test_other_controllers_are_refused(tmp_path):
    with pytest.raises(AssemblyError, match="is a position controller"):
        system_of(
            tmp_path, "{period: 2 ms, delay: 0}", text=FORCE_LIMIT.read_text(encoding="utf-8")
        )


def test_force_coordinates_are_refused(tmp_path):
    path = tmp_path / "sampled.nrs.yaml"
    path.write_text(f"{TEXT}\nsampling: {{period: 2 ms, delay: 0}}\n", encoding="utf-8")
    designed = run_design(read_spec(path))
    with pytest.raises(AssemblyError, match="do not apply to the sampled loop"):
        assemble(designed.spec, designed.plant, designed.design, "force")


def test_contact_is_kept_where_the_spec_says_so(tmp_path):
    system = system_of(tmp_path, "{period: 2 ms, delay: 0}\ncontact: kept")
    assert system.contact is None
    assert "Contact is not lost" in " ".join(system.assumptions)


def test_a_damped_environment_is_kept(tmp_path):
    damped = ("model: elastic", "model: kelvin-voigt\n    damping: 1 N*s/m")
    system = system_of(tmp_path, "{period: 2 ms, delay: 0}", damped)
    assert system.contact is None
    assert "lags behind is not modelled" in " ".join(system.assumptions)


def test_loss_of_contact_with_damping_is_refused_where_the_spec_asks_for_it(tmp_path):
    damped = ("model: elastic", "model: kelvin-voigt\n    damping: 1 N*s/m")
    with pytest.raises(AssemblyError, match="loss of contact with soft, which has damp") as caught:
        system_of(tmp_path, "{period: 2 ms, delay: 0}\ncontact: losable", damped)
    assert "contact: kept" in caught.value.remedy
    assert caught.value.at == ("contact",)


def test_where_free_motion_rests_is_not_said(tmp_path):
    losable = system_of(tmp_path, "{period: 2 ms, delay: 0}")
    assert "all modes in contact then rest at one point" in " ".join(losable.assumptions)
    kept = system_of(tmp_path, "{period: 2 ms, delay: 0}\ncontact: kept")
    assert "all modes then rest at one point" in " ".join(kept.assumptions)


def test_doubts_about_identified_values_are_said(tmp_path):
    doubtful = (
        "time_constant: 0.0351 s",
        'time_constant: 0.0351 s\n  doubts: ["dead time"]\n  accept_doubt: it is short',
    )
    about = ("    model: elastic", "    model: elastic\n    linearized_about: 2 mm")
    texts = system_of(tmp_path, "{period: 2 ms, delay: 0}", doubtful, about).assumptions
    assert any("actuator is in doubt: dead time; accepted because: it is short" in t for t in texts)
    assert any("soft is the linearization about 2 mm" in text for text in texts)
