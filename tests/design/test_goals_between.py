"""Goals between the corners of ranges: proved, missed at a point between, or not judged."""

import pytest

from nrs_design.cli import exit_codes
from nrs_design.gating.examine import Examiner
from nrs_design.pipeline.design import run_analysis
from nrs_design.pipeline.runs import run_interaction
from nrs_design.spec import read_spec
from tests.support import run

# A motor with a load, and contact whose margins are worst inside its range: Ms 3.42, a disk margin
# of 0.334 and a delay margin of 42.6 ms at 81.3 N m/rad, a phase margin of 27.8 deg at 60 N m/rad
# (python-control).
SPEC = """kind: interaction-design
name: between
actuator: {gain: 0.00102 rad/s/rpm, time_constant: 0.08627 s, load_inertia: 0.3039 kg*m^2}
motion_loop: {damping_ratio: 0.707, settling_time: 0.34508 s, derivative_gain: 414 rpm*s/rad,
  zero: 30.52 1/s}
limits: {velocity: 8 deg/s, torque: 0.3 N*m, bandwidth: 2 Hz}
environments:
  soft: {model: kelvin-voigt, damping: 0.1618 N*m*s/rad,
    stiffness: {nominal: 25.71 N*m/rad, range: [25.71 N*m/rad, 257.1 N*m/rad], varies: false}}
controllers:
  c0: {type: impedance, environment: soft, Mt: 0.2156 kg*m^2, Bt: 2.128 N*m*s/rad}
goals: {GOALS}
contact: kept
switching: arbitrary
"""
# Sampled, with a range: no proof covers what is between.
SAMPLED = (
    SPEC.replace(", load_inertia: 0.3039 kg*m^2", "")
    .replace("contact: kept", "contact: kept\nsampling: {period: 2 ms, delay: 1}")
    .replace("Bt: 2.128", "Bt: 40")
)


def written(folder, text, goals):
    path = folder / "between.nrs.yaml"
    path.write_text(text.replace("{GOALS}", goals))
    return path


@pytest.mark.parametrize(
    ("goals", "standing"),
    [
        ("{max_sensitivity_peak: 2.4}", "missed"),
        ("{min_phase_margin: 38 deg}", "missed"),
        ("{min_delay_margin: 50 ms}", "missed"),
        ("{min_disk_margin: 0.5}", "missed"),
        ("{max_sensitivity_peak: 3.5}", "met"),
        ("{min_disk_margin: 0.32}", "met"),
        ("{min_delay_margin: 30 ms}", "met"),
    ],
)
def test_a_goal_is_met_over_the_whole_range_or_missed_between(tmp_path, goals, standing):
    loaded = read_spec(written(tmp_path, SPEC, goals))
    (item,) = run_analysis(run_interaction(loaded, "")).impedance
    (found,) = (one for one in item.judged if one.goal is not None)
    assert found.standing == standing


@pytest.mark.parametrize(
    ("text", "goals", "code"),
    [
        (SPEC, "{max_sensitivity_peak: 2.4}", 1),
        (SPEC, "{max_sensitivity_peak: 3.5}", 0),
        (SAMPLED, "{max_sensitivity_peak: 9}", 3),
        # One that is missed decides beside one that is open.
        (SAMPLED, "{max_sensitivity_peak: 9, min_gain_margin: 1e6}", 1),
        (
            SAMPLED.replace(", range: [25.71 N*m/rad, 257.1 N*m/rad], varies: false", ""),
            "{max_sensitivity_peak: 9}",
            0,
        ),
    ],
)
def test_optimize_and_gate_end_alike(tmp_path, text, goals, code):
    path = written(tmp_path, text, goals)
    run("optimize", path, cwd=tmp_path, code=code)
    loaded = read_spec(path)
    found = Examiner(loaded).goals(run_analysis(run_interaction(loaded, "")))
    assert exit_codes.OF_SEVERITY[max(item.severity for item in found)] == code
